// The kinds of things that `armwright list` shows. A kind can list its items and explain one of
// them.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "cli/terminal/terminal.hpp"
#include "sim/engines/engine_table.hpp"

namespace armwright {

struct ListItem {
  std::string name;
  std::string summary;
  std::string unavailable = {};  // why it cannot be used here; empty if it can
};

struct ListKind {
  std::string name;  // "optimizers"
  std::function<std::vector<ListItem>()> list;
  // Both throw Error{usage} with the valid names if there is no item of that name.
  std::function<std::string(const std::string& name, const Style& style)> explain;
  std::function<nlohmann::json(const std::string& name)> explain_as_json;
  // Both are optional. The first returns more than names and summaries, for --json. The second
  // returns Markdown of one item, or of all items if the name is empty.
  std::function<nlohmann::json()> list_as_json = {};
  std::function<std::string(const std::string& name)> explain_as_markdown = {};
};

ListKind make_problem_kind();
ListKind make_optimizer_kind();

// How `list robots FILE` reads the file. An empty value leaves the choice to the reader.
struct RobotRequest {
  std::string base, tip;
  std::vector<std::string> packages;  // NAME=DIR
  std::string write;                  // the file that gets the repaired robot; empty: none does
};
ListKind make_robot_kind(const RobotRequest& request = {});

ListKind make_engine_kind(std::span<const EngineRow> table = engine_table());
ListKind make_design_kind();
ListKind make_study_kind(const std::string& program = "armwright");
ListKind make_controller_kind();
ListKind make_setting_kind();
// `program` is this program's name as the user typed it, for the commands that texts name. `robot`
// is for the kind "robots".
std::vector<ListKind> list_kinds(const std::string& program = "armwright",
                                 const RobotRequest& robot = {});
// Returns the names of all kinds: "problems", "optimizers", ...
std::vector<std::string> list_kind_names();

// Returns the line "NAME: SUMMARY".
std::string format_title(const Style& style, const std::string& name, const std::string& summary);

}  // namespace armwright
