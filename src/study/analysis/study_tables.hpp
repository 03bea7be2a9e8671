// A study's tables, for people and other programs: tables/*.csv, result.json and verdict.txt. All
// derived from the cells; the same cells give the same bytes.
//
//   cells.csv              every run: values and errors on the test set, counts
//   metrics.csv            of every winner, on the test set: objectives, torque, energy, ...
//   best.csv               the same of every optimizer's best run by the validation set
//   summary.csv            problem x optimizer: medians, quartiles, intervals, failures, ranks
//   pairs.csv              every two optimizers: Wilcoxon, Holm, A12, wins
//   friedman.csv           do optimizers differ at all
//   running_times.csv      expected running time to targets
//   targets.csv            to fixed targets: successes, expected running times, ratios
//   choices.csv            with fixed targets: what the design chosen by then is worth, every run
//   failures.csv, failure_pairs.csv   of arms: shares of failing test cases, and every two compared
//   curves.csv             value on the test set over the budget
//   ecdf.csv               share of (run, target) pairs reached over the budget
//   data_profiles.csv, performance_profiles.csv
//   ranking.csv            mean ranks over problems, and with one problem left out
//   fronts.csv, attainment.csv   of several objectives
//   sets.csv               every set of test cases with its content's hash
#pragma once

#include <filesystem>

#include "study/analysis/study_result.hpp"

namespace armwright {

// result.json last: its presence says that the rest is there.
void write_study_tables(const StudyPlan& plan, const StudyResult& result,
                        const std::filesystem::path& study);

// The same as result.json.
std::string to_json(const StudyPlan& plan, const StudyResult& result);

}  // namespace armwright
