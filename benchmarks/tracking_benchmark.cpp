// Compares the cost of a tracking simulation with that of the physics engine alone, and measures
// how evaluations scale over cores. Every ratio is measured within one run, with both sides running
// alternately, so that a slower machine slows down both.
#include <benchmark/benchmark.h>
#include <ode/ode.h>

#include <algorithm>
#include <memory>
#include <numeric>
#include <string>
#include <utility>
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

// One case of an arm's own task, as many times as the engine `articulated` takes together.
struct Work {
  Work(const TrackingSetup& its_setup, ArmDesign its_design, double gain_factor,
       const TestCase& test_case)
      : setup(its_setup), design(std::move(its_design)), targets(setup.make_targets(test_case)) {
    for (JointDrive& drive : design.joints) {
      for (double& gain : drive.gains) {
        gain *= gain_factor;
      }
    }
    jobs.resize(engine->batch_size().largest);
    for (TrackingJob& job : jobs) {
      job.design = &design;
      job.targets = &targets;
    }
  }
  // Returns the CPU time per robot step.
  double measure_ns() const {
    const double time_s =
        measure_cpu_s([&] { benchmark::DoNotOptimize(engine->simulate(setup, jobs)); });
    return 1e9 * time_s / (static_cast<double>(jobs.size()) * targets.steps);
  }
  bool reaches_end() const {
    return std::ranges::all_of(engine->simulate(setup, jobs), [&](const TrackingResult& result) {
      return result.steps == targets.steps;
    });
  }

  std::unique_ptr<PhysicsEngine> engine = make_engine("articulated");
  const TrackingSetup& setup;
  ArmDesign design;
  TargetTable targets;
  std::vector<TrackingJob> jobs;
};

void compare_work(benchmark::State& state, const Work& work, const Work& reference) {
  std::vector<double> own, other, ratio;
  for (auto _ : state) {
    own.push_back(work.measure_ns());
    other.push_back(reference.measure_ns());
    ratio.push_back(own.back() / other.back());
  }
  state.counters["ns_per_step"] = calc_median(own);
  state.counters["reference_ns_per_step"] = calc_median(other);
  state.counters["ratio"] = calc_median(ratio);
  if (!work.reaches_end() || !reference.reaches_end()) {
    state.SkipWithError("a simulation did not reach the end");
  }
}

// Measures what the plant of real joints costs per robot step.
void BM_PlantAgainstIdealArm(benchmark::State& state) {
  const LoadedProblem problem = load_problem("q1-complex");
  const TrackingSetup& ideal = problem.tracking()->setup();
  const auto parts = static_cast<std::size_t>(state.range(0));
  const TrackingSetup full(make_plant(ideal.robot(), parts), ideal.task());
  const ArmDesign design = load_design("table-a1").design;
  const TestCase test_case = problem.tracking()->get_set("test/2").make_case(0);
  constexpr double kGainFactor = 0.15;  // so that springs do not swing up
  compare_work(state, {full, design, kGainFactor, test_case},
               {ideal, design, kGainFactor, test_case});
  state.SetLabel("with " + kPlantParts[parts]);
}
BENCHMARK(BM_PlantAgainstIdealArm)->DenseRange(0, 4)->Iterations(60)->Unit(benchmark::kMillisecond);

// Compares a step of an arm of six or seven joints with one of the thesis's arm.
void BM_MoreJointsAgainstThesisArm(benchmark::State& state) {
  const std::string robot = state.range(0) == 7 ? "arm7" : "irb4600_six";
  const LoadedProblem thesis = load_problem("q1-complex");
  const LoadedProblem problem = load_problem("robot", std::vector{"robot.urdf=" + robot});
  const TrackingConfig& config = problem.tracking()->config();
  TrackingTask task = config.task;
  // One substep, as for the thesis's arm. Without gravity and with weak controllers, the arm takes
  // such long steps for some seconds.
  task.physics.substeps = 1;
  task.physics.gravity_m_per_s2 = 0;
  const TrackingSetup setup(config.robot, task);
  TestCase test_case = problem.tracking()->get_set("test/2").make_case(0);
  test_case.points_m.resize(4);
  compare_work(state, {setup, config.start, 0.001, test_case},
               {thesis.tracking()->setup(), load_design("table-a1").design, 0.15,
                thesis.tracking()->get_set("test/2").make_case(0)});
  state.SetLabel(robot);
}
BENCHMARK(BM_MoreJointsAgainstThesisArm)
    ->DenseRange(6, 7)
    ->Iterations(60)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace armwright

BENCHMARK_MAIN();
