// Shows the progress of a run or an evaluation on stderr. On a terminal it redraws one line in
// place; elsewhere it prints plain lines.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "problems/interface/problem.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {

// An observer that prints. Not thread-safe: LockedObserver serves several threads.
class ProgressBar final : public RunObserver {
 public:
  // With `quiet`, only messages are printed. `objective` gives the unit of the best value.
  ProgressBar(bool quiet, Quantity objective);
  ~ProgressBar() override { clear(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void on_progress(const Progress& progress) override;
  void on_message(const std::string& message) override;
  // Removes the bar from the screen, so that other text can be written.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  enum class Mode : std::uint8_t;

  // Returns the mean rate since the phase began, in cases per second. Returns 0 if less than 0.3 s
  // have passed or nothing was simulated.
  double calc_cases_per_s(const Progress& progress, Clock::time_point now) const;
  void draw_bar(const Progress& progress, Clock::time_point now);
  void write_line(const Progress& progress, Clock::time_point now);

  Mode mode_;
  Quantity objective_;
  bool begun_ = false;
  Progress last_;
  Clock::time_point phase_began_;
  std::uint64_t simulated_before_phase_ = 0;  // cases of the journal are not counted
  Clock::time_point last_shown_;
  std::uint64_t last_tenth_ = 0;
  bool drawn_ = false;
};

}  // namespace armwright
