#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/error.hpp"
#include "base/text.hpp"
#include "report/page/arm_evidence.hpp"
#include "report/page/distance_response.hpp"

namespace armwright {
namespace {

class Replays {
 public:
  explicit Replays(const TrackingProblem& problem) : problem_(problem) {}

  void add(const std::string& set, std::uint64_t number, const std::string& what) {
    const auto is_it = [&](const ReplayRequest& request) {
      return request.number == number && request.set.name() == set;
    };
    if (std::ranges::none_of(requests_, is_it)) {
      requests_.push_back({problem_.get_set(set), number,
                           fmt::format("{}, case {}: {}", sanitize(set), number, what)});
    }
  }
  std::vector<ReplayRequest> take() { return std::move(requests_); }

 private:
  const TrackingProblem& problem_;
  std::vector<ReplayRequest> requests_;
};

// With training cases that change that of the second generation, the first being of random designs.
void add_training_case(const RecordedRun& run, Replays& replays) {
  const auto& training = run.journal.training;
  if (training.empty()) {
    return;
  }
  const auto second = std::ranges::find_if(training, [&](const EvaluationRecord& record) {
    return record.generation > training.front().generation;
  });
  const bool has_second = run.schedule.changes_cases() && second != training.end();
  const CaseBlock& cases = (has_second ? *second : training.front()).cases;
  replays.add(cases.set, cases.numbers.front(),
              has_second ? "what the second generation was trained on" : "the first of training");
}

void add_by_rank(const RecordedRun& run, const std::vector<double>& errors, Replays& replays) {
  const std::string& set = run.problem->sets.test;
  const auto value = [&](std::size_t i) {
    return std::isnan(errors[i]) ? std::numeric_limits<double>::infinity() : errors[i];
  };
  std::vector<std::size_t> order(errors.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, value);
  const std::size_t count = errors.size();
  replays.add(set, order[(count - 1) / 2], fmt::format("the median of {}", count));
  replays.add(set, order[(95 * count + 99) / 100 - 1], "the 95th percentile");
  replays.add(set, order[count - 1], fmt::format("the worst of {}", count));
  constexpr int kMostFailures = 3;
  int shown = 0;
  for (std::size_t i = 0; i < count && shown < kMostFailures; ++i) {
    if (value(i) > kFailureError_m) {
      replays.add(set, i, "a failure of the winner");
      ++shown;
    }
  }
}

void add_asked_for(const std::string& text, Replays& replays) {
  const auto colon = text.rfind(':');
  const std::string set = text.substr(0, std::min(colon, text.size()));
  constexpr long long kMost = 1'000'000'000;
  const long long number =
      colon == std::string::npos ? -1 : parse_integer(text.substr(colon + 1)).value_or(-1);
  if (set.find('/') == std::string::npos || set.front() == '/' || set.back() == '/' || number < 0 ||
      number > kMost) {
    throw Error(ErrorKind::usage,
                fmt::format("case '{}' is none: it must be SET:NUMBER with the name of a set of "
                            "test cases and a number from 0, as in test/2:17",
                            sanitize(text)));
  }
  replays.add(set, static_cast<std::uint64_t>(number), "asked for");
}

}  // namespace

std::vector<ReplayRequest> choose_replays(const RecordedRun& run,
                                          const std::vector<ShownDesign>& designs,
                                          const std::vector<std::string>& asked_for) {
  Replays replays(*run.tracking());
  add_training_case(run, replays);
  replays.add(run.problem->sets.test, 0, "the first of the test set");
  const bool has_winner = run.result && run.result->winner && !designs.empty();
  if (has_winner && !run.result->test.case_errors.empty()) {
    add_by_rank(run, run.result->test.case_errors, replays);
  }
  for (const std::string& text : asked_for) {
    add_asked_for(text, replays);
  }
  return replays.take();
}

}  // namespace armwright
