#include "study/matrix/cell_attempt.hpp"

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "base/error.hpp"
#include "base/folder_checksums.hpp"
#include "study/compare/cell.hpp"
#include "study/compare/study_folder.hpp"
#include "study/matrix/attempt.hpp"
#include "study/run/run_lock.hpp"

namespace armwright {
namespace {

// Passes everything on to `next` and counts the simulated training cases.
class CountingObserver final : public RunObserver {
 public:
  explicit CountingObserver(RunObserver& next) : next_(next) {}
  void on_progress(const Progress& progress) override {
    if (progress.phase == CaseRole::training) {
      cases_ = progress.done;
    }
    next_.on_progress(progress);
  }
  void on_message(const std::string& message) override { next_.on_message(message); }
  std::uint64_t cases() const { return cases_; }

 private:
  RunObserver& next_;
  std::atomic<std::uint64_t> cases_ = 0;
};

// A thread that writes signs of life and stops the run once there is a newer attempt, for as long
// as this object lives. A superseded process therefore ends soon. Until then it does no harm,
// because it writes only in its own folder.
class Watcher {
 public:
  Watcher(const Attempt& attempt, const CountingObserver& run, StopSignal& stop)
      : attempt_(attempt), run_(run), stop_(stop), thread_([this] { watch(); }) {}
  ~Watcher() {
    {
      const std::lock_guard lock(mutex_);
      ended_ = true;
    }
    wake_.notify_one();
    thread_.join();
  }
  Watcher(const Watcher&) = delete;
  Watcher& operator=(const Watcher&) = delete;

  bool has_stopped_it() const { return has_stopped_it_; }

 private:
  using Clock = std::chrono::steady_clock;

  void watch() {
    constexpr std::chrono::milliseconds kPeriod{500};
    constexpr std::chrono::seconds kSignOfLifePeriod{10};
    auto last_sign = Clock::now();
    std::unique_lock lock(mutex_);
    while (!wake_.wait_for(lock, kPeriod, [this] { return ended_; })) {
      try {
        if (!attempt_.find_successor().empty()) {
          has_stopped_it_ = true;
          stop_.request(StopReason::terminated);
          return;
        }
        if (Clock::now() - last_sign >= kSignOfLifePeriod) {
          last_sign = Clock::now();
          attempt_.tell_alive(run_.cases());
        }
      } catch (const Error&) {
        // A lasting error also shows when the run itself writes; a short one may be ignored.
      }
    }
  }

  const Attempt& attempt_;
  const CountingObserver& run_;
  StopSignal& stop_;
  std::atomic<bool> has_stopped_it_ = false;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool ended_ = false;
  std::thread thread_;  // declared last: it uses all other members
};

// Removes the cell from the study's checksums if they cover an earlier state of it. The lock keeps
// other processes from changing the checksums meanwhile.
void uncover_cell(const StudyPlan& plan, const Cell& cell, const std::filesystem::path& study) {
  const std::string name = (make_cell_path(plan, cell) / kChecksumFile).string();
  if (FolderChecksums(study).covers(name)) {
    const RunLock lock{Folder(study)};
    uncover_unfinished(plan, {&cell, 1}, study);
  }
}

CellAttempt superseded(const Attempt& attempt) {
  attempt.end_in_order();
  return {CellAttempt::End::superseded, attempt.find_successor(), false};
}

}  // namespace

CellAttempt attempt_cell(const StudyPlan& plan, const Cell& cell, const CellAttemptRequest& request,
                         StopSignal& stop, RunObserver& observer) {
  const auto attempts = make_attempts_path(plan, cell, request.study);
  if (std::string successor = find_later_life(attempts, request.process_begun_s);
      !successor.empty()) {
    return {CellAttempt::End::superseded, std::move(successor), false};
  }
  const Attempt attempt(attempts, request.study, request.process_begun_s);
  try {
    // An earlier attempt may have published the cell before it could see this one.
    if (load_cell(plan, cell, request.study)) {
      attempt.end_in_order();
      return {};
    }
    uncover_cell(plan, cell, request.study);
    copy_furthest_state(plan, cell, request.study, attempt.run(), observer);
    CountingObserver counting(observer);
    std::optional<CellOutcome> outcome;
    {
      const Watcher watcher(attempt, counting, stop);
      outcome = run_cell(plan, cell,
                         CellRequest{.folder = attempt.run(),
                                     .root = request.study,
                                     .jobs = request.jobs,
                                     .command_line = request.command_line},
                         stop, counting);
      if (!outcome && !watcher.has_stopped_it()) {
        attempt.end_in_order();
        return {CellAttempt::End::stopped, "", false};
      }
    }
    if (!outcome || !attempt.find_successor().empty()) {
      return superseded(attempt);
    }
    publish_cell(plan, cell, request.study, attempt.run(), attempt.aside());
    attempt.end_in_order();
    return {CellAttempt::End::done, "", !outcome->failure.empty()};
  } catch (const Error& error) {
    // The error is no fault if another process has superseded this attempt and removed its files.
    if (!attempt.find_successor().empty()) {
      return superseded(attempt);
    }
    attempt.end_in_order();
    try {
      attempt.record_error(error.what());
    } catch (const Error&) {
      // If the error cannot be written either, the first error is still the one to report.
    }
    throw;
  }
}

}  // namespace armwright
