#include "cli/commands/mpi_job.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "cli/terminal/format.hpp"
#include "cli/terminal/terminal.hpp"
#include "study/executor/rank_messages.hpp"
#include "study/executor/worker.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {
namespace {

// The time for workers that are connected to confirm that they end.
constexpr double kEndTimeout_s = 2;

std::vector<const Problem*> get_simulated(const MpiJob::Problems& problems) {
  std::vector<const Problem*> simulated;
  for (const LoadedProblem* problem : problems) {
    simulated.push_back(problem->problem.get());
  }
  return simulated;
}

}  // namespace

MpiJob::MpiJob(Session& session) : session_(session), place_(find_rank_place()) {
  if (place_) {
    transport_ = open_mpi_transport();
    begun_ = std::chrono::steady_clock::now();
  }
}

MpiJob::~MpiJob() {
  // A worker may still be reading the configuration.
  constexpr double kBeginning_s = 10;
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begun_;
  end(std::max(kEndTimeout_s, kBeginning_s - passed.count()));
}

void MpiJob::end_workers(std::unique_ptr<Coordinator> coordinator) {
  if (coordinator && !coordinator->expects_workers()) {
    coordinator.reset();
    end(kEndTimeout_s);
  }
}

void MpiJob::end(double timeout_s) {
  if (!transport_) {
    return;
  }
  constexpr double kStopped_s = 0.3;  // mpirun kills one second after its signal
  const StopReason stopped = session_.stop.reason();
  const bool is_asked = stopped == StopReason::interrupted || stopped == StopReason::terminated;
  timeout_s = is_asked ? kStopped_s : timeout_s;
  if (armwright::end_workers(*transport_, timeout_s)) {
    close_mpi();
    transport_.reset();
    return;
  }
  // MPI still holds messages for the missing rank, and ending MPI needs all ranks.
  [[maybe_unused]] const MessageTransport* kept = transport_.release();
  session_.must_abort_ranks = true;
  if (!is_asked) {
    write_message(
        "note: a rank is missing, so MPI cannot end in order. The command is done; ignore the "
        "messages of mpirun about errors and about ending all processes");
  }
}

void MpiJob::serve(const std::function<Problems()>& load, unsigned threads) {
  WorkerIntroduction introduction = make_introduction(threads);
  Problems problems;
  try {
    problems = load();
    introduction.identity = make_rank_identity(problems);
  } catch (const std::exception& error) {
    introduction.failure = error.what();
  }
  try {
    Worker worker(*transport_, get_simulated(problems), introduction);
    if (worker.serve() == Worker::End::finalize) {
      close_mpi();
    }
    ::_exit(exit_code::kDone);  // does not wait for threads that may never end
  } catch (const std::exception&) {
    ::_exit(exit_code::kInternal);  // rank 0 does its work and reports that it is missing
  }
}

std::unique_ptr<Coordinator> MpiJob::make_coordinator(const Problems& problems, unsigned threads,
                                                      RunObserver& observer) {
  if (!place_) {
    return nullptr;
  }
  if (!place_->survives) {
    observer.on_message(
        "note: started without mpirun's --enable-recovery, so all ranks end if one of them dies "
        "(nothing is lost; the same command resumes)");
  }
  return std::make_unique<Coordinator>(
      *transport_, get_simulated(problems), make_rank_identity(problems),
      CoordinatorSettings{.threads = threads, .cpu = make_introduction(threads).cpu},
      [&observer](const std::string& message) { observer.on_message(message); });
}

std::string MpiJob::describe() const {
  return place_ ? format_count(place_->size, "rank") : "";
}

}  // namespace armwright
