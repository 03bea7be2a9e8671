// [command], [[variable]], [[objective]], [[constraint]], [[metric]] and [cases]: a problem that is
// a command per case. The tables of the description are also those of the kind external.

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <stdexcept>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
#include "base/text.hpp"
#include "problems/config/problem_readers.hpp"
#include "problems/user/command_server.hpp"
#include "problems/user/user_problem.hpp"
#include "process/command_words.hpp"
#include "process/json_message.hpp"

namespace armwright {
namespace {

constexpr std::size_t kTemplateLimit_bytes = std::size_t{8} << 20;

const Setting<std::string> kCommandRun{
    "run", kNoDefault,
    "for the kind command: the command line of one case; {NAME} stands for a variable's value, "
    "{seed}, {case}, {role} or {folder}, the folder of the problem file; no shell runs it"};
const Setting<double> kCommandTimeLimit{
    "time_limit_s",
    {.lower = 0, .upper = 1e7, .lower_open = true},
    ServerLimits{}.time_limit_s,
    "for the kind command: longest time for one case; a case that takes longer is a failed case"};
const Setting<double> kCommandMemory{
    "memory_mib",
    {.lower = 1, .upper = 1e7},
    ServerLimits{}.memory_mib,
    "for the kind command: how much memory its process may take, together with what it has "
    "started; beyond it the case is a failed case"};
const Setting<std::string> kCommandKeep{
    "keep", one_of({"none", "failed", "all"}), "none",
    "for the kind command: the cases whose working folders are kept in command.workspace"};
const Setting<std::string> kCommandWorkspace{
    "workspace", "",
    "for the kind command: the folder in which working folders are made (default: the folder for "
    "temporary files)"};
const Setting<bool> kCommandDeterministic{
    "deterministic", UserDescription{}.is_deterministic,
    "for the kind command: whether the same case of the same design has the same results"};

const Setting<std::string> kInputFile{"file", kNoDefault,
                                      "name of an input file in the working folder"};
const Setting<std::string> kInputText{
    "text", kNoDefault, "its text, with places as in command.run; {{ stands for one brace"};
const Setting<std::string> kInputTemplate{
    "template", kNoDefault,
    "in place of a text: a file with the text, looked for beside the problem file"};
const Setting<std::string> kInputTemplateText{
    "template_text", kNoDefault,
    "the text of that file, which armwright records; with it, the file is not read"};
const SettingTable kInputSettings{
    .key = "input",
    .is_array = true,
    .settings = {&kInputFile, &kInputText, &kInputTemplate, &kInputTemplateText}};

constexpr Range kAnyNumber{.lower = -1e300, .upper = 1e300};
const Setting<std::string> kTableName{"name", kNoDefault,
                                      "its name: letters, digits, '_', '-' and '.'"};
const Setting<std::string> kTableUnit{"unit", "", "its unit"};

const Setting<std::string> kVariableType{"type", &list_type_names, "real",
                                         "real, integer, or category: one of a list of words"};
const Setting<double> kVariableLower{"lower", kAnyNumber, kNoDefault,
                                     "lower bound; not for a category"};
const Setting<double> kVariableUpper{"upper", kAnyNumber, kNoDefault,
                                     "upper bound; not for a category"};
const Setting<double> kVariableStart{
    "start", kAnyNumber, kNoDefault,
    "where runs begin; of a category, one of its words (default: the middle of the bounds, or the "
    "first word)"};
const Setting<std::string> kVariableScale{
    "scale", one_of({"linear", "logarithmic"}), "linear",
    "logarithmic: factors count and not differences; both bounds have the same sign"};
const Setting<std::vector<std::string>> kVariableChoices{"choices", kNoDefault,
                                                         "for a category: its words"};
const Setting<std::string> kStartWord{"start", kNoDefault, "as kVariableStart, of a category"};

const Setting<std::string> kFrom{
    "from", ResultReading::kStandardOutput,
    "where the result is read: a file in the working folder, or stdout, what the command prints"};
const Setting<std::string> kJson{"json", kNoDefault,
                                 "a JSON pointer to the number: \"/results/0/error\""};
const Setting<std::string> kColumn{
    "column", kNoDefault,
    "name of a column of a CSV file, or its number from 1; fields are separated by commas, "
    "semicolons, tabs or blanks"};
const Setting<std::string> kRow{"row", one_of({"last", "first", "max", "min", "mean"}), "last",
                                "for a column: which of its values is the result"};
const Setting<std::string> kRegex{
    "regex", kNoDefault,
    "a regular expression (ECMAScript), whose first group is the number; the last line that "
    "matches counts"};
const Setting<bool> kExitCode{
    "exit_code", false,
    "true: the exit code of the command is the number, and one other than 0 is no failure"};

const Setting<std::string> kDirection{"direction", one_of({"minimize", "maximize"}), "minimize",
                                      "minimize or maximize"};
const Setting<double> kObjectiveWeight{"weight", kAnyNumber, UserObjective{}.weight,
                                       "its weight where several objectives make one number; > 0"};
const Setting<double> kObjectivePenalty{
    "penalty", kAnyNumber, kNoDefault,
    "what a failed training case counts as (default: a design with one has no objectives)"};
const Setting<double> kObjectiveBound{"bound", kAnyNumber, kNoDefault,
                                      "no case has a better value; races can then give up designs"};
const Setting<double> kUserLimit{
    "limit", kAnyNumber, kNoDefault,
    "the constraint is met up to this value, > 0 (without a limit: where its value is <= 0)"};

const Setting<std::int64_t> kCasesTraining{
    "training",
    {.lower = 0, .upper = kMostCases},
    UserDescription{}.training_cases,
    "for the kind command: how many training cases there are; 0: as many as are asked for"};
const Setting<std::int64_t> kCasesValidation{
    "validation",
    {.lower = 1, .upper = kMostCases},
    UserDescription{}.validation_cases,
    "for the kind command: how many validation cases there are"};
const Setting<std::int64_t> kCasesTest{"test",
                                       {.lower = 1, .upper = kMostCases},
                                       UserDescription{}.test_cases,
                                       "for the kind command: how many test cases there are"};
const Setting<std::string> kCasesCombine{
    "combine", one_of({"mean", "worst"}), "mean",
    "for the kind command: how the objectives of several cases are combined"};

// A name that files, columns of tables and command lines can have.
std::string read_plain_name(const ConfigTable& table) {
  const std::string name = table.get(kTableName);
  if (!is_name(name)) {
    table.refuse(kTableName, fmt::format("it must be a name: {}", kNameRule));
  }
  return name;
}

std::string read_file_name(const ConfigTable& table, const Setting<std::string>& setting) {
  const std::string name = table.get(setting);
  if (name.empty() || name.find('/') != std::string::npos || name == "." || name == "..") {
    table.refuse(setting, "it must be the name of a file in the working folder, without folders");
  }
  return name;
}

DecisionVariable read_variable_table(const ConfigTable& table) {
  DecisionVariable variable;
  variable.name = read_plain_name(table);
  const auto own = list_places({});
  if (std::ranges::find(own, variable.name) != own.end()) {
    table.refuse(kTableName, fmt::format("the places {} have other meanings; choose another name",
                                         join(own, ", ")));
  }
  variable.unit = table.get(kTableUnit);
  variable.type = kVariableTypes[table.get_choice(kVariableType)];
  if (variable.type == VariableType::category) {
    variable.choices = table.get(kVariableChoices);
    variable.upper = static_cast<double>(variable.choices.size()) - 1;
    if (table.has(kStartWord)) {
      const auto start = find_word(variable, table.get(kStartWord));
      if (!start) {
        table.refuse(kStartWord, fmt::format("it must be one of its choices: {}",
                                             join(variable.choices, ", ")));
      }
      variable.start = *start;
    }
    return variable;
  }
  variable.lower = table.get(kVariableLower);
  variable.upper = table.get(kVariableUpper);
  variable.scale = table.get_choice(kVariableScale) == 1 ? Scale::logarithmic : Scale::linear;
  variable.start = table.has(kVariableStart) ? table.get(kVariableStart) : choose_start(variable);
  return variable;
}

void check_pointer(const ConfigTable& table, const std::string& pointer) {
  try {
    const nlohmann::json::json_pointer checked(pointer);
  } catch (const nlohmann::json::exception&) {
    table.refuse(kJson, "it must be a JSON pointer, as in \"/results/0/error\"");
  }
}

std::regex read_regex(const ConfigTable& table) {
  const std::string text = table.get(kRegex);
  constexpr std::size_t kLongestPattern = 1000;  // the library recurses once per character
  if (text.size() > kLongestPattern) {
    table.refuse(kRegex, fmt::format("it may have at most {} characters", kLongestPattern));
  }
  try {
    std::regex pattern(text, std::regex::ECMAScript | std::regex::optimize);
    if (pattern.mark_count() >= 1) {
      return pattern;
    }
  } catch (const std::regex_error&) {
    table.refuse(kRegex, "it must be a regular expression (ECMAScript)");
  }
  table.refuse(kRegex, "it must have a group in parentheses, which matches the number");
}

ResultReading read_reading(const ConfigTable& table) {
  using Kind = ResultReading::Kind;
  const auto pointer = table.find(kJson);
  const auto column = table.find(kColumn);
  const auto pattern = table.find(kRegex);
  const int given =
      pointer.has_value() + column.has_value() + pattern.has_value() + table.get(kExitCode);
  if (given != 1) {
    throw Error(ErrorKind::usage,
                fmt::format("{} has {} of json, column, regex and exit_code = true; give one, "
                            "which says how the number is read",
                            table.describe_place(kTableName), given));
  }
  ResultReading reading;
  reading.from = read_file_name(table, kFrom);
  reading.row = static_cast<ColumnRow>(table.get_choice(kRow));
  if (pointer) {
    reading.kind = Kind::json;
    reading.what = *pointer;
    check_pointer(table, *pointer);
  } else if (column) {
    reading.kind = Kind::column;
    reading.what = *column;
  } else if (pattern) {
    reading.kind = Kind::regex;
    reading.what = *pattern;
    reading.pattern = read_regex(table);
  }
  return reading;
}

Template read_template(const ConfigTable& table, const Setting<std::string>& setting,
                       const std::string& text, const std::vector<std::string>& places) {
  try {
    return Template(text, places);
  } catch (const std::invalid_argument& error) {
    table.refuse(setting, fmt::format("it must {}", error.what()));
  }
}

CommandPlan::Input read_input(const ConfigTable& table, const std::vector<std::string>& places,
                              LoadedProblem& loaded) {
  const std::string file = read_file_name(table, kInputFile);
  const auto own_text = table.find(kInputText);
  const auto template_file = table.find(kInputTemplate);
  if (own_text.has_value() == template_file.has_value()) {
    table.refuse(kInputText, "an input file has either a text or a template");
  }
  if (own_text) {
    return {file, read_template(table, kInputText, *own_text, places)};
  }
  const std::filesystem::path path = *template_file;
  const std::string text =
      table.has(kInputTemplateText)
          ? table.get(kInputTemplateText)
          : read_file(table.file().parent_path() / path, kTemplateLimit_bytes, ErrorKind::usage);
  if (!is_utf8(text)) {
    table.refuse(kInputTemplate, "the file must be text in UTF-8");
  }
  table.settle(kInputTemplateText, text);
  loaded.input_hashes[path.string()] = calc_sha256_hex(text);
  return {file, read_template(table, kInputTemplate, text, places)};
}

// Splits the command line into words before values come into it, so that no value adds a word.
std::vector<Template> read_command_words(const ConfigTable& table,
                                         const std::vector<std::string>& places,
                                         const std::filesystem::path& folder,
                                         LoadedProblem& loaded) {
  std::vector<std::string> words;
  try {
    words = split_command(table.get(kCommandRun), "problem");
  } catch (const Error&) {
    table.refuse(kCommandRun, "it must begin with a program, and every quote must be closed");
  }
  std::vector<std::string> values(places.size());
  const auto place_of_folder =
      static_cast<std::size_t>(std::ranges::find(places, "folder") - places.begin());
  values[place_of_folder] = folder.string();
  std::vector<Template> templates;
  for (const std::string& word : words) {
    templates.push_back(read_template(table, kCommandRun, word, places));
    const std::filesystem::path file = templates.back().fill(values);
    if (std::error_code ignored;
        file.is_absolute() && std::filesystem::is_regular_file(file, ignored)) {
      loaded.input_hashes[word] = calc_program_hash(file);
    }
  }
  return templates;
}

// The tables of a description, for messages of check_description().
struct DescriptionTables {
  const ConfigTable& file;
  std::vector<ConfigTable> variables, objectives, constraints, metrics;

