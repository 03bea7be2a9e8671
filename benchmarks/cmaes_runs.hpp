// One run of CMA-ES to a target, ours and pagmo's, for cmaes_benchmark.cpp.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/random.hpp"
#include "optimizers/interface/optimizer.hpp"
#include "optimizers/table/optimizer_table.hpp"

#ifdef ARMWRIGHT_WITH_PAGMO
#include <pagmo/algorithm.hpp>
#include <pagmo/algorithms/cmaes.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#endif

namespace armwright {

using Vector = std::vector<double>;

inline double calc_sphere(std::span<const double> x) {
  double sum = 0;
  for (const double xi : x) {
    sum += xi * xi;
  }
  return sum;
}

inline double calc_ellipsoid(std::span<const double> x) {
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum += std::pow(1e6, static_cast<double>(i) / static_cast<double>(x.size() - 1)) * x[i] * x[i];
  }
  return sum;
}

inline double calc_rosenbrock(std::span<const double> x) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    sum += 100 * std::pow(x[i + 1] - x[i] * x[i], 2) + std::pow(1 - x[i], 2);
  }
  return sum;
}

inline double calc_rastrigin(std::span<const double> x) {
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

inline Vector draw_start(const Setting& setting, int seed) {
  RandomStream random("benchmark/cmaes/start", static_cast<std::uint64_t>(seed));
  Vector start(static_cast<std::size_t>(setting.dimension));
  for (double& value : start) {
    value = setting.start_lower + (setting.start_upper - setting.start_lower) * random.uniform();
  }
  return start;
}

inline std::vector<DecisionVariable> make_variables(const Setting& setting, int seed) {
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
inline Outcome run_own(const Setting& setting, int seed, const std::vector<std::string>& more = {},
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
inline Outcome run_pagmo(const Setting& setting, int seed) {
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

}  // namespace armwright
