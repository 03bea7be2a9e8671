// Runs an optimizer where it can be abandoned: in a child process (fork), whose Evaluator asks this
// process for every score. A crash, an exit, a hang or a hunger for memory costs the run, not the
// program. Results are those of running it here.
#pragma once

#include <functional>
#include <string>

#include "optimizers/interface/optimizer.hpp"
#include "process/process_watch.hpp"

namespace armwright {

class OutputLog;

// Calls `body` in the child. Returns when it returns. Kills the child as soon as
// evaluator.stopped() holds. Throws OptimizerFailure, with `name` in the message, if the child
// throws, dies, falls silent, asks for nonsense or on and on without evaluating, or takes more
// memory than allowed; Error{io} if there is no process to be had. What the child prints goes into
// `log`, or else to our standard error.
void minimize_isolated(const std::string& name, const std::function<void(Evaluator&)>& body,
                       Evaluator& evaluator, const ProcessLimits& limits, OutputLog* log = nullptr);

// The options silence_s, memory_mib and log of optimizers that run in a process of their own. They change no
// result: a run may be resumed with other values.
std::vector<OptionSpec> make_watch_options();

}  // namespace armwright
