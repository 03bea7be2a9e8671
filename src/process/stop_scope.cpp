#include "process/stop_scope.hpp"

#include <chrono>
#include <thread>
#include <utility>

namespace armwright {
namespace {

thread_local StopSignal* t_stop = nullptr;

}  // namespace

StopScope::StopScope(StopSignal* stop) : before_(std::exchange(t_stop, stop)) {}

StopScope::~StopScope() {
  t_stop = before_;
}

StopSignal* get_work_stop() {
  return t_stop;
}

void check_work_stop() {
  if (t_stop != nullptr && t_stop->requested() && t_stop->reason() != StopReason::time_limit) {
    throw WorkStopped{};
  }
}

void await_work_stop() {
  constexpr int kChecks = 10;
  constexpr std::chrono::milliseconds kPause{10};
  check_work_stop();
  for (int i = 0; t_stop != nullptr && i < kChecks; ++i) {
    std::this_thread::sleep_for(kPause);
    check_work_stop();
  }
}

}  // namespace armwright
