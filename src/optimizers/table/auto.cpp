#include "optimizers/table/auto.hpp"

#include <fmt/format.h>

#include <optional>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
#include "optimizers/interface/treated_problem.hpp"
#include "optimizers/table/auto_probe.hpp"
#include "optimizers/table/auto_rules.hpp"

namespace armwright {
namespace {

constexpr const char* kPlannedOption = "evaluations";

// The evaluator of the chosen optimizer: gives it the variables as it can treat them.
class ChosenEvaluator : public Evaluator {
 public:
  ChosenEvaluator(Evaluator& evaluator, const Capabilities& capabilities)
      : evaluator_(evaluator), treated_(evaluator.problem(), capabilities) {}

  const ProblemDescription& problem() const override { return treated_.description(); }

  std::vector<Score> evaluate(std::span<const std::vector<double>> points) override {
    return settle_all(points, [&](const auto& settled) { return evaluator_.evaluate(settled); });
  }
  std::vector<Score> evaluate_with_jacobian(std::span<const std::vector<double>> points) override {
    return settle_all(
        points, [&](const auto& settled) { return evaluator_.evaluate_with_jacobian(settled); });
  }

  bool stopped() const override { return evaluator_.stopped(); }
  std::int64_t remaining() const override { return evaluator_.remaining(); }
  // auto itself has begun the first generation.
  void begin_generation() override {
    if (!is_first_) {
      evaluator_.begin_generation();
    }
    is_first_ = false;
  }
  bool grow_cases() override { return evaluator_.grow_cases(); }
  std::uint64_t case_changes() const override { return evaluator_.case_changes(); }
  std::size_t cases() const override { return evaluator_.cases(); }
  bool may_change_cases() const override { return evaluator_.may_change_cases(); }
  void recommend(std::span<const double> x) override { evaluator_.recommend(settle(x).x); }
  void explain_end(std::string_view reason) override { evaluator_.explain_end(reason); }

 private:
  TreatedProblem::Point settle(std::span<const double> x) const {
    if (x.size() != problem().variables.size()) {
      throw OptimizerFailure(
          fmt::format("a point of {} numbers was asked for; there are {} "
                      "decision variables",
                      x.size(), problem().variables.size()));
    }
    return treated_.settle(x);
  }

  template <class Evaluate>
  std::vector<Score> settle_all(std::span<const std::vector<double>> points,
                                const Evaluate& evaluate) const {
    std::vector<std::vector<double>> settled;
    std::vector<bool> clipped;
    for (const std::vector<double>& point : points) {
      TreatedProblem::Point one = settle(point);
      settled.push_back(std::move(one.x));
      clipped.push_back(one.clipped);
    }
    std::vector<Score> scores = evaluate(settled);
    for (std::size_t i = 0; i < scores.size(); ++i) {
      scores[i].clipped = clipped[i];
    }
    return scores;
  }

  Evaluator& evaluator_;
  TreatedProblem treated_;
  bool is_first_ = true;
};

class Auto : public Optimizer {
 public:
  explicit Auto(const Options& options)
      : rules_(options.get_text("rules")), evaluations_(options.get_integer(kPlannedOption)) {}

  void minimize(Evaluator& evaluator, std::uint64_t seed) override {
    const std::vector<AutoRule> rules = load_auto_rules(find_auto_rules(rules_));
    const std::int64_t budget = evaluator.remaining();
    const std::int64_t planned = evaluations_ == 0 ? budget : evaluations_;
    AutoFeatures features =
        calc_auto_features(evaluator.problem(), planned, evaluator.may_change_cases());
    evaluator.begin_generation();
    std::optional<bool> rugged;
    const AutoRule& rule = choose_rule(rules, features, evaluator.problem(), [&] {
      return rugged.emplace(is_rugged(evaluator, seed, planned));
    });
    explain(rules, rule, features, budget, rugged, evaluator);
    check_limit(rule, budget);
    const auto chosen =
        rule.row.make(Options::parse(rule.row.name, rule.row.options, rule.options));
    ChosenEvaluator inner(evaluator, rule.row.capabilities);
    chosen->check_problem(inner.problem());
    if (!log_.empty()) {
      chosen->log_to(log_);
    }
    chosen->minimize(inner, seed);
  }

