#include "study/run_evaluator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <numeric>
#include <span>
#include <stdexcept>
#include <utility>

#include "base/bits.hpp"
#include "base/error.hpp"
#include "base/text.hpp"

namespace armwright {
RunEvaluator::RunEvaluator(const RunPlan& plan, CaseRunner& runner, StopSignal& stop,
                           Journal& journal, JournalContent recorded, RunObserver& observer)
    : plan_(plan),
      runner_(runner),
      stop_(stop),
      journal_(journal),
      observer_(observer),
      wants_residuals_(plan.optimizer.capabilities.residuals ||
                       plan.optimizer.requirements.residuals),
      journal_ended_(recorded.ended),
      candidates_(plan) {
  for (EvaluationRecord& record : recorded.training) {
    recorded_.resize(std::max<std::size_t>(recorded_.size(), record.index + 1));
    const std::uint64_t index = record.index;
    recorded_[index] = std::move(record);
  }
  block_.role = CaseRole::training;
  block_.set = plan.problem.sets.training;
  block_.numbers.resize(static_cast<std::size_t>(plan.schedule.cases));
  std::iota(block_.numbers.begin(), block_.numbers.end(), std::uint64_t{0});
}

const ProblemDescription& RunEvaluator::problem() const {
  return plan_.problem.problem->description();
}

bool RunEvaluator::stopped() const {
  return stopped_ || budget_spent_ || stop_.reason() != StopReason::none;
}

std::int64_t RunEvaluator::remaining() const {
  return (plan_.budget - static_cast<std::int64_t>(counts_.cases)) / plan_.schedule.cases;
}

void RunEvaluator::begin_generation() {
  if (!stopped()) {
    start_generation();
  }
}

void RunEvaluator::start_generation() {
  if (plan_.schedule.fresh) {
    const std::uint64_t first = counts_.generations * block_.numbers.size();
    std::iota(block_.numbers.begin(), block_.numbers.end(), first);
    candidates_.end_generation();
  }
  ++counts_.generations;
}

void RunEvaluator::recommend(std::span<const double> x) {
  if (stopped()) {
    return;
  }
  candidates_.recommend(make_request(x).x, counts_.generations);
}

EvaluationRecord RunEvaluator::make_request(std::span<const double> x) const {
  const auto& variables = problem().variables;
  if (x.size() != variables.size()) {
    throw OptimizerFailure(
        fmt::format("optimizer '{}' asked for a point of {} numbers; problem {} has {} decision "
                    "variables",
                    plan_.optimizer.name, x.size(), plan_.problem.name, variables.size()));
  }
  EvaluationRecord request;
  request.generation = counts_.generations;
  request.cases = block_;
  request.x.resize(x.size());
  bool clipped = false;
  for (std::size_t i = 0; i < x.size(); ++i) {
    // A coordinate that is no number at all goes to the start value: there is no nearest point
    // inside.
    const double inside = std::isnan(x[i])
                              ? variables[i].start
                              : std::clamp(x[i], variables[i].lower, variables[i].upper);
    clipped |= !(inside == x[i]);
    request.x[i] = inside;
  }
  request.clipped = clipped;
  return request;
}

void RunEvaluator::check_replay(const EvaluationRecord& request,
                                const EvaluationRecord& recorded) const {
  std::string difference;
  if (recorded.cases.numbers != request.cases.numbers || recorded.cases.set != request.cases.set) {
    difference = "its training cases differ";
  } else if (!same_bits(recorded.x, request.x)) {
    difference = "the decision vector differs";
    for (std::size_t i = 0; i < std::min(request.x.size(), recorded.x.size()); ++i) {
      if (!same_bits({&request.x[i], 1}, {&recorded.x[i], 1})) {
        difference = fmt::format("{} was {} and is now {}", problem().variables[i].name,
                                 format_exact(recorded.x[i]), format_exact(request.x[i]));
        break;
      }
    }
  } else if (recorded.with_jacobian != request.with_jacobian) {
    difference = "one was asked for with derivatives, the other without";
  } else if (recorded.generation != request.generation || recorded.clipped != request.clipped) {
    difference = "its generation or clipping differs";
  }
  if (!difference.empty()) {
    refuse_replay(recorded.index, difference);
  }
}

void RunEvaluator::refuse_replay(std::uint64_t evaluation, const std::string& difference) const {
  throw Error(
      ErrorKind::bad_data,
      fmt::format("evaluation {} of the journal is not what optimizer '{}' asks for now: {}. "
                  "The run was made by another version, machine or plugin; resume it there, "
                  "or start a new run with --new",
                  evaluation, plan_.optimizer.name, difference));
}

void RunEvaluator::check_replay_complete() const {
  for (const auto& record : recorded_) {
    if (record) {
      refuse_replay(record->index, "it is recorded, and no longer asked for");
    }
  }
}

void RunEvaluator::take_remaining_recorded() {
  for (auto& record : recorded_) {
    if (!record) {
      continue;
    }
    if (record->generation < counts_.generations) {
      refuse_replay(record->index, "its generation is over");
    }
    while (counts_.generations < record->generation) {
      start_generation();
    }
    ++counts_.replayed;
    replayed_cases_ += record->calc_charge();
    Score score;  // nobody is asking any more
    take(std::move(*record), score);
    record.reset();
  }
  report(0, 0);
}

std::vector<Score> RunEvaluator::evaluate_with_jacobian(
    std::span<const std::vector<double>> points) {
  if (!problem().has_jacobian) {
    throw std::logic_error("derivatives were asked for of a problem that has none");
  }
  return evaluate(points, true);
}

std::vector<Score> RunEvaluator::evaluate(std::span<const std::vector<double>> points,
                                          bool with_jacobian) {
  if (stopped()) {
    return {};
  }
  const std::int64_t charge = with_jacobian ? calc_jacobian_charge(problem().variables.size()) : 1;
  const auto allowed = static_cast<std::size_t>(std::max<std::int64_t>(0, remaining() / charge));
  if (points.size() > allowed) {
    points = points.first(allowed);
    budget_spent_ = true;
  }
  std::vector<EvaluationRecord> records;
  records.reserve(points.size());
  std::vector<char> answered(points.size());
  std::vector<std::size_t> missing;
  std::vector<std::span<const double>> candidates;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EvaluationRecord& record = records.emplace_back(make_request(points[i]));
    record.index = counts_.evaluations + i;
    record.with_jacobian = with_jacobian;
    if (record.index < recorded_.size() && recorded_[record.index]) {
      check_replay(record, *recorded_[record.index]);
      record.evaluation = std::move(recorded_[record.index]->evaluation);
      recorded_[record.index].reset();
      answered[i] = true;
    } else {
      missing.push_back(i);
      candidates.emplace_back(record.x);
    }
  }
  if (journal_ended_ && !missing.empty()) {
    refuse_replay(records[missing.front()].index, "the recorded run had ended before it");
  }

