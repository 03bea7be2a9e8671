// Fills what a problem file leaves open for a robot: tool, workspace, pace and start.

#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"
#include "problems/config/problem_readers.hpp"
#include "sim/proposal/drive_proposal.hpp"
#include "sim/proposal/workspace_proposal.hpp"

namespace armwright {
namespace {

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

// `has_place`: the user gives a workspace or a path.
void propose_tool(const ConfigTable& task, bool has_place, TrackingConfig& config) {
  if (task.has(kTaskOrientation)) {
    return;
  }
  ToolTask& tool = config.task.tool;
  // A user who gives the place also gives the tool's orientation there, if it counts.
  if (!has_place || has_turns(config) || task.has(kTaskToolRpy)) {
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
  const WorkspaceProposal proposal = propose_workspace(config.robot, task, config.workspace);
  config.workspace = proposal.sphere;
  task.home = proposal.home;
  workspace.settle(kWorkspaceCentre, to_list(proposal.sphere.centre_m));
  workspace.settle(kWorkspaceRadius, proposal.sphere.radius_m);
  workspace.settle(kWorkspaceShortestMove, proposal.sphere.shortest_move_m);
  if (proposal.sphere.normal) {
    workspace.settle(kWorkspaceNormal, to_list(*proposal.sphere.normal));
  }
  task_table.settle(kTaskHome, proposal.home);
  if (task.tool.orientation != ToolOrientation::free) {
    const Eigen::Vector3d rpy = calc_rpy(proposal.centre.turn);
    task.tool.turn = make_turn(rpy);  // the orientation that the recorded numbers give
    task_table.settle(kTaskToolRpy, to_list(rpy));
  }
}

void propose_pace(const ConfigTable& task_table, TrackingConfig& config) {
  TrackingTask& task = config.task;
  const std::vector<TestCase> cases = get_cases(config);
  if (!task_table.has(kTaskDistanceLimit)) {
    task.distance_limit_m =
        config.path ? calc_longest_move_m(cases) : 2 * config.workspace.radius_m;
    task_table.settle(kTaskDistanceLimit, task.distance_limit_m);
  }
  if (!task_table.has(kTaskSpeed) && !(config.path && config.path->continuous)) {
    task.speed_m_per_s = propose_speed(config.robot, task, cases);
    task_table.settle(kTaskSpeed, task.speed_m_per_s);
  }
}

}  // namespace

void apply_proposal(const ConfigTable& table, TrackingConfig& config) {
  const ConfigTable task = table.get_table_or_empty(kTaskSettings);
  const ConfigTable workspace = table.get_table_or_empty(kWorkspaceSettings);
  const ConfigTable path = table.get_table_or_empty(kPathSettings);
  const bool has_place = workspace.has(kWorkspaceCentre) || config.path;
  propose_tool(task, has_place, config);
  if (has_place) {
    check_place(task, workspace, config);
  } else {
    propose_place(task, workspace, config);
  }
  try {
    propose_pace(task, config);
  } catch (const Error& error) {
    if (!config.path) {
      throw;
    }
    path.refuse("kind", fmt::format("{}; move the path, or ask less of the tool "
                                    "(task.orientation)",
                                    error.what()));
  }
}

ArmDesign propose_start(const TrackingConfig& config) {
  return propose_design(config.robot, config.task, get_cases(config), config.own_effort_limits);
}

}  // namespace armwright
