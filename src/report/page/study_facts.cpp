// Describes a study's plan.
#include <fmt/format.h>

#include <algorithm>

#include "base/text.hpp"
#include "report/evidence/page_json.hpp"
#include "report/page/study_parts.hpp"
#include "study/compare/study_folder.hpp"

namespace armwright {
namespace {

using nlohmann::json;

// Joins the texts that `describe` gives for the problems, in their order, each text once.
std::string join_different(const StudyPlan& plan, const auto& describe) {
  std::vector<std::string> texts;
  for (const StudyProblem& problem : plan.problems) {
    const std::string text = describe(problem);
    if (!text.empty() && std::ranges::find(texts, text) == texts.end()) {
      texts.push_back(text);
    }
  }
  return join(texts, ", ");
}

std::string describe_engine(const StudyProblem& problem) {
  if (!problem.loaded.tracking()) {
    return "";
  }
  const EnginePair& engines = problem.loaded.tracking()->config().engines;
  return engines.training_name == engines.judging_name
             ? engines.training_name
             : fmt::format("{} (judged on {})", engines.training_name, engines.judging_name);
}

std::string describe_optimizers(const StudyPlan& plan, bool baselines) {
  std::vector<std::string> texts;
  for (const StudyOptimizer& optimizer : plan.optimizers) {
    if (optimizer.baseline != baselines) {
      continue;
    }
    std::string text = optimizer.label;
    if (optimizer.label != optimizer.name) {
      text += " = " + optimizer.name;
    }
    if (!optimizer.options.empty() && optimizer.label != optimizer.name) {
      text += " (" + join(optimizer.options, ", ") + ")";
    }
    texts.push_back(text);
  }
  return join(texts, ", ");
}

}  // namespace

json make_study_facts(const StudyPlan& plan) {
  json facts = json::array();
  const auto add = [&](std::string_view label, const std::string& value) {
    if (!value.empty()) {
      facts.push_back(make_fact(label, sanitize(value)));
    }
  };
  for (const StudyProblem& problem : plan.problems) {
    const std::string title =
        problem.loaded.title.empty() ? problem.loaded.name : problem.loaded.title;
    const std::vector<std::string> chosen = list_chosen_settings(problem);
    const std::string settings = chosen.empty() ? "" : " (" + join(chosen, ", ") + ")";
    add("Problem " + sanitize(problem.label), title + settings);
  }
  add("Optimizers", describe_optimizers(plan, false));
  add("Baselines", plan.baselines ? describe_optimizers(plan, true) : "left out on request");
  add("Replicates", fmt::format("{} of every optimizer on every problem, paired: the start and the "
                                "training cases are the same for all",
                                plan.replicates));
  add("Budget", fmt::format("{} simulated training cases a run", plan.budget));
  add("Schedule", join_different(plan, [](const StudyProblem& problem) {
        return problem.own_schedules
                   ? fmt::format("own: {} for optimizers with generations, {} for the others",
                                 to_text(kOwnWithGenerations), to_text(kOwnWithoutGenerations))
                   : to_text(problem.schedule);
      }));
  add("Start", fmt::format("drawn from a box as wide as {} of the bounds, about the problem's own",
                           format_exact(plan.start_spread)));
  add("Engine", join_different(plan, describe_engine));
  const auto describe_set = [](const std::string& name, auto cases) {
    return fmt::format("{}: {} {}", name, cases, cases == 1 ? "case" : "cases");
  };
  add("Validation set", join_different(plan, [&](const StudyProblem& problem) {
        return describe_set(problem.loaded.sets.validation, problem.loaded.sets.validation_cases);
      }));
  add("Test set", join_different(plan, [&](const StudyProblem& problem) {
        return describe_set(problem.loaded.sets.test, problem.loaded.sets.test_cases);
      }));
  if (plan.constraint_tolerance > 0) {
    add("Constraint tolerance", format_exact(plan.constraint_tolerance));
  }
  add("Best designs again on", plan.final_engine);
  add("Seed", fmt::format("{}", plan.seed));
  add("Plan", calc_plan_hash(plan));
  return facts;
}

}  // namespace armwright
