// Remembers, of all that a run evaluates in training, the designs worth judging: with fixed cases
// every improvement, with fresh ones the best of every generation (objectives on different cases do
// not compare), with several objectives the front, and what the optimizer recommends.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "study/journal/journal.hpp"
#include "study/run/run_plan.hpp"

namespace armwright {

// A design that may become the winner. Several objectives count as one number here: calc_scalar().
struct Candidate {
  std::vector<double> x;
  std::uint64_t evaluation =
      0;  // of the training evaluation that made it one; unused for a recommendation
  std::uint64_t generation = 0;
  bool recommended = false;  // named by the optimizer; it has no training objective of its own
  double training_objective = 0;
};

// Of any number of candidates, in the order in which they come, those that select() may ask for.
class RememberedCandidates {
 public:
  RememberedCandidates(const Selection& selection, bool keeps_all);

  void add(const Candidate& candidate);
  // The last different ones, each where it came last; oldest first.
  const std::vector<Candidate>& last() const { return last_; }
  // The best different ones with an objective of their own, the earliest of equals.
  const std::vector<Candidate>& best() const { return best_; }
  // At most `count` of all, the first and the last included, at even distances; where there are
  // more than 65536, of every second, fourth, ... one. Only of who keeps all.
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

class CandidatePool {
 public:
  explicit CandidatePool(const RunPlan& plan);  // which outlives it

  void consider(const EvaluationRecord& record);  // a feasible one
  void recommend(std::vector<double> x, std::uint64_t generation);
  void end_generation();  // fresh cases only
  // With fixed cases the incumbent's; with fresh ones the present generation's best, or the last
  // one's before there is any; NaN if there is none.
  double best_objective() const;
  // Of the present training cases; infinity if there is none.
  double incumbent_objective() const;
  // The designs to judge on the validation set, oldest first, no two the same: the last and the
  // best candidates; with constraints, instead of the last, some of the whole run; with several
  // objectives the front, thinned out.
  std::vector<Candidate> select() const;

 private:
  void extend_front(const EvaluationRecord& record, double objective);
  std::vector<Candidate> thin_front() const;

  const ProblemDescription& problem_;
  const Selection selection_;
  const bool fresh_;
  std::optional<Candidate> incumbent_;  // fixed: best so far; fresh: best of this generation
  // fresh: the best objective of the generation before
  double last_best_ = std::numeric_limits<double>::quiet_NaN();
  // fixed: of all improvements; fresh: of the bests of generations and of recommendations
  RememberedCandidates candidates_;
  // Several objectives: the feasible evaluations that no other one is at least as good as in all
  // objectives.
  struct FrontMember {
    Candidate candidate;
    std::vector<double> objectives;
  };
  std::vector<FrontMember> front_;
};

}  // namespace armwright
