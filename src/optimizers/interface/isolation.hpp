// Runs an optimizer in a child process, where it can be abandoned. The child's Evaluator asks this
// process for every score. If the optimizer crashes, exits, hangs or takes too much memory, only
// the run fails, not the program. The results are the same as without the child process.
#pragma once

#include <functional>
#include <string>

#include "optimizers/interface/optimizer.hpp"
#include "process/process_watch.hpp"

namespace armwright {

class OutputLog;

// Calls `body` in a child process and returns when `body` returns. Kills the child `farewell_s`
// seconds after evaluator.stopped() has become true. Until then the child may recommend points, and
// no fault of it makes the run fail. The child's output goes to `log`, or to the standard error of this
// process if there is no log. Throws OptimizerFailure, with `name` in its message, if the child
// throws, dies, sends nothing for too long, sends invalid requests, keeps asking without
// evaluating, or exceeds its memory limit. Throws Error{io} if no process can be started.
void minimize_isolated(const std::string& name, const std::function<void(Evaluator&)>& body,
                       Evaluator& evaluator, const ProcessLimits& limits, OutputLog* log = nullptr,
                       double farewell_s = 0);

// Returns the options silence_s, memory_mib and log of optimizers that run in a process of their
// own. They change no result: a run may be resumed with other values.
std::vector<OptionSpec> make_isolation_options();

}  // namespace armwright
