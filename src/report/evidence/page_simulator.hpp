// Simulates the cases that a page shows.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/stop_signal.hpp"
#include "problems/tracking/tracking_problem.hpp"
#include "study/executor/case_executor.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {

// A simulator that divides the work among threads, checks the stop signal between chunks, and
// reports its progress to an observer as a test phase, counted in simulated cases. One thread may
// call it. After a request to stop it throws WorkStopped; the function that makes the page catches
// it.
class PageSimulator {
 public:
  PageSimulator(unsigned jobs, StopSignal& stop, RunObserver& observer)
      : executor_(jobs), stop_(stop), observer_(observer) {}

  // Adds to the total that the observer sees. Callers announce all cases that they know of at the
  // beginning, so that the progress bar is right.
  void expect(std::uint64_t cases) { expected_ += cases; }

  // Simulates a design with the judging engine on the cases first, ..., first + count - 1 of a set.
  // Returns one result per case; they do not depend on the number of threads. Throws WorkStopped.
  std::vector<TrackingResult> evaluate(const TrackingProblem& problem, const ArmDesign& design,
                                       const TestSet& set, std::uint64_t first,
                                       std::uint64_t count);
  // Evaluates a decision vector of any problem on all cases of a block. Throws WorkStopped.
  Evaluation evaluate(const Problem& problem, std::span<const double> x, const CaseBlock& block);
  // Calls job(0) to job(jobs - 1) in any order, on several threads. Each call simulates one case.
  // Throws WorkStopped.
  void run(std::size_t jobs, const std::function<void(std::size_t)>& job);

 private:
  void run(std::size_t jobs, std::size_t cases_per_job, std::uint64_t cases,
           const std::function<void(std::size_t)>& job);
  void report(std::uint64_t more_cases);

  ThreadExecutor executor_;
  StopSignal& stop_;
  RunObserver& observer_;
  std::uint64_t expected_ = 0;
  std::uint64_t done_ = 0;
};

}  // namespace armwright
