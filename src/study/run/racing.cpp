#include "study/run/racing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

namespace armwright {
namespace {

// A field is the candidates of a race, with the outcomes of the cases that they have had.
class Field {
 public:
  Field(const Problem& problem, CaseExecutor& executor, StopSignal& stop,
        Racer::Candidates candidates, const CaseBlock& block)
      : problem_(problem),
        executor_(executor),
        stop_(stop),
        candidates_(candidates),
        block_(block),
        outcomes_(candidates.size()) {}

  // Simulates the next cases up to `end` for each candidate of `who`. Returns false if the run was
  // stopped before all were simulated.
  bool advance(std::span<const std::size_t> who, std::size_t end, const Racer::OnCases& on_cases) {
    const auto first = block_.numbers.begin();
    const CaseBlock some{
        block_.role,
        block_.set,
        {first + static_cast<std::ptrdiff_t>(had_), first + static_cast<std::ptrdiff_t>(end)}};
    std::vector<std::span<const double>> points;
    for (const std::size_t candidate : who) {
      points.push_back(candidates_[candidate]);
    }
    std::vector<char> done(who.size());
    executor_.simulate(problem_, points, some, {}, stop_,
                       [&](std::size_t i, std::span<CaseOutcome> outcomes) {
                         std::ranges::move(outcomes, std::back_inserter(outcomes_[who[i]]));
                         done[i] = true;
                         on_cases(some.numbers.size());
                       });
    had_ = end;
    return std::ranges::find(done, false) == done.end();
  }

  std::size_t had() const { return had_; }
  std::span<const CaseOutcome> outcomes(std::size_t candidate) const {
    return outcomes_[candidate];
  }

