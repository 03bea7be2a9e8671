#include "study/candidate_pool.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <limits>
#include <utility>

#include "base/bits.hpp"

namespace armwright {
namespace {

// At most `count` of them, the first and the last included, at even distances. The last
// improvements of a long run lie together, close to a limit, and all exceed it where new cases are
// a little harder: some from further back are judged as well.
std::vector<Candidate> spread(const std::vector<Candidate>& candidates, std::size_t count) {
  count = std::min(count, candidates.size());
  std::vector<Candidate> some;
  for (std::size_t i = 0; i < count; ++i) {
    some.push_back(candidates[i * (candidates.size() - 1) / std::max<std::size_t>(count - 1, 1)]);
  }
  return some;
}

}  // namespace

CandidatePool::CandidatePool(const RunPlan& plan)
    : problem_(plan.problem.problem->description()),
      selection_(plan.selection),
      fresh_(plan.schedule.changes_cases()) {}

void CandidatePool::recommend(std::vector<double> x, std::uint64_t generation) {
  candidates_.push_back({std::move(x), 0, generation, true, 0});
}

void CandidatePool::end_generation() {
  if (incumbent_) {
    last_best_ = incumbent_->training_objective;
    candidates_.push_back(*std::exchange(incumbent_, std::nullopt));
  }
}

double CandidatePool::best_objective() const {
  return incumbent_ ? incumbent_->training_objective : last_best_;
}

double CandidatePool::incumbent_objective() const {
  return incumbent_ ? incumbent_->training_objective : std::numeric_limits<double>::infinity();
}

void CandidatePool::consider(const EvaluationRecord& record) {
  const double objective = calc_scalar(problem_, record.evaluation.objectives);
  if (problem_.objectives.size() > 1) {
    extend_front(record, objective);
  }
  if (incumbent_ && incumbent_->training_objective <= objective) {
    return;
  }
  incumbent_ = Candidate{record.x, record.index, record.generation, false, objective};
  if (!fresh_) {
    candidates_.push_back(*incumbent_);
  }
}

void CandidatePool::extend_front(const EvaluationRecord& record, double objective) {
  const auto covers = [](const std::vector<double>& a, const std::vector<double>& b) {
    return std::ranges::equal(a, b, std::less_equal{});
  };
  const std::vector<double>& objectives = record.evaluation.objectives;
  if (std::ranges::any_of(front_, [&](const FrontMember& member) {
        return covers(member.objectives, objectives);
      })) {
    return;
  }
  std::erase_if(front_,
                [&](const FrontMember& member) { return covers(objectives, member.objectives); });
  Candidate candidate{record.x, record.index, record.generation, false, objective};
  front_.push_back({std::move(candidate), objectives});
}

// Both ends of the front and, where it is longer than what is judged, members in between at even
// distances of rank along the first objective.
std::vector<Candidate> CandidatePool::thin_front() const {
  std::vector<FrontMember> members = front_;
  std::ranges::stable_sort(members, {}, [](const FrontMember& m) { return m.objectives.front(); });
  const std::size_t count = std::min(members.size(), static_cast<std::size_t>(selection_.last));
  std::vector<Candidate> thinned;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t gaps = std::max<std::size_t>(count - 1, 1);
    thinned.push_back(members[i * (members.size() - 1) / gaps].candidate);
  }
  return thinned;
}

std::vector<Candidate> CandidatePool::select() const {
  std::vector<Candidate> all = candidates_;
  if (fresh_ && incumbent_) {
    all.push_back(*incumbent_);  // the last generation's best
  }
  const std::vector<Candidate> candidates =
      problem_.constraints.empty() ? all : spread(all, static_cast<std::size_t>(selection_.last));
  const auto known = [](const std::vector<Candidate>& chosen, const Candidate& candidate) {
    return std::any_of(chosen.begin(), chosen.end(),
                       [&](const Candidate& other) { return same_bits(other.x, candidate.x); });
  };
  std::vector<Candidate> chosen =
      problem_.objectives.size() > 1 ? thin_front() : std::vector<Candidate>{};
  for (auto candidate = candidates.rbegin();
       candidate != candidates.rend() && std::ssize(chosen) < selection_.last; ++candidate) {
    if (!known(chosen, *candidate)) {
      chosen.push_back(*candidate);
    }
  }
  std::vector<Candidate> by_objective;
  std::copy_if(all.begin(), all.end(), std::back_inserter(by_objective),
               [](const Candidate& candidate) { return !candidate.recommended; });
  std::stable_sort(by_objective.begin(), by_objective.end(),
                   [](const Candidate& a, const Candidate& b) {
                     return a.training_objective < b.training_objective;
                   });
  std::vector<Candidate> best;
  for (const Candidate& candidate : by_objective) {
    if (std::ssize(best) == selection_.best) {
      break;
    }
    if (!known(best, candidate)) {
      best.push_back(candidate);
    }
  }
  std::copy_if(best.begin(), best.end(), std::back_inserter(chosen),
               [&](const Candidate& candidate) { return !known(chosen, candidate); });
  std::stable_sort(chosen.begin(), chosen.end(), [](const Candidate& a, const Candidate& b) {
    return a.generation != b.generation ? a.generation < b.generation : a.evaluation < b.evaluation;
  });
  return chosen;
}

}  // namespace armwright
