#include "problems/config/values_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "base/config.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "base/toml_text.hpp"
#include "problems/user/user_description.hpp"

namespace armwright {
namespace {

const Setting<std::string> kValuesTitle{"title", "", "one line"};
const Setting<std::string> kValuesSource{"source", "", "where the values come from"};
const Setting<std::string> kValueName{"name", kNoDefault, "name of the variable or objective"};
const Setting<std::string> kValueUnit{"unit", "", "its unit"};
const Setting<double> kValueNumber{"value", kNoDefault, "its value; not for a category"};
const Setting<std::string> kValueWord{"word", kNoDefault, "the word of a category"};
const SettingTable kValueVariables{
    .key = "variable",
    .is_array = true,
    .settings = {&kValueName, &kValueUnit, &kValueNumber, &kValueWord}};
const SettingTable kValueObjectives{
    .key = "objective", .is_array = true, .settings = {&kValueName, &kValueUnit, &kValueNumber}};
const SettingTable kValuesSettings{.key = "",
                                   .settings = {&kValuesTitle, &kValuesSource},
                                   .tables = {&kValueVariables, &kValueObjectives}};

std::string write_values(const std::string& key, const std::vector<FileValue>& values) {
  std::string toml;
  for (const FileValue& one : values) {
    toml += fmt::format("\n[[{}]]\nname = {}\n", key, quote_toml(one.quantity.name));
    toml += one.word.empty() ? fmt::format("value = {}\n", format_exact(one.value))
                             : fmt::format("word = {}\n", quote_toml(one.word));
    if (!one.quantity.unit.empty()) {
      toml += fmt::format("unit = {}\n", quote_toml(one.quantity.unit));
    }
  }
  return toml;
}

FileValue read_value_table(const ConfigTable& table, bool allows_word) {
  FileValue one;
  one.quantity = {table.get(kValueName), table.get(kValueUnit)};
  if (allows_word && table.has(kValueWord)) {
    one.word = table.get(kValueWord);
  } else {
    one.value = table.get(kValueNumber);
  }
  return one;
}

double find_value(const FileValue& one, const DecisionVariable& variable,
                  const std::function<void(const std::string&)>& refuse) {
  if (variable.type == VariableType::category) {
    const auto value = find_word(variable, one.word);
    if (!value) {
      refuse(fmt::format("needs a word, which must be one of: {}", join(variable.choices, ", ")));
    }
    return *value;
  }
  const bool is_inside = one.value >= variable.lower && one.value <= variable.upper;
  if (!one.word.empty() || !is_inside || settle_value(variable, one.value) != one.value) {
    refuse(fmt::format("is {}; it must be {} from {} to {}",
                       one.word.empty() ? format_exact(one.value) : "'" + one.word + "'",
                       variable.type == VariableType::integer ? "a whole number" : "a number",
                       format_exact(variable.lower), format_exact(variable.upper)));
  }
  return one.value;
}

}  // namespace

std::string to_toml(const ValuesFile& file) {
  return fmt::format("title = {}\nsource = {}\n", quote_toml(file.title), quote_toml(file.source)) +
         write_values(kValueVariables.key, file.variables) +
         write_values(kValueObjectives.key, file.objectives);
}

ValuesFile load_values(const std::filesystem::path& path) {
  try {
    const ConfigTable table = ConfigTable::load(kValuesSettings, path);
    ValuesFile file;
    file.title = table.get(kValuesTitle);
    file.source = table.get(kValuesSource);
    for (const ConfigTable& one : table.get_tables(kValueVariables)) {
      file.variables.push_back(read_value_table(one, true));
    }
    for (const ConfigTable& one : table.get_tables_or_empty(kValueObjectives)) {
      file.objectives.push_back(read_value_table(one, false));
    }
    table.refuse_unknown();
    return file;
  } catch (const Error& error) {
    throw Error(error.kind() == ErrorKind::usage ? ErrorKind::bad_data : error.kind(),
                error.what());
  }
}

std::vector<FileValue> list_values(const std::vector<DecisionVariable>& variables,
                                   const std::vector<double>& x) {
  std::vector<FileValue> values;
  for (std::size_t i = 0; i < variables.size(); ++i) {
    const bool is_word = variables[i].type == VariableType::category;
    values.push_back({{variables[i].name, variables[i].unit},
                      x[i],
                      is_word ? format_value(variables[i], x[i]) : ""});
  }
  return values;
}

std::vector<double> read_values(const ValuesFile& file, const std::filesystem::path& path,
                                const std::vector<DecisionVariable>& variables) {
  const auto refuse = [&](const std::string& name, const std::string& fault) {
    throw Error(ErrorKind::bad_data, fmt::format("{}: variable '{}' {}", sanitize(path.string()),
                                                 sanitize(name), sanitize(fault)));
  };
  std::vector<std::string> names;
  std::vector<double> x;
  for (const DecisionVariable& variable : variables) {
    names.push_back(variable.name);
    const auto is_it = [&](const FileValue& one) { return one.quantity.name == variable.name; };
    const auto found = std::ranges::find_if(file.variables, is_it);
    if (std::ranges::count_if(file.variables, is_it) != 1) {
      refuse(variable.name, found == file.variables.end() ? "is missing" : "is there twice");
    }
    x.push_back(find_value(*found, variable,
                           [&](const std::string& fault) { refuse(variable.name, fault); }));
  }
  for (const FileValue& one : file.variables) {
    if (std::ranges::count(names, one.quantity.name) == 0) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("{}: {}", sanitize(path.string()),
                              describe_unknown("variable", one.quantity.name, names)));
    }
  }
  return x;
}

}  // namespace armwright
