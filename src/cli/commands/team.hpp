// The ranks of this job, where mpirun has started the program: rank 0 runs the command and alone
// writes anything; the others simulate for it. Without mpirun there is no team, and nothing of
// this does anything.
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

class RunObserver;

class Team {
 public:
  // On every rank, before anything that may fail: MPI begins on all ranks or on none.
  explicit Team(Session& session);
  ~Team();  // on rank 0 the others are told to end, if they have not been yet
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  using Problems = std::vector<const LoadedProblem*>;

  bool is_worker() const { return place_ && place_->rank > 0; }
  // The rest of a worker's life. `load` gives the problems as rank 0 has them.
  [[noreturn]] void serve(const std::function<Problems()>& load, unsigned threads);

  // On rank 0, once: who simulates, with `threads` of its own. Null without a team.
  std::unique_ptr<Coordinator> lead(const Problems& problems, unsigned threads,
                                    RunObserver& observer);
  // On rank 0, when there is no more work: the others are told to end.
  void dismiss(std::unique_ptr<Coordinator> coordinator);
  // How many ranks there are, in words; empty without a team.
  std::string describe() const;

 private:
  // With what patience for those that have yet to answer.
  void end(double patience_s);

  Session& session_;
  std::optional<RankPlace> place_;
  std::unique_ptr<MessageTransport> transport_;
  std::chrono::steady_clock::time_point begun_;
};

}  // namespace armwright
