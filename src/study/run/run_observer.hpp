// The progress and the messages of a run, and the interface of objects that receive them.
#pragma once

#include <cstdint>
#include <limits>
#include <mutex>
#include <string>

#include "problems/interface/problem.hpp"

namespace armwright {

struct Progress {
  CaseRole phase = CaseRole::training;  // the run's phase: on which set it evaluates now
  std::uint64_t done = 0;               // cases
  std::uint64_t total = 0;              // cases
  std::uint64_t replayed = 0;           // of the cases done, those that the journal has answered
  std::uint64_t generation = 0;
  // On fixed training cases the incumbent's objective, on others the best of the last generation;
  // NaN if there is none yet.
  double best_objective = std::numeric_limits<double>::quiet_NaN();
};

// Returns "training", "validation" or "test".
inline const char* to_string(CaseRole phase) {
  switch (phase) {
    case CaseRole::training:
      return "training";
    case CaseRole::validation:
      return "validation";
    case CaseRole::test:
      break;
  }
  return "test";
}

// An observer receives what a run reports. Calls come from any thread, one at a time.
class RunObserver {
 public:
  virtual ~RunObserver() = default;
  virtual void on_progress(const Progress& progress) = 0;
  virtual void on_message(const std::string& message) = 0;
};

// A LockedObserver passes on the calls of several callers to one observer, one call at a time. The
// inner observer must outlive it.
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
