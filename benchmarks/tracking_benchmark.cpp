// Compares the cost of a tracking simulation with that of the physics engine alone, and measures
// how evaluations scale over cores. Every ratio is measured within one run, with both sides running
// alternately, so that a slower machine slows down both.
#include <benchmark/benchmark.h>
#include <ode/ode.h>

#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

#include "measure.hpp"
#include "problems/config/design_file.hpp"
#include "problems/config/problem_loader.hpp"
#include "sim/engines/ode/ode_arm.hpp"
#include "study/executor/case_executor.hpp"

namespace armwright {
namespace {

// Replays recorded efforts on the same bodies and hinges in plain ODE, and does nothing else.
void replay_in_bare_ode(const RobotModel& model, std::span<const double> start_positions,
                        const std::vector<TrajectorySample>& recorded, double dt_s) {
  const dWorldID world = dWorldCreate();
  dWorldSetGravity(world, 0, 0, -9.80665);
  dWorldSetERP(world, 0.25);
  dWorldSetCFM(world, 0);
  dWorldSetAutoDisableFlag(world, 0);
  const auto poses = calc_link_poses(model, start_positions);
  std::vector<dJointID> hinges;
  dBodyID parent = nullptr;
  for (std::size_t i = 0; i < model.joint_count(); ++i) {
    const Inertial& inertial = model.links[i].inertial;
    const Eigen::Matrix3d& inertia = inertial.inertia_kg_m2;
    const Eigen::Matrix3d rotation = poses[i].linear();
    const Eigen::Vector3d com = poses[i] * inertial.com_m;
    const Eigen::Vector3d anchor = poses[i].translation();
    const Eigen::Vector3d axis = rotation * model.joints[i].axis;
    const dBodyID body = dBodyCreate(world);
    dMass mass;
    dMassSetParameters(&mass, inertial.mass_kg, 0, 0, 0, inertia(0, 0), inertia(1, 1),
                       inertia(2, 2), inertia(0, 1), inertia(0, 2), inertia(1, 2));
    dBodySetMass(body, &mass);
    dBodySetPosition(body, com.x(), com.y(), com.z());
    dMatrix3 r = {};
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        r[4 * row + column] = rotation(row, column);
      }
    }
    dBodySetRotation(body, r);
    const dJointID hinge = dJointCreateHinge(world, nullptr);
    dJointAttach(hinge, body, parent);
    dJointSetHingeAnchor(hinge, anchor.x(), anchor.y(), anchor.z());
    dJointSetHingeAxis(hinge, axis.x(), axis.y(), axis.z());
    hinges.push_back(hinge);
    parent = body;
  }
  for (const TrajectorySample& sample : recorded) {
    for (std::size_t i = 0; i < hinges.size(); ++i) {
      dJointAddHingeTorque(hinges[i], sample.effort[i]);
    }
    dWorldStep(world, dt_s);
  }
  benchmark::DoNotOptimize(dBodyGetPosition(parent)[0]);
  dWorldDestroy(world);
}

void BM_WholeTrackingAgainstBareOde(benchmark::State& state) {
  const LoadedProblem problem = load_problem(state.range(0) == 0 ? "q1-complex" : "q2-e6");
  const ArmDesign design = load_design(problem.published.design).design;
  const TestSet set = problem.tracking()->get_set("test/2");
  const TrackingSetup& setup = problem.tracking()->setup();
  const TargetTable targets = setup.make_targets(set.make_case(0));
  const TrackingResult recorded =
      problem.tracking()->track(design, set, 0, {.error_series = false, .trajectory = true});
  const auto engine = make_engine("ode");
  TrackingJob job;
  job.design = &design;
  job.targets = &targets;

  std::vector<double> whole, bare, ratio;
  for (auto _ : state) {
    whole.push_back(measure_s([&] {
      benchmark::DoNotOptimize(engine->simulate(setup, {&job, 1}));
    }));
    bare.push_back(measure_s([&] {
      replay_in_bare_ode(setup.robot(), targets.start_positions, recorded.trajectory,
                         setup.task().control_period_s);
    }));
    ratio.push_back(whole.back() / bare.back());
  }
  state.counters["whole_ns_per_step"] = 1e9 * calc_median(whole) / targets.steps;
  state.counters["bare_ns_per_step"] = 1e9 * calc_median(bare) / targets.steps;
  state.counters["ratio"] = calc_median(ratio);
  state.SetLabel(problem.name);
}
BENCHMARK(BM_WholeTrackingAgainstBareOde)
    ->Arg(0)
    ->Arg(1)
    ->Iterations(150)
    ->Unit(benchmark::kMillisecond);

void BM_InverseKinematicsOfOneCase(benchmark::State& state) {
  const LoadedProblem problem = load_problem("q1-complex");
  const TrackingSetup& setup = problem.tracking()->setup();
  const TestCase test_case = problem.tracking()->get_set("test/2").make_case(0);
  std::vector<double> seconds;
  int steps = 0;
  for (auto _ : state) {
    seconds.push_back(measure_s([&] { steps = setup.make_targets(test_case).steps; }));
  }
  state.counters["ns_per_step"] = 1e9 * calc_median(seconds) / steps;
}
BENCHMARK(BM_InverseKinematicsOfOneCase)->Unit(benchmark::kMicrosecond);

