// Chooses the test cases whose motion a page replays.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "report/evidence/arm_evidence.hpp"
#include "report/evidence/distance_response.hpp"

namespace armwright {
namespace {

// Adds a training case. If the schedule changes the cases, it is one of the second generation,
// because the designs of the first generation are random.
void add_training_case(const RecordedRun& run, ReplayList& replays) {
  const auto& training = run.journal.training;
  if (training.empty()) {
    return;
  }
  const auto second = std::ranges::find_if(training, [&](const EvaluationRecord& record) {
    return record.generation > training.front().generation;
  });
  const bool has_second = run.schedule.renews_cases() && second != training.end();
  const CaseBlock& cases = (has_second ? *second : training.front()).cases;
  std::string reason =
      has_second ? "what the second generation was trained on" : "the first of training";
  const Perturbation& plants = run.tracking()->config().perturbation;
  // A replay shows the plants of judging, not those of training.
  if (plants.applies_to(CaseRole::training) != plants.applies_to(CaseRole::test)) {
    reason += plants.applies_to(CaseRole::training)
                  ? ", there on a perturbed plant, here on the nominal one"
                  : ", there on the nominal plant, here on a perturbed one";
  }
  replays.add(cases.set, cases.numbers.front(), reason);
}

double get_rankable(double error) {
  return std::isnan(error) ? std::numeric_limits<double>::infinity() : error;
}

void add_by_rank(const RecordedRun& run, const std::vector<double>& errors, ReplayList& replays) {
  const std::string& set = run.problem->sets.test;
  const std::vector<std::size_t> order = rank_by_error(errors);
  const std::size_t count = errors.size();
  replays.add(set, order[(count - 1) / 2], fmt::format("the median of {} by error", count));
  replays.add(set, order[(95 * count + 99) / 100 - 1], "the 95th percentile");
  replays.add(set, order[count - 1], fmt::format("the worst of {}", count));
  constexpr int kMostFailures = 3;
  int shown = 0;
  for (std::size_t i = 0; i < count && shown < kMostFailures; ++i) {
    if (get_rankable(errors[i]) > kFailureError_m) {
      replays.add(set, i, "a failure of the winner");
      ++shown;
    }
  }
}

}  // namespace

std::vector<std::size_t> rank_by_error(const std::vector<double>& errors) {
  std::vector<std::size_t> order(errors.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return get_rankable(errors[i]); });
  return order;
}

std::vector<ReplayRequest> choose_replays(const RecordedRun& run,
                                          const std::vector<ShownDesign>& designs,
                                          const std::vector<std::string>& case_ids) {
  ReplayList replays(*run.tracking());
  // The page opens the first case, so the median test case comes first.
  const bool has_winner = run.result && run.result->winner && !designs.empty();
  if (has_winner && !run.result->test.case_errors.empty()) {
    add_by_rank(run, run.result->test.case_errors, replays);
  }
  replays.add(run.problem->sets.test, 0, "the first of the test set");
  add_training_case(run, replays);
  for (const std::string& text : case_ids) {
    replays.add(text, kAskedFor);
  }
  return replays.take();
}

}  // namespace armwright
