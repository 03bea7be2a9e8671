#include "optimizers/pagmo/pagmo_backend.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/random.hpp"
#include "optimizers/interface/scalar_function.hpp"
#include "optimizers/pagmo_module/pagmo_module.hpp"
#include "process/module_loader.hpp"

namespace armwright {
namespace {

// The value of each constraint of a failed evaluation. It is finite, because the methods add and
// square violations.
constexpr double kViolatedBeyondMeasure = 1e12;

// Evaluates points for pagmo. pagmo's coordinates are those of the search space with the integers behind the others, as pagmo
// wants them. A logarithmic integer is none of its integers: its steps are factors, and
// ScalarFunction rounds it.
class PagmoBridge : public PagmoProblem {
 public:
  PagmoBridge(const PagmoMethod& method, const Options& options, Evaluator& evaluator);

  std::vector<std::vector<double>> evaluate(std::span<const std::vector<double>> arranged) override;
  std::pair<std::vector<double>, std::vector<double>> bounds() const override {
    return {arrange(space().lower()), arrange(space().upper())};
  }
  std::size_t objective_count() const override {
    return method_.multi_objective ? problem().objectives.size() : 1;
  }
  std::size_t constraint_count() const override {
    return method_.constraints ? problem().constraints.size() : 0;
  }
  std::size_t integer_count() const override { return integer_count_; }

  const SearchSpace& space() const { return function_.space(); }
  const ProblemDescription& problem() const { return function_.evaluator().problem(); }
  std::int64_t evaluation_count() const { return evaluation_count_; }
  // True after an exception of the evaluator has passed through pagmo.
  bool has_thrown() const { return has_thrown_; }

  // Returns pagmo's coordinates of coordinates of the search space. Rounds the integers.
  std::vector<double> arrange(std::span<const double> coordinates) const;

 private:
  void require_finite(std::span<const double> coordinates) const;
  std::vector<double> calc_fitness(const Score& score) const;

  const PagmoMethod& method_;
  double constraint_weight_;
  ScalarFunction function_;
  std::vector<std::size_t> order_;  // pagmo's coordinate i is coordinate order_[i] of the space
  std::size_t integer_count_ = 0;
  std::int64_t evaluation_count_ = 0;
  bool has_thrown_ = false;
};

PagmoBridge::PagmoBridge(const PagmoMethod& method, const Options& options, Evaluator& evaluator)
    : method_(method),
      constraint_weight_(method.constraints ? 0 : options.get_number("constraint_weight")),
      function_(evaluator) {
  const std::vector<DecisionVariable>& variables = problem().variables;
  order_.resize(variables.size());
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  const auto integers = std::ranges::stable_partition(order_, [&](std::size_t i) {
    return variables[i].type == VariableType::real || variables[i].scale == Scale::logarithmic;
  });
  integer_count_ = integers.size();
}

std::vector<double> PagmoBridge::arrange(std::span<const double> coordinates) const {
  const std::size_t reals = order_.size() - integer_count_;
  std::vector<double> arranged;
  for (std::size_t i = 0; i < order_.size(); ++i) {
    const double value = coordinates[order_[i]];
    arranged.push_back(i < reals ? value : settle_value(problem().variables[order_[i]], value));
  }
  return arranged;
}

std::vector<std::vector<double>> PagmoBridge::evaluate(
    std::span<const std::vector<double>> arranged) {
  try {
    std::vector<std::vector<double>> coordinates;
    for (const std::vector<double>& one : arranged) {
      require_finite(one);
      coordinates.emplace_back(one.size());
      for (std::size_t i = 0; i < one.size(); ++i) {
        coordinates.back()[order_[i]] = one[i];
      }
    }
    const std::vector<Score> scores = function_.evaluate_batch(coordinates);
    evaluation_count_ += static_cast<std::int64_t>(scores.size());
    std::vector<std::vector<double>> fitness;
    std::ranges::transform(scores, std::back_inserter(fitness),
                           [this](const Score& score) { return calc_fitness(score); });
    return fitness;
  } catch (...) {
    has_thrown_ = true;
    throw;
  }
}

void PagmoBridge::require_finite(std::span<const double> coordinates) const {
  if (!std::ranges::all_of(coordinates, [](double u) { return std::isfinite(u); })) {
    throw OptimizerFailure(
        fmt::format("optimizer '{}' asked for a point that is not finite", method_.row));
  }
}

std::vector<double> PagmoBridge::calc_fitness(const Score& score) const {
  if (method_.multi_objective) {
    const double violation = problem().violation_scale * calc_violation(score.constraint_values);
    std::vector<double> fitness = score.objectives;
    for (double& objective : fitness) {
      objective += constraint_weight_ * violation;
    }
    return fitness;
  }
  if (!method_.constraints) {
    return {calc_merit(problem(), score, constraint_weight_)};
  }
  std::vector<double> fitness = {calc_scalar(problem(), score.objectives)};
  if (score.constraint_values.size() == constraint_count()) {
    // Some methods compare the objective with the constraints.
    std::ranges::transform(score.constraint_values, std::back_inserter(fitness),
                           [this](double g) { return problem().violation_scale * g; });
  } else {
    fitness.resize(1 + constraint_count(), kViolatedBeyondMeasure);
  }
  return fitness;
}

// pagmo's messages have several lines; the last one says what is wrong.
std::string get_reason(const std::exception& error) {
  const std::string text = error.what();
  const std::string mark = "what: ";
  const std::size_t at = text.rfind(mark);
  std::string reason = at == std::string::npos ? text : text.substr(at + mark.size());
  while (!reason.empty() && reason.back() == '\n') {
    reason.pop_back();
  }
  return reason;
}

class PagmoOptimizer : public Optimizer {
 public:
  PagmoOptimizer(PagmoMethod method, Options options)
      : method_(std::move(method)), options_(std::move(options)) {
    require_options_that_fit();
    make_search_ = reinterpret_cast<MakePagmoSearch*>(
        load_module(kPagmoModule, kPagmoEntry, fmt::format("optimizer '{}'", method_.row)));
    try {
      make_search();
    } catch (const std::exception& error) {
      refuse(get_reason(error));
    }
  }

