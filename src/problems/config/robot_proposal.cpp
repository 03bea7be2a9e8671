#include "problems/config/robot_proposal.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "sim/proposal/drive_proposal.hpp"
#include "sim/proposal/workspace_proposal.hpp"

namespace armwright {
namespace {

std::string to_text(const Eigen::Vector3d& v) {
  return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z());
}

// The cases that a proposal must suit.
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

class Proposer {
 public:
  Proposer(const ConfigTable& table, TrackingConfig& config)
      : task_table_(table.get_table_or_empty("task")),
        workspace_table_(table.get_table_or_empty("workspace")),
        path_table_(table.get_table_or_empty("path")),
        config_(config) {}

  std::vector<std::string> apply() {
    const bool has_place = workspace_table_.has("centre_m") || config_.path;
    propose_tool(has_place);
    if (has_place) {
      check_place();
    } else {
      propose_place();
    }
    try {
      propose_pace();
    } catch (const Error& error) {
      if (!config_.path) {
        throw;
      }
      path_table_.refuse("kind", fmt::format("{}; move the path, or ask less of the tool "
                                             "(task.orientation)",
                                             error.what()));
    }
    return std::move(settled_);
  }

 private:
  void settle(std::string_view key, const std::string& value) {
    settled_.push_back(fmt::format("{}={}", key, value));
  }

  void propose_tool(bool has_place) {
    if (task_table_.has("orientation")) {
      return;
    }
    ToolTask& tool = config_.task.tool;
    const bool has_turns = config_.path && !config_.path->turns.empty();
    // Where the place is the user's, how the tool is to be turned there is too.
    if (!has_place || has_turns || task_table_.has("tool_rpy_rad")) {
      tool.orientation = propose_orientation(config_.robot, tool);
    }
    settle("task.orientation",
           tool_orientation_names()[static_cast<std::size_t>(tool.orientation)]);
  }

  void check_place() const {
    const bool has_turns = config_.path && !config_.path->turns.empty();
    if (config_.task.tool.orientation != ToolOrientation::free && !has_turns &&
        !task_table_.has("tool_rpy_rad")) {
      task_table_.refuse(task_table_.has("orientation") ? "orientation" : "tool_rpy_rad",
                         "it needs task.tool_rpy_rad, how the tool is to be turned there");
    }
    if (!config_.path && !workspace_table_.has("radius_m")) {
      workspace_table_.refuse("centre_m", "workspace.radius_m belongs to it; give both or neither");
    }
  }

  void propose_place() {
    for (const char* key : {"radius_m", "shortest_move_m", "normal"}) {
      if (workspace_table_.has(key)) {
        workspace_table_.refuse(key, "workspace.centre_m belongs to it; give both or neither");
      }
    }
    for (const char* key : {"home", "tool_rpy_rad"}) {
      if (task_table_.has(key)) {
        task_table_.refuse(key,
                           "it belongs to a workspace of your own; give workspace.centre_m "
                           "and workspace.radius_m, or leave it out");
      }
    }
    TrackingTask& task = config_.task;
    const WorkspaceProposal proposal = propose_workspace(config_.robot, task, config_.workspace);
    config_.workspace = proposal.sphere;
    task.home = proposal.home;
    settle("workspace.centre_m", to_text(proposal.sphere.centre_m));
    settle("workspace.radius_m", fmt::format("{}", proposal.sphere.radius_m));
    settle("workspace.shortest_move_m", fmt::format("{}", proposal.sphere.shortest_move_m));
    if (proposal.sphere.normal) {
      settle("workspace.normal", to_text(*proposal.sphere.normal));
    }
    settle("task.home", fmt::format("[{}]", fmt::join(proposal.home, ", ")));
    if (task.tool.orientation != ToolOrientation::free) {
      const Eigen::Vector3d rpy = calc_rpy(proposal.centre.turn);
      task.tool.turn = make_turn(rpy);  // what the recorded numbers give
      settle("task.tool_rpy_rad", to_text(rpy));
    }
  }

  void propose_pace() {
    TrackingTask& task = config_.task;
    const std::vector<TestCase> cases = get_cases(config_);
    if (!task_table_.has("distance_limit_m")) {
      task.distance_limit_m =
          config_.path ? calc_longest_move_m(cases) : 2 * config_.workspace.radius_m;
      settle("task.distance_limit_m", fmt::format("{}", task.distance_limit_m));
    }
    if (!task_table_.has("speed_m_per_s") && !(config_.path && config_.path->continuous)) {
      task.speed_m_per_s = propose_speed(config_.robot, task, cases);
      settle("task.speed_m_per_s", fmt::format("{}", task.speed_m_per_s));
    }
  }

  ConfigTable task_table_;
  ConfigTable workspace_table_;
  ConfigTable path_table_;
  TrackingConfig& config_;
  std::vector<std::string> settled_;
};

}  // namespace

std::vector<std::string> apply_proposal(const ConfigTable& table, TrackingConfig& config) {
  return Proposer(table, config).apply();
}

ArmDesign propose_start(const TrackingConfig& config) {
  return propose_design(config.robot, config.task, get_cases(config));
}

}  // namespace armwright
