// Races: candidates that do badly on their first training cases are not simulated on the rest
// (docs/racing.md). Decisions are made between the steps of a race (rungs) or between chunks of
// fixed sizes, from objectives alone, so results depend on neither threads nor time.
//
// Successive halving (Karnin, Koren and Somekh 2013; Jamieson and Talwalkar 2016): all n candidates
// of a batch get the first r_0 cases, the better ceil(n / eta) go on to eta r_0 cases, and so on;
// the last rung has all K cases. The objective of a candidate that drops out is that of its cases,
// but at least the worst objective of the candidates that got further. An optimizer that ranks
// candidates therefore ranks them as the race did.
//
// Abandonment: a candidate is abandoned between two chunks of cases as soon as its objective is
// certain to exceed a threshold. That lower bound is then its objective.
//
// Candidates that lose in either way have the status `abandoned`. They can neither be the incumbent
// nor candidates for the winner.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "problems/interface/schedule.hpp"
#include "study/executor/case_executor.hpp"

namespace armwright {

struct Rung {
  std::size_t candidates = 0;
  std::size_t cases = 0;  // per candidate, counted from the start of the race
};

// Returns the rungs of a race. A single candidate gets all cases at once.
std::vector<Rung> plan_rungs(const Racing& racing, std::size_t candidates, std::size_t cases);
// Returns the number of cases that the whole race simulates.
std::size_t calc_race_cost(std::span<const Rung> rungs);
// Returns the largest number of candidates, at most `wanted`, whose race costs at most `budget`
// cases.
std::size_t count_affordable(const Racing& racing, std::size_t wanted, std::size_t cases,
                             std::size_t budget);
// Returns the threshold of abandonment, f + (margin - 1) |f|, for the incumbent's objective f.
double calc_threshold(const Racing& racing, double incumbent);

struct RacedCandidate {
  std::size_t cases = 0;  // simulated
  Evaluation evaluation;
};

// A Racer holds races on one problem. All references must outlive it. Its functions rethrow what
// the problem or a callback throws.
class Racer {
 public:
  using Candidates = std::span<const std::span<const double>>;
  // Receives the number of newly simulated cases, from any thread.
  using OnCases = std::function<void(std::size_t cases)>;
  using OnDone = std::function<void(std::size_t candidate, RacedCandidate result)>;

  Racer(const Racing& racing, const Problem& problem, CaseExecutor& executor, StopSignal& stop)
      : racing_(racing), problem_(problem), executor_(executor), stop_(stop) {}

  // Returns one result per candidate, or nothing if stopped. Candidates without objectives rank as
  // if their objective were `penalty`.
  std::optional<std::vector<RacedCandidate>> halve(Candidates candidates, const CaseBlock& block,
                                                   double penalty, const OnCases& on_cases);
  // Calls `on_done` for each candidate as soon as it is finished or abandoned. Candidates that a
  // stop leaves unfinished are not reported.
  void abandon(Candidates candidates, const CaseBlock& block, double threshold,
               const OnCases& on_cases, const OnDone& on_done);

 private:
  const Racing& racing_;
  const Problem& problem_;
  CaseExecutor& executor_;
  StopSignal& stop_;
};

}  // namespace armwright
