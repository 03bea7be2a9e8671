#include "study/run/run_evaluator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <limits>
#include <mutex>
#include <numeric>
#include <span>
#include <stdexcept>
#include <utility>

#include "base/bits.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "study/run/racing.hpp"

namespace armwright {
namespace {

// The most decision vectors that count after the end of the budget. Later ones are ignored.
constexpr std::size_t kMostLate = 100;

// Returns the point as the optimizer asked for it, within its bounds.
const std::vector<double>& get_asked(const EvaluationRecord& record) {
  return record.proposed.empty() ? record.x : record.proposed;
}

}  // namespace

// Candidates that the optimizer asks for together, and what is known of them.
struct RunEvaluator::Batch {
  std::vector<EvaluationRecord> records;
  std::vector<char> answered;  // from the journal or by simulation
  bool with_jacobian = false;
  std::uint64_t replayed_cases = 0;
  double threshold = 0;  // of abandonment
};

RunEvaluator::RunEvaluator(const RunPlan& plan, CaseExecutor& executor, StopSignal& stop,
                           Journal& journal, const JournalContent& recorded, RunObserver& observer)
    : plan_(plan),
      executor_(executor),
      stop_(stop),
      journal_(journal),
      observer_(observer),
      treated_(plan.problem.problem->description(), plan.optimizer.capabilities),
      recorded_(recorded.training),
      journal_ended_(recorded.ended),
      recorded_late_(recorded.late),
      candidates_(plan) {
  block_.role = CaseRole::training;
  block_.set = get_training_set(plan.problem.sets.training, plan.schedule);
  block_.numbers.resize(static_cast<std::size_t>(plan.schedule.cases));
  std::iota(block_.numbers.begin(), block_.numbers.end(), std::uint64_t{0});
  if (plan.schedule.kind == Schedule::Kind::coevolution) {
    breeder_.emplace(block_.set, plan.schedule.cases);
    block_.numbers = breeder_->genomes();
  }
  if (plan.schedule.kind == Schedule::Kind::growing) {
    growth_.emplace(plan);
  }
}

bool RunEvaluator::stopped() const {
  return stopped_ || budget_spent_ || stop_.requested();
}

std::int64_t RunEvaluator::remaining() const {
  return (plan_.budget - static_cast<std::int64_t>(counts_.cases)) /
         static_cast<std::int64_t>(block_.numbers.size());
}

void RunEvaluator::begin_generation() {
  if (!stopped()) {
    start_generation();
  }
}

bool RunEvaluator::grow_cases() {
  if (stopped() || !growth_) {
    return false;
  }
  const std::uint64_t changes = case_changes_;
  start_generation();
  return case_changes_ > changes;
}

void RunEvaluator::start_generation() {
  if (plan_.schedule.kind == Schedule::Kind::fresh) {
    const std::uint64_t first = counts_.generations * block_.numbers.size();
    std::iota(block_.numbers.begin(), block_.numbers.end(), first);
  }
  if (breeder_) {
    breeder_->breed();
    block_.numbers = breeder_->genomes();
  }
  if (plan_.schedule.renews_cases()) {
    candidates_.end_generation();
    ++case_changes_;
  }
  if (growth_ && growth_->grow(calc_cases_left())) {
    block_.numbers.resize(static_cast<std::size_t>(growth_->cases()));
    std::iota(block_.numbers.begin(), block_.numbers.end(), std::uint64_t{0});
    ++case_changes_;
  }
  ++counts_.generations;
}

void RunEvaluator::recommend(std::span<const double> x) {
  if (stopped_ || stop_.requested()) {
    return;
  }
  std::vector<double> inside = make_request(x).x;
  if (!budget_spent_) {
    candidates_.recommend(std::move(inside), counts_.generations);
  } else if (late_.size() < kMostLate * inside.size()) {
    late_.insert(late_.end(), inside.begin(), inside.end());
  }
}

void RunEvaluator::take_late_recommendations() {
  const std::size_t dimension = problem().variables.size();
  if (!budget_spent_ || (journal_ended_ && !recorded_late_)) {
    return;
  }
  if (!recorded_late_) {
    recorded_late_ = {.count = late_.size() / dimension, .x = std::move(late_)};
    // Only what runs in a process of its own may recommend less when the machine is slow.
    if (recorded_late_->count > 0 || !plan_.optimizer.isolated.empty()) {
      journal_.append(*recorded_late_);
    }
  }
  if (recorded_late_->count > kMostLate ||
      recorded_late_->x.size() != recorded_late_->count * dimension) {
    throw Error(
        ErrorKind::bad_data,
        fmt::format("the journal has {} recommendations with {} numbers in all, and problem "
                    "{} has {} decision variables; start a new run with --new",
                    recorded_late_->count, recorded_late_->x.size(), plan_.problem.name,
                    dimension));
  }
  for (auto x = recorded_late_->x.begin(); x != recorded_late_->x.end();) {
    const auto next = x + static_cast<std::ptrdiff_t>(dimension);
    candidates_.recommend({x, next}, counts_.generations);
    x = next;
  }
}

void RunEvaluator::explain_end(std::string_view reason) {
  constexpr std::size_t kLongest = 200;
  end_detail_ = sanitize(reason.substr(0, kLongest));
}

void RunEvaluator::explain_choice(std::string_view sentences) {
  constexpr std::size_t kLongest = 1000;
  choice_ = sanitize(sentences.substr(0, kLongest));
  observer_.on_message(choice_);
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
  TreatedProblem::Point point = treated_.settle(x);
  request.x = std::move(point.x);
  request.proposed = std::move(point.proposed);
  request.clipped = point.clipped;
  return request;
}

void RunEvaluator::check_replay(const EvaluationRecord& request, const EvaluationRecord& recorded,
                                double threshold) const {
  const Evaluation& evaluation = recorded.evaluation;
  const auto& had = recorded.cases.numbers;
  const auto& all = request.cases.numbers;
  const bool is_first =
      !had.empty() && had.size() <= all.size() && std::equal(had.begin(), had.end(), all.begin());
  const bool may_be_part =
      (races(Racing::Kind::halving, request.with_jacobian) &&
       (evaluation.status == EvaluationStatus::abandoned || evaluation.objectives.empty())) ||
      (races(Racing::Kind::abandonment, request.with_jacobian) &&
       evaluation.status == EvaluationStatus::abandoned && !evaluation.objectives.empty() &&
       had.size() % static_cast<std::size_t>(plan_.racing.chunk_cases) == 0 &&
       evaluation.objectives.front() > threshold);
  std::string difference;
  if (recorded.cases.set != request.cases.set || !is_first ||
      (had.size() < all.size() && !may_be_part)) {
    difference = "its training cases differ";
  } else if (!same_bits(recorded.x, request.x) ||
             !same_bits(get_asked(recorded), get_asked(request))) {
    difference = "the decision vector differs";
    const std::vector<double>& was = get_asked(recorded);
    const std::vector<double>& now = get_asked(request);
    for (std::size_t i = 0; i < std::min(now.size(), was.size()); ++i) {
      if (!same_bits({&now[i], 1}, {&was[i], 1})) {
        difference = fmt::format("{} was {} and is now {}", problem().variables[i].name,
                                 format_exact(was[i]), format_exact(now[i]));
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
      fmt::format("evaluation {} of the journal is not what optimizer '{}' asks for now: {}. {}",
                  evaluation, plan_.optimizer.name, difference,
                  begin_ ? "With the larger budget it searches otherwise from the beginning, or "
                           "the run was made by another version, machine or plugin. The run stays "
                           "as it was; start a new run with --new"
                         : "The run was made by another version, machine or plugin; resume it "
                           "there, or start a new run with --new"));
}

void RunEvaluator::check_replay_complete() const {
  const std::size_t next = recorded_.find_number(counts_.evaluations);
  if (next < recorded_.size()) {
    refuse_replay(recorded_.get_index(next), "it is recorded, and no longer asked for");
  }
}

void RunEvaluator::take_remaining_recorded() {
  const std::size_t first = recorded_.find_number(counts_.evaluations);
  for (std::size_t number = first; number < recorded_.size(); ++number) {
    EvaluationRecord record = recorded_[number];
    if (record.generation < counts_.generations) {
      refuse_replay(record.index, "its generation is over");
    }
    while (counts_.generations < record.generation) {
      start_generation();
    }
    ++counts_.replayed;
    replayed_cases_ += record.calc_charge();
    Score score;  // unused: the optimizer has ended
    finish_evaluation(std::move(record), score);
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

bool RunEvaluator::races(Racing::Kind kind, bool with_jacobian) const {
  return plan_.racing.kind == kind && !with_jacobian && can_race(plan_.optimizer, kind);
}

std::vector<Score> RunEvaluator::evaluate(std::span<const std::vector<double>> points,
                                          bool with_jacobian) {
  if (!races(Racing::Kind::abandonment, with_jacobian)) {
    return evaluate_batch(points, with_jacobian);
  }
  // The cost of a candidate is only known afterwards. The candidates are therefore evaluated in
  // parts: as many as the budget allows if none is abandoned, but at least one. A last one that
  // costs more than is left ends the budget.
  std::vector<Score> scores;
  while (!points.empty() && !stopped()) {
    const auto affordable = static_cast<std::size_t>(std::max<std::int64_t>(1, remaining()));
    const auto some = points.first(std::min(points.size(), affordable));
    std::ranges::move(evaluate_batch(some, false), std::back_inserter(scores));
    points = points.subspan(some.size());
  }
  return scores;
}

std::vector<Score> RunEvaluator::evaluate_batch(std::span<const std::vector<double>> points,
                                                bool with_jacobian) {
  if (stopped()) {
    return {};
  }
  const bool halves = races(Racing::Kind::halving, with_jacobian);
  const std::int64_t charge = with_jacobian ? calc_jacobian_charge(problem().variables.size()) : 1;
  const auto allowed =
      halves
          ? count_affordable(plan_.racing, points.size(), block_.numbers.size(), calc_cases_left())
          : static_cast<std::size_t>(std::max<std::int64_t>(0, remaining() / charge));
  if (points.size() > allowed) {
    points = points.first(allowed);
    budget_spent_ = true;
  }
  Batch batch;
  batch.with_jacobian = with_jacobian;
  batch.threshold = calc_threshold(plan_.racing, candidates_.incumbent_objective());
  for (const std::vector<double>& point : points) {
    batch.records.push_back(make_request(point));
    batch.records.back().index = counts_.evaluations + batch.records.size() - 1;
    batch.records.back().with_jacobian = with_jacobian;
  }
  const std::vector<std::size_t> missing = answer_from_journal(batch);
  if (journal_ended_ && !missing.empty()) {
    refuse_replay(batch.records[missing.front()].index, "the recorded run had ended before it");
  }
  if (begin_ && !missing.empty()) {
    std::exchange(begin_, nullptr)();
  }
  if (halves && !missing.empty()) {
    halve(batch);  // simulates the whole race again and uses no recorded outcome
  } else {
    count_replayed(batch);
    if (halves) {
      check_race(batch.records);
    } else {
      simulate(batch, missing);
    }
  }

  // A stop can leave gaps. The optimizer gets the results before the first gap, and a resumed run
  // evaluates only the gaps.
  const auto complete =
      static_cast<std::size_t>(std::ranges::find(batch.answered, false) - batch.answered.begin());
  stopped_ = complete < points.size();
  replayed_cases_ += batch.replayed_cases;
  std::vector<Score> scores(complete);
  for (std::size_t i = 0; i < complete; ++i) {
    finish_evaluation(std::move(batch.records[i]), scores[i]);
  }
  if (remaining() <= 0) {
    budget_spent_ = true;
  }
  report(0, 0);
  return scores;
}

// Returns the places in the batch that the journal does not have.
std::vector<std::size_t> RunEvaluator::answer_from_journal(Batch& batch) {
  std::vector<std::size_t> missing;
  batch.answered.resize(batch.records.size());
  for (std::size_t i = 0; i < batch.records.size(); ++i) {
    EvaluationRecord& record = batch.records[i];
    auto recorded = recorded_.find(record.index);
    if (!recorded) {
      missing.push_back(i);
      continue;
    }
    check_replay(record, *recorded, batch.threshold);
    record.cases.numbers = std::move(recorded->cases.numbers);
    record.evaluation = std::move(recorded->evaluation);
    batch.answered[i] = true;
  }
  return missing;
}

void RunEvaluator::count_replayed(Batch& batch) {
  for (std::size_t i = 0; i < batch.records.size(); ++i) {
    if (batch.answered[i]) {
      batch.replayed_cases += batch.records[i].calc_charge();
      ++counts_.replayed;
    }
  }
}

void RunEvaluator::simulate(Batch& batch, const std::vector<std::size_t>& missing) {
  if (ask_) {
    std::vector<const EvaluationRecord*> requests;
    for (const std::size_t i : missing) {
      requests.push_back(&batch.records[i]);
    }
    if (!requests.empty()) {
      ask_(requests);
    }
    return;
  }
  std::vector<std::span<const double>> candidates;
  for (const std::size_t i : missing) {
    candidates.emplace_back(batch.records[i].x);
  }
  // The journal is not flushed: it writes within 10 ms by itself, and a resumed run repeats what a
  // kill has lost. For quick functions, a write per batch would take longer than all the rest.
  std::mutex mutex;
  std::size_t finished = batch.records.size() - missing.size();
  std::uint64_t cases = batch.replayed_cases;
  const auto progress = [&](std::uint64_t more_cases, std::size_t more_finished) {
    const std::lock_guard lock(mutex);
    cases += more_cases;
    finished += more_finished;
    if (finished < batch.records.size()) {  // evaluate_batch() reports the end of the batch
      report(cases, batch.replayed_cases);
    }
  };
  const auto finish = [&](std::size_t candidate, Evaluation evaluation) {
    const std::size_t i = missing[candidate];
    batch.records[i].evaluation = std::move(evaluation);
    journal_.append(batch.records[i]);
    batch.answered[i] = true;
  };
  if (races(Racing::Kind::abandonment, batch.with_jacobian)) {
    Racer(plan_.racing, *plan_.problem.problem, executor_, stop_)
        .abandon(
            candidates, block_, batch.threshold,
            [&](std::size_t more_cases) { progress(more_cases, 0); },
            [&](std::size_t candidate, RacedCandidate result) {
              batch.records[missing[candidate]].cases.numbers.resize(result.cases);
              finish(candidate, std::move(result.evaluation));
              progress(0, 1);
            });
    return;
  }
  executor_.evaluate(*plan_.problem.problem, candidates, block_,
                     {.residuals = wants_residuals(plan_.optimizer) || batch.with_jacobian,
                      .jacobian = batch.with_jacobian},
                     stop_, [&](std::size_t candidate, Evaluation evaluation) {
                       finish(candidate, std::move(evaluation));
                       progress(batch.records[missing[candidate]].calc_charge(), 1);
                     });
}

// Simulates a whole race, because its outcomes depend on each other. If the journal has some of its
// records, which a kill can cause, they must be the same as the outcomes now.
void RunEvaluator::halve(Batch& batch) {
  std::vector<std::span<const double>> candidates;
  for (const EvaluationRecord& record : batch.records) {
    candidates.emplace_back(record.x);
  }
  std::mutex mutex;
  std::uint64_t cases = 0;
  const double penalty = plan_.problem.problem->penalty_objectives().front();
  auto results = Racer(plan_.racing, *plan_.problem.problem, executor_, stop_)
                     .halve(candidates, block_, penalty, [&](std::size_t more_cases) {
                       const std::lock_guard lock(mutex);
                       cases += more_cases;
                       report(cases, 0);
                     });
  if (!results) {
    std::ranges::fill(batch.answered, false);
    return;
  }
  for (std::size_t i = 0; i < batch.records.size(); ++i) {
    EvaluationRecord& record = batch.records[i];
    RacedCandidate& result = (*results)[i];
    if (batch.answered[i] &&
        !(record.cases.numbers.size() == result.cases &&
          record.evaluation.status == result.evaluation.status &&
          same_bits(record.evaluation.objectives, result.evaluation.objectives) &&
          same_bits(record.evaluation.case_errors, result.evaluation.case_errors))) {
      refuse_replay(record.index, "the race that it was in ends otherwise");
    }
    record.cases.numbers.assign(block_.numbers.begin(),
                                block_.numbers.begin() + static_cast<std::ptrdiff_t>(result.cases));
    record.evaluation = std::move(result.evaluation);
    if (!batch.answered[i]) {
      journal_.append(record);
    }
    batch.answered[i] = true;
  }
}

// Checks a race whose records are all in the journal.
void RunEvaluator::check_race(const std::vector<EvaluationRecord>& records) const {
  if (records.empty()) {
    return;
  }
  std::vector<std::size_t> had;
  for (const EvaluationRecord& record : records) {
    had.push_back(record.cases.numbers.size());
  }
  std::ranges::sort(had, std::greater{});
  for (const Rung& rung : plan_rungs(plan_.racing, records.size(), block_.numbers.size())) {
    if (had[rung.candidates - 1] < rung.cases ||
        (rung.candidates < had.size() && had[rung.candidates] >= rung.cases)) {
      refuse_replay(records.front().index, "the race that it was in went otherwise");
    }
  }
}

void RunEvaluator::finish_evaluation(EvaluationRecord record, Score& score) {
  Evaluation& evaluation = record.evaluation;
  counts_.add(record);
  if (breeder_ && evaluation.status != EvaluationStatus::abandoned &&
      !evaluation.objectives.empty()) {
    breeder_->add(record, calc_scalar(problem(), evaluation.objectives));
  }
  if (growth_) {
    growth_->add(record, is_feasible(evaluation) ? calc_scalar(problem(), evaluation.objectives)
                                                 : std::numeric_limits<double>::infinity());
  }
  if (is_feasible(evaluation)) {
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
  const bool is_raced = plan_.racing.kind != Racing::Kind::none;
  const std::uint64_t cases_each = is_raced ? 1 : block_.numbers.size();
  Progress progress;
  progress.done = counts_.cases + more_cases;
  progress.total = static_cast<std::uint64_t>(plan_.budget) / cases_each * cases_each;
  progress.replayed = replayed_cases_ + more_replayed;
  progress.generation = counts_.generations;
  progress.best_objective = candidates_.best_objective();
  observer_.on_progress(progress);
}

}  // namespace armwright
