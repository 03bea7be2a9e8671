// armwright import: makes a design file from an export.

#include "report/exchange/import.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <limits>

#include "base/error.hpp"
#include "base/text.hpp"
#include "cli/commands/commands.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/terminal.hpp"
#include "cli/views/design_and_problem.hpp"
#include "problems/config/design_file.hpp"

namespace armwright {
namespace {

constexpr const char* kImportExamples = R"(Examples:
  armwright import results/q1/export-csv --problem q1-complex --out best.toml
  armwright import q1-ioh --problem q1-complex --optimizer ga --replicate 3 --out best.toml
  armwright evaluate best.toml --problem q1-complex

The command writes the design with the best training objective of the chosen runs. With a fresh schedule this is often a
lucky design, so prefer the winner; a csv export has it in designs/. An export contains only the names of the problem
and its variables. If the problem is not a shipped one or was changed by --set, name it with --config and --set.
'armwright testset import' reads files of test cases.)";

struct ImportOptions {
  std::string folder;
  std::string problem;
  std::string label;
  std::string replicate;
  std::string config;
  OverrideOptions overrides;
  std::string out = "-";
};

// Throws Error{bad_data} if the variables of the problem and of the export differ.
void check_variables(const LoadedProblem& problem, const ImportedRun& run) {
  std::vector<std::string> names;
  for (const DecisionVariable& variable : problem.problem->description().variables) {
    names.push_back(variable.name);
  }
  if (names != run.variables) {
    throw Error(ErrorKind::bad_data,
                fmt::format("the export's variables on '{}' are {}; those of problem {} are {}; "
                            "name the problem of the export with --config and --set",
                            sanitize(run.problem), sanitize(join(run.variables, ", ")),
                            problem.name, join(names, ", ")));
  }
}

int run_import(const ImportOptions& options) {
  ImportChoice choice;
  if (!options.problem.empty()) {
    choice.problem = options.problem;
  }
  if (!options.label.empty()) {
    choice.label = options.label;
  }
  if (!options.replicate.empty()) {
    choice.replicate = static_cast<std::uint64_t>(
        parse_count("--replicate", options.replicate, 1, std::numeric_limits<std::int64_t>::max()));
  }
  const ImportedRun run = import_best(options.folder, choice);
  const LoadedProblem problem =
      load_problem(options.config.empty() ? run.problem : options.config, options.overrides.get());
  const TrackingProblem& tracking = require_tracking(problem);
  check_variables(problem, run);
  DesignFile file = make_design_file(tracking.config().robot, tracking.make_design(run.x));
  file.name = fmt::format("{}-{}-{}", run.problem, run.label, run.replicate);
  file.title = fmt::format("Evaluation {} of {} on {}, replicate {}", run.evaluation, run.label,
                           run.problem, run.replicate);
  file.source = fmt::format("armwright import; training objective {}", run.objective);
  write_output(options.out, to_toml(file));
  write_message(fmt::format("{}: training objective {}", file.title, run.objective));
  return exit_code::kDone;
}

}  // namespace

void add_import(CLI::App& app, Session& session) {
  auto options = std::make_shared<ImportOptions>();
  CLI::App* command =
      add_command(app, session, "import",
                  "Make a design file from the best decision vector of an export", kImportExamples);
  command
      ->add_option("EXPORT", options->folder, "An export that armwright wrote as csv, json or ioh")
      ->required();
  command->add_option("--problem,-p", options->problem, "Use only runs on this problem")
      ->type_name("PROBLEM");
  command->add_option("--optimizer", options->label, "Use only runs with this label")
      ->type_name("LABEL");
  command->add_option("--replicate", options->replicate, "Use only this replicate")->type_name("N");
  command
      ->add_option("--config", options->config,
                   "The problem that turns decision vectors into designs, by name or file\n"
                   "(default: the problem that the export names)")
      ->type_name("PROBLEM");
  options->overrides.add_to(*command);
  command->add_option("--out", options->out, "The design file (default: standard output)")
      ->type_name("FILE");
  command->callback(
      [options, &session] { session.action = [options] { return run_import(*options); }; });
}

}  // namespace armwright
