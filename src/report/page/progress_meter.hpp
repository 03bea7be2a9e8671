// Measures the progress of a run or study while `armwright watch` looks at it: throughput, time left,
// running cells and failures. Everything is read from the folder, which is left as it is. Only .cpp
// files include this.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>

#include "report/evidence/recorded_run.hpp"
#include "study/compare/cell.hpp"
#include "study/compare/study_plan.hpp"

namespace armwright {

// Estimates rates from amounts of work at several times. Times are in s, of any steady clock.
class RateEstimate {
 public:
  // The time over which the throughput is a mean.
  static constexpr double kWindow_s = 60;

  // Takes what is done at a time that is not before the last one. `work` and `total` have the same
  // unit; `simulations` is the number of simulated cases.
  void add(double time_s, double simulations, double work, double total);
  // Returns the simulations per second in the last minute; nothing with one observation in it.
  std::optional<double> calc_per_second() const;
  // Returns the time that the rest of the work takes at the mean speed since the first observation.
  // Returns nothing if no work was done since then, or none in the last minute.
  std::optional<double> calc_left_s() const;

 private:
  struct Observation {
    double time_s = 0, simulations = 0, work = 0, total = 0;
  };
  std::optional<Observation> first_;
  std::deque<Observation> recent_;  // of the last minute; never empty after add()
};

// One meter belongs to one folder. Not thread-safe.
class ProgressMeter {
 public:
  // Each returns Watched of web/src/data.ts at the present time.
  nlohmann::json observe_run(const RecordedRun& run);
  // `ended` are the cells that have ended. Throws Error{io}.
  nlohmann::json observe_study(const StudyPlan& plan, std::span<const CellOutcome> ended,
                               const std::filesystem::path& study);
  nlohmann::json observe_results(std::size_t done, std::size_t total);

 private:
  // The evaluations of a cell or run that were counted so far, over all attempts at it.
  struct Counted {
    std::filesystem::path journal;  // of the newest attempt
    std::uintmax_t bytes = 0;       // its size when it was read last
    std::size_t evaluations = 0;
    std::uint64_t simulations = 0;
    std::uint64_t failed = 0;
    std::set<std::uint64_t> listed;  // evaluations that were once in failures_, by index
  };

  // Counts the evaluations behind those that were counted before. `name` is that of the cell, or
  // empty for a run.
  const Counted& count(const std::string& name, const RecordedEvaluations& training);
  // Does the same for a journal of the cell. Does not open a journal whose size is the same as
  // before. Otherwise reads the whole journal, but simulations and failures only behind those that
  // were counted. Throws Error.
  const Counted& count_cell(const std::string& name, const std::filesystem::path& journal);
  nlohmann::json make(double simulations, double work, double total);

  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  RateEstimate rate_;
  std::map<std::string, Counted> counted_;  // by the name of the cell; "" for a run
  std::deque<nlohmann::json> failures_;     // of candidates, the newest ones, newest first
};

}  // namespace armwright
