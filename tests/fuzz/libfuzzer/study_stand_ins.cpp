// A cell of a study is read but not run.
#include <stdexcept>

#include "study/run/run.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {

std::optional<RunResult> execute_run(const RunRequest& /*request*/, StopSignal& /*stop*/,
                                     RunObserver& /*observer*/) {
  throw std::logic_error("fuzzers do not run");
}

}  // namespace armwright
