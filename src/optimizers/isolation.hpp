// Runs an optimizer where it can be abandoned: in a child process (fork), whose Evaluator asks this
// process for every score. A crash, an exit, a hang or a hunger for memory costs the run, not the
// program. Results are those of running it here.
#pragma once

#include <functional>
#include <string>

#include "optimizers/optimizer.hpp"

namespace armwright {

class OutputLog;

struct IsolationLimits {
  double silence_s = 60;     // longest time between two questions; the scores' own time not counted
  double memory_mib = 4096;  // that the child may allocate beyond what it began with
  bool are_options = false;  // the two above: messages then name them, for the user to change
};

// Calls `body` in the child. Returns when it returns. Kills the child as soon as
// evaluator.stopped() holds. Throws OptimizerFailure, with `name` in the message, if the child
// throws, dies, falls silent, asks for nonsense or on and on without evaluating, or takes more
// memory than allowed; Error{io} if there is no process to be had. What the child prints goes into
// `log`, or else to our standard error.
void minimize_isolated(const std::string& name, const std::function<void(Evaluator&)>& body,
                       Evaluator& evaluator, const IsolationLimits& limits,
                       OutputLog* log = nullptr);

}  // namespace armwright
