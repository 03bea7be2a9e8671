// Races: candidates that do badly on their first training cases are not simulated on the rest
// (docs/racing.md). Decisions are made between rungs and chunks of fixed sizes, from numbers alone:
// results depend on neither threads nor time.
//
// Successive halving (Karnin, Koren and Somekh 2013; Jamieson and Talwalkar 2016): all n candidates
// of a batch have the first r_0 cases, the better ceil(n / eta) go on to eta r_0, and so on; the
// last rung has all K. Of those that drop out the objective is that of the cases they had, but at
// least the worst of those that got further: an optimizer that ranks then ranks as the race did,
// whatever luck a candidate had with its few cases.
//
// Abandonment: a candidate is given up between two chunks of cases as soon as its objective is
// certain to exceed a threshold; what counts for it then is that bound.
//
// Both have the status `abandoned`: neither can be an incumbent or a candidate for the win.
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
  std::size_t cases = 0;  // that each has had at its end
};

// A single candidate has all cases at once.
std::vector<Rung> plan_rungs(const Racing& racing, std::size_t candidates, std::size_t cases);
// Cases simulated by the whole race.
std::size_t calc_race_cost(std::span<const Rung> rungs);
// The most candidates, up to `wanted`, whose race costs no more than `budget` cases.
std::size_t count_affordable(const Racing& racing, std::size_t wanted, std::size_t cases,
                             std::size_t budget);
// What the incumbent's objective f allows: f + (margin - 1) |f|.
double calc_threshold(const Racing& racing, double incumbent);

struct RacedCandidate {
  std::size_t cases = 0;  // that it has had
  Evaluation evaluation;
};

class Racer {
 public:
  using Candidates = std::span<const std::span<const double>>;
  // So many cases more have been simulated. From any thread.
  using OnCases = std::function<void(std::size_t cases)>;
  using OnDone = std::function<void(std::size_t candidate, RacedCandidate result)>;

  Racer(const Racing& racing, const Problem& problem, CaseRunner& runner)
      : racing_(racing), problem_(problem), runner_(runner) {}

  // Nothing if the run was stopped before the end. `penalty` ranks candidates without a number.
  std::optional<std::vector<RacedCandidate>> halve(Candidates candidates, const CaseBlock& block,
                                                   double penalty, const OnCases& on_cases);
  // `on_done` hears of each candidate as soon as that is decided, from any thread; of those that a
  // stop leaves unfinished never.
  void abandon(Candidates candidates, const CaseBlock& block, double threshold,
               const OnCases& on_cases, const OnDone& on_done);

 private:
  const Racing& racing_;
  const Problem& problem_;
  CaseRunner& runner_;
};

}  // namespace armwright
