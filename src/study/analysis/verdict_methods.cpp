// The verdict's sentences on what the optimizers saw and did. Each names only what differs between
// the optimizers.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "study/analysis/method_facts.hpp"
#include "study/analysis/verdict.hpp"

namespace armwright {
namespace {

// A text and the names that it holds for.
using Group = std::pair<std::string, std::vector<std::string>>;

void add_to_group(std::vector<Group>& groups, const std::string& text, const std::string& name) {
  const auto found = std::ranges::find(groups, text, &Group::first);
  if (found == groups.end()) {
    groups.push_back({text, {name}});
  } else if (found->second.back() != name) {
    found->second.push_back(name);
  }
}

// Makes a sentence "On PROBLEMS TEXT." of every group.
std::vector<std::string> make_sentences(const std::vector<Group>& groups) {
  std::vector<std::string> sentences;
  for (const auto& [text, problems] : groups) {
    sentences.push_back(fmt::format("On {} {}.", join_names(problems), text));
  }
  return sentences;
}

// Returns "ga and cmaes have the schedule fresh:1, the others fixed:5"; empty if all have the same.
std::string describe_schedules(const StudyPlan& plan, std::span<const MethodFacts> facts) {
  std::vector<Group> groups;
  for (std::size_t o = 0; o < facts.size(); ++o) {
    add_to_group(groups, to_text(facts[o].schedule), plan.optimizers[o].label);
  }
  if (groups.size() < 2) {
    return "";
  }
  const auto largest =
      std::ranges::max_element(groups, {}, [](const Group& group) { return group.second.size(); });
  std::string text;
  for (const Group& group : groups) {
    if (&group != &*largest) {
      const char* verb = group.second.size() == 1 ? "has" : "have";
      text += fmt::format("{} {} the schedule {}, ", join_names(group.second), verb, group.first);
    }
  }
  return largest->second.size() == 1
             ? fmt::format("{}{} {}", text, largest->second.front(), largest->first)
             : fmt::format("{}the others {}", text, largest->first);
}

// Returns what optimizers with residuals see; empty if all optimizers see the same.
std::string describe_residuals(const StudyPlan& plan, std::span<const MethodFacts> facts) {
  std::vector<Group> groups;
  for (std::size_t o = 0; o < facts.size(); ++o) {
    const std::string seen =
        facts[o].residuals == 0
            ? ""
            : fmt::format("{} residuals per evaluation{}", facts[o].residuals,
                          facts[o].has_jacobian ? " and their exact derivatives" : "");
    add_to_group(groups, seen, plan.optimizers[o].label);
  }
  if (groups.size() < 2) {
    return "";
  }
  std::string text;
  bool some_see_less = false;
  for (const auto& [seen, labels] : groups) {
    if (seen.empty()) {
      some_see_less = true;
      continue;
    }
    text += fmt::format("{}{} {} {}", text.empty() ? "" : ", ", join_names(labels),
                        labels.size() == 1 ? "sees" : "see", seen);
  }
  return text + (some_see_less ? "; the others see only the objective" : "");
}

const char* explain_end(const std::string& end_reason) {
  return end_reason == "optimizer failed" ? "it failed" : "it ended by itself";
}

// Returns which optimizers left at least 1 % of their budget; empty if none did.
std::string describe_unused_budget(const StudyPlan& plan, std::span<const MethodFacts> facts) {
  std::vector<std::string> parts;
  for (std::size_t o = 0; o < facts.size(); ++o) {
    const MethodFacts& one = facts[o];
    if (one.early_runs == 0 || plan.optimizers[o].row.name == kStartBaseline) {
      continue;
    }
    std::vector<std::string> reasons;
    for (const std::string& reason : one.early_reasons) {
      reasons.emplace_back(explain_end(reason));
    }
    const std::string cases =
        one.early_fewest_cases == one.early_most_cases
            ? fmt::format("{}", one.early_most_cases)
            : fmt::format("{} to {}", one.early_fewest_cases, one.early_most_cases);
    parts.push_back(fmt::format("{} stopped after {} of {} simulations in {} of {} runs ({})",
                                plan.optimizers[o].label, cases, plan.budget, one.early_runs,
                                one.runs, join_names(reasons)));
  }
  return join_names(parts);
}

// The median number of judged candidates of an optimizer's runs on a problem.
struct Judged {
  double count = 0;
  std::string optimizer, problem;
};

// Adds the numbers of a problem if they differ between the optimizers.
void add_judged(const StudyPlan& plan, const std::string& problem,
                std::span<const MethodFacts> facts, std::vector<Judged>& judged) {
  std::vector<Judged> here;
  for (std::size_t o = 0; o < facts.size(); ++o) {
    if (facts[o].judged) {
      here.push_back({*facts[o].judged, plan.optimizers[o].label, problem});
    }
  }
  const auto differs = [&](const Judged& one) { return one.count != here.front().count; };
  if (std::ranges::any_of(here, differs)) {
    judged.insert(judged.end(), here.begin(), here.end());
  }
}

// Returns the sentence on the fewest and the most judged candidates per run.
std::string describe_judged(std::span<const Judged> judged, bool has_problems) {
  const auto [fewest, most] = std::ranges::minmax_element(judged, {}, &Judged::count);
  const auto name = [&](const Judged& one) {
    return has_problems ? fmt::format("{} on {}", one.optimizer, one.problem) : one.optimizer;
  };
  return fmt::format(
      "Between {:g} ({}) and {:g} ({}) candidates of a run were judged on the validation set, in "
      "the "
      "median.",
      fewest->count, name(*fewest), most->count, name(*most));
}

}  // namespace

std::vector<std::string> describe_methods(const StudyPlan& plan, const StudyResult& result) {
  std::vector<Group> schedules, residuals, unused, tuned;
  std::vector<Judged> judged;
  for (const ProblemResult& problem : result.problems) {
    const auto facts = calc_method_facts(plan, problem.label, result.cells);
    if (const std::string text = describe_schedules(plan, facts); !text.empty()) {
      add_to_group(schedules, text, problem.label);
    }
    if (const std::string text = describe_residuals(plan, facts); !text.empty()) {
      add_to_group(residuals, text, problem.label);
    }
    if (const std::string text = describe_unused_budget(plan, facts); !text.empty()) {
      add_to_group(unused, text, problem.label);
    }
    add_judged(plan, problem.label, facts, judged);
    for (std::size_t o = 0; o < facts.size(); ++o) {
      if (facts[o].is_tuned_here) {
        add_to_group(tuned, plan.optimizers[o].label, problem.label);
      }
    }
  }
  std::vector<std::string> sentences = make_sentences(schedules);
  for (const std::vector<std::string>& more : {make_sentences(residuals), make_sentences(unused)}) {
    sentences.insert(sentences.end(), more.begin(), more.end());
  }
  if (!judged.empty()) {
    sentences.push_back(describe_judged(judged, result.problems.size() > 1));
  }
  for (const auto& [label, problems] : tuned) {
    sentences.push_back(fmt::format("Default settings of {} were chosen on {} of this study: {}.",
                                    label, problems.size() == 1 ? "a problem" : "problems",
                                    join_names(problems)));
  }
  return sentences;
}

}  // namespace armwright
