// The progress and the messages of a run, and the interface of those who listen to them.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

namespace armwright {

struct Progress {
  enum class Phase { training, validation, test } phase = Phase::training;
  std::uint64_t done = 0;  // cases
  std::uint64_t total = 0;
  std::uint64_t replayed = 0;  // of the cases done, those from the journal
  std::uint64_t generation = 0;
  double best_objective =
      std::numeric_limits<double>::quiet_NaN();  // fixed: the incumbent's; fresh: the last
                                                 // generation's best
};

const char* to_string(Progress::Phase phase);

// What a run tells while it goes on. Calls come from any thread, one at a time.
class RunObserver {
 public:
  virtual ~RunObserver() = default;
  virtual void on_progress(const Progress& progress) = 0;
  virtual void on_message(const std::string& message) = 0;
};

}  // namespace armwright
