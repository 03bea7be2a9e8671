// `armwright list studies`.

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/text.hpp"
#include "cli/list/list_views.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/table.hpp"
#include "cli/views/study_view.hpp"
#include "problems/config/config_files.hpp"

namespace armwright {
namespace {

using nlohmann::json;

StudyPlan load_study(const std::string& name) {
  StudyRequest request;
  request.file = name;
  request.plugins = PluginUse::read;
  return make_study_plan(request);
}

std::vector<ListItem> list_known_studies() {
  std::vector<ListItem> items;
  for (const std::string& name : list_configs("studies")) {
    items.push_back({name, read_study_title(name)});
  }
  return items;
}

// Returns what a study's file says without the descriptions that the programs of its problems give.
std::string describe_outline(const std::string& name, const StudyOutline& outline,
                             const Style& style, const std::string& program) {
  Table table({{"", false}, {"", false, true}});
  for (const std::string& problem : outline.problems) {
    table.add_row({"problem", sanitize(problem)});
  }
  table.add_row({"optimizers", sanitize(join(outline.optimizers, ", "))});
  table.add_row(
      {"each",
       fmt::format("{}, budget {}",
                   format_count(static_cast<unsigned long long>(outline.replicates), "replicate"),
                   format_count(static_cast<unsigned long long>(outline.budget), "case"))});
  return format_title(style, outline.name, outline.title) + table.format(style) +
         fmt::format(
             "\nA problem of this study is described by its program, and this command starts no "
             "program. This shows the\nwhole plan and its cost:\n  {}\n",
             sanitize(
                 quote_command(std::vector<std::string>{program, "compare", name, "--dry-run"})));
}

std::string explain_study(const std::string& name, const Style& style, const std::string& program) {
  if (const StudyOutline outline = read_study_outline(name); outline.needs_programs) {
    return describe_outline(name, outline, style, program);
  }
  const StudyPlan plan = load_study(name);
  return format_title(style, plan.name, plan.title) + describe_plan(plan) +
         describe_cost(plan, 0, 1);
}

json explain_study_as_json(const std::string& name) {
  if (const StudyOutline outline = read_study_outline(name); outline.needs_programs) {
    return {{"name", sanitize(outline.name)},
            {"title", sanitize(outline.title)},
            {"problems", outline.problems},
            {"optimizers", outline.optimizers},
            {"replicates", outline.replicates},
            {"budget", outline.budget},
            {"cells", nullptr}};  // the baselines are not known
  }
  const StudyPlan plan = load_study(name);
  json problems = json::array();
  for (const StudyProblem& problem : plan.problems) {
    problems.push_back(problem.label);
  }
  json optimizers = json::array();
  for (const StudyOptimizer& optimizer : plan.optimizers) {
    optimizers.push_back(optimizer.label);
  }
  return {{"name", plan.name},
          {"title", sanitize(plan.title)},
          {"problems", problems},
          {"optimizers", optimizers},
          {"replicates", plan.replicates},
          {"budget", plan.budget},
          {"cells", calc_cost(plan).cells}};
}

}  // namespace

ListKind make_study_kind(const std::string& program) {
  const auto explain = [program](const std::string& name, const Style& style) {
    return explain_study(name, style, program);
  };
  return {"studies", list_known_studies, explain, explain_study_as_json};
}

}  // namespace armwright
