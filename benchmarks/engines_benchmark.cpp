// Measures the cost of a step of the thesis's arm in every engine, on the same task: four
// controllers, the dynamics and the measures of 64 test cases. Times are CPU times of the thread,
// without the target tables, which all engines share. Every ratio compares with ODE on some of the
// same cases. Both sides run alternately, so that a slower machine slows down both. The errors are
// reported too.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "engines/parts.hpp"
#include "measure.hpp"
#include "problems/config/design_file.hpp"
#include "problems/config/problem_loader.hpp"
#include "sim/dynamics/chain_model.hpp"
#include "study/executor/case_executor.hpp"

namespace armwright {
namespace {

constexpr std::size_t kCases = 64;
constexpr std::size_t kOdeCases = 4;

struct Task {
  LoadedProblem problem;
  ArmDesign design;
  std::vector<TargetTable> targets;
  std::vector<TrackingJob> jobs;

  explicit Task(const char* problem_name)
      : problem(load_problem(problem_name)), design(load_design(problem.published.design).design) {
    const TestSet set = problem.tracking()->get_set("test/2");
    for (std::size_t i = 0; i < kCases; ++i) {
      targets.push_back(problem.tracking()->setup().make_targets(set.make_case(i)));
    }
    for (const TargetTable& table : targets) {
      TrackingJob& job = jobs.emplace_back();
      job.design = &design;
      job.targets = &table;
    }
  }
};

struct Measured {
  double seconds = 0, steps = 0, error_m = 0;
};
Measured simulate(const PhysicsEngine& engine, const Task& task, std::size_t cases) {
  Measured measured;
  std::vector<TrackingResult> results;
  measured.seconds = measure_cpu_s([&] {
    results = engine.simulate(task.problem.tracking()->setup(), std::span(task.jobs).first(cases));
  });
  for (const TrackingResult& result : results) {
    measured.steps += result.steps;
    measured.error_m += result.mean_error_m / static_cast<double>(cases);
  }
  return measured;
}

void run_engine(benchmark::State& state, const char* problem_name, const std::string& engine_name,
                const EngineOptions& options) {
  const Task task(problem_name);
  const auto engine = make_engine(engine_name, options);
  const auto ode = make_engine("ode");
  const bool fast = find_engine(engine_name).simd;
  std::vector<double> own, ratio;
  double error_m = 0;
  for (auto _ : state) {
    const Measured a = simulate(*engine, task, fast ? kCases : kOdeCases);
    const Measured b = simulate(*ode, task, kOdeCases);
    own.push_back(a.seconds / a.steps);
    ratio.push_back(b.seconds / b.steps / own.back());
  }
  error_m = simulate(*engine, task, kCases).error_m;
  state.counters["ns_per_step"] = 1e9 * calc_median(own);
  state.counters["times_as_fast_as_ode"] = calc_median(ratio);
  state.counters["mean_error_mm"] = 1e3 * error_m;
}

void run_part(benchmark::State& state, SimdLevel level, benchmarks::Part part) {
  const LoadedProblem problem = load_problem("q1-complex");
  const articulated::ChainModel& chain = problem.tracking()->setup().chain();
  const benchmarks::PartsChain numbers{chain.joints(), chain.flags().data(), chain.tilted_gravity(),
                                       chain.numbers().data()};
  std::vector<double> seconds;
  constexpr int kRounds = 20000;
  int lanes = 1;
  for (auto _ : state) {
    seconds.push_back(
        measure_cpu_s([&] { lanes = benchmarks::run_part(level, part, numbers, kRounds); }));
  }
  state.counters["ns_per_step"] = 1e9 * calc_median(seconds) / kRounds / lanes;
}

// Makes the target tables of 16 cases with both solvers of the numeric inverse kinematics, by turns.
void run_targets(benchmark::State& state, const std::string& robot) {
  const LoadedProblem problem = load_problem("robot", std::vector{"robot.urdf=" + robot});
  TrackingTask task = problem.tracking()->config().task;
  const TrackingSetup lanes(problem.tracking()->config().robot, task);
  task.solver = NumericSolver::scalar;
  const TrackingSetup scalar(problem.tracking()->config().robot, task);
  std::vector<TestCase> cases;
  for (std::uint64_t i = 0; i < 16; ++i) {
    cases.push_back(problem.tracking()->get_set("test/2").make_case(i));
  }
  std::vector<double> own, ratio, alone_ratio;
  for (auto _ : state) {
    const double together = measure_cpu_s([&] { lanes.make_targets(cases); });
    const double alone = measure_cpu_s([&] {
      for (const TestCase& its : cases) {
        lanes.make_targets(its);
      }
    });
    const double before = measure_cpu_s([&] { scalar.make_targets(cases); });
    own.push_back(together / static_cast<double>(cases.size()));
    ratio.push_back(before / together);
    alone_ratio.push_back(before / alone);
  }
  state.counters["ms_per_case"] = 1e3 * calc_median(own);
  state.counters["times_as_fast_as_scalar"] = calc_median(ratio);
  state.counters["alone_times_as_fast"] = calc_median(alone_ratio);
}

// Runs the same number of simulations on one thread and on two, and as many designs on one case as
// cases of one design. Target tables exist before. Measures wall-clock time.
void run_sharing(benchmark::State& state) {
  const std::vector<std::string> overrides = {"physics.engine=articulated"};
  const LoadedProblem problem = load_problem("q1-complex", overrides);
  const auto x = problem.tracking()->make_vector(load_design("table-a5").design);
  StopSignal stop;
  ThreadExecutor one(1);
  ThreadExecutor two(2);
  const auto evaluate = [&](ThreadExecutor& executor, std::size_t designs, std::size_t cases) {
    CaseBlock block{CaseRole::training, "train/1", std::vector<std::uint64_t>(cases)};
    std::iota(block.numbers.begin(), block.numbers.end(), 0);
    const std::vector<std::span<const double>> candidates(designs, x);
    executor.evaluate(*problem.problem, candidates, block, {}, stop,
                      [](std::size_t, Evaluation) {});
  };
  std::vector<double> speedup, ratio;
  evaluate(one, 1, kCases);  // makes the target tables
  for (auto _ : state) {
    const double serial = measure_s([&] { evaluate(one, 16, kCases); });
    const double parallel = measure_s([&] { evaluate(two, 16, kCases); });
    speedup.push_back(serial / parallel);
    const double many_cases = measure_s([&] { evaluate(one, 1, kCases); });
    const double many_designs = measure_s([&] { evaluate(one, kCases, 1); });
    ratio.push_back(many_designs / many_cases);
  }
  state.counters["two_cores_over_one"] = calc_median(speedup);
  state.counters["rate_1x64_over_64x1"] = calc_median(ratio);
}

void add_rows() {
  for (const char* problem : {"q2-e6", "q1-complex"}) {
    for (const EngineRow& row : engine_table()) {
      const auto add = [&](const std::string& label, const EngineOptions& options) {
        benchmark::RegisterBenchmark((std::string(problem) + "/" + label).c_str(),
                                     [problem, name = row.name, options](benchmark::State& state) {
                                       run_engine(state, problem, name, options);
                                     })
            ->Iterations(9)
            ->Unit(benchmark::kMillisecond);
      };
      if (!row.simd) {
        add(row.name, {});
        continue;
      }
      for (const std::string& level : supported_simd_names()) {
        for (const Precision precision : {Precision::double_, Precision::single}) {
          add(row.name + "/" + level + "/" + to_string(precision), {precision, parse_simd(level)});
        }
      }
    }
  }
  for (const std::string& level : supported_simd_names()) {
    for (const benchmarks::Part part : benchmarks::kParts) {
      benchmark::RegisterBenchmark(
          ("part/" + level + "/" + to_string(part)).c_str(),
          [level, part](benchmark::State& state) { run_part(state, parse_simd(level), part); })
          ->Iterations(25)
          ->Unit(benchmark::kMillisecond);
    }
  }
  for (const char* robot : {"arm7", "irb4600_six"}) {
    benchmark::RegisterBenchmark((std::string("targets/") + robot).c_str(),
                                 [robot](benchmark::State& state) { run_targets(state, robot); })
        ->Iterations(9)
        ->Unit(benchmark::kMillisecond);
  }
  benchmark::RegisterBenchmark("sharing", run_sharing)
      ->Iterations(40)
      ->Unit(benchmark::kMillisecond);
}

}  // namespace
}  // namespace armwright

int main(int argc, char** argv) {
  armwright::add_rows();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
