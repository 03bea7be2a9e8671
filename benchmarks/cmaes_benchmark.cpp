// Measures how many evaluations CMA-ES needs: ours, pagmo's and the published ones. Prints the
// tables of docs/cmaes.md as Markdown and takes two minutes. With --integers FILE, it prints the
// table of functions with integers only, and writes it to the file as CSV.
//
//   build/release/bin/cmaes_benchmark > table.md
//   build/release/bin/cmaes_benchmark --integers results/mixed-integer/cmaes.csv
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/random.hpp"
#include "optimizers/interface/optimizer.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "problems/analytic/analytic.hpp"

#ifdef ARMWRIGHT_WITH_PAGMO
#include <pagmo/algorithm.hpp>
#include <pagmo/algorithms/cmaes.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#endif

namespace {

using namespace armwright;
using Vector = std::vector<double>;

double calc_sphere(std::span<const double> x) {
  double sum = 0;
  for (const double xi : x) {
    sum += xi * xi;
  }
  return sum;
}

double calc_ellipsoid(std::span<const double> x) {
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum += std::pow(1e6, static_cast<double>(i) / static_cast<double>(x.size() - 1)) * x[i] * x[i];
  }
  return sum;
}

double calc_rosenbrock(std::span<const double> x) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    sum += 100 * std::pow(x[i + 1] - x[i] * x[i], 2) + std::pow(1 - x[i], 2);
  }
  return sum;
}

double calc_rastrigin(std::span<const double> x) {
  double sum = 0;
  for (const double xi : x) {
    sum += xi * xi + 10 * (1 - std::cos(2 * std::numbers::pi * xi));
  }
  return sum;
}

struct Function {
  const char* name = "";
  std::function<double(std::span<const double>)> calc;
};

// A function on [-half_width, half_width]^n, and the range in which its search starts.
struct Setting {
  Function function;
  int dimension = 10;
  double half_width = 100;  // the sources search without bounds
  double start_lower = 0;   // the start is uniform in [start_lower, start_upper]^n
  double start_upper = 0;
  double sigma = 1;
  int population = 0;  // 0: the default
  double target = 1e-8;
  std::int64_t budget = 1000000;
  const char* restarts = "none";
  const char* published = "";
};

constexpr int kSeeds = 15;

Vector draw_start(const Setting& setting, int seed) {
  RandomStream random("benchmark/cmaes/start", static_cast<std::uint64_t>(seed));
  Vector start(static_cast<std::size_t>(setting.dimension));
  for (double& value : start) {
    value = setting.start_lower + (setting.start_upper - setting.start_lower) * random.uniform();
  }
  return start;
}

std::vector<DecisionVariable> make_variables(const Setting& setting, int seed) {
  std::vector<DecisionVariable> variables;
  for (const double value : draw_start(setting, seed)) {
    variables.push_back({"x", "", -setting.half_width, setting.half_width, value, Scale::linear});
  }
  return variables;
}

// Counts evaluations until the target is met, then stops.
class TargetEvaluator : public Evaluator {
 public:
  TargetEvaluator(const Setting& setting, std::vector<DecisionVariable> variables)
      : setting_(setting) {
    problem_.name = setting.function.name;
    problem_.variables = std::move(variables);
    problem_.objectives = {{"f", ""}};
  }

  const ProblemDescription& problem() const override { return problem_; }
  std::vector<Score> evaluate(std::span<const Vector> points) override {
    std::vector<Score> scores;
    for (const Vector& point : points) {
      if (stopped()) {
        break;
      }
      ++count_;
      scores.push_back({.objectives = {setting_.function.calc(point)},
                        .constraint_values = {},
                        .residuals = {},
                        .jacobian = {}});
      hit_ = hit_ || scores.back().objectives[0] < setting_.target;
    }
    return scores;
  }
  bool stopped() const override { return hit_ || count_ >= setting_.budget; }
  std::int64_t remaining() const override { return stopped() ? 0 : setting_.budget - count_; }
  void begin_generation() override {}
  void recommend(std::span<const double> /*x*/) override {}

  std::int64_t count() const { return count_; }
  bool hit() const { return hit_; }

 private:
  const Setting& setting_;
  ProblemDescription problem_;
  std::int64_t count_ = 0;
  bool hit_ = false;
};

struct Outcome {
  bool hit = false;
  std::int64_t evaluations = 0;
};