// Evaluates a generation of the genetic algorithm, 35 designs on one new case, on one thread and on
// two.
void BM_GenerationOnTwoCoresAgainstOne(benchmark::State& state) {
  const LoadedProblem problem = load_problem("q1-complex");
  const auto x = problem.tracking()->make_vector(load_design("table-a5").design);
  StopSignal stop;
  ThreadExecutor one(1);
  ThreadExecutor two(2);
  std::uint64_t number = 0;
  const auto evaluate_generation = [&](ThreadExecutor& executor) {
    const CaseBlock block{CaseRole::training, "train/1", {number++}};
    const std::vector<std::span<const double>> candidates(35, x);
    executor.evaluate(*problem.problem, candidates, block, {}, stop,
                      [](std::size_t, Evaluation) {});
  };
  std::vector<double> speedup, serial, parallel;
  const std::uint64_t computed_before = problem.tracking()->targets().computed();
  for (auto _ : state) {
    serial.push_back(measure_s([&] { evaluate_generation(one); }));
    parallel.push_back(measure_s([&] { evaluate_generation(two); }));
    speedup.push_back(serial.back() / parallel.back());
  }
  state.counters["speedup"] = calc_median(speedup);
  state.counters["evaluations_per_s_on_two"] = 35 / calc_median(parallel);
  state.counters["inverse_kinematics_per_generation"] =
      static_cast<double>(problem.tracking()->targets().computed() - computed_before) /
      static_cast<double>(number);
}
BENCHMARK(BM_GenerationOnTwoCoresAgainstOne)->Iterations(30)->Unit(benchmark::kMillisecond);

// The parts of a plant, each with those before it.
const std::vector<std::string> kPlantParts = {"rotor inertia", "friction", "Stribeck",
                                              "counterbalance", "springs"};

RobotModel make_plant(RobotModel robot, std::size_t parts) {
  for (std::size_t i = 0; i < robot.joint_count(); ++i) {
    JointPlant& plant = robot.joints[i].plant;
    const double size = i < 3 ? 1 : 0.005;
    plant.armature = 100 * size;
    plant.viscous = parts > 0 ? 50 * size : 0;
    plant.coulomb = parts > 0 ? 80 * size : 0;
    plant.offset = parts > 0 ? 5 * size : 0;
    plant.stribeck = parts > 1 ? 30 * size : 0;
    if (parts > 3 && i < 2) {
      plant.stiffness = 5e5;  // resolved by the one step of 10 ms
      plant.damping = 1e3;
    }
  }
  if (parts > 2) {
    robot.joints[1].plant.counterbalance = {-2, 3, std::vector<double>(1025, 300)};
  }
  return robot;
}

// Measures what the plant of real joints costs the engine `articulated` per robot step.
void BM_PlantAgainstIdealArm(benchmark::State& state) {
  const LoadedProblem problem = load_problem("q1-complex");
  const TrackingSetup& ideal = problem.tracking()->setup();
  const auto parts = static_cast<std::size_t>(state.range(0));
  const TrackingSetup full(make_plant(ideal.robot(), parts), ideal.task());
  ArmDesign design = load_design("table-a1").design;
  for (JointDrive& drive : design.joints) {
    for (double& gain : drive.gains) {
      gain *= 0.15;  // so that springs do not swing up
    }
  }
  const TargetTable targets =
      ideal.make_targets(problem.tracking()->get_set("test/2").make_case(0));
  const auto engine = make_engine("articulated");
  std::vector<TrackingJob> jobs(engine->batch_size().largest);
  for (TrackingJob& job : jobs) {
    job.design = &design;
    job.targets = &targets;
  }
  std::vector<double> with, without, ratio;
  for (auto _ : state) {
    with.push_back(measure_cpu_s([&] { benchmark::DoNotOptimize(engine->simulate(full, jobs)); }));
    without.push_back(
        measure_cpu_s([&] { benchmark::DoNotOptimize(engine->simulate(ideal, jobs)); }));
    ratio.push_back(with.back() / without.back());
  }
  const double steps = static_cast<double>(jobs.size()) * targets.steps;
  state.counters["plant_ns_per_step"] = 1e9 * calc_median(with) / steps;
  state.counters["ideal_ns_per_step"] = 1e9 * calc_median(without) / steps;
  state.counters["ratio"] = calc_median(ratio);
  for (const TrackingResult& result : engine->simulate(full, jobs)) {
    if (result.steps != targets.steps) {
      state.SkipWithError("a simulation did not reach the end");
    }
  }
  state.SetLabel("with " + kPlantParts[parts]);
}
BENCHMARK(BM_PlantAgainstIdealArm)->DenseRange(0, 4)->Iterations(60)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace armwright

BENCHMARK_MAIN();
