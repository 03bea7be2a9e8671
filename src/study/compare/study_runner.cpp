#include "study/compare/study_runner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "base/error.hpp"
#include "base/text.hpp"
#include "problems/user/user_problem.hpp"
#include "process/child_process.hpp"
#include "study/compare/cell_worker.hpp"
#include "study/executor/case_packets.hpp"
#include "study/executor/coordinator.hpp"

namespace armwright {
namespace {

class Runner {
 public:
  Runner(const StudyPlan& plan, const std::filesystem::path& study, StopSignal& stop,
         RunObserver& observer, Coordinator* coordinator)
      : plan_(plan),
        study_(study),
        stop_(stop),
        observer_(observer),
        coordinator_(coordinator),
        problems_(list_problems(plan)) {
    progress_.total = list_cells(plan).size() *
                      static_cast<std::uint64_t>(std::max<std::int64_t>(plan.budget, 1));
    for (const Cell& cell : list_cells(plan)) {
      if (load_cell(plan, cell, study)) {
        progress_.done += static_cast<std::uint64_t>(plan.budget);
      } else {
        cells_.push_back(cell);
      }
    }
    progress_.replayed = progress_.done;
    under_way_.resize(cells_.size());
  }

  std::optional<std::size_t> run(unsigned jobs) {
    observer_.on_progress(progress_);
    forget_warnings();  // of the simulations that estimated the time of the study
    auto workers = start_workers(std::min(count_at_once(jobs), cells_.size()));
    std::vector<std::thread> threads;
    try {
      for (auto& worker : workers) {
        threads.emplace_back([this, &worker] { guard([&] { run_worker(worker); }); });
      }
    } catch (const std::system_error&) {
      warn_of_fewer(threads.size() + 1, workers.size());
      guard([&] { run_worker(workers[threads.size()]); });
    }
    for (std::thread& thread : threads) {
      thread.join();
    }
    if (failure_) {
      std::rethrow_exception(failure_);
    }
    return stop_.requested() ? std::nullopt : std::optional(broken_);
  }

 private:
  // Returns the number of worker processes. With ranks, a cell waits for answers most of the time.
  // A cell whose optimizer asks for one point after the other leaves most ranks idle. A few more
  // cells than threads keep all ranks busy.
  std::size_t count_at_once(unsigned jobs) const {
    constexpr std::size_t kMore = 2, kMost = 64;
    return coordinator_ == nullptr ? jobs
                                   : std::min(kMost, coordinator_->estimate_threads() + kMore);
  }

  // Starts the workers before this process has threads. Starts fewer, but at least one, if the
  // system grants no more.
  std::vector<std::unique_ptr<ChildProcess>> start_workers(std::size_t count) {
    std::vector<std::unique_ptr<ChildProcess>> workers;
    try {
      while (workers.size() < count) {
        workers.push_back(start_worker());
      }
    } catch (const Error&) {
      if (workers.empty()) {
        throw;
      }
      warn_of_fewer(workers.size(), count);
    }
    return workers;
  }

  void warn_of_fewer(std::size_t granted, std::size_t wanted) {
    if (granted == wanted) {
      return;
    }
    const std::lock_guard lock(mutex_);
    observer_.on_message(
        fmt::format("warning: the system grants {} of {} processes; the results "
                    "are the same, but take longer",
                    granted, wanted));
  }

  std::unique_ptr<ChildProcess> start_worker() {
    // A cell has no limits of time and memory. The processes of optimizers have their own limits.
    const ProcessLimits limits{.silence_s = std::numeric_limits<double>::infinity(),
                               .memory_mib = 1e9};
    return std::make_unique<ChildProcess>(
        [this](ParentLink& parent) {
          forget_warnings();  // of this process, which the worker has inherited
          work_on_cells(plan_, cells_, study_, parent, coordinator_ != nullptr);
        },
        limits);
  }

  void forget_warnings() {
    for (const LoadedProblem* loaded : problems_) {
      if (ProblemWarnings* const warnings = find_warnings(*loaded->problem)) {
        warnings->forget();
      }
    }
  }

  void guard(const std::function<void()>& body) {
    try {
      body();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!failure_) {
        failure_ = std::current_exception();
      }
    }
  }

  bool must_end() {
    const std::lock_guard lock(mutex_);
    return failure_ != nullptr || stop_.requested();
  }

  // Gives cells to one worker, and replaces the worker if it dies. A cell whose process dies is
  // tried once more, because the cause of its death may lie outside the cell.
  void run_worker(std::unique_ptr<ChildProcess>& worker) {
    for (std::size_t number = next_++; number < cells_.size() && !must_end(); number = next_++) {
      const CasesInUse use(*this, number);
      std::string death;
      if (!hand_over(*worker, number, death)) {
        worker = start_worker();
        if (!hand_over(*worker, number, death)) {
          note_broken(number, fmt::format("its process {}, twice", death));
          worker = start_worker();
        }
      }
    }
  }

  // Returns false if the worker died during the cell.
  bool hand_over(ChildProcess& worker, std::size_t number, std::string& death) {
    try {
      PacketWriter order;
      order.put(std::uint64_t{number});
      if (!worker.send(order.bytes(), [this] { return must_end(); }) && !follow(worker, number)) {
        // The cell has not ended, and its optimizer may have processes that the worker must end.
        constexpr std::chrono::seconds kPatience{3};
        worker.end_gently(kPatience);
      }
    } catch (const ChildFailure& failure) {
      death = failure.what();
      return false;
    }
    return true;
  }