// Runs cmaes on the given variables, or on those of the setting.
Outcome run_own(const Setting& setting, int seed, const std::vector<std::string>& more = {},
                std::vector<DecisionVariable> variables = {}) {
  const OptimizerRow& row = find_optimizer("cmaes");
  std::vector<std::string> assignments = {
      fmt::format("sigma={}", setting.sigma / (2 * setting.half_width)),
      fmt::format("population={}", setting.population),
      fmt::format("restarts={}", setting.restarts),
      fmt::format("tol_fun={}", std::min(1e-12, 1e-4 * std::abs(setting.target)))};
  assignments.insert(assignments.end(), more.begin(), more.end());
  TargetEvaluator evaluator(
      setting, variables.empty() ? make_variables(setting, seed) : std::move(variables));
  row.make(Options::parse("cmaes", row.options, assignments))
      ->minimize(evaluator, static_cast<std::uint64_t>(seed));
  return {evaluator.hit(), evaluator.count()};
}

#ifdef ARMWRIGHT_WITH_PAGMO
struct PagmoFunction {
  struct Shared {
    const Setting* setting = nullptr;
    std::int64_t count = 0;
    std::optional<std::int64_t> hit_at;
  };
  Shared* shared = nullptr;

  Vector fitness(const Vector& x) const {
    ++shared->count;
    const double value = shared->setting->function.calc(x);
    if (value < shared->setting->target && !shared->hit_at) {
      shared->hit_at = shared->count;
    }
    return {value};
  }
  std::pair<Vector, Vector> get_bounds() const {
    const auto n = static_cast<std::size_t>(shared->setting->dimension);
    return {Vector(n, -shared->setting->half_width), Vector(n, shared->setting->half_width)};
  }
};

// Runs pagmo's CMA-ES without any help. The initial population is sampled around the start as
// pagmo's strategy would do it, and the mean begins at its best member.
Outcome run_pagmo(const Setting& setting, int seed) {
  PagmoFunction::Shared shared{.setting = &setting, .count = 0, .hit_at = {}};
  const int population = setting.population > 0
                             ? setting.population
                             : 4 + static_cast<int>(3 * std::log(setting.dimension));
  pagmo::population members{pagmo::problem{PagmoFunction{&shared}}, 0u,
                            static_cast<unsigned>(seed)};
  const Vector start = draw_start(setting, seed);
  RandomStream random("benchmark/cmaes/pagmo", static_cast<std::uint64_t>(seed));
  members.push_back(start);
  for (int i = 1; i < population; ++i) {
    Vector x = start;
    for (double& value : x) {
      value = std::clamp(value + setting.sigma * random.normal(), -setting.half_width,
                         setting.half_width);
    }
    members.push_back(x);
  }
  // pagmo's sigma is a share of the box as well (its initial covariance is scaled by the bounds).
  pagmo::algorithm algorithm{pagmo::cmaes(1u, -1, -1, -1, -1,
                                          setting.sigma / (2 * setting.half_width), 0, 0, true,
                                          true, static_cast<unsigned>(seed))};
  while (!shared.hit_at && shared.count < setting.budget) {
    const std::int64_t before = shared.count;
    members = algorithm.evolve(members);
    if (shared.count == before) {
      break;
    }
  }
  return {shared.hit_at.has_value(), shared.hit_at.value_or(shared.count)};
}
#endif

std::string describe(const std::function<Outcome(int)>& run) {
  std::vector<double> counts;
  int hits = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const Outcome outcome = run(seed);
    hits += outcome.hit ? 1 : 0;
    counts.push_back(outcome.hit ? static_cast<double>(outcome.evaluations)
                                 : std::numeric_limits<double>::infinity());
  }
  std::ranges::sort(counts);
  const double median = counts[kSeeds / 2];
  return std::isfinite(median) ? fmt::format("{:.0f} ({}/{})", median, hits, kSeeds)
                               : fmt::format("- ({}/{})", hits, kSeeds);
}

