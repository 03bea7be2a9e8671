// Evaluates the shown designs at several nominal speeds.

#include <fmt/format.h>

#include <algorithm>

#include "base/text.hpp"
#include "report/evidence/arm_evidence.hpp"
#include "report/evidence/distance_response.hpp"
#include "report/evidence/page_json.hpp"

namespace armwright {
namespace {

using nlohmann::json;

// Enough cases to distinguish the speeds, and few enough for a short wait.
constexpr int kMostSweepCases = 100;

struct SweepRequest {
  std::vector<double> speeds_m_per_s;
  std::string set;          // "test/2"
  std::uint64_t cases = 0;  // the first cases of the set
  std::string command;      // repeats the sweep
};

// Leaves out designs with their own speed: they ignore the task's speed, which the sweep changes.
std::vector<const ShownDesign*> choose_swept(const std::vector<ShownDesign>& designs) {
  std::vector<const ShownDesign*> swept;
  for (const ShownDesign& design : designs) {
    if (design.named.id != "base" && !design.named.design.speed_m_per_s) {
      swept.push_back(&design);
    }
  }
  return swept;
}

SweepRequest make_sweep_request(const RecordedRun& run,
                                const std::vector<const ShownDesign*>& swept) {
  constexpr double kFirst_m_per_s = 0.5;
  constexpr double kStep_m_per_s = 0.25;
  constexpr int kSpeeds = 11;
  constexpr double kThesis_m_per_s = 1.5;
  // For tasks whose speed is far from the thesis's, the speeds are scaled by the same factor.
  const double speed_m_per_s = run.tracking()->config().task.speed_m_per_s;
  const double scale = speed_m_per_s < kFirst_m_per_s || speed_m_per_s > 2 * kThesis_m_per_s
                           ? speed_m_per_s / kThesis_m_per_s
                           : 1;
  SweepRequest request;
  std::vector<std::string> values;
  for (int i = 0; i < kSpeeds; ++i) {
    request.speeds_m_per_s.push_back(scale * (kFirst_m_per_s + kStep_m_per_s * i));
    values.push_back(format_exact(request.speeds_m_per_s.back()));
  }
  const CaseSets& sets = run.problem->sets;
  request.set = sets.test;
  request.cases = static_cast<std::uint64_t>(std::min(sets.test_cases, kMostSweepCases));
  if (!run.problem_arguments.empty() && !swept.empty() && !swept.front()->argument.empty()) {
    std::vector<std::string> words = {"armwright", "sweep"};
    words.insert(words.end(), run.problem_arguments.begin() + 1, run.problem_arguments.end());
    words.insert(words.end(), {"--design", swept.front()->argument, "--parameter",
                               "task.speed_m_per_s", "--values", join(values, ","), "--test-set",
                               sets.test, "--cases", fmt::format("{}", request.cases)});
    request.command = quote_command(words);
  }
  return request;
}

// Returns Sweep of web/src/data.ts over task.speed_m_per_s: every design at every speed on the same
// cases, by the judging engine. The nominal speed is the problem's own.
json simulate_speeds(PageSimulator& simulator, const TrackingProblem& problem,
                     const SweepRequest& request, std::span<const NamedDesign> designs) {
  json series = json::array();
  for (const NamedDesign& design : designs) {
    series.push_back({{"name", design.name},
                      {"mean_m", json::array()},
                      {"standard_error_m", json::array()},
                      {"median_m", json::array()},
                      {"failures", json::array()}});
  }
  for (const double speed_m_per_s : request.speeds_m_per_s) {
    TrackingConfig config = problem.config();
    config.task.speed_m_per_s = speed_m_per_s;
    const TrackingProblem at_speed(std::move(config));
    const TestSet set = problem.get_set(request.set);
    for (std::size_t i = 0; i < designs.size(); ++i) {
      const auto results = simulator.evaluate(at_speed, designs[i].design, set, 0, request.cases);
      const ErrorSummary summary = summarize_cases(results);
      series[i]["mean_m"].push_back(finite_or_null(summary.mean));
      series[i]["standard_error_m"].push_back(
          finite_or_null(calc_mean_and_error(get_case_errors(results)).standard_error));
      series[i]["median_m"].push_back(finite_or_null(summary.median));
      series[i]["failures"].push_back(summary.failures);
    }
  }
  return {{"parameter", "task.speed_m_per_s"},
          {"quantity", make_quantity({"average speed", "m/s"})},
          {"values", request.speeds_m_per_s},
          {"nominal", problem.config().task.speed_m_per_s},
          {"cases", request.cases},
          {"engine", problem.config().engines.judging_name},
          {"command", request.command},
          {"series", std::move(series)}};
}

}  // namespace

std::uint64_t count_sweep_cases(const RecordedRun& run, const std::vector<ShownDesign>& designs) {
  const auto swept = choose_swept(designs);
  if (run.tracking()->config().never_rests()) {
    return 0;
  }
  const SweepRequest request = make_sweep_request(run, swept);
  return request.speeds_m_per_s.size() * request.cases * swept.size();
}

json make_speed_sweep(const RecordedRun& run, const std::vector<ShownDesign>& designs,
                      PageSimulator& simulator, std::vector<std::string>& notes) {
  if (run.tracking()->config().never_rests()) {
    notes.push_back("The path has its own times, so there is no sweep over the speed.");
    return nullptr;
  }
  const auto swept = choose_swept(designs);
  std::vector<std::string> own_speed;
  for (const ShownDesign& design : designs) {
    if (design.named.design.speed_m_per_s && design.named.id != "base") {
      own_speed.push_back(sanitize(design.named.name));
    }
  }
  if (!own_speed.empty()) {
    notes.push_back(
        fmt::format("Designs with their own speed ignore the task's speed, so the sweep over the "
                    "speed leaves out {}.",
                    join(own_speed, ", ")));
  }
  if (swept.empty()) {
    return nullptr;
  }
  std::vector<NamedDesign> named;
  for (const ShownDesign* design : swept) {
    named.push_back(design->named);
  }
  return simulate_speeds(simulator, *run.tracking(), make_sweep_request(run, swept), named);
}

}  // namespace armwright
