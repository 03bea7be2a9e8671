#include "study/compare/cell_worker.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <exception>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "base/error.hpp"
#include "process/packet.hpp"
#include "study/executor/case_packets.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {
namespace {

std::string make_note(Note kind, std::string_view text, std::uint64_t number = 0) {
  PacketWriter packet;
  packet.put(kind);
  packet.put(number);
  packet.put(text);
  return packet.bytes();
}

// Sends the messages and the progress of a run to the parent, progress at most a few times per
// second.
class Reporter final : public RunObserver {
 public:
  explicit Reporter(ParentLink& parent) : parent_(parent) {}

  void on_progress(const Progress& progress) override {
    constexpr std::chrono::milliseconds kInterval{200};
    const auto now = Clock::now();
    if (progress.phase == CaseRole::training && now - last_ >= kInterval) {
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

// Lets the parent simulate the batches of a cell. A replicate's problem is simulated as the problem
// of the plan from which it was made, so it must not be an instance of its own.
class ParentExecutor final : public CaseExecutor {
 public:
  ParentExecutor(const StudyPlan& plan, const Cell& cell, ParentLink& parent) : parent_(parent) {
    const auto problems = list_problems(plan);
    problem_ = static_cast<std::uint64_t>(std::ranges::find(problems, &get_problem(plan, cell)) -
                                          problems.begin());
  }

  void run(const CaseBatch& batch, StopSignal& /*stop*/) override {
    if (batch.size() == 0) {
      return;
    }
    PacketWriter packet;
    put_batch(packet, batch);
    parent_.send(make_note(Note::batch, packet.bytes(), problem_));
    std::exception_ptr failure;  // thrown by the batch; the answers are still read to their end
    while (true) {
      const std::string message = parent_.receive();
      PacketReader answer(message);
      const auto kind = answer.get<Answer>();
      if (kind == Answer::failure) {
        throw std::runtime_error(answer.get_text());
      }
      if (kind == Answer::end) {
        break;
      }
      const auto first = answer.get<std::uint64_t>();
      try {
        if (!failure) {
          batch.deliver(first, get_outcomes(answer));
        }
      } catch (...) {
        failure = std::current_exception();
      }
    }
    if (failure) {
      std::rethrow_exception(failure);
    }
  }

 private:
  ParentLink& parent_;
  std::uint64_t problem_ = 0;
};

// Global, because a signal handler can reach only globals. A worker process has only one.
std::atomic<StopSignal*> g_worker_stop = nullptr;

extern "C" void stop_worker(int /*signal*/) {
  g_worker_stop.load()->request(StopReason::terminated);
}

// Runs the cell as soon as its lock is free. This comparison holds the study's lock, so a process
// with the cell's lock is a worker of a killed comparison and will end soon.
void run_when_free(const StudyPlan& plan, const Cell& cell, const CellRequest& where,
                   StopSignal& stop, RunObserver& observer) {
  constexpr int kMostTries = 100;
  constexpr std::chrono::milliseconds kPause{50};
  for (int tries = 1;; ++tries) {
    try {
      run_cell(plan, cell, where, stop, observer);
      return;
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::busy || tries == kMostTries) {
        throw;
      }
    }
    std::this_thread::sleep_for(kPause);
  }
}

}  // namespace

void work_on_cells(const StudyPlan& plan, std::span<const Cell> cells,
                   const std::filesystem::path& study, ParentLink& parent, bool parent_simulates) {
  StopSignal stop;
  g_worker_stop = &stop;
  std::signal(SIGTERM, stop_worker);
  std::signal(SIGXFSZ, SIG_IGN);  // write() then returns an error instead
  while (true) {
    const std::string order = parent.receive();
    const auto number = PacketReader(order).get<std::uint64_t>();
    Reporter reporter(parent);
    try {
      ParentExecutor executor(plan, cells[number], parent);
      // The parent has the problems of the plan, but not the instances of its replicates. Functions
      // cost so little that this process evaluates them itself.
      const auto& function = get_problem(plan, cells[number]).function;
      const bool is_instance = function && function->instance_per_replicate;
      const CellRequest where{.folder = study / make_cell_path(plan, cells[number]),
                              .root = study,
                              .executor = parent_simulates && !is_instance ? &executor : nullptr};
      run_when_free(plan, cells[number], where, stop, reporter);
      if (stop.requested()) {
        return;
      }
      parent.send(make_note(Note::done, ""));
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::io) {
        parent.send(make_note(Note::io_error, error.what()));
        return;  // the comparison ends and orders no more cells
      }
      parent.send(make_note(Note::broken, error.what()));
    }
  }
}

}  // namespace armwright
