// The replays of a study's page.
#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"
#include "base/folder.hpp"
#include "base/text.hpp"
#include "problems/config/config_files.hpp"
#include "report/evidence/motions.hpp"
#include "report/evidence/page_json.hpp"
#include "report/evidence/robot_scene.hpp"
#include "report/page/study_parts.hpp"
#include "study/analysis/final_check.hpp"
#include "study/run/run.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr std::size_t kMostProblemsShown = 4;
constexpr std::size_t kMostDesigns = 6;
constexpr std::size_t kMostGroups = 3;                    // of divide_by_motion()
constexpr std::size_t kMostBytes = std::size_t{3} << 20;  // all replays together

// Returns the name of the design from which the problem's optimizations start.
std::string name_start(const LoadedProblem& problem) {
  const json variables = json::parse(problem.resolved_json).at("variables");
  return variables.at("start") == kProposedStart ? kProposedControllers : kBaseControllers;
}

struct BestDesign {
  const CellOutcome* cell = nullptr;
  NamedDesign named;
};

// Returns the best design of each of the best optimizers, the best optimizer first. Each design
// comes with its method's problem, because a controller may need precomputed efforts that the
// problems of other methods do not have.
std::vector<BestDesign> find_best_designs(const StudyPlan& plan, const StudyResult& result,
                                          std::size_t problem, std::vector<std::string>& notes) {
  std::vector<BestDesign> designs;
  for (const std::size_t o : result.problems[problem].order) {
    const std::string& label = plan.optimizers[o].label;
    const CellOutcome* cell = find_best_cell(result.cells, plan.problems[problem].label, label);
    if (cell == nullptr || designs.size() >= kMostDesigns) {
      continue;
    }
    const TrackingProblem& its_problem =
        *get_problem(plan, {problem, o, cell->replicate}).tracking();
    NamedDesign named{fmt::format("optimizer-{}", o),
                      fmt::format("{}, replicate {}", label, cell->replicate),
                      its_problem.make_design(cell->x), &its_problem};
    try {
      its_problem.check_design(named.design);
      designs.push_back({cell, std::move(named)});
    } catch (const Error& error) {  // the page has other parts
      notes.push_back(fmt::format("The replay of {} on {} is left out: {}.", sanitize(label),
                                  sanitize(plan.problems[problem].label), sanitize(error.what())));
    }
  }
  return designs;
}

std::vector<ReplayRequest> choose_cases(const StudyPlan& plan, const StudyProblem& problem,
                                        std::span<const BestDesign> designs,
                                        const std::filesystem::path& folder,
                                        std::span<const std::string> asked_for) {
  const CaseSets& sets = problem.loaded.sets;
  ReplayList replays(*problem.loaded.tracking());
  replays.add(sets.test, 0, "the first of the test set");
  if (!designs.empty()) {
    const CellOutcome& cell = *designs.front().cell;
    const auto optimizer =
        std::ranges::find(plan.optimizers, cell.optimizer, &StudyOptimizer::label);
    const Cell where{static_cast<std::size_t>(&problem - plan.problems.data()),
                     static_cast<std::size_t>(optimizer - plan.optimizers.begin()), cell.replicate};
    const auto run = folder / make_cell_path(plan, where);
    // A study needs only cell.json, so the user may have removed the run's result.
    const auto errors = path_exists(run / "result.json") ? load_result(run).test.case_errors
                                                         : std::vector<double>{};
    if (!errors.empty()) {
      replays.add(
          sets.test, find_worst_case(errors),
          fmt::format("the worst of {} for {}", sets.test_cases, designs.front().named.name));
    }
  }
  for (const std::string& text : asked_for) {
    replays.add(text, kAskedFor);
  }
  return replays.take();
}

std::filesystem::path find_urdf_folder(const StudyProblem& problem) {
  const json resolved = json::parse(problem.loaded.resolved_json);
  const auto urdf = resolved.at("robot").at("urdf").get<std::string>();
  const auto problem_folder = std::filesystem::path(problem.name).parent_path();
  if (path_exists(problem_folder / urdf)) {
    return (problem_folder / urdf).parent_path();
  }
  try {
    return resolve_config("robots", urdf).parent_path();
  } catch (const Error&) {
    return problem_folder;  // it has no meshes; the robot gets plain shapes
  }
}

// Removes motions until the replay is small enough: first the cases between the first one and those
// that the user asked for, then the worst designs, which stand last before the start. The best
// design and the start stay.
void shrink(json& replay, std::size_t most_bytes, std::size_t least_cases) {
  while (dump_page(replay).size() > most_bytes) {
    json& cases = replay["cases"];
    json& designs = replay["designs"];
    if (cases.size() > least_cases) {
      cases.erase(1);
      continue;
    }
    if (designs.size() <= 2) {
      return;
    }
    const std::size_t worst = designs.size() - 2;
    designs.erase(worst);
    for (json& one : cases) {
      one["motions"].erase(worst);
    }
  }
}

}  // namespace

json make_study_replays(const StudyPlan& plan, const StudyResult& result,
                        const std::filesystem::path& folder, std::span<const std::string> cases,
                        PageSimulator& simulator, json& robots, std::vector<std::string>& notes) {
  std::vector<std::size_t> shown;
  for (std::size_t p = 0; p < plan.problems.size() && shown.size() < kMostProblemsShown; ++p) {
    if (plan.problems[p].loaded.tracking()) {
      shown.push_back(p);
    }
  }
  json replays = json::array();
  std::vector<std::string> smaller;
  for (const std::size_t p : shown) {
    const StudyProblem& problem = plan.problems[p];
    const TrackingProblem& tracking = *problem.loaded.tracking();
    const auto best = find_best_designs(plan, result, p, notes);
    const auto requests = choose_cases(plan, problem, best, folder, cases);
    std::vector<NamedDesign> designs;
    for (const BestDesign& one : best) {
      designs.push_back(one.named);
    }
    designs.push_back({"start", name_start(problem.loaded), tracking.config().start});
    auto groups = divide_by_motion(tracking, designs);
    bool is_whole = groups.size() <= kMostGroups;
    if (!is_whole) {  // the groups of the two best designs and of the start stay
      groups.erase(groups.begin() + kMostGroups - 1, groups.end() - 1);
    }
    const auto folder_of_meshes = find_urdf_folder(problem);
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const auto& group = groups[g];
      const std::size_t robot = add_robot(make_shown_arm(tracking, group.front()),
                                          tracking.config().task, folder_of_meshes, robots, notes);
      simulator.expect(group.size() * requests.size());
      json replay = make_replay_set(
          simulator, tracking,
          make_group_text({fmt::format("problem-{}", p), sanitize(problem.label)}, groups, g),
          robot, group, requests);
      shrink(replay, kMostBytes / shown.size() / groups.size(), 1 + cases.size());
      is_whole = is_whole && replay["designs"].size() == group.size() &&
                 replay["cases"].size() == requests.size();
      replays.push_back(std::move(replay));
    }
    if (!is_whole) {
      smaller.push_back(sanitize(problem.label));
    }
  }
  if (!smaller.empty()) {
    notes.push_back(
        fmt::format("Replays of {} have fewer designs or cases than there are, to keep "
                    "the page small.",
                    join(smaller, ", ")));
  }
  return replays;
}

}  // namespace armwright