  // No flush of the journal: its promise of 10 ms is enough, since a resumed run makes again what
  // a kill has cost, and for quick functions a write a batch would take longer than all the rest.
  std::mutex mutex;
  const std::uint64_t replayed = points.size() - missing.size();
  std::uint64_t finished = replayed;
  const std::uint64_t cases_each = block_.numbers.size() * static_cast<std::uint64_t>(charge);
  runner_.run(
      candidates, block_, wants_residuals_ || with_jacobian,
      [&](std::size_t candidate, Evaluation evaluation) {
        const std::size_t i = missing[candidate];
        records[i].evaluation = std::move(evaluation);
        journal_.append(records[i]);
        answered[i] = true;
        const std::lock_guard lock(mutex);
        if (++finished < points.size()) {  // the last one's is the report on all, below
          report(finished * cases_each, replayed * cases_each);
        }
      },
      with_jacobian);

  // A stop can leave holes; the optimizer learns the results before the first, and a resumed run
  // evaluates only the holes.
  const auto complete =
      static_cast<std::size_t>(std::ranges::find(answered, false) - answered.begin());
  stopped_ = complete < points.size();
  counts_.replayed += replayed;
  replayed_cases_ += replayed * cases_each;
  std::vector<Score> scores(complete);
  for (std::size_t i = 0; i < complete; ++i) {
    take(std::move(records[i]), scores[i]);
  }
  if (remaining() <= 0) {
    budget_spent_ = true;
  }
  report(0, 0);
  return scores;
}

void RunEvaluator::take(EvaluationRecord record, Score& score) {
  Evaluation& evaluation = record.evaluation;
  ++counts_.evaluations;
  counts_.cases += record.calc_charge();
  counts_.clipped += record.clipped ? 1 : 0;
  counts_.failed += evaluation.status == EvaluationStatus::ok ? 0 : 1;
  if (is_feasible(evaluation)) {
    ++counts_.feasible;
    candidates_.consider(record);
  }
  if (!evaluation.constraint_values.empty()) {
    const double violation = calc_violation(evaluation.constraint_values);
    least_violation_ = std::min(least_violation_.value_or(violation), violation);
  }
  score.status = evaluation.status;
  score.clipped = record.clipped;
  score.residuals = std::move(evaluation.residuals);
  score.jacobian = std::move(evaluation.jacobian);
  if (!evaluation.objectives.empty()) {
    score.objectives = std::move(evaluation.objectives);
    score.constraint_values = std::move(evaluation.constraint_values);
    return;
  }
  score.objectives = plan_.problem.problem->penalty_objectives();
  if (first_failure_.empty()) {
    first_failure_ = std::move(evaluation.reason);
  }
}

void RunEvaluator::report(std::uint64_t more_cases, std::uint64_t more_replayed) {
  const std::uint64_t cases_each = block_.numbers.size();
  Progress progress;
  progress.done = counts_.cases + more_cases;
  progress.total = static_cast<std::uint64_t>(plan_.budget) / cases_each * cases_each;
  progress.replayed = replayed_cases_ + more_replayed;
  progress.generation = counts_.generations;
  progress.best_objective = candidates_.best_objective();
  observer_.on_progress(progress);
}

}  // namespace armwright
