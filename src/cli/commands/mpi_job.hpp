// The MPI ranks of this job, if mpirun has started the program. Rank 0 runs the command and writes
// all output; the other ranks are workers that simulate for it.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/terminal/session.hpp"
#include "problems/config/problem_loader.hpp"
#include "study/executor/coordinator.hpp"
#include "study/executor/mpi_transport.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {

// The connection of this process to the other ranks. Without mpirun there are none, and the
// functions do nothing.
class MpiJob {
 public:
  // Starts MPI. Every rank must construct it before anything that can fail, as MPI starts on all
  // ranks or on none.
  explicit MpiJob(Session& session);
  ~MpiJob();  // on rank 0, ends the workers if end_workers() has not been called
  MpiJob(const MpiJob&) = delete;
  MpiJob& operator=(const MpiJob&) = delete;

  using Problems = std::vector<const LoadedProblem*>;

  bool is_worker() const { return place_ && place_->rank > 0; }
  // Simulates for rank 0 with `threads` threads until rank 0 ends the workers, then ends the
  // process. `load` must return the same problems that rank 0 has. If it throws, rank 0 is told
  // why.
  [[noreturn]] void serve(const std::function<Problems()>& load, unsigned threads);

  // Call it once, on rank 0. Returns the coordinator of all ranks, with `threads` threads of this
  // process, or null without mpirun. The MpiJob must outlive the coordinator.
  std::unique_ptr<Coordinator> make_coordinator(const Problems& problems, unsigned threads,
                                                RunObserver& observer);
  // Call it on rank 0 when all work is done. Destroys the coordinator and ends the workers.
  void end_workers(std::unique_ptr<Coordinator> coordinator);
  // Returns the number of ranks in words, or an empty text without mpirun.
  std::string describe() const;

 private:
  // Waits at most `timeout_s` for workers that have not answered.
  void end(double timeout_s);

  Session& session_;
  std::optional<RankPlace> place_;
  std::unique_ptr<MessageTransport> transport_;
  std::chrono::steady_clock::time_point begun_;
};

}  // namespace armwright
