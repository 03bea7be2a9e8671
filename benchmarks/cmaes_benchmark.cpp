// Measures how many evaluations CMA-ES needs: ours, pagmo's and the published ones. Prints the
// tables of docs/cmaes.md as Markdown and takes two minutes. With --integers FILE, it prints the
// table of functions with integers only, and writes it to the file as CSV. With --surrogate FILE, it
// prints the table of the surrogate only, beside the runs of pycma in the file
// (benchmarks/pycma_surrogate.py), which began at the starts that --starts prints.
//
//   build/release/bin/cmaes_benchmark > table.md
//   build/release/bin/cmaes_benchmark --integers results/mixed-integer/cmaes.csv
//   build/release/bin/cmaes_benchmark --surrogate results/surrogate/pycma.csv
#include <fmt/ranges.h>

#include <cstdio>
#include <ctime>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>
#include <string_view>

#include "cmaes_runs.hpp"
#include "problems/analytic/analytic.hpp"

namespace {

using namespace armwright;

constexpr int kSeeds = 15;
constexpr double kNever = std::numeric_limits<double>::infinity();  // evaluations of a failure

std::vector<double> count_evaluations(const std::function<Outcome(int)>& run) {
  std::vector<double> counts;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const Outcome outcome = run(seed);
    counts.push_back(outcome.hit ? static_cast<double>(outcome.evaluations) : kNever);
  }
  return counts;
}

double calc_median(std::vector<double> counts) {
  std::ranges::sort(counts);
  return counts.empty() ? kNever : counts[counts.size() / 2];
}

std::string describe(const std::vector<double>& counts) {
  const double median = calc_median(counts);
  const auto misses = std::ranges::count(counts, kNever);
  return fmt::format("{} ({}/{})",
                     std::isfinite(median) ? fmt::format("{:.0f}", median) : std::string("-"),
                     static_cast<std::ptrdiff_t>(counts.size()) - misses, counts.size());
}

std::string describe(const std::function<Outcome(int)>& run) {
  return describe(count_evaluations(run));
}

std::vector<Setting> make_smooth_settings() {
  std::vector<Setting> settings;
  for (const int n : {10, 20}) {
    Setting setting{.function = {"sphere", calc_sphere},
                    .dimension = n,
                    .start_lower = -4,
                    .start_upper = 4,
                    .sigma = 2};
    settings.push_back(setting);
    setting.function = {"ellipsoid", calc_ellipsoid};
    settings.push_back(setting);
    setting = {.function = {"rosenbrock", calc_rosenbrock}, .dimension = n, .sigma = 0.5};
    settings.push_back(setting);
  }
  return settings;
}

std::vector<Setting> make_settings() {
  const Function ellipsoid{"ellipsoid", calc_ellipsoid};
  const Function rosenbrock{"rosenbrock", calc_rosenbrock};
  const Function rastrigin{"rastrigin", calc_rastrigin};
  std::vector<Setting> settings = make_smooth_settings();
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

// Prints the starts of the smooth functions for benchmarks/pycma_surrogate.py.
void print_starts() {
  std::string separator = "[";
  for (const Setting& s : make_smooth_settings()) {
    for (int seed = 1; seed <= kSeeds; ++seed) {
      fmt::print(
          "{}\n{{\"function\": \"{}\", \"seed\": {}, \"sigma\": {}, \"target\": {}, "
          "\"budget\": {}, \"start\": [{}]}}",
          separator, s.function.name, seed, s.sigma, s.target, s.budget,
          fmt::join(draw_start(s, seed), ", "));
      separator = ",";
    }
  }
  fmt::print("\n]\n");
}

// The runs of pycma on one function, as benchmarks/pycma_surrogate.py stores them.
struct StoredRuns {
  std::vector<double> plain;
  std::vector<double> surrogate;
};

std::map<std::string, StoredRuns> read_stored_runs(const std::string& file) {
  std::map<std::string, StoredRuns> runs;
  std::ifstream csv(file);
  std::string line;
  std::getline(csv, line);  // the version
  std::getline(csv, line);  // the names of the columns
  while (std::getline(csv, line)) {
    std::istringstream fields(line);
    std::string function;
    std::string n;
    std::string seed;
    std::string plain;
    std::string surrogate;
    std::getline(fields, function, ',');
    std::getline(fields, n, ',');
    std::getline(fields, seed, ',');
    std::getline(fields, plain, ',');
    std::getline(fields, surrogate, ',');
    StoredRuns& stored = runs[function + "," + n];
    stored.plain.push_back(plain.empty() ? kNever : std::stod(plain));
    stored.surrogate.push_back(surrogate.empty() ? kNever : std::stod(surrogate));
  }
  return runs;
}

// Compares the surrogate with the plain strategy, here and in pycma.
void print_surrogate(const std::string& file) {
  const std::map<std::string, StoredRuns> stored = read_stored_runs(file);
  fmt::print(
      "| function | n | plain | surrogate | factor | pycma, plain | pycma, surrogate | factor |\n"
      "|---|---|---|---|---|---|---|---|\n");
  for (const Setting& s : make_smooth_settings()) {
    const auto plain = count_evaluations([&](int seed) { return run_own(s, seed); });
    const auto surrogate =
        count_evaluations([&](int seed) { return run_own(s, seed, {"surrogate=quadratic"}); });
    const auto theirs = stored.find(fmt::format("{},{}", s.function.name, s.dimension));
    const StoredRuns pycma = theirs == stored.end() ? StoredRuns{} : theirs->second;
    fmt::print("| {} | {} | {} | {} | {:.1f} | {} | {} | {:.1f} |\n", s.function.name, s.dimension,
               describe(plain), describe(surrogate), calc_median(plain) / calc_median(surrogate),
               describe(pycma.plain), describe(pycma.surrogate),
               calc_median(pycma.plain) / calc_median(pycma.surrogate));
    std::fflush(stdout);
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
  if (argc == 3 && std::string_view(argv[1]) == "--surrogate") {
    print_surrogate(argv[2]);
    return 0;
  }
  if (argc == 2 && std::string_view(argv[1]) == "--starts") {
    print_starts();
    return 0;
  }
  print_comparison();
  print_restarts();
  print_bounds();
  print_speed();
}