 private:
  const Problem& problem_;
  CaseExecutor& executor_;
  StopSignal& stop_;
  Racer::Candidates candidates_;
  const CaseBlock& block_;
  std::vector<std::vector<CaseOutcome>> outcomes_;
  std::size_t had_ = 0;  // cases, for each candidate that is still in the race
};

Evaluation aggregate(const Problem& problem, std::span<const double> x,
                     std::span<const CaseOutcome> outcomes) {
  Evaluation evaluation = problem.aggregate(x, outcomes);
  evaluation.residuals.clear();  // some problems always make them
  return evaluation;
}

}  // namespace

std::vector<Rung> plan_rungs(const Racing& racing, std::size_t candidates, std::size_t cases) {
  const auto eta = static_cast<std::size_t>(racing.eta);
  const auto first = static_cast<std::size_t>(racing.first_cases);
  std::vector<Rung> rungs;
  if (candidates > 1) {
    for (std::size_t some = first; some < cases; some *= eta) {
      rungs.push_back({candidates, some});
      candidates = (candidates + eta - 1) / eta;
    }
  }
  rungs.push_back({candidates, cases});
  return rungs;
}

std::size_t calc_race_cost(std::span<const Rung> rungs) {
  std::size_t cost = 0;
  std::size_t had = 0;
  for (const Rung& rung : rungs) {
    cost += rung.candidates * (rung.cases - std::exchange(had, rung.cases));
  }
  return cost;
}

std::size_t count_affordable(const Racing& racing, std::size_t wanted, std::size_t cases,
                             std::size_t budget) {
  // Bisection is right because a larger race never costs less.
  std::size_t affordable = 0;
  std::size_t beyond = wanted + 1;
  while (beyond - affordable > 1) {
    const std::size_t middle = affordable + (beyond - affordable) / 2;
    const bool fits = calc_race_cost(plan_rungs(racing, middle, cases)) <= budget;
    (fits ? affordable : beyond) = middle;
  }
  return affordable;
}

double calc_threshold(const Racing& racing, double incumbent) {
  return std::isfinite(incumbent) ? incumbent + (racing.margin - 1) * std::abs(incumbent)
                                  : incumbent;
}

std::optional<std::vector<RacedCandidate>> Racer::halve(Candidates candidates,
                                                        const CaseBlock& block, double penalty,
                                                        const OnCases& on_cases) {
  const std::size_t cases = block.numbers.size();
  const std::vector<Rung> rungs = plan_rungs(racing_, candidates.size(), cases);
  Field field(problem_, executor_, stop_, candidates, block);
  std::vector<RacedCandidate> results(candidates.size());
  std::vector<double> objectives(candidates.size());
  std::vector<std::size_t> alive(candidates.size());
  std::iota(alive.begin(), alive.end(), std::size_t{0});
  std::vector<std::vector<std::size_t>> dropped;  // by rung; the last ones had all cases
  for (std::size_t rung = 0; rung < rungs.size(); ++rung) {
    if (!field.advance(alive, rungs[rung].cases, on_cases)) {
      return std::nullopt;
    }
    for (const std::size_t candidate : alive) {
      RacedCandidate& result = results[candidate];
      result.cases = rungs[rung].cases;
      result.evaluation = aggregate(problem_, candidates[candidate], field.outcomes(candidate));
      const bool has_number = !result.evaluation.objectives.empty();
      objectives[candidate] = has_number ? result.evaluation.objectives.front() : penalty;
    }
    std::ranges::stable_sort(alive, {}, [&](std::size_t i) { return objectives[i]; });
    const bool is_last = rung + 1 == rungs.size();
    const std::size_t stay = is_last ? 0 : rungs[rung + 1].candidates;
    dropped.emplace_back(alive.begin() + static_cast<std::ptrdiff_t>(stay), alive.end());
    alive.resize(stay);
    std::ranges::sort(alive);
  }
  double worst = -std::numeric_limits<double>::infinity();  // of the candidates that got further
  for (std::size_t rung = rungs.size(); rung-- > 0;) {
    double worst_here = worst;
    for (const std::size_t candidate : dropped[rung]) {
      Evaluation& evaluation = results[candidate].evaluation;
      objectives[candidate] = std::max(objectives[candidate], worst);
      worst_here = std::max(worst_here, objectives[candidate]);
      if (rung + 1 < rungs.size() && !evaluation.objectives.empty()) {
        evaluation.objectives = {objectives[candidate]};
        evaluation.status = EvaluationStatus::abandoned;
        evaluation.reason =
            fmt::format("dropped out after {} of {} cases", results[candidate].cases, cases);
      }
    }
    worst = worst_here;
  }
  return results;
}

void Racer::abandon(Candidates candidates, const CaseBlock& block, double threshold,
                    const OnCases& on_cases, const OnDone& on_done) {
  const std::size_t cases = block.numbers.size();
  // Without an incumbent no candidate can be abandoned, so one chunk has all cases.
  const std::size_t chunk =
      std::isfinite(threshold) ? static_cast<std::size_t>(racing_.chunk_cases) : cases;
  Field field(problem_, executor_, stop_, candidates, block);
  std::vector<std::size_t> alive(candidates.size());
  std::iota(alive.begin(), alive.end(), std::size_t{0});
  while (!alive.empty() && field.had() < cases) {
    if (!field.advance(alive, std::min(cases, field.had() + chunk), on_cases)) {
      return;
    }
    std::vector<std::size_t> next;
    for (const std::size_t candidate : alive) {
      const std::span<const double> x = candidates[candidate];
      const auto outcomes = field.outcomes(candidate);
      const auto bound =
          field.had() < cases ? problem_.calc_lower_bound(x, outcomes, cases) : std::nullopt;
      const bool is_lost = bound && *bound > threshold;
      if (!is_lost && field.had() < cases) {
        next.push_back(candidate);
        continue;
      }
      RacedCandidate result{field.had(), aggregate(problem_, x, outcomes)};
      if (is_lost) {
        result.evaluation.objectives = {*bound};
        result.evaluation.status = EvaluationStatus::abandoned;
        result.evaluation.reason = fmt::format(
            "given up after {} of {} cases: no better than the incumbent", field.had(), cases);
      }
      on_done(candidate, std::move(result));
    }
    alive = std::move(next);
  }
}

}  // namespace armwright
