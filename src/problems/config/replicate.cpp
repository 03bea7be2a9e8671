// Gives a replicate of a comparison its own training cases and its own start.

#include <cassert>
#include <nlohmann/json.hpp>
#include <utility>

#include "problems/config/problem_loader.hpp"

namespace armwright {
namespace {

// A problem with another start.
class StartedElsewhere final : public Problem {
 public:
  StartedElsewhere(std::shared_ptr<const Problem> problem, const std::vector<double>& start)
      : problem_(std::move(problem)), description_(problem_->description()) {
    assert(start.size() == description_.variables.size());
    for (std::size_t i = 0; i < start.size(); ++i) {
      description_.variables[i].start = start[i];
    }
  }

  const ProblemDescription& description() const override { return description_; }
  const TrackingProblem* tracking() const override { return problem_->tracking(); }
  BatchSize batch_size(CaseRole role) const override { return problem_->batch_size(role); }
  std::vector<CaseOutcome> simulate(std::span<const CaseJob> jobs) const override {
    return problem_->simulate(jobs);
  }
  Evaluation aggregate(std::span<const double> x,
                       std::span<const CaseOutcome> outcomes) const override {
    return problem_->aggregate(x, outcomes);
  }
  std::optional<double> calc_lower_bound(std::span<const double> x,
                                         std::span<const CaseOutcome> outcomes,
                                         std::size_t cases) const override {
    return problem_->calc_lower_bound(x, outcomes, cases);
  }
  std::vector<double> penalty_objectives() const override { return problem_->penalty_objectives(); }
  void forget_cases() const override { problem_->forget_cases(); }

 private:
  std::shared_ptr<const Problem> problem_;
  ProblemDescription description_;
};

}  // namespace

LoadedProblem make_replicate(const LoadedProblem& problem, const std::string& training_set,
                             const std::vector<double>& start) {
  LoadedProblem replicate = problem;
  replicate.problem = std::make_shared<StartedElsewhere>(problem.problem, start);
  replicate.sets.training = training_set;
  auto resolved = nlohmann::json::parse(problem.resolved_json);
  resolved["sets"]["training"] = training_set;
  resolved["replicate"]["start"] = start;
  replicate.resolved_json = resolved.dump(2);
  return replicate;
}

}  // namespace armwright
