// Fills what a problem file leaves open for a robot: tool, workspace, pace and start.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <span>

#include "base/error.hpp"
#include "base/read_limit.hpp"
#include "base/text.hpp"
#include "problems/config/problem_readers.hpp"
#include "sim/proposal/drive_proposal.hpp"
#include "sim/proposal/workspace_proposal.hpp"

namespace armwright {
namespace {

// Starts are simulated, the usual one first, until the largest error is below this share of the error
// that counts as a failure. Slower controllers help an arm that swings, faster ones an arm that its
// weight pulls down.
constexpr double kGoodStart = 0.5;
constexpr double kOtherStarts_rad_per_s[] = {7, 14, 5, 20, 3.5, 28, 2.5};
constexpr std::size_t kStartCases = 4;
constexpr std::size_t kStartPoints = 8;  // without the first; the moves to them are the longest

std::vector<double> to_list(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

// Returns the cases that a proposal must suit.
std::vector<TestCase> get_cases(const TrackingConfig& config) {
  return config.path ? std::vector<TestCase>{*config.path} : make_proposal_cases(config.workspace);
}

double calc_longest_move_m(const std::vector<TestCase>& cases) {
  double longest_m = 0;
  for (const TestCase& one : cases) {
    for (std::size_t k = 1; k < one.points_m.size(); ++k) {
      longest_m = std::max(longest_m, (one.points_m[k] - one.points_m[k - 1]).norm());
    }
  }
  return longest_m;
}

bool has_turns(const TrackingConfig& config) {
  return config.path && !config.path->turns.empty();
}

// Chooses the orientation at a place that the user gives, unless the file does.
void propose_tool(const ConfigTable& task, TrackingConfig& config) {
  if (task.has(kTaskOrientation)) {
    return;
  }
  ToolTask& tool = config.task.tool;
  // A user who gives the place also gives the tool's orientation there, if it counts.
  if (has_turns(config) || task.has(kTaskToolRpy)) {
    tool.orientation = propose_orientation(config.robot, tool);
  }
  task.settle(kTaskOrientation,
              tool_orientation_names()[static_cast<std::size_t>(tool.orientation)]);
}

// Checks that a place of the user's own is complete.
void check_place(const ConfigTable& task, const ConfigTable& workspace,
                 const TrackingConfig& config) {
  if (config.task.tool.orientation != ToolOrientation::free && !has_turns(config) &&
      !task.has(kTaskToolRpy)) {
    task.refuse(task.has(kTaskOrientation) ? kTaskOrientation.key : kTaskToolRpy.key,
                "it needs task.tool_rpy_rad, how the tool is to be turned there");
  }
  if (!config.path && !workspace.has(kWorkspaceRadius)) {
    workspace.refuse(kWorkspaceCentre, "workspace.radius_m belongs to it; give both or neither");
  }
}

// Throws Error{bad_data} if there is no place to work. Notes say what the place lacks.
WorkspaceProposal find_place(const ConfigTable& task_table, TrackingConfig& config) {
  TrackingTask& task = config.task;
  std::optional<ToolOrientation> wanted;
  if (task_table.has(kTaskOrientation)) {
    wanted = task.tool.orientation;
  }
  const auto found = propose_workspace(config.robot, task, config.workspace, wanted);
  if (!found) {
    refuse_proposal(
        config.robot,
        fmt::format("no place was found {}{}where its tool can move along straight lines with "
                    "task.orientation = \"{}\", within all joint ranges and off singularities; set "
                    "another task.orientation, or workspace.centre_m, workspace.radius_m and "
                    "task.home yourself",
                    task.floor_m ? fmt::format("above task.floor_m = {:g} ", *task.floor_m) : "",
                    task.clearance ? "clear of obstacles " : "",
                    wanted ? tool_orientation_names()[static_cast<std::size_t>(*wanted)] : "free"));
  }
  if (!found->floor_m) {
    config.robot.notes.emplace_back(
        "no workspace was found above a floor at height 0, so the proposed one may lie below it; "
        "give task.floor_m if there is a floor");
  }
  if (!found->points_down && found->orientation != ToolOrientation::free) {
    config.robot.notes.emplace_back(
        "no workspace was found where the tool points down; the proposed one has it tilted "
        "(task.tool_rpy_rad)");
  }
  return *found;
}

void propose_place(const ConfigTable& task_table, const ConfigTable& workspace,
                   TrackingConfig& config) {
  const AnySetting* const of_place[] = {&kWorkspaceRadius, &kWorkspaceShortestMove,
                                        &kWorkspaceNormal};
  for (const AnySetting* setting : of_place) {
    if (workspace.has(*setting)) {
      workspace.refuse(*setting, "workspace.centre_m belongs to it; give both or neither");
    }
  }
  for (const auto* setting : {&kTaskHome, &kTaskToolRpy}) {
    if (task_table.has(*setting)) {
      task_table.refuse(*setting,
                        "it belongs to a workspace of your own; give workspace.centre_m "
                        "and workspace.radius_m, or leave it out");
    }
  }
  TrackingTask& task = config.task;
  if (!task_table.has(kTaskToolAxis)) {
    task.tool.axis = propose_tool_axis(config.robot);
  }
  const WorkspaceProposal proposal = find_place(task_table, config);
  config.workspace = proposal.sphere;
  task.home = proposal.home;
  task.tool.orientation = proposal.orientation;
  workspace.settle(kWorkspaceCentre, to_list(proposal.sphere.centre_m));
  workspace.settle(kWorkspaceRadius, proposal.sphere.radius_m);
  workspace.settle(kWorkspaceShortestMove, proposal.sphere.shortest_move_m);
  if (proposal.sphere.normal) {
    workspace.settle(kWorkspaceNormal, to_list(*proposal.sphere.normal));
  }
  task_table.settle(kTaskHome, proposal.home);
  task_table.settle(kTaskOrientation,
                    tool_orientation_names()[static_cast<std::size_t>(proposal.orientation)]);
  task.floor_m = proposal.floor_m;
  if (task.floor_m) {
    task_table.settle(kTaskFloor, *task.floor_m);
  }
  if (task.tool.orientation != ToolOrientation::free) {
    const Eigen::Vector3d rpy = calc_rpy(proposal.centre.turn);
    task.tool.turn = make_turn(rpy);  // the orientation that the recorded numbers give
    task_table.settle(kTaskToolRpy, to_list(rpy));
  }
  if (task.tool.orientation == ToolOrientation::pointing) {
    task_table.settle(kTaskToolAxis, to_list(task.tool.axis));
  }
}

// Proposes the distance limit, the control period with its steps, and the speed.
void propose_pace(const ConfigTable& table, TrackingConfig& config) {
  const ConfigTable task_table = table.get_table_or_empty(kTaskSettings);
  const ConfigTable control = table.get_table_or_empty(kControlSettings);
  const ConfigTable physics = table.get_table_or_empty(kPhysicsSettings);
  TrackingTask& task = config.task;
  const std::vector<TestCase> cases = get_cases(config);
  if (!task_table.has(kTaskDistanceLimit)) {
    task.distance_limit_m =
        config.path ? calc_longest_move_m(cases) : 2 * config.workspace.radius_m;
    task_table.settle(kTaskDistanceLimit, task.distance_limit_m);
  }
  if (!control.has(kControlPeriod) && !config.never_rests()) {
    task.control_period_s = propose_period_s(config.robot, task, cases);
    control.settle(kControlPeriod, task.control_period_s);
    if (!physics.has(kPhysicsSubsteps)) {
      task.physics.substeps =
          static_cast<int>(std::lround(task.control_period_s / kProposedStep_s));
      physics.settle(kPhysicsSubsteps, task.physics.substeps);
    }
  }
  if (!task_table.has(kTaskSpeed) && !config.never_rests()) {
    task.speed_m_per_s = propose_speed(config.robot, task, cases);
    task_table.settle(kTaskSpeed, task.speed_m_per_s);
  }
}

// Returns the beginnings of the first cases.
std::vector<TestCase> shorten_cases(const std::vector<TestCase>& cases) {
  std::vector<TestCase> some(cases.begin(), cases.begin() + static_cast<std::ptrdiff_t>(std::min(
                                                                kStartCases, cases.size())));
  for (TestCase& one : some) {
    const std::size_t points = std::min(kStartPoints + 1, one.points_m.size());
    if (!one.continuous) {
      one.points_m.resize(points);
      one.turns.resize(std::min(points, one.turns.size()));
    }
  }
  return some;
}

// The largest error (m) of the design on the cases. Infinite if a simulation does not end well.
double simulate_start(const PhysicsEngine& engine, const TrackingSetup& setup,
                      const std::vector<TargetTable>& tables, const ArmDesign& design) {
  std::vector<TrackingJob> jobs;
  for (const TargetTable& table : tables) {
    if (table.unreachable.empty()) {
      TrackingJob& job = jobs.emplace_back();
      job.design = &design;
      job.targets = &table;
    }
  }
  double most_m = 0;
  for (const TrackingResult& result : engine.simulate(setup, jobs)) {
    check_reading();
    most_m = result.status == SimulationStatus::ok ? std::max(most_m, result.mean_error_m)
                                                   : std::numeric_limits<double>::infinity();
  }
  return most_m;
}

// Returns the first design with errors that are small enough, or else the one with the smallest.
std::size_t find_good_start(const TrackingConfig& config, const std::vector<TestCase>& cases,
                            const std::vector<ArmDesign>& designs) {
  const ReadStep step(
      fmt::format("simulating the start of robot '{}'", sanitize(config.robot.name)));
  const TrackingSetup setup(config.robot, config.task);
  const std::vector<TargetTable> tables = setup.make_targets(shorten_cases(cases));
  std::size_t best = 0;
  double least_error_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < designs.size(); ++i) {
    const double error_m = simulate_start(*config.engines.judging, setup, tables, designs[i]);
    if (error_m < least_error_m) {
      least_error_m = error_m;
      best = i;
    }
    if (error_m < kGoodStart * kFailureError_m) {
      break;
    }
  }
  return best;
}

}  // namespace

void apply_proposal(const ConfigTable& table, TrackingConfig& config) {
  const ConfigTable task = table.get_table_or_empty(kTaskSettings);
  const ConfigTable workspace = table.get_table_or_empty(kWorkspaceSettings);
  const ConfigTable path = table.get_table_or_empty(kPathSettings);
  if (workspace.has(kWorkspaceCentre) || config.path) {
    propose_tool(task, config);
    check_place(task, workspace, config);
  } else {
    propose_place(task, workspace, config);
  }
  try {
    propose_pace(table, config);
  } catch (const Error& error) {
    if (!config.path) {
      throw;
    }
    path.refuse("kind", fmt::format("{}; move the path, or ask less of the tool "
                                    "(task.orientation)",
                                    error.what()));
  }
}

ArmDesign propose_start(const ConfigTable& variables, const TrackingConfig& config) {
  const std::vector<TestCase> cases = get_cases(config);
  const auto propose = [&](std::span<const double> bandwidths_rad_per_s) {
    return propose_designs(config.robot, config.task, cases, config.own_effort_limits,
                           bandwidths_rad_per_s);
  };
  if (const auto given = variables.find(kVariablesStartBandwidth)) {
    if (*given == kStartOfVersion1) {
      variables.leave_out(kVariablesStartBandwidth);  // so recorded version 1.0
    }
    return propose({&*given, 1}).front();
  }
  std::vector<double> tried_rad_per_s = {kStartBandwidth_rad_per_s};
  // The controllers of drives follow from the drives' own times.
  if (!config.task.drives.has_loops()) {
    tried_rad_per_s.insert(tried_rad_per_s.end(), std::begin(kOtherStarts_rad_per_s),
                           std::end(kOtherStarts_rad_per_s));
  }
  const std::vector<ArmDesign> designs = propose(tried_rad_per_s);
  const std::size_t best = designs.size() == 1 ? 0 : find_good_start(config, cases, designs);
  variables.settle(kVariablesStartBandwidth, tried_rad_per_s[best]);
  return designs[best];
}

}  // namespace armwright
