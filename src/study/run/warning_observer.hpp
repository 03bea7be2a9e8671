// Tells the warnings of a user's problem while it is simulated in this process.
#pragma once

#include <string>

#include "problems/user/user_problem.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {

// A WarningObserver passes on all reports. Before each of them, it tells the warnings of the problem
// that wait. Its destructor tells the rest, because work may end by an exception or a stop before it
// reports again.
class WarningObserver final : public RunObserver {
 public:
  // The problem and the inner observer must outlive this object.
  WarningObserver(const Problem& problem, RunObserver& inner)
      : warnings_(find_warnings(problem)), inner_(inner) {}
  ~WarningObserver() override {
    try {
      tell_warnings();
    } catch (...) {  // an exception in progress must not be replaced
    }
  }
  WarningObserver(const WarningObserver&) = delete;
  WarningObserver& operator=(const WarningObserver&) = delete;

  void on_progress(const Progress& progress) override {
    tell_warnings();
    inner_.on_progress(progress);
  }
  void on_message(const std::string& message) override {
    tell_warnings();
    inner_.on_message(message);
  }

 private:
  void tell_warnings() {
    if (warnings_ != nullptr) {
      for (const std::string& warning : warnings_->take()) {
        inner_.on_message("warning: " + warning);
      }
    }
  }

  ProblemWarnings* const warnings_;  // null if the problem has none
  RunObserver& inner_;
};

}  // namespace armwright
