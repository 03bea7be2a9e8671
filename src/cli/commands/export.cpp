// armwright export: runs in the formats of other programs, and an arm's winner for its maker.

#include "report/exchange/export.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "base/text.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/terminal.hpp"

namespace armwright {
namespace {

constexpr const char* kExportExamples = R"(Examples:
  armwright export results/q1-complex-ga-seed1 --format csv
  armwright export results/q1 --format ioh --out q1-ioh       # a whole study, for IOHanalyzer
  armwright export results/q1 --format coco                   # for cocopp
  armwright export results/my-arm-ga-seed1 --format ros2-control   # the winner's gains, for the robot
  armwright export results/my-arm-ga-seed1 --format datasheet      # the winner on a page to print
  armwright evaluate designs/mine.toml --problem q1-complex --test-cases results/q1/export-csv/test-cases/q1-complex.json

ros2-control, urdf and datasheet are made of one finished run of an arm, the other formats of a run or
a study: of that, the cells that have finished. With csv and json come the test cases that the winners met, as a file for
evaluate and for other programs. docs/exporting.md has the formats.)";

struct ExportOptions {
  std::string folder;
  std::string format;
  std::string out;
};

int run_export(const ExportOptions& options) {
  const ExportSummary summary = export_runs(options.folder, options.format, options.out);
  const std::string folder = sanitize(summary.folder.string());
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
    write_message(fmt::format("{} evaluated nothing and are left out",
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
  CLI::App* command = add_command(app, session, "export",
                                  "Write the runs of a folder for other programs", kExportExamples);
  std::string formats = "How to write them:";
  for (const ExportFormat& format : export_formats()) {
    formats += fmt::format("\n{:<13} {}", format.name, format.title);
  }
  command->add_option("FOLDER", options->folder, "The folder of a run or of a study")->required();
  command->add_option("--format", options->format, formats)->type_name("FORMAT")->required();
  command
      ->add_option("--out", options->out,
                   "A new folder for them (default: FOLDER/export-FORMAT); nothing is overwritten")
      ->type_name("DIR");
  command->callback(
      [options, &session] { session.action = [options] { return run_export(*options); }; });
}

}  // namespace armwright
