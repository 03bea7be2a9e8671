#include "study/compare/optimizer_labels.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "optimizers/table/optimizer_table.hpp"
#include "study/compare/study_reader.hpp"

namespace armwright {
namespace {

bool has_label(const StudyPlan& plan, const std::string& label) {
  return std::ranges::find(plan.optimizers, label, &StudyOptimizer::label) != plan.optimizers.end();
}

// Returns a label that does not depend on the other optimizers. A plugin that calls itself as an
// optimizer of armwright does keeps the name that the user typed.
std::string make_label(const StudyOptimizer& optimizer) {
  const OptimizerRow& row = optimizer.row;
  const std::string& label = row.short_name.empty() ? row.name : row.short_name;
  const bool is_shipped = std::ranges::count(optimizer_names(), label) > 0;
  return is_shipped ? optimizer.name : label;
}

// Returns the label for the optimizer `one` of the plan, which has none.
std::string choose_label(const StudyPlan& plan, const StudyOptimizer& one) {
  const std::string label = make_label(one);
  const bool is_repeated = std::ranges::any_of(plan.optimizers, [&](const StudyOptimizer& other) {
    return &other != &one && !other.has_given_label && other.name == one.name;
  });
  std::string free = label;
  for (int number = 2; !is_repeated && label != one.name && has_label(plan, free); ++number) {
    free = fmt::format("{}#{}", label, number);
  }
  return free;
}

}  // namespace

void choose_labels(StudyPlan& plan) {
  for (StudyOptimizer& optimizer : plan.optimizers) {
    if (optimizer.label.empty()) {
      optimizer.label = choose_label(plan, optimizer);
    }
  }
  const auto named = std::ranges::find(plan.optimizers, plan.reference, &StudyOptimizer::name);
  if (!has_label(plan, plan.reference) && named != plan.optimizers.end()) {
    plan.reference = named->label;
  }
}

void adopt_labels(const std::filesystem::path& recorded, StudyPlan& plan) {
  const auto reference = std::ranges::find(plan.optimizers, plan.reference, &StudyOptimizer::label);
  for (StudyOptimizer& optimizer : plan.optimizers) {
    optimizer.label = optimizer.has_given_label ? optimizer.label : "";
  }
  const std::vector<NamedOptimizer> known = read_recorded_optimizers(recorded);
  for (StudyOptimizer& optimizer : plan.optimizers) {
    const auto same = std::ranges::find_if(known, [&](const NamedOptimizer& one) {
      return one.name == optimizer.name && !has_label(plan, one.label);
    });
    if (optimizer.label.empty() && same != known.end()) {
      optimizer.label = same->label;
    }
  }
  choose_labels(plan);
  if (reference != plan.optimizers.end()) {
    plan.reference = reference->label;
  }
}

}  // namespace armwright
