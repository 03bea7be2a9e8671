// A problem that a user has written, as a Problem. It keeps one server per thread that simulates,
// and starts another one where a server fails. A case whose server crashes, hangs or answers with a
// number that is not finite is a failed case with a reason.
#pragma once

#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "problems/user/case_server.hpp"

namespace armwright {

// A server answered against its contract. This ends the run.
class BrokenProtocol : public Error {
  using Error::Error;
};

// Warnings about failed cases, which say more than their recorded reasons: the last lines that the
// program printed, and the text that a command has written in place of a number. Thread-safe.
class ProblemWarnings {
 public:
  // Adds a warning, unless there has been one with the same reason or there have been many.
  void add(const std::string& reason, const std::string& details);
  // Returns the warnings that it has not returned yet.
  std::vector<std::string> take();
  // Forgets all warnings, so that the same reason is a new warning again.
  void forget();

 private:
  std::mutex mutex_;
  std::set<std::string> told_;
  std::vector<std::string> waiting_;
};

// Objectives of several cases are combined by their mean or worst value, constraints by their worst
// value, metrics by their mean. Nothing starts before the first simulation. simulate() throws
// BrokenProtocol if a server breaks its contract, Error if none can be started, and WorkStopped as
// check_work_stop() does.
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
// Returns the warnings of a problem that make_user_problem() made; null for other problems. Valid as
// long as the problem.
ProblemWarnings* find_warnings(const Problem& problem);
// Throws Error{usage}, which says what to do, if a problem of make_user_problem() has no server.
void require_server(const Problem& problem);

// Returns the evaluation of a decision vector on the only case of `job.block` from an answer that
// was made outside of this program. The problem must be one of make_user_problem(). Throws
// Error{bad_data} if its residuals do not fit its objective.
Evaluation make_evaluation(const Problem& problem, const CaseJob& job, CaseAnswer answer);

}  // namespace armwright