  void check_problem(const ProblemDescription& /*problem*/) const override {
    load_auto_rules(find_auto_rules(rules_));
  }
  std::map<std::string, std::string> list_inputs() const override {
    const std::filesystem::path file = find_auto_rules(rules_);
    const std::string name = rules_.empty() ? file.filename().string() : rules_;
    constexpr std::size_t kLimit_bytes = std::size_t{1} << 20;
    return {{name, calc_sha256_hex(read_file(file, kLimit_bytes))}};
  }
  void log_to(const std::filesystem::path& file) override { log_ = file; }

 private:
  // Says which optimizer was chosen, and whether the rules would choose it for the whole budget.
  static void explain(const std::vector<AutoRule>& rules, const AutoRule& rule,
                      const AutoFeatures& features, std::int64_t budget,
                      const std::optional<bool>& rugged, Evaluator& evaluator) {
    AutoFeatures now =
        calc_auto_features(evaluator.problem(), budget, evaluator.may_change_cases());
    bool is_known = true;
    const AutoRule& own = choose_rule(rules, now, evaluator.problem(), [&] {
      is_known = rugged.has_value();
      return rugged.value_or(false);
    });
    const bool is_kept = &own != &rule || !is_known;
    evaluator.explain_choice(is_kept ? fmt::format("kept {}, which auto chose for {}. {}",
                                                   describe_used(rule), describe_features(features),
                                                   rule.why)
                                     : fmt::format("auto chose {} for {}. {}", describe_used(rule),
                                                   describe_features(now), rule.why));
  }

  // The rules do not choose an optimizer beyond its limits, but a kept one may come to them.
  static void check_limit(const AutoRule& rule, std::int64_t budget) {
    const std::int64_t most = rule.row.limits.evaluations;
    if (most > 0 && budget > most) {
      throw Error(
          ErrorKind::usage,
          fmt::format("optimizer '{}', which auto chose, is made for at most {} "
                      "evaluations, and the budget pays for {}; give a smaller --budget, or "
                      "begin a run with --new, for which auto chooses again",
                      rule.row.name, most, budget));
    }
  }

  std::string rules_;         // a path; empty: the shipped rules
  std::int64_t evaluations_;  // with which it chooses; 0: those of the budget
  std::filesystem::path log_;
};

}  // namespace

std::vector<OptimizerRow> make_auto_rows() {
  OptimizerRow row;  // filled line by line: GCC 12 warns of the same as one initializer
  row.name = kAutoName;
  row.summary = "Chooses another optimizer by rules about the problem and the budget";
  row.source = "Rice 1976, The algorithm selection problem";
  row.capabilities = {.bounds = true,
                      .constraints = true,
                      .multi_objective = true,
                      .batch = true,
                      .noisy = true,
                      .residuals = true,
                      .stochastic = true,
                      .generations = true,
                      .paced = true,
                      .integer = true,
                      .categorical = true};
  row.options = {{.name = "rules",
                  .description = "file of rules in place of the shipped ones (docs/auto.md)",
                  .fallback = std::string()},
                 {.name = kPlannedOption,
                  .description = "chooses as for a budget of this many evaluations; 0: that of the "
                                 "run. A run that is continued with a larger budget has the number "
                                 "with which it began",
                  .fallback = std::int64_t{0},
                  .lower = 0,
                  .upper = kLargestInteger,
                  .is_new = true}};
  row.make = [](const Options& options) -> std::unique_ptr<Optimizer> {
    return std::make_unique<Auto>(options);
  };
  row.pace_option = kPlannedOption;
  return {row};
}

}  // namespace armwright
