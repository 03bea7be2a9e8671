// Makes the page of a study.

#include <fmt/format.h>

#include <algorithm>

#include "base/text.hpp"
#include "report/evidence/page_json.hpp"
#include "report/page/page_data.hpp"
#include "report/page/page_file.hpp"
#include "report/page/progress_meter.hpp"
#include "report/page/study_parts.hpp"
#include "study/analysis/final_check.hpp"
#include "study/analysis/verdict.hpp"
#include "study/compare/study_folder.hpp"
#include "study/statistics/power.hpp"

namespace armwright {
namespace {

using nlohmann::json;

std::string count(std::size_t number, std::string_view what) {
  return fmt::format("{} {}{}", number, what, number == 1 ? "" : "s");
}

json make_optimizers(const StudyPlan& plan) {
  json list = json::array();
  for (const StudyOptimizer& optimizer : plan.optimizers) {
    list.push_back({{"label", optimizer.label}, {"name", optimizer.row.name}});
  }
  return list;
}

// Returns the smallest number of replicates with which a pair of optimizers can be decided; null if
// there is no pair.
json find_fewest_replicates(const StudyPlan& plan) {
  const std::size_t pairs = plan.optimizers.size() * (plan.optimizers.size() - 1) / 2;
  return pairs > 0 ? json(find_fewest_pairs(pairs)) : json(nullptr);
}

json make_problems(const StudyPlan& plan, const StudyResult& result,
                   const std::filesystem::path& folder) {
  json list = json::array();
  std::span<const CellOutcome> rest = result.cells;
  for (std::size_t p = 0; p < plan.problems.size(); ++p) {
    const auto missing = std::ranges::count(result.missing, p, &Cell::problem);
    const std::size_t cells = plan.optimizers.size() * static_cast<std::size_t>(plan.replicates) -
                              static_cast<std::size_t>(missing);
    list.push_back(make_study_problem(plan, p, rest.first(cells), result.problems[p], folder));
    rest = rest.subspan(cells);
  }
  return list;
}

}  // namespace

std::optional<std::string> make_study_page(const std::filesystem::path& folder,
                                           const PageOptions& options, StopSignal& stop,
                                           RunObserver& observer) {
  const StudyPlan plan = load_study_plan(folder);
  if (stop.requested()) {
    return std::nullopt;
  }
  StudyResult result = analyze_study(plan, folder, MissingCells::left_out);
  load_final_checks(plan, folder, result);
  if (stop.requested()) {
    return std::nullopt;
  }
  const std::size_t total = list_cells(plan).size();
  const bool finished = result.missing.empty();
  std::vector<std::string> notes;
  const std::vector<std::string> again = {"armwright", "compare", (folder / "study.toml").string(),
                                          "--out", folder.string()};
  json page = {
      {"format", kPageFormat},
      {"kind", "study"},
      {"title", plan.title.empty() ? plan.name : plan.title},
      {"subtitle",
       fmt::format("{}, {}, {} each, a budget of {} simulated cases",
                   count(plan.problems.size(), "problem"),
                   count(plan.optimizers.size(), "optimizer"),
                   count(static_cast<std::size_t>(plan.replicates), "replicate"), plan.budget)},
      {"program", make_program()},
      {"folder", folder.string()},
      {"command", quote_command(again)},
      {"finished", finished},
      {"progress",
       finished
           ? json(nullptr)
           : json{{"done", total - result.missing.size()}, {"total", total}, {"unit", "cells"}}},
      {"watched", options.meter == nullptr
                      ? json(nullptr)
                      : options.meter->observe_study(plan, result.cells, folder)},
      {"facts", make_study_facts(plan)},
      {"robots", json::array()},
      {"replays", json::array()},
      {"verdict", describe_verdict(plan, result)},
      {"optimizers", make_optimizers(plan)},
      {"replicates", plan.replicates},
      {"fewest_replicates", find_fewest_replicates(plan)},
      {"reference", sanitize(plan.reference)},
      {"budget", plan.budget},
      {"problems", make_problems(plan, result, folder)},
      {"overall", make_study_overall(plan, result, notes)}};
  if (!finished) {
    notes.insert(notes.begin(),
                 fmt::format("{} of {} cells have not ended: all numbers are of those that have, "
                             "and problems that lack cells have no ranks and no tests.",
                             result.missing.size(), total));
  }
  const bool has_arm = std::ranges::any_of(plan.problems, [](const StudyProblem& problem) {
    return problem.loaded.tracking() != nullptr;
  });
  if (has_arm && !options.simulate) {
    notes.emplace_back("Nothing was simulated for this page, so there is no replay.");
  } else if (has_arm) {
    PageSimulator simulator(options.jobs, stop, observer);
    try {
      page["replays"] =
          make_study_replays(plan, result, folder, options.cases, simulator, page["robots"], notes);
    } catch (const WorkStopped&) {
      return std::nullopt;
    }
  }
  page["notes"] = notes;
  return dump_page(page);
}

}  // namespace armwright
