#include "report/page/reproduction_replays.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "problems/config_files.hpp"
#include "report/page/motions.hpp"
#include "report/page/robot_scene.hpp"
#include "study/design_evaluation.hpp"

namespace armwright {
namespace {

using nlohmann::json;

LoadedProblem load_problem_of(const PartResult& result, const ReproductionRecord& record) {
  std::vector<std::string> overrides = result.part.overrides;
  overrides.insert(overrides.end(), record.overrides.begin(), record.overrides.end());
  return load_problem(result.part.problem, overrides);
}

// "table-a5": "A.5 (Winner of Q1)", of its title what is before the first colon.
NamedDesign make_named_design(const std::string& name) {
  const DesignFile file = load_design(name);
  return {name,
          fmt::format("{} ({})", get_table_name(name), file.title.substr(0, file.title.find(':'))),
          file.design};
}

// A case without a number is worse than all others.
std::size_t find_worst(const std::vector<double>& errors) {
  const auto none = std::ranges::find_if(errors, [](double error) { return std::isnan(error); });
  const auto worst = none != errors.end() ? none : std::ranges::max_element(errors);
  return static_cast<std::size_t>(worst - errors.begin());
}

// "test/2:17"
ReplayRequest parse_case(const TrackingProblem& problem, const std::string& id) {
  const std::size_t colon = id.rfind(':');
  const auto number =
      colon == std::string::npos ? std::nullopt : parse_integer(id.substr(colon + 1));
  if (!number || *number < 0) {
    throw Error(ErrorKind::usage,
                fmt::format("case '{}': it must be the name of a set and a number, as in test/2:17",
                            sanitize(id)));
  }
  const std::string set = id.substr(0, colon);
  return {problem.get_set(set), static_cast<std::uint64_t>(*number),
          fmt::format("{}, case {}", set, *number)};
}

std::vector<ReplayRequest> choose_cases(const TrackingProblem& problem, const ReplayConfig& replay,
                                        const PartResult& result, const PageOptions& options) {
  std::vector<ReplayRequest> cases = {parse_case(problem, replay.training_case)};
  cases.back().label += ", that of generation 1";
  const auto add = [&](ReplayRequest request) {
    const auto same = [&](const ReplayRequest& other) {
      return other.set.name() == request.set.name() && other.number == request.number;
    };
    if (std::ranges::none_of(cases, same)) {
      cases.push_back(std::move(request));
    }
  };
  const std::size_t worst = find_worst(result.case_errors);
  add({problem.get_set(result.test_set), worst,
       fmt::format("{}, case {}: the worst of {} for {}", result.test_set, worst,
                   result.case_errors.size(), result.part.label)});
  for (const std::string& id : options.cases) {
    add(parse_case(problem, id));
  }
  return cases;
}

// One for each load.
class Robots {
 public:
  Robots(json& list, std::vector<std::string>& notes) : list_(list), notes_(notes) {}

  std::size_t find(const LoadedProblem& problem) {
    const double load_kg = problem.tracking->config().task.load_kg;
    const auto urdf = json::parse(problem.resolved_json).at("robot").at("urdf").get<std::string>();
    const auto key = fmt::format("{} {}", urdf, load_kg);
    const auto known = std::ranges::find(keys_, key);
    if (known == keys_.end()) {
      keys_.push_back(key);
      list_.push_back(make_robot(problem.tracking->config().robot, load_kg,
                                 resolve_config("robots", urdf).parent_path(), notes_));
      return keys_.size() - 1;
    }
    return static_cast<std::size_t>(known - keys_.begin());
  }

 private:
  json& list_;
  std::vector<std::string>& notes_;
  std::vector<std::string> keys_;
};

}  // namespace

ReproductionReplays make_reproduction_replays(const ReproductionRecord& record,
                                              const ReproductionConfig& config,
                                              const PageOptions& options, PageSimulator& simulator,
                                              std::vector<std::string>& notes) {
  ReproductionReplays made;
  if (!options.simulate) {
    notes.emplace_back(
        "Motions were not simulated: there is no replay and no error over the time.");
    return made;
  }
  Robots robots(made.robots, notes);
  std::vector<std::string> missing;
  for (const ReplayConfig& replay : config.replays) {
    const auto found = record.results.find(replay.of);
    if (found == record.results.end()) {
      missing.push_back(replay.title);
      continue;
    }
    const PartResult& result = found->second;
    const LoadedProblem problem = load_problem_of(result, record);
    const TrackingProblem& tracking = require_tracking(problem);
    std::vector<NamedDesign> designs = {make_named_design(result.part.design)};
    for (const std::string& name : replay.beside) {
      designs.push_back(make_named_design(name));
    }
    const auto cases = choose_cases(tracking, replay, result, options);
    made.replays.push_back(make_replay_set(simulator, tracking, {replay.id, replay.title},
                                           robots.find(problem), designs, cases));
  }
  for (const MomentaryConfig& momentary : config.momentary) {
    const auto replay = std::ranges::find(made.replays, momentary.replay, [](const json& one) {
      return one["id"].get<std::string>();
    });
    if (replay != made.replays.end()) {
      made.momentary.push_back({{"name", momentary.name},
                                {"replay", momentary.replay},
                                {"design", (*replay)["designs"][0]["id"]},
                                {"case", (*replay)["cases"][0]["id"]}});
    }
  }
  if (!missing.empty()) {
    notes.push_back(
        fmt::format("Without the published results that they belong to, these motions "
                    "are left out: {}.",
                    join(missing, "; ")));
  }
  return made;
}

}  // namespace armwright