  // Handles messages until the cell is done or broken. Returns false if the study ends before that.
  bool follow(ChildProcess& worker, std::size_t number) {
    std::string message;
    while (worker.receive([this] { return must_end(); }, message) == ChildProcess::Event::message) {
      PacketReader packet(message);
      const auto kind = packet.get<Note>();
      const auto count = packet.get<std::uint64_t>();
      const std::string text = packet.get_text();
      switch (kind) {
        case Note::batch:
          simulate(worker, count, text);
          break;
        case Note::progress:
          report(number, count);
          break;
        case Note::message:
          tell(number, text);
          break;
        case Note::done:
          report(number, static_cast<std::uint64_t>(plan_.budget));
          return true;
        case Note::broken:
          note_broken(number, text);
          return true;
        case Note::io_error:
          throw Error(ErrorKind::io, text);
      }
    }
    return false;
  }

  // Simulates a batch for the process of a cell.
  void simulate(ChildProcess& worker, std::uint64_t number, const std::string& bytes) {
    const LoadedProblem& loaded = *problems_.at(number);
    ReceivedBatch received;
    PacketReader packet(bytes);
    get_batch(packet, received);
    std::mutex sending;
    const auto answer = [&](const PacketWriter& message) {
      const std::lock_guard lock(sending);
      worker.send(message.bytes(), [this] { return must_end(); });
    };
    const auto pass_on = [&](const CaseBatch&, std::size_t first,
                             const std::vector<CaseOutcome>& outcomes) {
      PacketWriter message;
      message.put(Answer::outcomes);
      message.put(std::uint64_t{first});
      put_outcomes(message, outcomes);
      answer(message);
    };
    PacketWriter last;
    try {
      coordinator_->run(
          CaseBatch(*loaded.problem, received.candidates, received.block, received.extras, pass_on),
          stop_);
      last.put(Answer::end);
    } catch (const std::exception& error) {
      last.put(Answer::failure);
      last.put(std::string_view(error.what()));
    }
    tell_warnings(loaded);
    answer(last);
  }

  // Several cells may simulate the same problem here, so the messages name no cell.
  void tell_warnings(const LoadedProblem& loaded) {
    if (ProblemWarnings* const warnings = find_warnings(*loaded.problem)) {
      const std::lock_guard lock(mutex_);
      for (const std::string& warning : warnings->take()) {
        observer_.on_message(
            fmt::format("problem '{}': warning: {}", sanitize(loaded.name), warning));
      }
    }
  }

  // Counts the running cells of each problem while it lives. When the last one ends, the problem's
  // test cases are forgotten here and in the ranks; otherwise every problem would keep its cases.
  class CasesInUse {
   public:
    CasesInUse(Runner& runner, std::size_t number)
        : runner_(runner), problem_(*get_problem(runner.plan_, runner.cells_[number]).problem) {
      const std::lock_guard lock(runner_.mutex_);
      ++runner_.in_use_[&problem_];
    }
    ~CasesInUse() {
      const std::lock_guard lock(runner_.mutex_);
      if (--runner_.in_use_[&problem_] == 0 && runner_.coordinator_ != nullptr) {
        runner_.coordinator_->forget(problem_);
      }
    }
    CasesInUse(const CasesInUse&) = delete;
    CasesInUse& operator=(const CasesInUse&) = delete;

   private:
    Runner& runner_;
    const Problem& problem_;
  };

  void report(std::size_t number, std::uint64_t cases) {
    const std::lock_guard lock(mutex_);
    progress_.done += cases - under_way_[number];
    under_way_[number] = cases;
    observer_.on_progress(progress_);
  }

  void tell(std::size_t number, const std::string& text) {
    const std::lock_guard lock(mutex_);
    observer_.on_message(
        fmt::format("{}: {}", make_cell_path(plan_, cells_[number]).string(), text));
  }

  void note_broken(std::size_t number, const std::string& reason) {
    tell(number, "error: " + reason);
    report(number, static_cast<std::uint64_t>(plan_.budget));
    const std::lock_guard lock(mutex_);
    ++broken_;
  }

  const StudyPlan& plan_;
  const std::filesystem::path study_;
  StopSignal& stop_;
  RunObserver& observer_;
  Coordinator* const coordinator_;  // simulates for the cells; null if their processes do
  const std::vector<const LoadedProblem*> problems_;
  std::vector<Cell> cells_;  // those that have not ended
  std::atomic<std::size_t> next_ = 0;
  std::mutex mutex_;  // guards all members below
  Progress progress_;
  std::vector<std::uint64_t> under_way_;          // counted cases per cell
  std::map<const Problem*, std::size_t> in_use_;  // number of cells that use it
  std::size_t broken_ = 0;                        // count of cells that did not end
  std::exception_ptr failure_;
};

}  // namespace

std::optional<std::size_t> run_cells(const StudyPlan& plan, const std::filesystem::path& study,
                                     unsigned jobs, StopSignal& stop, RunObserver& observer,
                                     Coordinator* coordinator) {
  return Runner(plan, study, stop, observer, coordinator).run(jobs);
}

}  // namespace armwright
