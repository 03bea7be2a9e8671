// A problem that a user has written, as a Problem. It keeps one server per thread that simulates,
// and starts another one where a server fails. A case whose server crashes, hangs or answers with a
// number that is not finite is a failed case with a reason.
#pragma once

#include <memory>

#include "problems/user/case_server.hpp"

namespace armwright {

// Objectives of several cases are combined by their mean or worst value, constraints by their worst
// value, metrics by their mean. Nothing starts before the first simulation. simulate() throws
// Error{bad_data} if a server breaks its contract, and Error if none can be started.
std::shared_ptr<const Problem> make_user_problem(UserProgram program);

// A problem that changes the description of another one. The functions below see through it.
class WrappedProblem : public Problem {
 public:
  // Returns the other problem. Valid as long as this object lives.
  virtual const Problem& inner() const = 0;
};

// Returns whether a case failed although its program did not answer that it fails: the program
// crashed, hung, or answered with a number that is not finite.
bool is_fault_of_program(const CaseOutcome& outcome);
// Returns the description that the user gave of a problem that make_user_problem() made; null for
// other problems. Valid as long as the problem.
const UserDescription* find_user_description(const Problem& problem);
// Throws Error{usage}, which says what to do, if a problem of make_user_problem() has no server.
void require_server(const Problem& problem);

// Returns the evaluation of a decision vector on the only case of `job.block`, where somebody else
// has simulated it and hands over the answer. The problem must be one of make_user_problem(). Throws
// Error{bad_data} if its residuals do not fit its objective.
Evaluation make_evaluation(const Problem& problem, const CaseJob& job, CaseAnswer answer);

}  // namespace armwright
