#include "optimizers/table/multistart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/error.hpp"
#include "base/random.hpp"
#include "base/text.hpp"
#include "optimizers/interface/search_space.hpp"
#include "optimizers/interface/treated_problem.hpp"
#include "optimizers/table/optimizer_table.hpp"

namespace armwright {
namespace {

// The same problem with another start and a limited number of evaluations.
class StartedElsewhere : public Evaluator {
 public:
  StartedElsewhere(Evaluator& evaluator, ProblemDescription problem, std::int64_t allowance)
      : evaluator_(evaluator), problem_(std::move(problem)), allowance_(allowance) {}

  const ProblemDescription& problem() const override { return problem_; }

  std::vector<Score> evaluate(std::span<const std::vector<double>> points) override {
    if (stopped()) {
      return {};
    }
    const auto count = std::min(std::ssize(points), static_cast<std::ptrdiff_t>(allowance_));
    return count_down(evaluator_.evaluate(points.first(static_cast<std::size_t>(count))), 1);
  }
  std::vector<Score> evaluate_with_jacobian(std::span<const std::vector<double>> points) override {
    if (stopped()) {
      return {};
    }
    const std::int64_t charge = calc_jacobian_charge(problem_.variables.size());
    const auto count =
        std::min(std::ssize(points), static_cast<std::ptrdiff_t>(allowance_ / charge));
    if (count < std::ssize(points)) {
      points = points.first(static_cast<std::size_t>(count));
      is_spent_ = true;
    }
    return count_down(evaluator_.evaluate_with_jacobian(points), charge);
  }

  bool stopped() const override { return allowance_ == 0 || is_spent_ || evaluator_.stopped(); }
  std::int64_t remaining() const override { return std::min(allowance_, evaluator_.remaining()); }
  void begin_generation() override { evaluator_.begin_generation(); }
  bool grow_cases() override { return evaluator_.grow_cases(); }
  std::uint64_t case_changes() const override { return evaluator_.case_changes(); }
  std::size_t cases() const override { return evaluator_.cases(); }
  void recommend(std::span<const double> x) override { evaluator_.recommend(x); }

  bool has_evaluated() const { return has_evaluated_; }

 private:
  std::vector<Score> count_down(std::vector<Score> scores, std::int64_t charge) {
    allowance_ -= std::ssize(scores) * charge;
    has_evaluated_ = has_evaluated_ || !scores.empty();
    return scores;
  }

  Evaluator& evaluator_;
  ProblemDescription problem_;
  std::int64_t allowance_;
  bool is_spent_ = false;  // what is left is too little for what was asked for
  bool has_evaluated_ = false;
};

class Multistart : public Optimizer {
 public:
  Multistart(std::unique_ptr<Optimizer> inner, const Options& options)
      : inner_(std::move(inner)),
        spread_(options.get_number("spread")),
        evaluations_per_start_(options.get_integer("evaluations_per_start")) {}

  void minimize(Evaluator& evaluator, std::uint64_t seed) override {
    RandomStream random("optimizer/multistart", seed);
    const SearchSpace space(adapt_variables(evaluator.problem().variables, {}));
    const std::int64_t allowance = evaluations_per_start_ == 0 ? INT64_MAX : evaluations_per_start_;
    // Two consecutive starts without an evaluation: the inner optimizer cannot work on this
    // problem, and the loop would never end.
    int idle_starts = 0;
    for (bool is_first = true; !evaluator.stopped() && idle_starts < 2; is_first = false) {
      ProblemDescription problem = evaluator.problem();
      const std::uint64_t inner_seed = random.next_u64();
      if (!is_first) {
        const std::vector<double> start = draw_start(space, random);
        for (std::size_t i = 0; i < start.size(); ++i) {
          DecisionVariable& variable = problem.variables[i];
          variable.start = settle_value(variable, start[i]);
        }
      }
      StartedElsewhere restarted(evaluator, std::move(problem), allowance);
      inner_->minimize(restarted, inner_seed);
      idle_starts = restarted.has_evaluated() ? 0 : idle_starts + 1;
    }
    if (idle_starts > 0) {
      evaluator.explain_end("two starts one after the other have evaluated nothing");
    }
  }
  void check_problem(const ProblemDescription& problem) const override {
    inner_->check_problem(problem);
  }
  void log_to(const std::filesystem::path& file) override { inner_->log_to(file); }

 private:
  std::vector<double> draw_start(const SearchSpace& space, RandomStream& random) const {
    std::vector<double> lower = space.start();
    std::vector<double> upper = space.start();
    for (std::size_t i = 0; i < space.dimension(); ++i) {
      lower[i] -= spread_ * (lower[i] - space.lower()[i]);
      upper[i] += spread_ * (space.upper()[i] - upper[i]);
    }
    return space.to_point(space.draw_between(lower, upper, random));
  }

  std::unique_ptr<Optimizer> inner_;
  double spread_;
  std::int64_t evaluations_per_start_;
};

std::vector<OptionSpec> make_multistart_options() {
  return {{.name = "spread",
           .description = "of the random starts about the problem's start, share of the box",
           .fallback = 1.0,
           .lower = 0,
           .upper = 1},
          {.name = "evaluations_per_start",
           .description = "after which a start is given up; 0: when it ends by itself",
           .fallback = std::int64_t{0},
           .lower = 0,
           .upper = 1e12}};
}

// Returns the checked options of the inner optimizer.
Options select_inner(const OptimizerRow& inner, const Options& options) {
  std::vector<std::string> assignments;
  for (const OptionSpec& spec : inner.options) {
    assignments.push_back(spec.name + "=" + to_text(options.values().at(spec.name)));
  }
  return Options::parse(inner.name, inner.options, assignments);
}

}  // namespace

OptimizerRow make_multistart_row(const OptimizerRow& inner) {
  OptimizerRow row = inner;
  row.name = "multistart:" + inner.name;
  row.short_name = inner.short_name.empty() ? "" : "multistart:" + inner.short_name;
  if (!inner.capabilities.local) {
    std::vector<std::string> local;
    for (const OptimizerRow& candidate : optimizer_table()) {
      if (candidate.capabilities.local) {
        local.push_back(candidate.name);
      }
    }
    throw Error(ErrorKind::usage,
                fmt::format("optimizer '{}': '{}' is no local optimizer that ends by itself, so "
                            "there is nothing to restart; these are: {}",
                            sanitize(row.name), sanitize(inner.name), join(local, ", ")));
  }
  row.summary = fmt::format("{} from the start and then from random points, until the budget ends",
                            inner.name);
  row.source = fmt::format(
      "Rinnooy Kan and Timmer 1987, Stochastic global optimization methods; {}", inner.source);
  row.capabilities.stochastic = true;
  row.capabilities.local = false;
  for (OptionSpec& own : make_multistart_options()) {
    if (std::ranges::count(inner.options, own.name, &OptionSpec::name) > 0) {
      throw Error(ErrorKind::usage,
                  fmt::format("optimizer '{}': '{}' has an option '{}' itself, which would hide "
                              "multistart's",
                              sanitize(row.name), sanitize(inner.name), own.name));
    }
    row.options.push_back(std::move(own));
  }
  row.make = [inner](const Options& options) -> std::unique_ptr<Optimizer> {
    return std::make_unique<Multistart>(inner.make(select_inner(inner, options)), options);
  };
  return row;
}

}  // namespace armwright
