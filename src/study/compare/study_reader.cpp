#include "study/compare/study_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "base/read_limit.hpp"
#include "base/text.hpp"
#include "problems/config/config_files.hpp"
#include "problems/config/problem_loader.hpp"
#include "study/compare/study_methods.hpp"

namespace armwright {
namespace {

constexpr Range kBudgetRange{.lower = 1, .upper = 1e12};
constexpr Range kSelectedRange{.lower = 0, .upper = 10'000};

const Setting<std::string> kStudyTitle{"title", "", "one line, for lists and reports"};
const Setting<std::string> kStudyDescription{"description", "", "some lines more"};
const Setting<std::string> kStudyName{"name", "",
                                      "name of the study's folder (default: the file's name)"};
const Setting<std::vector<std::string>> kStudyProblems{
    "problems", kNoDefault, "names of problems, in place of [[problem]]"};
const Setting<std::vector<std::string>> kStudyOptimizers{
    "optimizers", kNoDefault, "names of optimizers, in place of [[optimizer]]"};
const Setting<std::vector<std::string>> kStudySet{"set", kNoDefault,
                                                  "changes to every problem, a list of KEY=VALUE"};
const Setting<std::int64_t> kStudyBudget{
    "budget", kBudgetRange, 0,
    "training cases that every run may simulate; required, here or by --budget"};
const Setting<int> kStudyReplicates{"replicates",
                                    {.lower = 1, .upper = 10'000},
                                    StudyPlan{}.replicates,
                                    "runs of every optimizer on every problem"};
const Setting<std::int64_t> kStudySeed{
    "seed",
    {.lower = 0},
    1,
    "seed of the study, for starts, training cases and the optimizers' streams"};
const Setting<std::string> kStudySchedule{
    "schedule", kNoDefault,
    "training cases: fixed:K, fresh:K, coevolution:K or growing:K:FACTOR for all optimizers, or "
    "own (fresh:1 for "
    "optimizers with generations, fixed:5 for the others; default: fixed, with the problem's K)"};
const Setting<double> kStudyStartSpread{
    "start_spread",
    {.lower = 0, .upper = 2},
    StudyPlan{}.start_spread,
    "width of the box that starts are drawn from, as a share of the bounds"};
const Setting<bool> kStudyBaselines{
    "baselines", StudyPlan{}.baselines,
    "whether the start, random search and a local search are added to the optimizers"};
const Setting<int> kStudyCheckpoints{
    "checkpoints",
    {.lower = 1, .upper = 1000},
    StudyPlan{}.checkpoints,
    "number of budgets, logarithmically spaced, at which incumbents are tested"};
const Setting<std::int64_t> kStudyFirstCheckpoint{"first_checkpoint", kBudgetRange,
                                                  StudyPlan{}.first_checkpoint,
                                                  "the smallest of these budgets, in cases"};
const Setting<double> kStudyTolerance{
    "constraint_tolerance",
    {.lower = 0, .upper = 1},
    StudyPlan{}.constraint_tolerance,
    "constraint violation that is allowed on validation and test sets"};
const Setting<std::string> kStudyFinalEngine{
    "final_engine", "",
    "engine that simulates the best designs once more; empty: they are not simulated again"};
const Setting<std::string> kStudyValue{
    "value", one_of({"objective", "failures"}),  // in the order of StudyValue
    "objective",
    "value of a run: the winner's objective on the test set, or the share of test cases in which "
    "the winner fails"};
const Setting<std::string> kStudyReference{
    "reference", "",
    "label of the optimizer whose running times to targets divide those of the others; empty: "
    "none"};
const Setting<std::string> kStudyPlanHash{
    "plan_sha256", "", "in a resolved plan: SHA-256 of the text below this line"};

const Setting<int> kSelectionLast{"last",
                                  {.lower = 1, .upper = kSelectedRange.upper},
                                  StudyPlan{}.selection.last,
                                  "the last N incumbents are judged on the validation set"};
const Setting<int> kSelectionBest{
    "best", kSelectedRange, StudyPlan{}.selection.best,
    "the N candidates with the best training objective are judged on it too"};
const Setting<int> kSelectionMost{
    "most",
    {.lower = 1, .upper = 2 * kSelectedRange.upper},
    StudyPlan{}.selection.most,
    "at most N candidates per run are judged, recommendations of the optimizer included (default "
    "with last or best: their sum)"};
const Setting<bool> kSelectionAlong{
    "along", StudyPlan{}.judge_along,
    "whether the candidates of all checkpoints are judged, not only those of the end"};
const SettingTable kSelectionSettings{
    .key = "selection",
    .settings = {&kSelectionLast, &kSelectionBest, &kSelectionMost, &kSelectionAlong}};

const Setting<std::string> kProblemEntryName{"name", kNoDefault, "a shipped problem or a file"};
const Setting<std::string> kProblemEntryLabel{
    "label", "", "name of the problem in tables and folders (default: its name)"};
const Setting<std::vector<std::string>> kProblemEntrySet{
    "set", kNoDefault, "changes to this problem, a list of KEY=VALUE"};
const Setting<std::string> kProblemEntrySchedule{"schedule", kNoDefault,
                                                 "schedule of this problem, or own"};
const Setting<std::string> kProblemEntryHash{
    "configuration_sha256", "",
    "in a resolved plan: SHA-256 of the problem's configuration when the plan was made"};
const Setting<std::string> kProblemEntryTraining{
    "training_set", "", "in a resolved plan: the training set, for the reader"};
const Setting<std::string> kProblemEntryValidation{
    "validation_set", "", "in a resolved plan: the validation set, for the reader"};
const Setting<std::string> kProblemEntryTest{"test_set", "",
                                             "in a resolved plan: the test set, for the reader"};
const Setting<std::vector<std::string>> kProblemEntryInputs{
    "inputs", kNoDefault, "in a resolved plan: hashes of the files of a problem's program"};
const SettingTable kProblemEntrySettings{
    .key = "problem",
    .is_array = true,
    .settings = {&kProblemEntryName, &kProblemEntryLabel, &kProblemEntrySet, &kProblemEntrySchedule,
                 &kProblemEntryHash, &kProblemEntryTraining, &kProblemEntryValidation,
                 &kProblemEntryTest, &kProblemEntryInputs}};

const Setting<std::string> kOptimizerEntryName{"name", kNoDefault, "optimizer, as --optimizer"};
const Setting<std::string> kOptimizerEntryLabel{
    "label", "",
    "name of the optimizer in tables and folders (default: its name, of a plugin the name that it "
    "gives itself)"};
const Setting<std::vector<std::string>> kOptimizerEntryOptions{
    "options", kNoDefault, "options of the optimizer, a list of KEY=VALUE"};
const Setting<std::string> kOptimizerEntrySchedule{
    "schedule", kNoDefault, "schedule of this optimizer, which becomes a method of its own"};
const Setting<std::vector<std::string>> kOptimizerEntrySet{
    "set", kNoDefault,
    "changes to the problems for this optimizer, a list of KEY=VALUE of [racing], [schedule], "
    "[perturbation] or control.controller; it becomes a method of its own"};
const Setting<bool> kOptimizerEntryBaseline{
    "baseline", false, "in a resolved plan: the optimizer was added as a baseline"};
const Setting<std::string> kOptimizerEntryDescription{
    "description", "", "in a resolved plan: description of a plugin or of an optimizer in Python"};
const Setting<std::vector<std::string>> kOptimizerEntryInputs{
    "inputs", kNoDefault, "in a resolved plan: hashes of a plugin's files"};
const Setting<std::string> kOptimizerEntryOwnSchedule{
    "own_schedule", kNoDefault,
    "in a resolved plan: schedule of this optimizer on problems whose schedule is own"};
const Setting<std::string> kOptimizerEntryStream{
    "stream", "", "in a resolved plan: name of the optimizer's random streams"};
const SettingTable kOptimizerEntrySettings{
    .key = "optimizer",
    .is_array = true,
    .settings = {&kOptimizerEntryName, &kOptimizerEntryLabel, &kOptimizerEntryOptions,
                 &kOptimizerEntrySchedule, &kOptimizerEntrySet, &kOptimizerEntryBaseline,
                 &kOptimizerEntryDescription, &kOptimizerEntryInputs, &kOptimizerEntryOwnSchedule,
                 &kOptimizerEntryStream}};

const Setting<std::string> kTargetLabel{"label", kNoDefault, "name of a fixed target in tables"};
const Setting<std::vector<std::string>> kTargetProblems{
    "problems", kNoDefault, "labels of the problems that it holds for (default: all)"};
const Setting<double> kTargetValue{"value", kNoDefault, "largest objective on the test set"};
const Setting<std::int64_t> kTargetFailures{"failures",
                                            {.lower = 0, .upper = 1'000'000},
                                            kNoDefault,
                                            "largest number of failing test cases"};
const SettingTable kTargetSettings{
    .key = "target",
    .is_array = true,
    .settings = {&kTargetLabel, &kTargetProblems, &kTargetValue, &kTargetFailures}};

std::optional<Schedule> read_schedule_key(const ConfigTable& table,
                                          const Setting<std::string>& setting) {
  const auto text = table.find(setting);
  if (!text) {
    return std::nullopt;
  }
  const auto schedule = read_schedule(*text);
  if (!schedule) {
    table.refuse(setting, fmt::format("it must be {}", kScheduleForms));
  }
  return schedule;
}

std::optional<StudySchedule> read_study_schedule_key(const ConfigTable& table,
                                                     const Setting<std::string>& setting) {
  const auto text = table.find(setting);
  if (!text) {
    return std::nullopt;
  }
  const auto schedule = read_study_schedule(*text);
  if (!schedule) {
    table.refuse(setting, "it must be " + describe_study_schedules());
  }
  return schedule;
}

// Refuses keys that would give one optimizer more than another.
void refuse_privileges(const ConfigTable& table) {
  for (const char* key : {"budget", "replicates", "seed", "start_spread", "sets"}) {
    if (table.has(key)) {
      table.refuse(key,
                   "it is the same for every optimizer of a comparison: it belongs to the top "
                   "of the file");
    }
  }
}

void read_targets(const ConfigTable& table, StudyPlan& plan) {
  plan.value = static_cast<StudyValue>(table.get_choice(kStudyValue));
  plan.reference = table.get(kStudyReference);
  for (const ConfigTable& one : table.get_tables_or_empty(kTargetSettings)) {
    StudyTarget target;
    target.label = one.get(kTargetLabel);
    target.problems = one.get_or(kTargetProblems, {});
    target.value = one.find(kTargetValue);
    target.failures = one.find(kTargetFailures);
    if (!target.value && !target.failures) {
      one.refuse(kTargetLabel,
                 "it must have a value (the objective on the test set at most), failures (the most "
                 "test cases with an error above 100 mm), or both");
    }
    plan.targets.push_back(std::move(target));
  }
}

NamedProblem read_problem_entry(const ConfigTable& table) {
  NamedProblem problem{.name = table.get(kProblemEntryName),
                       .label = table.get(kProblemEntryLabel),
                       .settings = table.get_or(kProblemEntrySet, {}),
                       .schedule = read_study_schedule_key(table, kProblemEntrySchedule),
                       .configuration_sha256 = table.get(kProblemEntryHash),
                       .inputs = table.get_or(kProblemEntryInputs, {}),
                       .place = table.describe_place(kProblemEntryName)};
  for (const auto* set : {&kProblemEntryTraining, &kProblemEntryValidation, &kProblemEntryTest}) {
    table.get(*set);  // the rest of the plan determines them
  }
  return problem;
}

NamedOptimizer read_optimizer_entry(const ConfigTable& table) {
  refuse_privileges(table);
  NamedOptimizer optimizer{.name = table.get(kOptimizerEntryName),
                           .label = table.get(kOptimizerEntryLabel),
                           .options = table.get_or(kOptimizerEntryOptions, {}),
                           .baseline = table.get(kOptimizerEntryBaseline),
                           .schedule = read_schedule_key(table, kOptimizerEntrySchedule),
                           .settings = table.get_or(kOptimizerEntrySet, {})};
  check_method_settings(table, kOptimizerEntrySet, optimizer.settings);
  optimizer.description = table.get(kOptimizerEntryDescription);
  optimizer.inputs = table.get_or(kOptimizerEntryInputs, {});
  optimizer.own_schedule = read_schedule_key(table, kOptimizerEntryOwnSchedule);
  optimizer.stream = table.get(kOptimizerEntryStream);
  optimizer.place = table.describe_place(kOptimizerEntryName);
  return optimizer;
}

Selection read_selection(const ConfigTable& table) {
  Selection selection{.last = table.get(kSelectionLast), .best = table.get(kSelectionBest)};
  selection.most = table.get(kSelectionMost);
  if (!table.has(kSelectionMost) && (table.has(kSelectionLast) || table.has(kSelectionBest))) {
    selection.most = selection.last + selection.best;
  }
  return selection;
}

}  // namespace

const SettingTable& study_settings() {
  static const SettingTable settings{
      .key = "",
      .settings = {&kStudyTitle, &kStudyDescription, &kStudyName, &kStudyProblems,
                   &kStudyOptimizers, &kStudySet, &kStudyBudget, &kStudyReplicates, &kStudySeed,
                   &kStudySchedule, &kStudyStartSpread, &kStudyBaselines, &kStudyCheckpoints,
                   &kStudyFirstCheckpoint, &kStudyTolerance, &kStudyFinalEngine, &kStudyValue,
                   &kStudyReference, &kStudyPlanHash},
      .tables = {&kSelectionSettings, &kProblemEntrySettings, &kOptimizerEntrySettings,
                 &kTargetSettings},
      .listed_as = "study:"};
  return settings;
}

RawPlan read_study_file(const std::filesystem::path& file, StudyPlan& plan) {
  const ConfigTable table = ConfigTable::load(study_settings(), file);
  RawPlan raw;
  plan.title = table.get(kStudyTitle);
  table.get(kStudyDescription);
  plan.name = table.get(kStudyName);
  // check_plan_hash() compares it with the text.
  raw.is_recorded = !table.get(kStudyPlanHash).empty();
  plan.seed = static_cast<std::uint64_t>(table.get(kStudySeed));
  plan.replicates = table.get(kStudyReplicates);
  plan.budget = table.get(kStudyBudget);
  plan.start_spread = table.get(kStudyStartSpread);
  plan.checkpoints = table.get(kStudyCheckpoints);
  plan.first_checkpoint = table.get(kStudyFirstCheckpoint);
  plan.constraint_tolerance = table.get(kStudyTolerance);
  plan.final_engine = table.get(kStudyFinalEngine);
  plan.baselines = table.get(kStudyBaselines);
  const ConfigTable selection = table.get_table_or_empty(kSelectionSettings);
  if (raw.is_recorded && !selection.has(kSelectionMost)) {
    throw Error(
        ErrorKind::usage,
        fmt::format("{}: version 1.0 of armwright recorded this plan, and this version reads "
                    "none of its studies; use version 1.0 for it, or begin a new study",
                    sanitize(file.string())));
  }
  plan.selection = read_selection(selection);
  plan.judge_along = selection.get(kSelectionAlong);
  read_targets(table, plan);
  raw.schedule = read_study_schedule_key(table, kStudySchedule);
  raw.settings = table.get_or(kStudySet, {});
  for (const std::string& name : table.get_or(kStudyProblems, {})) {
    raw.problems.push_back(
        {.name = name, .place = table.describe_place(kStudyProblems, raw.problems.size())});
  }
  for (const ConfigTable& problem : table.get_tables_or_empty(kProblemEntrySettings)) {
    raw.problems.push_back(read_problem_entry(problem));
  }
  for (const std::string& name : table.get_or(kStudyOptimizers, {})) {
    raw.optimizers.push_back(
        {.name = name, .place = table.describe_place(kStudyOptimizers, raw.optimizers.size())});
  }
  for (const ConfigTable& optimizer : table.get_tables_or_empty(kOptimizerEntrySettings)) {
    raw.optimizers.push_back(read_optimizer_entry(optimizer));
  }
  table.refuse_unknown();
  return raw;
}

std::map<std::string, std::string> read_inputs(std::span<const std::string> inputs) {
  std::map<std::string, std::string> hashes;
  for (const std::string& input : inputs) {
    const std::size_t blank = std::min(input.rfind(' '), input.size());
    hashes[input.substr(0, blank)] = input.substr(std::min(blank + 1, input.size()));
  }
  return hashes;
}

std::vector<NamedOptimizer> read_recorded_optimizers(const std::filesystem::path& file) {
  std::vector<NamedOptimizer> optimizers;
  const ConfigTable plan = ConfigTable::load(study_settings(), file);
  for (const ConfigTable& table : plan.get_tables_or_empty(kOptimizerEntrySettings)) {
    optimizers.push_back(read_optimizer_entry(table));
  }
  return optimizers;
}

std::string read_study_title(const std::string& file) {
  const ReadStep step(fmt::format("the study '{}'", sanitize(file)));
  return ConfigTable::load(study_settings(), resolve_config("studies", file)).get(kStudyTitle);
}

StudyOutline read_study_outline(const std::string& file) {
  const ReadStep step(fmt::format("the study '{}'", sanitize(file)));
  const auto path = resolve_config("studies", file);
  StudyPlan plan;
  const RawPlan raw = read_study_file(path, plan);
  StudyOutline outline{.name = plan.name.empty() ? path.stem().string() : plan.name,
                       .title = plan.title,
                       .replicates = plan.replicates,
                       .budget = plan.budget};
  const auto get_label = [](const auto& one) { return one.label.empty() ? one.name : one.label; };
  std::ranges::transform(raw.problems, std::back_inserter(outline.problems), get_label);
  std::ranges::transform(raw.optimizers, std::back_inserter(outline.optimizers), get_label);
  outline.needs_programs = std::ranges::any_of(raw.problems, [&](const NamedProblem& problem) {
    std::vector<std::string> settings = raw.settings;
    settings.insert(settings.end(), problem.settings.begin(), problem.settings.end());
    return needs_program(problem.name, settings);
  });
  return outline;
}

}  // namespace armwright
