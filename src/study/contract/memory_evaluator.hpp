// An Evaluator without a journal, for tests of optimizers and for the contract suite
// (contract.hpp). It keeps the budget exactly, cuts the last batch, clips points to the bounds,
// rounds discrete variables, and records a trace of all requests. On request, evaluations fail or
// throw, or the run is stopped. It is as strict as the interface allows: a failed evaluation has
// the penalty as objectives and no constraint values.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "optimizers/interface/treated_problem.hpp"

namespace armwright {

// The exception that evaluate() throws on request.
struct BrokenEvaluator : std::runtime_error {
  BrokenEvaluator() : std::runtime_error("the evaluator is broken") {}
};

struct MemoryEvaluatorSettings {
  std::int64_t budget = 0;      // evaluations; one with derivatives costs calc_jacobian_charge()
  bool fresh = false;           // each generation has its own case, from 0; otherwise always case 0
  std::int64_t fail_every = 0;  // the evaluations k, 2k, 3k, ... (from 1) fail; 0: none
  std::int64_t throw_at = 0;    // the evaluation with this number (from 1) throws; 0: none
  std::int64_t stop_after = INT64_MAX;  // stops the run after this many evaluations
  // Of the optimizer. By default, discrete variables stay as they are.
  Capabilities capabilities = {.integer = true, .categorical = true};
};

// A MemoryEvaluator evaluates points of one problem, which must outlive it.
class MemoryEvaluator : public Evaluator {
 public:
  using Clock = std::chrono::steady_clock;

  struct Entry {
    std::vector<double> asked;
    std::vector<double> evaluated;
    Score score;
    std::int64_t generation = 0;  // 0 before the first generation
    bool with_jacobian = false;

    bool operator==(const Entry& other) const {
      return asked == other.asked && evaluated == other.evaluated &&
             generation == other.generation && with_jacobian == other.with_jacobian &&
             score.objectives == other.score.objectives;
    }
  };

  MemoryEvaluator(const Problem& problem, MemoryEvaluatorSettings settings)
      : problem_(problem),
        settings_(settings),
        treated_(problem.description(), settings.capabilities) {}

  const ProblemDescription& problem() const override { return treated_.description(); }

  std::vector<Score> evaluate(std::span<const std::vector<double>> points) override {
    return evaluate(points, false);
  }
  std::vector<Score> evaluate_with_jacobian(std::span<const std::vector<double>> points) override {
    if (!problem().has_jacobian) {
      throw std::logic_error("derivatives were asked for of a problem that has none");
    }
    return evaluate(points, true);
  }

  bool stopped() const override { return is_spent_ || remaining() == 0; }

  std::int64_t remaining() const override {
    return std::min(settings_.budget, settings_.stop_after) - charged_;
  }

  void begin_generation() override { ++generations_; }
  void recommend(std::span<const double> x) override {
    recommended_.emplace_back(x.begin(), x.end());
  }

  const std::vector<Entry>& trace() const { return trace_; }
  std::int64_t charged() const { return charged_; }                             // of the budget
  const std::vector<std::size_t>& batch_sizes() const { return batch_sizes_; }  // as asked for
  const std::vector<std::vector<double>>& recommended() const { return recommended_; }
  std::int64_t generations() const { return generations_; }
  std::int64_t calls_after_stop() const { return calls_after_stop_; }
  std::optional<Clock::time_point> stopped_at() const { return stopped_at_; }

  // Returns the best objective of a feasible point that did not fail, or nothing.
  std::optional<double> best() const {
    std::optional<double> best;
    for (const Entry& entry : trace_) {
      const bool usable =
          entry.score.status == EvaluationStatus::ok &&
          std::ranges::all_of(entry.score.constraint_values, [](double g) { return g <= 0; });
      if (usable && (!best || entry.score.objectives[0] < *best)) {
        best = entry.score.objectives[0];
      }
    }
    return best;
  }

 private:
  std::vector<Score> evaluate(std::span<const std::vector<double>> points, bool with_jacobian) {
    const std::int64_t charge =
        with_jacobian ? calc_jacobian_charge(problem().variables.size()) : 1;
    if (stopped()) {
      ++calls_after_stop_;
      return {};
    }
    batch_sizes_.push_back(points.size());
    std::vector<Score> scores;
    for (const std::vector<double>& point : points) {
      is_spent_ = is_spent_ || remaining() < charge;
      if (stopped()) {
        break;
      }
      scores.push_back(evaluate_one(point, with_jacobian));
    }
    return scores;
  }

  Score evaluate_one(const std::vector<double>& asked, bool with_jacobian) {
    const std::vector<DecisionVariable>& variables = problem().variables;
    if (asked.size() != variables.size()) {
      throw OptimizerFailure("a point of the wrong dimension was asked for");
    }
    const auto number = static_cast<std::int64_t>(trace_.size()) + 1;
    if (number == settings_.throw_at) {
      throw BrokenEvaluator();
    }
    TreatedProblem::Point point = treated_.settle(asked);
    Entry entry{.asked = asked,
                .evaluated = std::move(point.x),
                .score = {},
                .generation = generations_,
                .with_jacobian = with_jacobian};
    entry.score.clipped = point.clipped;
    if (settings_.fail_every > 0 && number % settings_.fail_every == 0) {
      entry.score.objectives = problem_.penalty_objectives();
      entry.score.status = EvaluationStatus::diverged;
    } else {
      const auto case_number = static_cast<std::uint64_t>(settings_.fresh ? generations_ - 1 : 0);
      const CaseBlock block{CaseRole::training, "train/test", {case_number}};
      const Evaluation evaluation = problem_.evaluate(entry.evaluated, block, with_jacobian);
      entry.score.objectives = evaluation.objectives;
      entry.score.constraint_values = evaluation.constraint_values;
      entry.score.residuals = evaluation.residuals;
      entry.score.jacobian = evaluation.jacobian;
    }
    trace_.push_back(entry);
    charged_ += with_jacobian ? calc_jacobian_charge(variables.size()) : 1;
    if (stopped()) {
      stopped_at_ = Clock::now();
    }
    return entry.score;
  }

  const Problem& problem_;
  MemoryEvaluatorSettings settings_;
  TreatedProblem treated_;
  std::vector<Entry> trace_;
  std::int64_t charged_ = 0;
  bool is_spent_ = false;  // the rest of the budget is too small for the last request
  std::vector<std::size_t> batch_sizes_;
  std::vector<std::vector<double>> recommended_;
  std::int64_t generations_ = 0;
  std::int64_t calls_after_stop_ = 0;
  std::optional<Clock::time_point> stopped_at_;
};

}  // namespace armwright