  // Refuses a field that is named "variables[2].lower".
  [[noreturn]] void refuse(const std::string& field, const std::string& fault) const {
    for (const auto& [list, tables] : {std::pair{"variables", &variables},
                                       {"objectives", &objectives},
                                       {"constraints", &constraints},
                                       {"metrics", &metrics}}) {
      const std::size_t bracket = field.find('[');
      if (bracket == std::string::npos || field.substr(0, bracket) != list) {
        continue;
      }
      const ConfigTable& table = tables->at(std::stoul(field.substr(bracket + 1)));
      AnySetting setting;
      setting.key = field.substr(field.find('.') + 1);
      // A value that the file leaves out has no place; the table's name has one.
      const std::string place =
          table.has(setting) ? table.describe_place(setting)
                             : fmt::format("{}: {}", table.describe_place(kTableName), setting.key);
      throw Error(ErrorKind::usage, fmt::format("{} {}", place, fault));
    }
    std::string key = field;
    if (key == "variables" || key == "objectives") {
      key.pop_back();  // as the file calls the tables
    }
    throw Error(ErrorKind::usage,
                fmt::format("{}: [[{}]] {}", sanitize(file.file().string()), key, fault));
  }
};

DescriptionTables get_description_tables(const ConfigTable& table) {
  return {table, table.get_tables_or_empty(kUserVariableSettings),
          table.get_tables_or_empty(kUserObjectiveSettings),
          table.get_tables_or_empty(kUserConstraintSettings),
          table.get_tables_or_empty(kUserMetricSettings)};
}

// Reads variables, objectives, constraints and metrics into the description.
void read_description(const DescriptionTables& tables, UserDescription& description) {
  for (const ConfigTable& one : tables.variables) {
    description.variables.push_back(read_variable_table(one));
  }
  for (const ConfigTable& one : tables.objectives) {
    description.objectives.push_back({.quantity = {read_plain_name(one), one.get(kTableUnit)},
                                      .is_maximised = one.get_choice(kDirection) == 1,
                                      .weight = one.get(kObjectiveWeight),
                                      .penalty = one.find(kObjectivePenalty),
                                      .bound = one.find(kObjectiveBound)});
  }
  for (const ConfigTable& one : tables.constraints) {
    description.constraints.push_back(
        {{read_plain_name(one), one.get(kTableUnit)}, one.find(kUserLimit)});
  }
  for (const ConfigTable& one : tables.metrics) {
    description.metrics.push_back({read_plain_name(one), one.get(kTableUnit)});
  }
}

}  // namespace

const SettingTable kUserVariableSettings{
    .key = "variable",
    .is_array = true,
    .settings = {&kTableName, &kTableUnit, &kVariableType, &kVariableLower, &kVariableUpper,
                 &kVariableStart, &kVariableScale, &kVariableChoices}};
const SettingTable kUserObjectiveSettings{
    .key = "objective",
    .is_array = true,
    .settings = {&kTableName, &kTableUnit, &kDirection, &kObjectiveWeight, &kObjectivePenalty,
                 &kObjectiveBound, &kFrom, &kJson, &kColumn, &kRow, &kRegex, &kExitCode}};
const SettingTable kUserConstraintSettings{
    .key = "constraint",
    .is_array = true,
    .settings = {&kTableName, &kTableUnit, &kUserLimit, &kFrom, &kJson, &kColumn, &kRow, &kRegex,
                 &kExitCode}};
const SettingTable kUserMetricSettings{
    .key = "metric",
    .is_array = true,
    .settings = {&kTableName, &kTableUnit, &kFrom, &kJson, &kColumn, &kRow, &kRegex, &kExitCode}};
const SettingTable kUserCasesSettings{
    .key = "cases", .settings = {&kCasesTraining, &kCasesValidation, &kCasesTest, &kCasesCombine}};
const SettingTable kCommandSettings{
    .key = "command",
    .settings = {&kCommandRun, &kCommandTimeLimit, &kCommandMemory, &kCommandKeep,
                 &kCommandWorkspace, &kCommandDeterministic},
    .tables = {&kInputSettings}};

void load_command(const ConfigTable& table, const std::filesystem::path& path,
                  const ProgramSource& programs, LoadedProblem& loaded) {
  const ConfigTable command = table.get_table(kCommandSettings);
  CommandPlan plan;
  plan.name = command.get(kCommandRun);
  plan.description.name = loaded.name;
  const DescriptionTables tables = get_description_tables(table);
  UserDescription& description = plan.description;
  read_description(tables, description);
  for (const auto* results : {&tables.objectives, &tables.constraints, &tables.metrics}) {
    for (const ConfigTable& one : *results) {
      plan.readings.push_back(read_reading(one));
    }
  }
  const ConfigTable cases = table.get_table_or_empty(kUserCasesSettings);
  description.training_cases = cases.get(kCasesTraining);
  description.validation_cases = cases.get(kCasesValidation);
  description.test_cases = cases.get(kCasesTest);
  description.takes_worst_case = cases.get_choice(kCasesCombine) == 1;
  description.is_deterministic = command.get(kCommandDeterministic);
  check_description(description, [&](const std::string& field, const std::string& fault) {
    tables.refuse(field, fault);
  });

  const std::vector<std::string> places = list_places(description.variables);
  plan.folder = std::filesystem::absolute(path).parent_path();
  plan.words = read_command_words(command, places, plan.folder, loaded);
  std::set<std::string> files;
  for (const ConfigTable& one : command.get_tables_or_empty(kInputSettings)) {
    plan.inputs.push_back(read_input(one, places, loaded));
    if (!files.insert(plan.inputs.back().file).second) {
      one.refuse(kInputFile, "another input file has this name");
    }
  }
  plan.limits = {.time_limit_s = command.get(kCommandTimeLimit),
                 .memory_mib = command.get(kCommandMemory)};
  plan.keep = static_cast<KeepFolders>(command.get_choice(kCommandKeep));
  plan.workspace = command.get(kCommandWorkspace);
  if (plan.keep != KeepFolders::none && plan.workspace.empty()) {
    command.refuse(kCommandKeep, "name a folder for them: command.workspace = \"results/cases\"");
  }
  loaded.program = plan.name;
  set_user_cases(description, loaded);
  UserProgram program = make_command_problem(std::move(plan));
  if (!programs.may_simulate) {
    program.start = nullptr;
    program.why_not = kStartsNothing;
  }
  loaded.problem = make_user_problem(std::move(program));
}

void load_external(const ConfigTable& table, LoadedProblem& loaded) {
  const DescriptionTables tables = get_description_tables(table);
  UserProgram program{
      .name = loaded.name,
      .why_not =
          "its file has kind = \"external\", so armwright cannot compute it. 'armwright ask "
          "RUN --problem FILE' hands out its points, and 'armwright tell RUN RESULTS' takes "
          "the results"};
  program.description.name = loaded.name;
  read_description(tables, program.description);
  check_description(program.description, [&](const std::string& field, const std::string& fault) {
    tables.refuse(field, fault);
  });
  for (const auto* named :
       {&tables.variables, &tables.objectives, &tables.constraints, &tables.metrics}) {
    for (const ConfigTable& one : *named) {
      if (const std::string name = one.get(kTableName); name == "id" || name == "missing") {
        one.refuse(kTableName,
                   "the tables of armwright ask and tell have a column with this name; choose "
                   "another name");
      }
    }
  }
  set_user_cases(program.description, loaded);
  loaded.problem = make_user_problem(std::move(program));
}

}  // namespace armwright
