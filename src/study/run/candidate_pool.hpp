// Keeps the designs of a run that are worth judging on the validation set: with fixed training
// cases every improvement, with growing cases every improvement of a stage, with new cases for every
// generation the best of each (objectives on different cases cannot be compared), with several
// objectives the front, and the optimizer's recommendations.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "study/journal/journal.hpp"
#include "study/run/run_plan.hpp"

namespace armwright {

// A candidate for the winner: an evaluated or recommended decision vector that the run keeps. The
// glossary's word "candidate" alone means any decision vector that an optimizer proposes.
struct Candidate {
  std::vector<double> x;
  std::uint64_t evaluation = 0;  // index of its training evaluation; unused if recommended
  std::uint64_t generation = 0;
  bool recommended = false;       // by the optimizer; it has no training objective then
  double training_objective = 0;  // calc_scalar(): of several objectives the weighted sum
};

// Keeps those of a sequence of candidates that CandidatePool::select() may need.
class RememberedCandidates {
 public:
  RememberedCandidates(const Selection& selection, bool keeps_all);

  void add(const Candidate& candidate);
  // Returns the last `selection.last` different candidates, oldest first. A candidate that was
  // added twice stands at its last place.
  const std::vector<Candidate>& last() const { return last_; }
  // Returns the best `selection.best` different candidates that are not recommendations, best
  // first; of equal ones the earliest.
  const std::vector<Candidate>& best() const { return best_; }
  // Returns at most `count` candidates at even distances, including the first and the last. Of more
  // than 65536 candidates, only every second, fourth, ... one is kept. Needs `keeps_all`.
  std::vector<Candidate> spread(std::size_t count) const;

 private:
  Selection selection_;
  bool keeps_all_;
  std::vector<Candidate> last_;
  std::vector<Candidate> best_;
  std::vector<Candidate> some_;  // every stride_-th
  std::uint64_t stride_ = 1;
  std::uint64_t count_ = 0;
  std::optional<Candidate> newest_;
};

// A candidate pool holds the candidates for the winner of one run. It is not thread-safe.
class CandidatePool {
 public:
  explicit CandidatePool(const RunPlan& plan);  // the plan must outlive the pool
  ~CandidatePool();

  void consider(const EvaluationRecord& record);  // must be feasible
  void recommend(std::vector<double> x, std::uint64_t generation);
  void end_generation();  // only if each generation has its own training cases
  // Returns the incumbent's objective with fixed training cases. With changing cases, returns the
  // best on these cases or, before there is any, on the last ones. NaN if there is none.
  double best_objective() const;
  // Returns the incumbent's objective on the present training cases; infinity if there is none.
  double incumbent_objective() const;
  // Returns the different designs to judge on the validation set, oldest first: the last and the
  // best candidates, at most Selection::most. With constraints, candidates from the whole run replace the last ones; with
  // several objectives, members of the front come first.
  std::vector<Candidate> select() const;
  // Returns further designs to judge if the best of select() fails there: at most Selection::last
  // candidates at even distances over the whole run. Small motors let a run end at the edge of
  // failing, and its last candidates fail together. Empty if the problem has neither constraints nor
  // a limit for failures.
  std::vector<Candidate> select_earlier() const;

 private:
  struct FrontMember;
  void extend_front(const EvaluationRecord& record, double objective);
  std::vector<Candidate> thin_front() const;
  RememberedCandidates list_all() const;
  void limit_places(const std::vector<Candidate>& best, std::vector<Candidate>& chosen) const;

  const ProblemDescription& problem_;
  const Selection selection_;
  const bool fresh_;  // each generation has its own training cases
  // The best so far on the present training cases.
  std::optional<Candidate> incumbent_;
  std::size_t cases_ = 0;  // of the incumbent; other numbers of cases are of another stage
  // With changing cases, the best objective before the last change.
  double last_best_ = std::numeric_limits<double>::quiet_NaN();
  // All improvements and recommendations; with changing cases, the best of each generation.
  RememberedCandidates candidates_;
  // With several objectives: the feasible evaluations that no other evaluation covers, that is, is
  // at least as good as in all objectives.
  std::vector<FrontMember> front_;
};

}  // namespace armwright