std::vector<Setting> make_settings() {
  const Function sphere{"sphere", calc_sphere};
  const Function ellipsoid{"ellipsoid", calc_ellipsoid};
  const Function rosenbrock{"rosenbrock", calc_rosenbrock};
  const Function rastrigin{"rastrigin", calc_rastrigin};
  std::vector<Setting> settings;
  for (const int n : {10, 20}) {
    Setting setting{
        .function = sphere, .dimension = n, .start_lower = -4, .start_upper = 4, .sigma = 2};
    settings.push_back(setting);
    setting.function = ellipsoid;
    settings.push_back(setting);
    setting = {.function = rosenbrock, .dimension = n, .sigma = 0.5};
    settings.push_back(setting);
  }
  // The runs that pycma's documentation prints.
  Setting run{.function = rosenbrock, .dimension = 8, .sigma = 0.5, .target = 1.272e-11};
  run.published = "4000 [1]";
  settings.push_back(run);
  run = {.function = rosenbrock,
         .dimension = 10,
         .start_lower = 0.1,
         .start_upper = 0.1,
         .sigma = 0.5,
         .target = 6.944e-11};
  run.published = "6000, not active [2]";
  settings.push_back(run);
  run = {.function = ellipsoid,
         .dimension = 4,
         .start_lower = 2,
         .start_upper = 2,
         .sigma = 1,
         .target = 9.602e-5};
  run.published = "800 [3]";
  settings.push_back(run);
  run.target = 5.727e-16;
  run.published = "1456 [3]";
  settings.push_back(run);
  // These functions have a global structure, so large populations are better.
  for (const auto& [n, population] : {std::pair{10, 200}, {10, 400}, {20, 400}, {20, 800}}) {
    settings.push_back({.function = rastrigin,
                        .dimension = n,
                        .start_lower = 1,
                        .start_upper = 5,
                        .sigma = 2,
                        .population = population});
  }
  return settings;
}

void print_comparison() {
  fmt::print(
      "| function | n | start | sigma | lambda | f < | ours | orthogonal=false | "
      "active=false as well | pagmo | published |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Setting& s : make_settings()) {
    const std::string own = describe([&](int seed) { return run_own(s, seed); });
    const std::string independent =
        describe([&](int seed) { return run_own(s, seed, {"orthogonal=false"}); });
    const std::string passive = describe([&](int seed) {
      return run_own(s, seed, {"orthogonal=false", "active=false"});
    });
    std::string pagmo = "not built";
#ifdef ARMWRIGHT_WITH_PAGMO
    pagmo = describe([&](int seed) { return run_pagmo(s, seed); });
#endif
    fmt::print("| {} | {} | {} | {} | {} | {:g} | {} | {} | {} | {} | {} |\n", s.function.name,
               s.dimension,
               s.start_lower == s.start_upper
                   ? fmt::format("{}", s.start_lower)
                   : fmt::format("[{}, {}]", s.start_lower, s.start_upper),
               s.sigma, s.population > 0 ? std::to_string(s.population) : "default", s.target, own,
               independent, passive, pagmo, s.published);
    std::fflush(stdout);
  }
}

void print_restarts() {
  fmt::print("\n| rastrigin in [-5, 5]^n, n | ipop | bipop |\n|---|---|---|\n");
  for (const int n : {5, 10, 20}) {
    Setting s{.function = {"rastrigin", calc_rastrigin},
              .dimension = n,
              .half_width = 5,
              .start_lower = -4,
              .start_upper = 4,
              .sigma = 0.5,
              .budget = 2000000};
    s.restarts = "ipop";
    const std::string ipop = describe([&](int seed) { return run_own(s, seed); });
    s.restarts = "bipop";
    const std::string bipop = describe([&](int seed) { return run_own(s, seed); });
    fmt::print("| {} | {} | {} |\n", n, ipop, bipop);
    std::fflush(stdout);
  }
}

// Runs f2 and its rotated form f10 of BBOB, one instance per seed, in their box and in a box that no
// run leaves.
void print_bounds() {
  fmt::print("\n| function | box | ours | orthogonal=false |\n|---|---|---|---|\n");
  for (const char* name : {"bbob-f2", "bbob-f10"}) {
    for (const double half_width : {5, 100}) {
      const auto run = [&](int seed, const std::vector<std::string>& options) {
        const std::shared_ptr<const Problem> problem =
            make_analytic({.name = name, .dimension = 10, .instance = seed, .adds_f_opt = false});
        const auto calc = [problem](std::span<const double> x) {
          CaseJob job;
          job.x = x;
          return problem->simulate(std::span(&job, 1)).front().error;
        };
        return run_own({.function = {name, calc},
                        .half_width = half_width,
                        .start_lower = -4,
                        .start_upper = 4,
                        .sigma = 0.5},
                       seed, options);
      };
      fmt::print("| {} | [-{}, {}]^10 | {} | {} |\n", name, half_width, half_width,
                 describe([&](int seed) { return run(seed, {}); }),
                 describe([&](int seed) { return run(seed, {"orthogonal=false"}); }));
    }
  }
}

