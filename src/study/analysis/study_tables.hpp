// Writes a study's tables for people and other programs: tables/*.csv, result.json and verdict.txt.
// All of them are derived from the cells; the same cells give the same bytes.
//
//   cells.csv              every run: values and errors on the test set, counts
//   metrics.csv            every winner on the test set: objectives, torque, energy, ...
//   best.csv               the same for every optimizer's best run on the validation set
//   summary.csv            problem x optimizer: medians, quartiles, intervals, failures, ranks,
//                          and what the optimizer saw and did (method_facts.hpp)
//   pairs.csv              every two optimizers: Wilcoxon, Holm, A12, wins
//   friedman.csv           test whether the optimizers differ at all
//   running_times.csv      expected running times to targets
//   targets.csv            fixed targets: successes, expected running times, ratios
//   choices.csv            only with fixed targets: the test value of the design chosen at each
//                          checkpoint, for every run
//   failures.csv           only for arms: shares of failing test cases
//   failure_pairs.csv      only for arms: every two optimizers compared by these shares
//   curves.csv             value on the test set over the budget
//   ecdf.csv               share of (run, target) pairs reached over the budget
//   data_profiles.csv, performance_profiles.csv
//   ranking.csv            mean ranks over all problems, and with one problem left out
//   fronts.csv, attainment.csv, indicators.csv   only for several objectives
//   sets.csv               every set of test cases with the hash of its content
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "study/analysis/study_result.hpp"

namespace armwright {

// Writes all files. Writes result.json last, so its presence shows that the others are complete.
// Then covers all files of the study with checksums. Throws Error{io}.
void write_study_tables(const StudyPlan& plan, const StudyResult& result,
                        const std::filesystem::path& study);

// Returns the text of result.json.
std::string to_json(const StudyPlan& plan, const StudyResult& result);

// Internal to study/analysis: the tables of fixed targets and failing test cases, and their parts
// of result.json.
// Has one row per problem, target and optimizer: successes, expected running time, ratio to the
// reference.
std::string make_targets_table(const StudyPlan& plan, const StudyResult& result);
// Has one row per run and checkpoint: the test value of the design chosen at that checkpoint.
std::string make_choices_table(const StudyResult& result);
// Has one row per problem and optimizer: shares of failing test cases.
std::string make_failures_table(const StudyPlan& plan, const StudyResult& result);
nlohmann::json target_times_to_json(const StudyPlan& plan, const ProblemResult& problem,
                                    const OptimizerResult& one);
nlohmann::json failures_to_json(const OptimizerResult& one);

}  // namespace armwright
