#include "study/run/candidate_pool.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <utility>

#include "base/bits.hpp"

namespace armwright {
namespace {

constexpr std::size_t kMostSpread = 65536;

auto find_same(auto& candidates, const Candidate& candidate) {
  return std::ranges::find_if(
      candidates, [&](const Candidate& other) { return same_bits(other.x, candidate.x); });
}

bool is_among(const std::vector<Candidate>& candidates, const Candidate& candidate) {
  return find_same(candidates, candidate) != candidates.end();
}

}  // namespace

struct CandidatePool::FrontMember {
  Candidate candidate;
  std::vector<double> objectives;
};

RememberedCandidates::RememberedCandidates(const Selection& selection, bool keeps_all)
    : selection_(selection), keeps_all_(keeps_all) {}

void RememberedCandidates::add(const Candidate& candidate) {
  const auto most = [](int count) { return static_cast<std::size_t>(count); };
  if (const auto before = find_same(last_, candidate); before != last_.end()) {
    last_.erase(before);
  }
  last_.push_back(candidate);
  if (last_.size() > most(selection_.last)) {
    last_.erase(last_.begin());
  }
  if (!candidate.recommended) {
    const auto before = find_same(best_, candidate);
    const bool is_better =
        before == best_.end() || candidate.training_objective < before->training_objective;
    if (before != best_.end() && is_better) {
      best_.erase(before);
    }
    if (is_better) {
      best_.insert(std::ranges::upper_bound(best_, candidate.training_objective, {},
                                            &Candidate::training_objective),
                   candidate);
    }
    if (best_.size() > most(selection_.best)) {
      best_.pop_back();
    }
  }
  if (keeps_all_) {
    if (count_ % stride_ == 0) {
      some_.push_back(candidate);
    }
    ++count_;
    newest_ = candidate;
    if (some_.size() > kMostSpread) {
      stride_ *= 2;
      for (std::size_t i = 0; 2 * i < some_.size(); ++i) {
        some_[i] = std::move(some_[2 * i]);
      }
      some_.resize((some_.size() + 1) / 2);
    }
  }
}

// With constraints, the last improvements of a long run all lie close to a limit. All of them
// exceed it if the validation cases are a little harder, so earlier candidates are judged as well.
std::vector<Candidate> RememberedCandidates::spread(std::size_t count) const {
  std::vector<Candidate> candidates = some_;
  if (newest_ && (count_ - 1) % stride_ != 0) {
    candidates.push_back(*newest_);
  }
  count = std::min(count, candidates.size());
  std::vector<Candidate> some;
  for (std::size_t i = 0; i < count; ++i) {
    some.push_back(candidates[i * (candidates.size() - 1) / std::max<std::size_t>(count - 1, 1)]);
  }
  return some;
}

CandidatePool::CandidatePool(const RunPlan& plan)
    : problem_(plan.problem.problem->description()),
      selection_(plan.selection),
      fresh_(plan.schedule.renews_cases()),
      candidates_(selection_,
                  !problem_.constraints.empty() || std::isfinite(problem_.failure_error)) {}

CandidatePool::~CandidatePool() = default;

void CandidatePool::recommend(std::vector<double> x, std::uint64_t generation) {
  candidates_.add({std::move(x), 0, generation, true, 0});
}

void CandidatePool::end_generation() {
  if (incumbent_) {
    last_best_ = incumbent_->training_objective;
    candidates_.add(*std::exchange(incumbent_, std::nullopt));
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
  if (record.cases.numbers.size() != cases_) {
    cases_ = record.cases.numbers.size();
    if (!fresh_ && incumbent_) {  // the cases have grown
      last_best_ = incumbent_->training_objective;
      incumbent_.reset();
    }
  }
  if (incumbent_ && incumbent_->training_objective <= objective) {
    return;
  }
  incumbent_ = Candidate{record.x, record.index, record.generation, false, objective};
  if (!fresh_) {
    candidates_.add(*incumbent_);
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

// Returns the whole front or, if it has too many members to judge, both ends and members at even
// distances of their rank in the first objective.
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

// Leaves at most `selection_.most` of the chosen candidates. The last ones stand in front, newest
// first, so the oldest of them that are not among the best lose their places.
void CandidatePool::limit_places(const std::vector<Candidate>& best,
                                 std::vector<Candidate>& chosen) const {
  const auto most = static_cast<std::size_t>(selection_.most);
  for (std::size_t i = chosen.size(); i > 0 && chosen.size() > most; --i) {
    if (!is_among(best, chosen[i - 1])) {
      chosen.erase(chosen.begin() + static_cast<std::ptrdiff_t>(i - 1));
    }
  }
}

RememberedCandidates CandidatePool::list_all() const {
  RememberedCandidates all = candidates_;
  if (fresh_ && incumbent_) {
    all.add(*incumbent_);  // the last generation's best
  }
  return all;
}

std::vector<Candidate> CandidatePool::select_earlier() const {
  const std::vector<Candidate> chosen = select();
  std::vector<Candidate> earlier;
  for (Candidate& candidate : list_all().spread(static_cast<std::size_t>(selection_.last))) {
    if (!is_among(chosen, candidate) && !is_among(earlier, candidate)) {
      earlier.push_back(std::move(candidate));
    }
  }
  return earlier;
}

std::vector<Candidate> CandidatePool::select() const {
  const RememberedCandidates all = list_all();
  const auto most = static_cast<std::size_t>(selection_.last);
  const std::vector<Candidate> candidates =
      problem_.constraints.empty() ? all.last() : all.spread(most);
  std::vector<Candidate> chosen =
      problem_.objectives.size() > 1 ? thin_front() : std::vector<Candidate>{};
  for (auto candidate = candidates.rbegin(); candidate != candidates.rend() && chosen.size() < most;
       ++candidate) {
    if (!is_among(chosen, *candidate)) {
      chosen.push_back(*candidate);
    }
  }
  std::ranges::copy_if(all.best(), std::back_inserter(chosen),
                       [&](const Candidate& candidate) { return !is_among(chosen, candidate); });
  limit_places(all.best(), chosen);
  std::stable_sort(chosen.begin(), chosen.end(), [](const Candidate& a, const Candidate& b) {
    return a.generation != b.generation ? a.generation < b.generation : a.evaluation < b.evaluation;
  });
  return chosen;
}

}  // namespace armwright
