#include "problems/config/problem_loader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
#include "base/read_limit.hpp"
#include "base/text.hpp"
#include "base/toml_text.hpp"
#include "problems/analytic/analytic.hpp"
#include "problems/config/config_files.hpp"
#include "problems/config/design_file.hpp"
#include "problems/config/problem_readers.hpp"

namespace armwright {
namespace {

constexpr std::size_t kInputLimit_bytes = std::size_t{8} << 20;

const Setting<std::string> kTitle{"title", kNoDefault,
                                  "one line, for lists and reports (default: the name)"};
const Setting<std::string> kDescription{"description", "", "some lines more"};
const Setting<std::string> kProblemKind{
    "kind",
    one_of({"tracking", "analytic", "program", "command", "external", "identification",
            "excitation", "motion"}),
    kNoDefault,
    "tracking: a robot follows a moving target; analytic: a function with a known optimum; "
    "program: a problem of your own that a program computes; command: one that a command line "
    "computes, case by case; external: one whose results you hand over (armwright ask); "
    "identification: a robot's parameters are found in recorded motions; excitation: a motion is "
    "found that tells them; motion: a motion through given points is planned"};
const Setting<std::string> kProblemName{
    "name", kNoDefault,
    "name of the problem and of its runs' folders (default: the file's name); {robot} in it stands "
    "for the name of the URDF file"};

const Setting<std::string> kSetsTraining{
    "training", CaseSets{}.training,
    "name of the training set, train/ID; another name has other cases"};
const Setting<std::string> kSetsValidation{"validation", CaseSets{}.validation,
                                           "name of the validation set, validation/ID"};
const Setting<std::string> kSetsTest{"test", CaseSets{}.test, "name of the test set, test/ID"};
const Setting<int> kSetsValidationCases{
    "validation_cases",
    {.lower = 1, .upper = kMostCases},
    CaseSets{}.validation_cases,
    "validation cases, on which the winner is chosen (for the kind analytic: 1)"};
const Setting<int> kSetsTestCases{
    "test_cases",
    {.lower = 1, .upper = kMostCases},
    CaseSets{}.test_cases,
    "test cases, on which the winner is judged (for the kind analytic: 1)"};
const SettingTable kSetsSettings{.key = "sets",
                                 .settings = {&kSetsTraining, &kSetsValidation, &kSetsTest,
                                              &kSetsValidationCases, &kSetsTestCases}};

const Setting<std::string> kRunOptimizer{"optimizer", "auto", "optimizer of armwright optimize"};
const Setting<std::int64_t> kRunBudget{"budget",
                                       {.lower = 0, .upper = 1e12},
                                       10000,
                                       "training cases that armwright optimize may simulate"};
const SettingTable kRunSettings{.key = "run", .settings = {&kRunOptimizer, &kRunBudget}};

const Setting<std::string> kSweepParameter{"parameter", kNoDefault,
                                           "setting that armwright sweep changes"};
const Setting<std::vector<double>> kSweepValues{
    "values", kNoDefault, "values of the setting, in the order of evaluation"};
const Setting<std::string> kSweepDesign{"design", kNoDefault, "design that is evaluated"};
const SettingTable kSweepSettings{.key = "sweep",
                                  .settings = {&kSweepParameter, &kSweepValues, &kSweepDesign}};

constexpr Range kAboveZero{.lower = 0, .lower_open = true};
const Setting<double> kWinnerError{"error_m", kAboveZero, kNoDefault,
                                   "error of the winner in the published source, for comparison"};
const Setting<double> kWinnerTorque{"total_torque_n_m", kAboveZero, kNoDefault,
                                    "total torque of that winner"};
const Setting<std::string> kWinnerDesign{"design", kNoDefault, "design file of that winner"};
const Setting<std::string> kWinnerWhere{"where", "",
                                        "table or page of the source with these numbers"};
const Setting<std::vector<std::string>> kWinnerSet{
    "set", std::vector<std::string>{},
    "settings, each KEY=VALUE, with which these numbers were found; results with other values of "
    "them are not shown beside these numbers"};
const SettingTable kWinnerSettings{
    .key = "published",
    .settings = {&kWinnerError, &kWinnerTorque, &kWinnerDesign, &kWinnerWhere, &kWinnerSet}};

const Setting<std::string> kFunctionName{"name", analytic_names, kNoDefault,
                                         "for the kind analytic: the function"};
const Setting<int> kFunctionDimension{
    "dimension",
    {.lower = static_cast<double>(AnalyticFunction{}.smallest_dimension),
     .upper = static_cast<double>(AnalyticFunction{}.largest_dimension)},
    AnalyticFunction{}.default_dimension,
    "for the kind analytic: number of variables (rosenbrock, sphere-int and ellipsoid-int: at "
    "least 2; branin: 2; hartmann6: 6; constrained: 4; zdt1: 2 to 30; dtlz2: 3 to 100; bbob-f1 to "
    "bbob-f15: 2 to 40)"};
const Setting<int> kFunctionInstance{
    "instance",
    {.lower = 0, .upper = kMostInstances},
    kNoDefault,
    "for the kind analytic: number of the function's instance, which decides where the minimiser "
    "lies and how the function is rotated. 0 is the plain form: a fixed shift, no rotation. "
    "Default: 0, for bbob-f1 to bbob-f15 1"};
const Setting<bool> kFunctionPerReplicate{
    "instance_per_replicate", FunctionChoice{}.instance_per_replicate,
    "for the kind analytic: whether replicate r of a comparison has instance + r - 1 as its "
    "instance (without effect on the plain form)"};
const Setting<bool> kFunctionAddsFOpt{
    "add_f_opt", kNoDefault,
    "for bbob-f1 to bbob-f15: whether the value includes f_opt, the instance's minimum; otherwise "
    "the minimum is 0. Default: true"};
const SettingTable kFunctionSettings{
    .key = "function",
    .settings = {&kFunctionName, &kFunctionDimension, &kFunctionInstance, &kFunctionPerReplicate,
                 &kFunctionAddsFOpt}};

// Reads the sets. `otherwise` holds the numbers of cases if the table lacks them.
CaseSets read_sets(const ConfigTable& table, const CaseSets& otherwise) {
  const auto read_name = [&](const Setting<std::string>& setting, std::string_view prefix) {
    const std::string name = table.get(setting);
    if (name.rfind(prefix, 0) != 0 || name.size() == prefix.size()) {
      table.refuse(setting, fmt::format("a {} set must be named {}ID, as in {}1", setting.key,
                                        prefix, prefix));
    }
    return name;
  };
  CaseSets sets;
  sets.training = read_name(kSetsTraining, "train/");
  sets.validation = read_name(kSetsValidation, "validation/");
  sets.test = read_name(kSetsTest, "test/");
  sets.validation_cases = table.get_or(kSetsValidationCases, otherwise.validation_cases);
  sets.test_cases = table.get_or(kSetsTestCases, otherwise.test_cases);
  sets.training_cases = otherwise.training_cases;
  return sets;
}

// Returns a name or path that means the same wherever it is read: a shipped name stays a name.
std::string read_design_name(const ConfigTable& table, const Setting<std::string>& setting) {
  const std::string name = table.get(setting);
  const auto path = resolve_named(table, setting, "designs");
  return path.stem() == name ? name : path.string();
}

PublishedWinner read_published_winner(const ConfigTable& table) {
  PublishedWinner published;
  published.error_m = table.find(kWinnerError);
  published.total_torque_n_m = table.find(kWinnerTorque);
  if (table.has(kWinnerDesign)) {
    published.design = read_design_name(table, kWinnerDesign);
  }
  published.where = table.get(kWinnerWhere);
  published.set = table.get(kWinnerSet);
  return published;
}

// Takes the numbers away from a published winner that was found with other settings than those of
// `resolved_json`, and says which setting differs.
void compare_settings(const std::string& resolved_json, PublishedWinner& published) {
  if (!published.error_m && !published.total_torque_n_m) {
    return;
  }
  const nlohmann::json resolved = nlohmann::json::parse(resolved_json);
  for (const std::string& setting : published.set) {
    const std::size_t equals = setting.find('=');
    const std::string key = setting.substr(0, equals);
    const std::string theirs = setting.substr(std::min(equals, setting.size() - 1) + 1);
    std::string path = "/" + key;
    std::ranges::replace(path, '.', '/');
    const nlohmann::json::json_pointer pointer(path);
    const nlohmann::json ours =
        resolved.contains(pointer) ? resolved.at(pointer) : nlohmann::json(nullptr);
    const nlohmann::json wanted = nlohmann::json::parse(theirs, nullptr, false);
    if (ours == (wanted.is_discarded() ? nlohmann::json(theirs) : wanted)) {
      continue;
    }
    published.difference =
        fmt::format("{} is {} here, and {} for the published winner", key,
                    ours.is_string() ? ours.get<std::string>() : ours.dump(), theirs);
    published.error_m.reset();
    published.total_torque_n_m.reset();
    return;
  }
}

SweepPlan read_sweep(const ConfigTable& table, const TrackingProblem& problem) {
  SweepPlan sweep;
  sweep.parameter = table.get(kSweepParameter);
  sweep.values = table.get(kSweepValues);
  if (sweep.values.empty()) {
    table.refuse(kSweepValues, "it must hold at least one number");
  }
  sweep.design = read_design_name(table, kSweepDesign);
  try {
    problem.check_design(load_design(sweep.design).design);
  } catch (const Error& error) {
    table.refuse(kSweepDesign, error.what());
  }
  return sweep;
}

constexpr std::string_view kRobotInName = "{robot}";

// Returns the problem's name: that of the program, the file's name, or the name that the file gives. "{robot}" in it
// stands for the name of the URDF file. A file that extends a file with such a name is named after
// itself.
std::string read_problem_name(const ConfigTable& table, const std::filesystem::path& path,
                              const LoadedProblem& loaded) {
  std::string name =
      table.get_or(kProblemName, loaded.program.empty() ? path.stem().string() : loaded.name);
  if (const std::size_t at = name.find(kRobotInName); at != std::string::npos) {
    if (table.files().size() > 1) {
      name = path.stem().string();
    } else {
      const std::filesystem::path urdf = table.get_table(kRobotSettings).get(kRobotUrdf);
      name.replace(at, kRobotInName.size(), urdf.stem().string());
    }
  }
  if (sanitize(name) != name) {
    throw Error(ErrorKind::usage,
                fmt::format("{}: the problem's name is not printable UTF-8. It is the file's name, "
                            "or the key 'name', where {{robot}} stands for the name of the URDF "
                            "file; rename the file that gives the name, or change the key",
                            sanitize(path.string())));
  }
  if (name.empty() || name.find('/') != std::string::npos || name.front() == '.') {
    table.refuse(kProblemName,
                 "folders are named after it, so it must not be empty, begin with '.' or contain "
                 "'/'");
  }
  return name;
}

// Settles one case per set if the problem has a path of its own and no perturbed plants: every
// simulation of a design is then the same, whatever the file says of generated cases.
void settle_path(const ConfigTable& table, LoadedProblem& loaded) {
  const TrackingConfig& config = loaded.tracking()->config();
  if (!config.path || config.perturbation.changes_anything()) {
    return;
  }
  loaded.sets.validation_cases = 1;
  loaded.sets.test_cases = 1;
  const ConfigTable sets = table.get_table_or_empty(kSetsSettings);
  sets.settle(kSetsValidationCases, loaded.sets.validation_cases);
  sets.settle(kSetsTestCases, loaded.sets.test_cases);
  settle_one_case(table.get_table_or_empty(kScheduleSettings), loaded);
}

// Settles what the program's description says of cases, where the file leaves it open.
void settle_program(const ConfigTable& table, LoadedProblem& loaded) {
  const ConfigTable sets = table.get_table_or_empty(kSetsSettings);
  sets.settle(kSetsValidationCases, loaded.sets.validation_cases);
  sets.settle(kSetsTestCases, loaded.sets.test_cases);
  if (loaded.problem->description().has_single_case) {
    settle_one_case(table.get_table_or_empty(kScheduleSettings), loaded);
  }
}

void check_instance(const ConfigTable& function, const AnalyticFunction& row,
                    const FunctionChoice& choice) {
  if (choice.instance < get_first_instance(row)) {
    function.refuse(
        kFunctionInstance,
        fmt::format("{} has no plain form; its instances are 1 to {}", row.name, kMostInstances));
  }
  if (choice.instance > 0 && !row.has_instances) {
    function.refuse(kFunctionInstance,
                    fmt::format("{} has the plain form only, instance 0", row.name));
  }
  if (choice.adds_f_opt && row.bbob == 0) {
    function.refuse(kFunctionAddsFOpt,
                    fmt::format("{} has no f_opt; its minimum is {}", row.name, row.minimum));
  }
  if (choice.adds_f_opt && choice.instance_per_replicate) {
    function.refuse(kFunctionPerReplicate,
                    "replicates whose minima differ cannot be compared; set function.add_f_opt to "
                    "false");
  }
}

void load_analytic(const ConfigTable& table, LoadedProblem& loaded) {
  const ConfigTable function = table.get_table(kFunctionSettings);
  const std::string name = function.get(kFunctionName);
  const AnalyticFunction& row = find_analytic(name);
  const Range dimensions{.lower = static_cast<double>(row.smallest_dimension),
                         .upper = static_cast<double>(row.largest_dimension)};
  FunctionChoice choice{
      .name = row.name,
      .dimension = function.get_or(kFunctionDimension.within(dimensions), row.default_dimension),
      .instance = function.get_or(kFunctionInstance, get_first_instance(row)),
      .instance_per_replicate = function.get(kFunctionPerReplicate),
      .adds_f_opt = function.get_or(kFunctionAddsFOpt, row.bbob != 0)};
  check_instance(function, row, choice);
  if (choice.instance == 0) {
    // So recorded the versions before 2.0, which had the plain form only.
    choice.instance_per_replicate = false;
    function.leave_out(kFunctionInstance);
    function.leave_out(kFunctionPerReplicate);
  } else {
    function.settle(kFunctionInstance, choice.instance);
  }
  loaded.problem = make_analytic(choice);
  loaded.function = choice;
}

}  // namespace

const SettingTable& problem_settings() {
  static const SettingTable settings{
      .key = "",
      .settings = {&kTitle, &kDescription, &kProblemKind, &kProblemName},
      .tables = {&kRobotSettings,        &kTaskSettings,          &kControlSettings,
                 &kWorkspaceSettings,    &kPathSettings,          &kPhysicsSettings,
                 &kTrainingSettings,     &kScheduleSettings,      &kRacingSettings,
                 &kSetsSettings,         &kRunSettings,           &kObjectiveSettings,
                 &kVariableSettings,     &kMotorSettings,         &kRequirementSettings,
                 &kPerturbationSettings, &kSweepSettings,         &kWinnerSettings,
                 &kFunctionSettings,     &kProgramSettings,       &kCommandSettings,
                 &kUserVariableSettings, &kUserObjectiveSettings, &kUserConstraintSettings,
                 &kUserMetricSettings,   &kUserCasesSettings,     &kIdentificationSettings,
                 &kExcitationSettings,   &kMotionSettings,        &kObstacleSettings,
                 &kTubeSettings},
      .listed_as = ""};
  return settings;
}

void add_input(LoadedProblem& loaded, const std::filesystem::path& file) {
  loaded.input_hashes[file.filename().string()] =
      calc_sha256_hex(read_file(file, kInputLimit_bytes));
}

std::filesystem::path find_beside(const ConfigTable& table, const Setting<std::string>& setting) {
  const std::filesystem::path named = table.get(setting);
  const std::filesystem::path beside = table.file().parent_path() / named;
  std::error_code ignored;
  const auto file = std::filesystem::is_regular_file(beside, ignored) ? beside : named;
  if (!std::filesystem::is_regular_file(file, ignored)) {
    table.refuse(setting, fmt::format("there is no such file, in {} or in the current folder",
                                      sanitize(table.file().parent_path().string())));
  }
  return file;
}

std::filesystem::path resolve_named(const ConfigTable& table, const Setting<std::string>& setting,
                                    std::string_view kind) {
  const std::string name = table.get(setting);
  try {
    return resolve_config(kind, name, table.file().parent_path());
  } catch (const Error& error) {
    table.refuse(setting, error.what());
  }
}

LoadedProblem read_problem(const ConfigTable& table, const std::filesystem::path& path,
                           std::span<const EngineRow> engines, const ProgramSource& programs) {
  LoadedProblem loaded;
  table.find(kProblemName);  // messages list the keys in the order in which they are first read
  table.find(kTitle);
  table.get(kDescription);
  const std::string kind = table.get(kProblemKind);
  CaseSets usual;
  if (kind == "analytic" || kind == "excitation" || kind == "motion") {  // every case is the same
    usual.validation_cases = 1;
    usual.test_cases = 1;
  }
  if (kind == "program") {
    load_program(table, programs, loaded);
    usual = loaded.sets;
  } else if (kind == "command") {
    loaded.name = read_problem_name(table, path, loaded);
    load_command(table, path, programs, loaded);
    usual = loaded.sets;
  } else if (kind == "external") {
    loaded.name = read_problem_name(table, path, loaded);
    load_external(table, loaded);
    usual = loaded.sets;
  }
  loaded.name = read_problem_name(table, path, loaded);
  loaded.title = table.get_or(kTitle, loaded.title.empty() ? loaded.name : loaded.title);
  read_schedule_table(table.get_table_or_empty(kScheduleSettings), loaded);
  loaded.racing = read_racing_table(table.get_table_or_empty(kRacingSettings));
  loaded.sets = read_sets(table.get_table_or_empty(kSetsSettings), usual);
  const ConfigTable run = table.get_table_or_empty(kRunSettings);
  loaded.optimizer = run.get(kRunOptimizer);
  loaded.budget = run.get(kRunBudget);
  loaded.published = read_published_winner(table.get_table_or_empty(kWinnerSettings));
  if (kind == "analytic") {
    load_analytic(table, loaded);
  } else if (kind == "program" || kind == "command" || kind == "external") {
    settle_program(table, loaded);
    if (kind != "program") {  // a record is read without the file that gives the name
      table.settle(kProblemName, loaded.name);
    }
  } else if (kind == "identification") {
    load_identification(table, loaded);
    table.settle(kProblemName, loaded.name);
    const ConfigTable sets = table.get_table_or_empty(kSetsSettings);
    sets.settle(kSetsValidationCases, loaded.sets.validation_cases);
    sets.settle(kSetsTestCases, loaded.sets.test_cases);
    loaded.schedule = {};
    loaded.schedule.cases = static_cast<int>(loaded.sets.training_cases);
  } else if (kind == "excitation" || kind == "motion") {
    (kind == "motion" ? load_motion : load_excitation)(table, loaded);
    table.settle(kProblemName, loaded.name);
    settle_program(table, loaded);
  } else {
    load_tracking(table, engines, loaded);
    if (table.get_or(kProblemName, "").find(kRobotInName) != std::string::npos) {
      table.settle(kProblemName, loaded.name);
    }
    settle_path(table, loaded);
    if (table.has(kSweepSettings.key)) {
      loaded.sweep = read_sweep(table.get_table(kSweepSettings), *loaded.tracking());
    }
  }
  table.refuse_unknown();
  loaded.resolved_json = table.to_json();
  compare_settings(loaded.resolved_json, loaded.published);
  return loaded;
}

namespace {

// Returns the settings of a problem and the path that names it.
std::pair<ConfigTable, std::filesystem::path> load_table(std::string_view name_or_path,
                                                         std::span<const std::string> overrides) {
  if (is_program_name(name_or_path)) {
    const std::string name(name_or_path);
    const std::string toml =
        fmt::format("kind = \"program\"\n[program]\ncommand = {}\n", quote_toml(name));
    return {ConfigTable::parse(problem_settings(), toml, name, overrides), name};
  }
  const auto path = resolve_config("problems", name_or_path);
  return {ConfigTable::load(problem_settings(), path, overrides, find_config_folder() / "problems"),
          path};
}

}  // namespace

LoadedProblem load_problem(std::string_view name_or_path, std::span<const std::string> overrides,
                           std::span<const EngineRow> engines, const ProgramSource& programs) {
  const ReadStep step(fmt::format("the problem '{}'", sanitize(name_or_path)));
  const auto [table, path] = load_table(name_or_path, overrides);
  return read_problem(table, path, engines, programs);
}

bool needs_program(std::string_view name_or_path, std::span<const std::string> overrides) {
  const auto [table, path] = load_table(name_or_path, overrides);
  return table.find(kProblemKind) == "program" &&
         !table.get_table_or_empty(kProgramSettings).has("description");
}

std::vector<ProblemTitle> list_problems() {
  std::vector<ProblemTitle> titles;
  for (const std::string& name : list_configs("problems")) {
    const ConfigTable table =
        ConfigTable::load(problem_settings(), resolve_config("problems", name));
    titles.push_back({name, table.get_or(kTitle, "")});
  }
  return titles;
}

}  // namespace armwright
