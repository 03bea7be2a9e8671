// For what another thread or process does sooner or later.
#pragma once

#include <chrono>
#include <functional>
#include <thread>

namespace armwright {

// Calls `condition` until it holds; false if it does not for so long that something hangs.
inline bool wait_until(const std::function<bool()>& condition,
                       std::chrono::milliseconds pause = std::chrono::milliseconds(1)) {
  constexpr std::chrono::seconds kPatience{60};
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) {
      return false;
    }
    std::this_thread::sleep_for(pause);
  }
  return true;
}

}  // namespace armwright