  void minimize(Evaluator& evaluator, std::uint64_t seed) override {
    PagmoBridge bridge(method_, options_, evaluator);
    try {
      evolve(bridge, evaluator, seed);
    } catch (const EvaluatorStopped&) {
    } catch (const std::invalid_argument& error) {
      if (bridge.has_thrown()) {
        throw;
      }
      refuse(get_reason(error));
    } catch (const std::exception& error) {
      if (bridge.has_thrown()) {
        throw;
      }
      throw OptimizerFailure(
          fmt::format("optimizer '{}': pagmo: {}", method_.row, get_reason(error)));
    }
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ErrorKind::usage, fmt::format("optimizer '{}': {}", method_.row, what));
  }

  std::unique_ptr<PagmoSearch> make_search() const {
    return std::unique_ptr<PagmoSearch>(make_search_(method_.algorithm, options_.values()));
  }

  bool has_option(const std::string& name) const { return options_.values().contains(name); }

  // Checks what pagmo would find only after the evaluation of the first population.
  void require_options_that_fit() const {
    const std::int64_t population = population_size();
    if (has_option("ker") && options_.get_integer("ker") > population) {
      refuse(fmt::format("option 'ker' is {}; it must be at most option 'population', which is {}",
                         options_.get_integer("ker"), population));
    }
    if (has_option("neighbours") && options_.get_integer("neighbours") >= population) {
      refuse(fmt::format(
          "option 'neighbours' is {}; it must be smaller than option 'population', which is {}",
          options_.get_integer("neighbours"), population));
    }
    if (method_.algorithm == "nsga2" && population % 4 != 0) {
      refuse(fmt::format("option 'population' is {}; it must be a multiple of 4", population));
    }
  }

  std::int64_t population_size() const {
    return has_option("population") ? options_.get_integer("population") : 1;
  }

  void evolve(PagmoBridge& bridge, Evaluator& evaluator, std::uint64_t seed) const {
    const std::unique_ptr<PagmoSearch> search = make_search();
    search->begin(bridge, fold_seed(seed));
    PagmoPlan plan{.seed = fold_seed(seed)};
    const double start_value = std::abs(add_population(bridge, *search, seed));
    if (start_value > 0) {
      plan.scale = start_value;
    }
    set_pace(plan, bridge, evaluator);
    search->plan(plan);
    while (!evaluator.stopped()) {
      const std::int64_t before = bridge.evaluation_count();
      search->evolve();
      if (method_.ends || bridge.evaluation_count() == before) {
        evaluator.explain_end(method_.ends ? "its search has converged"
                                           : "it asked for no further evaluation");
        return;
      }
      if (method_.paced) {  // a remainder shorter than one step of the schedule
        ++plan.seed;
        set_pace(plan, bridge, evaluator);
        search->plan(plan);
      }
    }
  }

  void set_pace(PagmoPlan& plan, const PagmoBridge& bridge, const Evaluator& evaluator) const {
    if (method_.paced) {
      const std::int64_t generations =
          evaluator.remaining() / calc_generation_cost(bridge.space().dimension());
      plan.generations = static_cast<unsigned>(
          std::clamp<std::int64_t>(generations, 1, std::int64_t{kEndlessGenerations}));
    }
  }

  // The number of evaluations between two steps of a schedule.
  std::int64_t calc_generation_cost(std::size_t dimension) const {
    if (method_.algorithm == "ihs") {
      return 1;
    }
    if (method_.algorithm == "simulated_annealing") {
      return options_.get_integer("n_range_adj") * options_.get_integer("bin_size") *
             static_cast<std::int64_t>(dimension);
    }
    return population_size();
  }

  // Returns the first value of the first individual.
  double add_population(PagmoBridge& bridge, PagmoSearch& search, std::uint64_t seed) const {
    RandomStream random("optimizer/pagmo:" + method_.algorithm, seed);
    const double spread = has_option("spread") ? options_.get_number("spread") : 1;
    std::vector<std::vector<double>> individuals =
        bridge.space().draw_population(static_cast<std::size_t>(population_size()), spread, random);
    for (std::vector<double>& individual : individuals) {
      individual = bridge.arrange(individual);
    }
    // Only a method that evaluates batches later begins with a batch.
    const std::size_t batch = method_.batch ? individuals.size() : 1;
    double first_value = 0;
    for (std::size_t from = 0; from < individuals.size(); from += batch) {
      const auto asked = std::span(individuals).subspan(from, batch);
      const std::vector<std::vector<double>> fitness = bridge.evaluate(asked);
      for (std::size_t i = 0; i < asked.size(); ++i) {
        search.add(asked[i], fitness[i]);
      }
      if (from == 0) {
        first_value = fitness.front().front();
      }
    }
    return first_value;
  }

  PagmoMethod method_;
  Options options_;
  MakePagmoSearch* make_search_ = nullptr;
};

}  // namespace

std::unique_ptr<Optimizer> make_pagmo_optimizer(const PagmoMethod& method, const Options& options) {
  return std::make_unique<PagmoOptimizer>(method, options);
}

}  // namespace armwright