// Runs sphere-int and ellipsoid-int as in Hamano et al. 2022, section 5: the distance of the start
// from the minimiser is uniform in [1, 3] along each axis, rounded along integers, sigma is 1, and
// the budget is 10,000 n. `is_rounded` makes the integers real variables that the function rounds.
Outcome run_integers(const char* name, int dimension, int seed, bool is_rounded,
                     const char* restarts, const std::vector<std::string>& options) {
  const std::shared_ptr<const Problem> problem =
      make_analytic({.name = name, .dimension = dimension});
  const ProblemDescription& description = problem->description();
  RandomStream random("benchmark/cmaes/integers", static_cast<std::uint64_t>(seed));
  std::vector<DecisionVariable> variables = description.variables;
  for (std::size_t i = 0; i < variables.size(); ++i) {
    DecisionVariable& variable = variables[i];
    variable.start = settle_value(variable, description.known_optimum[i] + random.uniform(1, 3));
    if (is_rounded && variable.type == VariableType::integer) {
      variable.type = VariableType::real;
      variable.lower -= 0.5;
      variable.upper += 0.5;
    }
  }
  const auto calc = [problem, &description](std::span<const double> x) {
    Vector settled(x.begin(), x.end());
    for (std::size_t i = 0; i < settled.size(); ++i) {
      settled[i] = settle_value(description.variables[i], settled[i]);
    }
    CaseJob job;
    job.x = settled;
    return problem->simulate(std::span(&job, 1)).front().error;
  };
  return run_own({.function = {name, calc},
                  .dimension = dimension,
                  .half_width = 10,
                  .sigma = 1,
                  .target = 1e-10,
                  .budget = 10000 * dimension,
                  .restarts = restarts},
                 seed, options, variables);
}

void print_integers(const std::string& file) {
  struct Variant {
    const char* name;
    bool is_rounded;
    const char* restarts;
    std::vector<std::string> options;
  };
  const std::vector<Variant> variants = {
      {"defaults", false, "ipop", {}},
      {"restarts=none", false, "none", {}},
      {"restarts=none orthogonal=false", false, "none", {"orthogonal=false"}},
      {"restarts=none orthogonal=false active=false",
       false,
       "none",
       {"orthogonal=false", "active=false"}},
      {"restarts=none without margin", true, "none", {}},
  };
  constexpr int kRuns = 100;
  std::ofstream csv(file);
  csv << "function,n,budget,variant,runs,reached,lower_quartile,median,upper_quartile\n";
  fmt::print("| function | n | variant | reached | evaluations |\n|---|---|---|---|---|\n");
  for (const char* name : {"sphere-int", "ellipsoid-int"}) {
    for (const int n : {20, 40}) {
      for (const Variant& variant : variants) {
        std::vector<std::int64_t> counts;
        for (int seed = 1; seed <= kRuns; ++seed) {
          const Outcome outcome =
              run_integers(name, n, seed, variant.is_rounded, variant.restarts, variant.options);
          if (outcome.hit) {
            counts.push_back(outcome.evaluations);
          }
        }
        std::ranges::sort(counts);
        // Of the runs that reached the target, as the paper counts.
        const auto quantile = [&](std::size_t quarters) {
          return counts.empty() ? 0 : counts[(counts.size() - 1) * quarters / 4];
        };
        csv << fmt::format("{},{},{},{},{},{},{},{},{}\n", name, n, 10000 * n, variant.name, kRuns,
                           counts.size(), quantile(1), quantile(2), quantile(3));
        fmt::print("| {} | {} | {} | {}/{} | {} ({} to {}) |\n", name, n, variant.name,
                   counts.size(), kRuns, quantile(2), quantile(1), quantile(3));
        std::fflush(stdout);
      }
    }
  }
  csv.close();
  if (!csv) {
    fmt::print(stderr, "cannot write {}\n", file);
  }
}

void print_speed() {
  Setting s{.function = {"sphere", calc_sphere},
            .dimension = 20,
            .start_lower = -4,
            .start_upper = 4,
            .sigma = 2,
            .target = -1,
            .budget = 300000};
  s.restarts = "ipop";
  const std::clock_t begin = std::clock();  // processor time of this process
  const Outcome outcome = run_own(s, 1);
  const double duration_s = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  fmt::print("\n{:.0f} thousand evaluations a second on the sphere in 20 dimensions.\n",
             static_cast<double>(outcome.evaluations) / duration_s / 1000);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3 && std::string_view(argv[1]) == "--integers") {
    print_integers(argv[2]);
    return 0;
  }
  print_comparison();
  print_restarts();
  print_bounds();
  print_speed();
}
