// What each optimizer of a study saw and did, beside its values: schedule, residuals, judged
// candidates, unused budget. The verdict names what differs between optimizers (verdict_methods.cpp).
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "study/compare/cell.hpp"
#include "study/compare/study_plan.hpp"

namespace armwright {

// One optimizer on one problem.
struct MethodFacts {
  Schedule schedule;
  // The number of residuals of an evaluation, if the optimizer uses them; 0 if it sees only
  // objectives and constraints. Exact if all cases have the same number.
  std::size_t residuals = 0;
  bool has_jacobian = false;     // it also gets the exact derivatives of the residuals
  std::optional<double> judged;  // candidates judged per run, median; empty if not known
  int runs = 0;                  // that have ended
  // The runs that the optimizer ended although it could have simulated at least 1 % of the budget.
  int early_runs = 0;
  std::uint64_t early_fewest_cases = 0;
  std::uint64_t early_most_cases = 0;
  std::set<std::string> early_reasons;  // CellOutcome::end_reason
  bool is_tuned_here = false;           // OptimizerRow::tuned_on has this problem
};

// Returns the facts of all optimizers on the problem with this label, in the plan's order. `cells`
// may hold cells of other problems too. Simulates up to three training cases per optimizer that uses
// residuals.
std::vector<MethodFacts> calc_method_facts(const StudyPlan& plan, std::string_view problem,
                                           std::span<const CellOutcome> cells);

// The columns of a CSV table with these facts, and the fields of one row.
inline constexpr std::string_view kMethodColumns =
    "schedule,residuals,exact_jacobian,median_judged,early_runs,early_fewest_cases,"
    "early_most_cases,early_reasons,tuned_on_problem";
std::string make_method_fields(const MethodFacts& facts);
// The same facts in result.json.
nlohmann::json method_to_json(const MethodFacts& facts);

}  // namespace armwright
