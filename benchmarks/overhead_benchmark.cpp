// Measures the overhead of armwright between an optimizer and a function, compared with the same
// work without it. The function is the sphere in 20 variables, evaluated as `armwright optimize`
// does it (run folder, journal, budget, incumbents, progress): in batches of 100, as for a
// population, and one at a time under NLopt's Nelder-Mead. The requirements are 500 000 evaluations
// per second in batches and 300 000 one at a time. The sphere as a user's problem is measured in
// batches too: as a program in Python, beside a loop in Python that only exchanges the same messages
// and may be at most 3 times as fast. docs/overhead.md explains the output.
#include <benchmark/benchmark.h>
#ifdef ARMWRIGHT_WITH_NLOPT
#include <nlopt.h>
#endif
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "base/random.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "study/run/run_evaluator.hpp"
#include "study/run/run_folder.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {
namespace {

constexpr std::size_t kBatch = 100;
// By then the simplex has shrunk to the size of rounding, as far as NLopt allows.
constexpr int kNelderMeadBudget = 10'000;

class Folder {
 public:
  Folder()
      : path_(std::filesystem::temp_directory_path() /
              ("armwright-overhead-benchmark-" + std::to_string(::getpid()))) {
    std::filesystem::remove_all(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// Reads the clock, as the progress bar does between two redraws.
class ClockReader : public RunObserver {
 public:
  void on_progress(const Progress& progress) override {
    last_ = progress;
    benchmark::DoNotOptimize(std::chrono::steady_clock::now());
  }
  void on_message(const std::string& /*message*/) override {}

 private:
  Progress last_;
};

const std::string kProgram = "python3 " ARMWRIGHT_BENCHMARKS "/sphere_problem.py";

RunPlan make_plan(const std::string& optimizer, const std::vector<std::string>& options,
                  std::int64_t budget, const std::string& problem = "sphere") {
  RunPlan plan;
  plan.problem =
      load_problem(problem, problem == "sphere" ? std::vector<std::string>{"function.dimension=20"}
                                                : std::vector<std::string>());
  plan.optimizer = load_optimizer(optimizer);
  plan.options = Options::parse(optimizer, plan.optimizer.options, options);
  plan.budget = budget;
  plan.schedule = plan.problem.schedule;
  return plan;
}

// The objects that execute_run() has while an optimizer works.
struct Run {
  Run(const RunPlan& plan, unsigned jobs)
      : run_folder(folder.path(), folder.path(), plan, {}),
        journal(run_folder.journal(), recorded),
        executor(jobs),
        evaluator(plan, executor, stop, journal, recorded, observer) {}

  Folder folder;
  RunFolder run_folder;
  JournalContent recorded;
  Journal journal;
  StopSignal stop;
  ThreadExecutor executor;
  ClockReader observer;
  RunEvaluator evaluator;
};

// Points drawn uniformly in the box: almost none of them improves the incumbent.
std::vector<std::vector<double>> draw_points(const ProblemDescription& problem, std::size_t count) {
  RandomStream random("benchmark/overhead", 1);
  std::vector<std::vector<double>> points(count, std::vector<double>(problem.variables.size()));
  for (std::vector<double>& point : points) {
    for (std::size_t i = 0; i < point.size(); ++i) {
      const DecisionVariable& variable = problem.variables[i];
      point[i] = variable.lower + (variable.upper - variable.lower) * random.uniform();
    }
  }
  return points;
}

// The function itself, written again for the sides without armwright.
double calc_sphere(const double* x, const double* minimiser, std::size_t dimension) {
  double sum = 0;
  for (std::size_t i = 0; i < dimension; ++i) {
    const double z = x[i] - minimiser[i];
    sum += z * z;
  }
  return sum;
}

// Measures processor time of all threads, including the journal's. Other work on the machine
// disturbs it less than wall-clock time.
class ProcessorWatch {
 public:
  void start() { start_ = std::clock(); }
  void stop() { sum_s_ += static_cast<double>(std::clock() - start_) / CLOCKS_PER_SEC; }

  // The rate in wall-clock time, and the processor time per evaluation.
  void report(benchmark::State& state, std::uint64_t evaluations) const {
    state.SetItemsProcessed(static_cast<std::int64_t>(evaluations));
    state.counters["cpu_us_each"] = 1e6 * sum_s_ / static_cast<double>(evaluations);
  }

 private:
  std::clock_t start_ = 0;
  double sum_s_ = 0;
};

void bare_loop(benchmark::State& state) {
  const RunPlan plan = make_plan("random", {}, 0);
  const ProblemDescription& problem = plan.problem.problem->description();
  const auto points = draw_points(problem, 100 * kBatch);
  std::vector<double> values(kBatch);
  std::size_t next = 0;
  ProcessorWatch watch;
  watch.start();
  for (auto _ : state) {
    for (std::size_t i = 0; i < kBatch; ++i) {
      const std::vector<double>& x = points[next + i];
      values[i] = calc_sphere(x.data(), problem.known_optimum.data(), x.size());
    }
    benchmark::DoNotOptimize(values.data());
    benchmark::ClobberMemory();
    next = (next + kBatch) % points.size();
  }
  watch.stop();
  watch.report(state, state.iterations() * kBatch);
}

// Measures a problem in batches on state.range(0) threads.
void measure_batches(benchmark::State& state, const std::string& problem) {
  const RunPlan plan = make_plan("random", {}, std::numeric_limits<std::int64_t>::max(), problem);
  Run run(plan, static_cast<unsigned>(state.range(0)));
  const auto points = draw_points(run.evaluator.problem(), 100 * kBatch);
  std::size_t next = 0;
  ProcessorWatch watch;
  watch.start();
  for (auto _ : state) {
    benchmark::DoNotOptimize(run.evaluator.evaluate(std::span(points).subspan(next, kBatch)));
    next = (next + kBatch) % points.size();
  }
  run.journal.flush();
  watch.stop();
  watch.report(state, run.evaluator.counts().evaluations);
}

void batches(benchmark::State& state) {
  measure_batches(state, "sphere");
}

// The same function as a problem in a shared library, whose process gets one message per batch.
void batches_of_library(benchmark::State& state) {
  measure_batches(state, ARMWRIGHT_OVERHEAD_LIBRARY);
}

void batches_of_program(benchmark::State& state) {
  measure_batches(state, "exec:" + kProgram);
}

void bare_exchange_in_python(benchmark::State& state) {
  constexpr int kExchanges = 100;
  for (auto _ : state) {
    double seconds = 0;
    std::FILE* const output =
        ::popen((kProgram + " bare " + std::to_string(kExchanges)).c_str(), "r");
    if (output == nullptr || std::fscanf(output, "%lf", &seconds) != 1 || ::pclose(output) != 0) {
      state.SkipWithError("the loop in Python failed");
      break;
    }
    state.SetIterationTime(seconds);
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * kExchanges *
                          static_cast<std::int64_t>(kBatch));
}

#ifdef ARMWRIGHT_WITH_NLOPT
struct BareSphere {
  std::vector<double> minimiser;
  std::uint64_t evaluations = 0;
};

double call_bare_sphere(unsigned n, const double* x, double* /*gradient*/, void* data) {
  auto& sphere = *static_cast<BareSphere*>(data);
  ++sphere.evaluations;
  return calc_sphere(x, sphere.minimiser.data(), n);
}

std::uint64_t minimize_bare(const ProblemDescription& problem) {
  BareSphere sphere{problem.known_optimum};
  std::vector<double> lower;
  std::vector<double> upper;
  std::vector<double> x;
  for (const DecisionVariable& variable : problem.variables) {
    lower.push_back(variable.lower);
    upper.push_back(variable.upper);
    x.push_back(variable.start);
  }
  const nlopt_opt solver = nlopt_create(NLOPT_LN_NELDERMEAD, static_cast<unsigned>(x.size()));
  nlopt_set_min_objective(solver, call_bare_sphere, &sphere);
  nlopt_set_lower_bounds(solver, lower.data());
  nlopt_set_upper_bounds(solver, upper.data());
  nlopt_set_maxeval(solver, kNelderMeadBudget);
  double value = 0;
  nlopt_optimize(solver, x.data(), &value);
  nlopt_destroy(solver);
  return sphere.evaluations;
}

RunPlan make_nelder_mead_plan() {
  return make_plan("nlopt:neldermead", {"restarts=0", "initial_step=0", "xtol_rel=0", "ftol_rel=0"},
                   kNelderMeadBudget);
}

void bare_nelder_mead(benchmark::State& state) {
  const RunPlan plan = make_nelder_mead_plan();
  std::uint64_t evaluations = 0;
  ProcessorWatch watch;
  watch.start();
  for (auto _ : state) {
    evaluations += minimize_bare(plan.problem.problem->description());
  }
  watch.stop();
  watch.report(state, evaluations);
}

// Measures one run per turn. Improvements cost more than other evaluations, and a whole run has the
// usual share of them. Making its folder is not timed.
void nelder_mead(benchmark::State& state) {
  const RunPlan plan = make_nelder_mead_plan();
  const auto optimizer = plan.optimizer.make(plan.options);
  const std::uint64_t expected = minimize_bare(plan.problem.problem->description());
  std::uint64_t evaluations = 0;
  ProcessorWatch watch;
  for (auto _ : state) {
    state.PauseTiming();
    {
      Run run(plan, static_cast<unsigned>(state.range(0)));
      state.ResumeTiming();
      watch.start();
      optimizer->minimize(run.evaluator, plan.seed);
      run.journal.flush();
      watch.stop();
      state.PauseTiming();
      evaluations += run.evaluator.counts().evaluations;
    }
    state.ResumeTiming();
  }
  if (evaluations != expected * state.iterations()) {
    state.SkipWithError("it asked for other points than the bare library");
  }
  watch.report(state, evaluations);
}
#endif

double calc_min(const std::vector<double>& values) {
  return *std::ranges::min_element(values);
}

#define ARMWRIGHT_OVERHEAD(function)  \
  BENCHMARK(function)                 \
      ->MeasureProcessCPUTime()       \
      ->UseRealTime()                 \
      ->Unit(benchmark::kMicrosecond) \
      ->ComputeStatistics("min", calc_min)

ARMWRIGHT_OVERHEAD(bare_loop);
ARMWRIGHT_OVERHEAD(batches)->ArgName("threads")->Arg(1)->Arg(2);
ARMWRIGHT_OVERHEAD(batches_of_library)->ArgName("threads")->Arg(1)->Arg(2);
ARMWRIGHT_OVERHEAD(batches_of_program)->ArgName("threads")->Arg(1)->Arg(2);
BENCHMARK(bare_exchange_in_python)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond)
    ->ComputeStatistics("min", calc_min);
#ifdef ARMWRIGHT_WITH_NLOPT
ARMWRIGHT_OVERHEAD(bare_nelder_mead);
ARMWRIGHT_OVERHEAD(nelder_mead)->ArgName("threads")->Arg(1)->Arg(2);
#endif

}  // namespace
}  // namespace armwright

BENCHMARK_MAIN();
