// armwright export: writes runs in the formats of other programs, and the winner for a real robot.

#include "report/exchange/export.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "base/text.hpp"
#include "cli/commands/commands.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/terminal.hpp"

namespace armwright {
namespace {

constexpr const char* kExportExamples = R"(Examples:
  armwright export results/irb4600-auto-seed1 --format csv
  armwright export results/q1 --format ioh --out q1-ioh       # a whole study, for IOHanalyzer
  armwright export results/q1 --format coco                   # for cocopp
  armwright export results/my-arm-ga-seed1 --format ros2-control   # the winner's gains for the robot
  armwright export results/my-arm-ga-seed1 --format datasheet      # a page about the winner, to print
  armwright evaluate designs/mine.toml --problem q1-complex --test-cases results/q1/export-csv/test-cases/q1-complex.json

ros2-control, urdf and datasheet need one finished run of an arm. The other formats take a run or a study; of a study
they contain the cells that have ended. csv and json also write the test cases that the winners were judged on, for
evaluate and for other programs. docs/exporting.md describes the formats.)";

struct ExportOptions {
  std::string folder;
  std::string format;
  std::string out;
  bool force = false;
};

int run_export(const ExportOptions& options) {
  const ExportSummary summary =
      export_runs(options.folder, options.format, options.out, options.force);
  const std::string folder = sanitize(summary.folder.string());
  for (const std::string& warning : summary.warnings) {
    write_message("warning: " + warning);
  }
  if (!summary.files.empty()) {
    write_stdout(fmt::format("{} as {} in {}: {}\n", summary.winner, options.format, folder,
                             sanitize(join(summary.files, ", "))));
    return exit_code::kDone;
  }
  if (summary.unfinished > 0) {
    write_message(fmt::format("{} have not finished and are left out",
                              format_count(summary.unfinished, "cell")));
  }
  if (summary.collected.empty > 0) {
    write_message(fmt::format("{} without evaluations are left out",
                              format_count(summary.collected.empty, "run")));
  }
  write_stdout(fmt::format(
      "{} with {} on {} as {} in {}\n", format_count(summary.collected.runs, "run"),
      format_count(summary.collected.evaluations, "evaluation"),
      format_count(summary.collected.problems.size(), "problem"), options.format, folder));
  return exit_code::kDone;
}

}  // namespace

void add_export(CLI::App& app, Session& session) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* command =
      add_command(app, session, "export",
                  "Write the runs of a folder in the formats of other programs", kExportExamples);
  std::string formats = "The format:";
  for (const ExportFormat& format : export_formats()) {
    formats += fmt::format("\n{:<13} {}", format.name, format.title);
  }
  command->add_option("FOLDER", options->folder, "The folder of a run or of a study")->required();
  command->add_option("--format", options->format, formats)->type_name("FORMAT")->required();
  command
      ->add_option("--out", options->out,
                   "The new folder (default: FOLDER/export-FORMAT); nothing is overwritten")
      ->type_name("DIR");
  command->add_flag(
      "--force", options->force,
      "Write ros2-control, urdf or datasheet of a winner that fails test cases, violates\n"
      "a constraint on the test set, or is not better than the start");
  command->callback(
      [options, &session] { session.action = [options] { return run_export(*options); }; });
}

}  // namespace armwright
