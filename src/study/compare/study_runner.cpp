#include "study/compare/study_runner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <exception>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>

#include "base/error.hpp"
#include "optimizers/child_process.hpp"
#include "optimizers/packet.hpp"

namespace armwright {
namespace {

// What a worker tells of its cell.
enum class Note : std::uint8_t { progress, message, done, broken, io_error };

std::string make_note(Note kind, std::string_view text, std::uint64_t number = 0) {
  PacketWriter packet;
  packet.put(kind);
  packet.put(number);
  packet.put(text);
  return packet.bytes();
}

// In the worker: passes on what the run says, progress at most a few times a second.
class Reporter final : public RunObserver {
 public:
  explicit Reporter(ParentLink& parent) : parent_(parent) {}

  void on_progress(const Progress& progress) override {
    constexpr std::chrono::milliseconds kInterval{200};
    const auto now = Clock::now();
    if (progress.phase == Progress::Phase::training && now - last_ >= kInterval) {
      last_ = now;
      parent_.send(make_note(Note::progress, "", progress.done));
    }
  }
  void on_message(const std::string& message) override {
    parent_.send(make_note(Note::message, message));
  }

 private:
  using Clock = std::chrono::steady_clock;
  ParentLink& parent_;
  Clock::time_point last_ = Clock::now();
};

// A signal handler reaches nothing but globals; a worker is a process of its own, and has but one.
std::atomic<StopSignal*> g_worker_stop = nullptr;

extern "C" void stop_worker(int /*signal*/) {
  g_worker_stop.load()->request(StopReason::terminated);
}

// The study's lock is ours, so whoever holds a cell's is a worker of a process that was killed, and
// about to die with it.
void run_when_free(const StudyPlan& plan, const Cell& cell, const std::filesystem::path& study,
                   StopSignal& stop, RunObserver& observer) {
  constexpr int kMostTries = 100;
  constexpr std::chrono::milliseconds kPause{50};
  for (int tries = 1;; ++tries) {
    try {
      run_cell(plan, cell, study, stop, observer);
      return;
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::busy || tries == kMostTries) {
        throw;
      }
    }
    std::this_thread::sleep_for(kPause);
  }
}

// A worker's life: one cell after the other, until it is asked to end.
void work(const StudyPlan& plan, std::span<const Cell> cells, const std::filesystem::path& study,
          ParentLink& parent) {
  StopSignal stop;
  g_worker_stop = &stop;
  std::signal(SIGTERM, stop_worker);
  std::signal(SIGXFSZ, SIG_IGN);  // an error of write()
  while (true) {
    const std::string order = parent.receive();
    const auto number = PacketReader(order).get<std::uint64_t>();
    Reporter reporter(parent);
    try {
      run_when_free(plan, cells[number], study, stop, reporter);
      if (stop.requested()) {
        return;
      }
      parent.send(make_note(Note::done, ""));
    } catch (const Error& error) {
      const bool is_io = error.kind() == ErrorKind::io;
      parent.send(make_note(is_io ? Note::io_error : Note::broken, error.what()));
    }
  }
}

class Runner {
 public:
  Runner(const StudyPlan& plan, const std::filesystem::path& study, StopSignal& stop,
         RunObserver& observer)
      : plan_(plan), study_(study), stop_(stop), observer_(observer) {
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

  CellsResult run(unsigned jobs) {
    observer_.on_progress(progress_);
    auto workers = start_workers(std::min<std::size_t>(jobs, cells_.size()));
    std::vector<std::thread> threads;
    try {
      for (auto& worker : workers) {
        threads.emplace_back([this, &worker] { guard([&] { attend(worker); }); });
      }
    } catch (const std::system_error&) {
      warn_of_fewer(threads.size() + 1, workers.size());
      guard([&] { attend(workers[threads.size()]); });
    }
    for (std::thread& thread : threads) {
      thread.join();
    }
    if (failure_) {
      std::rethrow_exception(failure_);
    }
    result_.stopped = stop_.requested();
    std::ranges::sort(result_.broken, {},
                      [&](const BrokenCell& broken) { return make_cell_path(plan_, broken.cell); });
    return std::move(result_);
  }

 private:
  // Before there are threads. As many as the system grants, if it grants any.
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
    // A cell takes as long and as much as it takes: the optimizers' own processes are watched.
    const IsolationLimits limits{.silence_s = std::numeric_limits<double>::infinity(),
                                 .memory_mib = 1e9};
    return std::make_unique<ChildProcess>(
        [this](ParentLink& parent) { work(plan_, cells_, study_, parent); }, limits);
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

  // Hands cells to one worker, and to a new one in its place if it dies. A cell whose process dies
  // is tried once more: what killed it may have had nothing to do with it.
  void attend(std::unique_ptr<ChildProcess>& worker) {
    for (std::size_t number = next_++; number < cells_.size() && !must_end(); number = next_++) {
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

  // False if the worker has died of it.
  bool hand_over(ChildProcess& worker, std::size_t number, std::string& death) {
    try {
      PacketWriter order;
      order.put(std::uint64_t{number});
      if (!worker.send(order.bytes(), [this] { return must_end(); }) && !follow(worker, number)) {
        // In the midst of a cell: its optimizer may have processes of its own to be ended.
        constexpr std::chrono::seconds kPatience{3};
        worker.end_gently(kPatience);
      }
    } catch (const ChildFailure& failure) {
      death = failure.what();
      return false;
    }
    return true;
  }

  // Until the cell is done or broken. False if everything is over before that.
  bool follow(ChildProcess& worker, std::size_t number) {
    std::string message;
    while (worker.receive([this] { return must_end(); }, message) == ChildProcess::Event::message) {
      PacketReader packet(message);
      const auto kind = packet.get<Note>();
      const auto count = packet.get<std::uint64_t>();
      const std::string text = packet.get_text();
      switch (kind) {
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
    result_.broken.push_back({cells_[number], reason});
  }

  const StudyPlan& plan_;
  const std::filesystem::path study_;
  StopSignal& stop_;
  RunObserver& observer_;
  std::vector<Cell> cells_;  // that have not ended
  std::atomic<std::size_t> next_ = 0;
  std::mutex mutex_;  // of all below
  Progress progress_;
  std::vector<std::uint64_t> under_way_;  // cases counted of each cell
  CellsResult result_;
  std::exception_ptr failure_;
};

}  // namespace

CellsResult run_cells(const StudyPlan& plan, const std::filesystem::path& study, unsigned jobs,
                      StopSignal& stop, RunObserver& observer) {
  return Runner(plan, study, stop, observer).run(jobs);
}

}  // namespace armwright
