// For what another thread does sooner or later.
#pragma once

#include <chrono>
#include <functional>
#include <thread>

namespace armwright {

// Calls `condition` until it holds; false if it does not for longer than anything takes.
inline bool wait_until(const std::function<bool()>& condition) {
  constexpr std::chrono::seconds kPatience{20};  // only a failing test waits that long
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) {
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace armwright
