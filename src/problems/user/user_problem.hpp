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

// Returns whether a case failed although its program did not answer that it fails: the program
// crashed, hung, or answered with a number that is not finite.
bool is_fault_of_program(const CaseOutcome& outcome);

}  // namespace armwright
