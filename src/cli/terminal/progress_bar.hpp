// Shows how far a run or an evaluation is, on stderr: one line redrawn in place on a terminal,
// plain lines elsewhere.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "problems/interface/problem.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {

class ProgressBar final : public RunObserver {
 public:
  // `quiet` shows no progress; messages come through all the same.
  ProgressBar(bool quiet, Quantity objective);
  ~ProgressBar() override { clear(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void on_progress(const Progress& progress) override;
  void on_message(const std::string& message) override;
  // Takes the bar off the screen, so that something else can be written.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  enum class Mode { none, lines, bar };

  // What is known of rate and remaining time, begun anew with every phase.
  struct Pace {
    Clock::time_point since;
    std::uint64_t simulated = 0;  // cases already done then, those from the journal not counted
  };
  struct Rate {
    double cases_per_s;
    double left_s;
  };
  std::optional<Rate> calc_rate(const Progress& progress, Clock::time_point now) const;
  void draw_bar(const Progress& progress, Clock::time_point now);
  void write_line(const Progress& progress, Clock::time_point now);

  Mode mode_;
  Quantity objective_;
  bool begun_ = false;
  Progress last_;
  Pace pace_;
  Clock::time_point last_shown_;
  std::uint64_t last_tenth_ = 0;
  bool drawn_ = false;
};

}  // namespace armwright
