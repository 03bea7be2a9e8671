// `armwright list designs`.

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/text.hpp"
#include "cli/list/list_views.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/table.hpp"
#include "cli/views/result_view.hpp"
#include "problems/config/config_files.hpp"
#include "problems/config/design_file.hpp"

namespace armwright {
namespace {

using nlohmann::json;

std::vector<ListItem> list_designs() {
  std::vector<ListItem> items;
  for (const std::string& name : list_configs("designs")) {
    items.push_back({name, load_design(name).title});
  }
  return items;
}

std::string explain_design(const std::string& name, const Style& style) {
  const DesignFile file = load_design(name);
  std::string text = format_title(style, file.name, file.title);
  text += file.source.empty() ? "" : fmt::format("  Source: {}\n", sanitize(file.source));
  text += fmt::format("\n{}", format_design(file, style));
  if (!file.published.empty()) {
    Table table({{"published as", false},
                 {"problem", false},
                 {"with", false},
                 {"error mm"},
                 {"where", false}});
    for (const PublishedResult& published : file.published) {
      table.add_row({sanitize(published.label), sanitize(published.problem),
                     sanitize(join(published.overrides, " ")), format_mm(published.error_m),
                     sanitize(published.where)});
    }
    text += fmt::format("\n{}", table.format(style));
  }
  return text;
}

json explain_design_as_json(const std::string& name) {
  const DesignFile file = load_design(name);
  const ControllerRow& controller = find_controller(file.design.controller);
  json joints = json::array();
  for (std::size_t i = 0; i < file.design.joints.size(); ++i) {
    const JointDrive& drive = file.design.joints[i];
    json joint = {{"name", sanitize(file.joint_names.at(i))},
                  {"effort_min_n_m", drive.limits.min},
                  {"effort_max_n_m", drive.limits.max}};
    for (std::size_t g = 0; g < drive.gains.size(); ++g) {
      joint[controller.gains[g].key] = drive.gains[g];
    }
    joints.push_back(std::move(joint));
  }
  json published = json::array();
  for (const PublishedResult& result : file.published) {
    published.push_back({{"label", sanitize(result.label)},
                         {"problem", sanitize(result.problem)},
                         {"error_m", result.error_m ? json(*result.error_m) : json(nullptr)},
                         {"where", sanitize(result.where)}});
  }
  return {{"name", sanitize(file.name)},
          {"title", sanitize(file.title)},
          {"source", sanitize(file.source)},
          {"controller", file.design.controller},
          {"total_torque_n_m", calc_total_effort(file.design)},
          {"joints", joints},
          {"published", published}};
}

}  // namespace

ListKind make_design_kind() {
  return {"designs", list_designs, explain_design, explain_design_as_json};
}

}  // namespace armwright
