// Lets several parties that know nothing of each other talk to one observer.
#pragma once

#include <mutex>
#include <string>

#include "study/run/run_observer.hpp"

namespace armwright {

class LockedObserver final : public RunObserver {
 public:
  explicit LockedObserver(RunObserver& inner) : inner_(inner) {}
  void on_progress(const Progress& progress) override {
    const std::lock_guard lock(mutex_);
    inner_.on_progress(progress);
  }
  void on_message(const std::string& message) override {
    const std::lock_guard lock(mutex_);
    inner_.on_message(message);
  }

 private:
  std::mutex mutex_;
  RunObserver& inner_;
};

}  // namespace armwright
