// Says for each argument and flag which values completion offers.

#include <algorithm>
#include <span>

#include "base/text.hpp"
#include "cli/list/list_views.hpp"
#include "cli/manual/completion.hpp"
#include "cli/manual/manual_formats.hpp"
#include "cli/manual/plugin_templates.hpp"
#include "problems/config/config_files.hpp"
#include "problems/identification/excitation_problem.hpp"
#include "report/exchange/export.hpp"
#include "sim/identification/plant_parameters.hpp"
#include "sim/simd/simd_level.hpp"

namespace armwright {
namespace {

using Names = std::vector<std::string>;

ValueSource choose(Names choices) {
  return {.choices = std::move(choices)};
}
ValueSource choose_from(const char* list) {
  return {.list = list};
}
ValueSource choose_or_file(const char* list, Names choices = {}) {
  return {.choices = std::move(choices), .list = list, .files = true};
}
ValueSource separate(ValueSource source) {
  source.separated = true;
  return source;
}
const ValueSource kFree = {};
const ValueSource kFile = {.files = true};
const ValueSource kFolder = {.folders = true};

Names list_simd_choices() {
  Names names = simd_names();
  names.insert(names.begin(), "auto");
  return names;
}

Names list_export_formats() {
  Names names;
  std::ranges::transform(export_formats(), std::back_inserter(names), &ExportFormat::name);
  return names;
}

ValueSource make_perturbation_source() {
  Names names = {"none", "lighter", "heavier"};
  std::ranges::copy(list_configs("perturbations"), std::back_inserter(names));
  return {.choices = names, .files = true, .separated = true};
}

struct SourceRow {
  const char* command;   // "testset export"; "" for all commands with the argument
  const char* argument;  // "--engine", "PROBLEM"
  ValueSource source;
};

// The rows of one command come before those of all commands.
std::vector<SourceRow> make_argument_rows() {
  return {
      {"list", "KIND", choose(list_kind_names())},
      {"list", "NAME", choose_from(kListOfFirstArgument)},
      {"excite", "--criterion", choose(excitation_criterion_names())},
      {"compare", "STUDY", choose_or_file("studies")},
      {"compare", "--preset", choose_from("studies")},
      {"compare", "--problems", separate(choose_or_file("problems"))},
      {"compare", "--optimizers", separate(choose_or_file("optimizers"))},
      {"compare", "--executor", choose({"local", "mpi", "slurm", "script"})},
      {"verify", "--engines", separate(choose_from("engines"))},
      {"verify", "--perturbations", make_perturbation_source()},
      {"sweep", "--values", kFree},
      {"report", "FOLDER", kFile},  // a folder, or a page
      {"plot", "FOLDER", kFile},
      {"plot", "--theme", choose({"light", "dark"})},
      {"plot", "--figure", kFree},
      {"reproduce", "--table", kFree},
      {"identify", "LOG", kFile},
      {"identify", "--validate", kFile},
      {"identify", "--column", kFree},
      {"identify", "--unit", kFree},
      {"identify", "--gear-ratio", kFree},
      {"identify", "--sign", kFree},
      {"identify", "--joints", kFree},
      {"identify", "--topic", kFree},
      {"identify", "--cutoff", kFree},
      {"identify", "--payload", kFree},
      {"identify", "--payload-com", kFree},
      {"identify", "--fit", separate(choose(fit_group_names()))},
      {"export", "--format", choose(list_export_formats())},
      {"import", "--optimizer", kFree},  // a label
      {"ask", "RUN", kFolder},
      {"tell", "RUN", kFolder},
      {"tell", "FILE", kFile},
      {"import", "EXPORT", kFile},
      {"testset export", "NAME", kFree},
      {"testset hash", "NAME", kFile},
      {"testset import", "FILE", kFile},
      {"testset export", "--format", choose({"json", "csv"})},
      {"testset import", "--format", choose({"json", "csv"})},
      {"check-plugin", "OPTIMIZER", choose_or_file("optimizers")},
      {"new-plugin", "NAME", kFree},
      {"new-plugin", "--language", choose(list_languages(kPluginTemplates))},
      {"check-problem", "PROBLEM", choose_or_file("problems")},
      {"new-problem", "NAME", kFree},
      {"new-problem", "--language", choose(list_languages(kProblemTemplates))},
      {"manual", "COMMAND", choose_from(kListOfCommands)},
      {"manual", "--format", choose(manual_format_names())},
      {"completion", "SHELL", choose({"bash"})},
      {"", "--color", choose({"auto", "always", "never"})},
      {"", "--optimizer", choose_or_file("optimizers")},
      {"", "--engine", choose_from("engines")},
      {"", "--judging-engine", choose_from("engines")},
      {"", "--precision", choose(precision_names())},
      {"", "--simd", choose(list_simd_choices())},
      {"", "--robot", choose_or_file("robots")},
      {"", "--plant", kFile},
      {"", "PROBLEM", choose_or_file("problems")},
      {"", "DESIGN", choose_or_file("designs", {"start"})},
      {"", "FOLDER", kFolder},
      {"", "STUDY", kFolder},
      {"", "PLAN", kFile},
      {"", "OTHER", kFolder},
      {"", "CELL", kFree},
  };
}

// Rows by the name of the value, for arguments without a row of their own.
std::vector<SourceRow> make_value_rows() {
  std::vector<SourceRow> rows = {
      {"", "PROBLEM", choose_or_file("problems")},
      {"", "DESIGN", choose_or_file("designs")},
      {"", "FILE", kFile},
      {"", "FOLDER", kFolder},
      {"", "DIR", kFolder},
  };
  for (const char* name : {"N", "ID", "KEY", "KEY=VALUE", "NAME=VALUE", "NUMBERS", "DURATION",
                           "CASES", "KIND", "KIND:K", "LABEL", "LINK", "NAME=DIR", "SET:NUMBER",
                           "TIME,MEMORY", "WIDTHxHEIGHT", "WORD"}) {
    rows.push_back({"", name, kFree});
  }
  for (const char* name : {"GROUPS", "HZ", "KG", "SECONDS", "X,Y,Z"}) {
    rows.push_back({"", name, kFree});
  }
  return rows;
}

std::optional<ValueSource> find_row(std::span<const SourceRow> rows, std::string_view command,
                                    std::string_view argument) {
  const auto row = std::ranges::find_if(rows, [&](const SourceRow& one) {
    return (*one.command == '\0' || one.command == command) && one.argument == argument;
  });
  return row == rows.end() ? std::nullopt : std::optional(row->source);
}

}  // namespace

std::optional<ValueSource> find_value_source(const CommandDefinition& command,
                                             const ArgumentDefinition& argument) {
  const static std::vector<SourceRow> arguments = make_argument_rows();
  const static std::vector<SourceRow> values = make_value_rows();
  const std::string below = join(std::span(command.words).subspan(1), " ");
  const auto source = find_row(arguments, below, argument.get_key());
  return source ? source : find_row(values, "", argument.value);
}

}  // namespace armwright
