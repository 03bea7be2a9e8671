// Gives a replicate of a comparison its own training cases, start and instance of a function.

#include <fmt/format.h>

#include <cassert>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/error.hpp"
#include "problems/analytic/analytic.hpp"
#include "problems/config/problem_loader.hpp"
#include "problems/user/user_problem.hpp"

namespace armwright {
namespace {

// A problem with another start.
class StartedElsewhere final : public WrappedProblem {
 public:
  StartedElsewhere(std::shared_ptr<const Problem> problem, const std::vector<double>& start)
      : problem_(std::move(problem)), description_(problem_->description()) {
    assert(start.size() == description_.variables.size());
    for (std::size_t i = 0; i < start.size(); ++i) {
      description_.variables[i].start = start[i];
    }
  }

  const Problem& inner() const override { return *problem_; }
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
  std::vector<double> calc_case_objectives(std::span<const double> x,
                                           const Evaluation& evaluation) const override {
    return problem_->calc_case_objectives(x, evaluation);
  }
  std::optional<double> calc_lower_bound(std::span<const double> x,
                                         std::span<const CaseOutcome> outcomes,
                                         std::size_t cases) const override {
    return problem_->calc_lower_bound(x, outcomes, cases);
  }
  std::vector<double> penalty_objectives() const override { return problem_->penalty_objectives(); }
  CaseRecord record_case(std::span<const double> x, const CaseBlock& block,
                         std::uint64_t number) const override {
    return problem_->record_case(x, block, number);
  }
  void forget_cases() const override { problem_->forget_cases(); }

 private:
  std::shared_ptr<const Problem> problem_;
  ProblemDescription description_;
};

// Returns the function as replicate number `replicate` has it.
FunctionChoice choose_instance(const LoadedProblem& problem, int replicate) {
  FunctionChoice choice = *problem.function;
  choice.instance_per_replicate = false;
  if (replicate - 1 > kMostInstances - choice.instance) {
    throw Error(ErrorKind::usage,
                fmt::format("problem '{}': replicate {} needs an instance above {}, the highest; "
                            "choose a lower function.instance than {}",
                            problem.name, replicate, kMostInstances, choice.instance));
  }
  choice.instance += replicate - 1;
  return choice;
}

}  // namespace

LoadedProblem make_replicate(const LoadedProblem& problem, int replicate,
                             const std::string& training_set, const std::vector<double>& start) {
  LoadedProblem made = problem;
  auto resolved = nlohmann::json::parse(problem.resolved_json);
  if (problem.function && problem.function->instance_per_replicate) {
    made.function = choose_instance(problem, replicate);
    made.problem = make_analytic(*made.function);
    resolved["function"]["instance"] = made.function->instance;
    resolved["function"]["instance_per_replicate"] = false;
  }
  made.problem = std::make_shared<StartedElsewhere>(made.problem, start);
  made.sets.training = training_set;
  resolved["sets"]["training"] = training_set;
  resolved["replicate"]["start"] = start;
  made.resolved_json = resolved.dump(2);
  return made;
}

}  // namespace armwright
