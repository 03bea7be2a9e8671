// Simulates what a page shows: fans work out over threads, honours a stop between chunks and tells
// an observer how far it is, as a test phase counted in simulated cases.
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

// Thrown by PageSimulator when a stop was asked for; whoever makes the page catches it.
struct PageStopped {};

class PageSimulator {
 public:
  PageSimulator(unsigned jobs, StopSignal& stop, RunObserver& observer)
      : executor_(jobs), stop_(stop), observer_(observer) {}

  // More cases will come: announced at the beginning, as far as known, they make an honest bar.
  void expect(std::uint64_t cases) { expected_ += cases; }

  // A design on the cases first, ..., first + count - 1 of a set, as it is judged: one result a
  // case, the same for any number of threads.
  std::vector<TrackingResult> evaluate(const TrackingProblem& problem, const ArmDesign& design,
                                       const TestSet& set, std::uint64_t first,
                                       std::uint64_t count);
  // A candidate of any problem on all cases of a block.
  Evaluation evaluate(const Problem& problem, std::span<const double> x, const CaseBlock& block);
  // job(0) to job(jobs - 1), in any order, each a simulated case.
  void run(std::size_t jobs, const std::function<void(std::size_t)>& job);

 private:
  // One after the other, a few for each thread between two looks at the stop.
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
