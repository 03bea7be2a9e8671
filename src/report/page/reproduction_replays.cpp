#include "report/page/reproduction_replays.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <string>
#include <tuple>

#include "base/text.hpp"
#include "problems/config/config_files.hpp"
#include "report/evidence/motions.hpp"
#include "report/evidence/robot_scene.hpp"
#include "study/run/design_evaluation.hpp"

namespace armwright {
namespace {

using nlohmann::json;

LoadedProblem load_problem_of(const PartResult& result, const ReproductionRecord& record) {
  std::vector<std::string> overrides = result.part.overrides;
  overrides.insert(overrides.end(), record.overrides.begin(), record.overrides.end());
  return load_problem(result.part.problem, overrides);
}

// Returns the design with the name "A.5" for "table-a5". A design without published results, such as
// the base controllers, has the beginning of its title as its name, up to the first colon.
NamedDesign make_named_design(const std::string& name) {
  const DesignFile file = load_design(name);
  std::string title = file.title.substr(0, file.title.find(':'));
  if (!title.empty()) {
    title[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(title[0])));
  }
  return {name, file.published.empty() ? title : get_table_name(name), file.design};
}

std::vector<ReplayRequest> choose_cases(const TrackingProblem& problem, const ReplayConfig& replay,
                                        const PartResult& result, const PageOptions& options) {
  ReplayList replays(problem);
  replays.add(replay.training_case, "that of generation 1");
  replays.add(result.test_set, find_worst_case(result.case_errors),
              fmt::format("the worst of {} for {}", result.case_errors.size(), result.part.label));
  for (const std::string& id : options.cases) {
    replays.add(id, kAskedFor);
  }
  return replays.take();
}

// The robots of the replays: one per file, mass and shape of the load.
class Robots {
 public:
  Robots(json& list, std::vector<std::string>& notes) : list_(list), notes_(notes) {}

  std::size_t find(const LoadedProblem& problem) {
    const TrackingConfig& config = problem.tracking()->config();
    const auto urdf = json::parse(problem.resolved_json).at("robot").at("urdf").get<std::string>();
    const Key key{urdf, config.task.load_kg, config.task.load_body};
    const auto known = std::ranges::find(keys_, key);
    if (known == keys_.end()) {
      keys_.push_back(key);
      list_.push_back(make_robot(config.robot, config.task,
                                 resolve_config("robots", urdf).parent_path(), notes_));
      return keys_.size() - 1;
    }
    return static_cast<std::size_t>(known - keys_.begin());
  }

 private:
  using Key = std::tuple<std::string, double, std::optional<LoadBody>>;  // URDF, kg, shape

  json& list_;
  std::vector<std::string>& notes_;
  std::vector<Key> keys_;
};

}  // namespace

json make_reproduction_replays(const ReproductionRecord& record, const ReproductionConfig& config,
                               const PageOptions& options, PageSimulator& simulator,
                               std::vector<std::string>& notes) {
  json made = {{"robots", json::array()}, {"replays", json::array()}, {"momentary", json::array()}};
  if (!options.simulate) {
    notes.emplace_back(
        "Motions were not simulated: there is no replay and no error over the time.");
    return made;
  }
  Robots robots(made["robots"], notes);
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
    made["replays"].push_back(make_replay_set(simulator, tracking, {replay.id, replay.title},
                                              robots.find(problem), designs, cases));
  }
  for (const auto& [name, id] : config.momentary) {
    const auto replay = std::ranges::find(
        made["replays"], id, [](const json& one) { return one["id"].get<std::string>(); });
    if (replay != made["replays"].end()) {
      made["momentary"].push_back({{"name", name},
                                   {"replay", id},
                                   {"design", (*replay)["designs"][0]["id"]},
                                   {"case", (*replay)["cases"][0]["id"]}});
    }
  }
  if (!missing.empty()) {
    notes.push_back(
        fmt::format("These motions are left out, because their published results are missing: {}.",
                    join(missing, "; ")));
  }
  return made;
}

}  // namespace armwright
