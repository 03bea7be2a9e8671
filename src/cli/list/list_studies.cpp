// `armwright list studies`.

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/text.hpp"
#include "cli/list/list_views.hpp"
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

std::string explain_study(const std::string& name, const Style& style) {
  const StudyPlan plan = load_study(name);
  return format_title(style, plan.name, plan.title) + describe_plan(plan) +
         describe_cost(plan, 0, 1);
}

json explain_study_as_json(const std::string& name) {
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

ListKind make_study_kind() {
  return {"studies", list_known_studies, explain_study, explain_study_as_json};
}

}  // namespace armwright
