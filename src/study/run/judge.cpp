#include "study/run/judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

#include "base/bits.hpp"
#include "base/error.hpp"

namespace armwright {
namespace {

CaseBlock make_block(CaseRole role, const std::string& set, int cases) {
  CaseBlock block{role, set, std::vector<std::uint64_t>(static_cast<std::size_t>(cases))};
  std::iota(block.numbers.begin(), block.numbers.end(), std::uint64_t{0});
  return block;
}

bool same_request(const EvaluationRecord& record, std::span<const double> x,
                  const CaseBlock& block) {
  return record.cases.role == block.role && record.cases.set == block.set &&
         record.cases.numbers == block.numbers && same_bits(record.x, x);
}

}  // namespace

Judge::Judge(const RunPlan& plan, CaseRunner& runner, Journal& journal,
             std::vector<EvaluationRecord> recorded, bool journal_ended, RunObserver& observer)
    : plan_(plan),
      runner_(runner),
      journal_(journal),
      recorded_(std::move(recorded)),
      journal_ended_(journal_ended),
      observer_(observer) {}

std::optional<std::vector<Evaluation>> Judge::evaluate(
    const std::vector<std::vector<double>>& designs, const CaseBlock& block,
    Progress::Phase phase) {
  std::vector<Evaluation> evaluations(designs.size());
  std::vector<std::size_t> missing;
  std::vector<std::span<const double>> candidates;
  for (std::size_t i = 0; i < designs.size(); ++i) {
    const auto found = std::find_if(
        recorded_.begin(), recorded_.end(),
        [&](const EvaluationRecord& record) { return same_request(record, designs[i], block); });
    if (found != recorded_.end()) {
      evaluations[i] = found->evaluation;
    } else {
      missing.push_back(i);
      candidates.emplace_back(designs[i]);
    }
  }
  if (journal_ended_ && !missing.empty()) {
    throw Error(ErrorKind::bad_data,
                fmt::format("the recorded run has ended, but judged other designs than those that "
                            "would be judged now ({} on {} is missing). It was made by another "
                            "version; resume it there, or start a new run with --new",
                            missing.size() == 1 ? "one judgement" : "judgements", block.set));
  }
  Progress progress;
  progress.phase = phase;
  progress.total = designs.size() * block.numbers.size();
  progress.done = (designs.size() - missing.size()) * block.numbers.size();
  progress.replayed = progress.done;
  observer_.on_progress(progress);
  std::mutex mutex;
  std::size_t done = 0;
  runner_.run(candidates, block, false, [&](std::size_t candidate, Evaluation evaluation) {
    EvaluationRecord record;
    record.index = missing[candidate];
    record.x = designs[record.index];
    record.cases = block;
    record.evaluation = std::move(evaluation);
    journal_.append(record);
    evaluations[record.index] = std::move(record.evaluation);
    const std::lock_guard lock(mutex);
    ++done;
    progress.done += block.numbers.size();
    observer_.on_progress(progress);
  });
  journal_.flush();
  return done == missing.size() ? std::optional(std::move(evaluations)) : std::nullopt;
}

std::optional<std::vector<JudgedCandidate>> Judge::validate(std::vector<Candidate> candidates) {
  const CaseSets& sets = plan_.problem.sets;
  std::vector<std::vector<double>> designs;
  for (const Candidate& candidate : candidates) {
    designs.push_back(candidate.x);
  }
  auto evaluations =
      evaluate(designs, make_block(CaseRole::validation, sets.validation, sets.validation_cases),
               Progress::Phase::validation);
  if (!evaluations) {
    return std::nullopt;
  }
  std::vector<JudgedCandidate> judged;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    judged.push_back({std::move(candidates[i]), std::move((*evaluations)[i])});
  }
  return judged;
}

std::optional<std::size_t> Judge::choose_winner(const ProblemDescription& problem,
                                                const std::vector<JudgedCandidate>& judged) {
  const auto rank = [&](const JudgedCandidate& candidate) {
    return std::tuple(candidate.validation.failed_cases,
                      calc_violation(candidate.validation.constraint_values),
                      calc_scalar(problem, candidate.validation.objectives));
  };
  std::optional<std::size_t> winner;
  for (std::size_t i = 0; i < judged.size(); ++i) {
    if (!judged[i].validation.objectives.empty() &&
        (!winner || rank(judged[i]) < rank(judged[*winner]))) {
      winner = i;
    }
  }
  return winner;
}

std::optional<Evaluation> Judge::test(const Candidate& winner) {
  const CaseSets& sets = plan_.problem.sets;
  auto evaluations = evaluate({winner.x}, make_block(CaseRole::test, sets.test, sets.test_cases),
                              Progress::Phase::test);
  return evaluations ? std::optional(std::move(evaluations->front())) : std::nullopt;
}

}  // namespace armwright
