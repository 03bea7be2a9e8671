// armwright report: writes one HTML page about a run, a study or a reproduction, or about two of them.

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "cli/commands/commands.hpp"
#include "cli/commands/page_input.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/terminal.hpp"
#include "report/page/page_data.hpp"
#include "report/page/page_file.hpp"

namespace armwright {
namespace {

constexpr const char* kReportExamples = R"(Examples:
  armwright report results/irb4600-auto-seed1     # writes results/irb4600-auto-seed1/report.html
  armwright report results/q1 --out q1.html        # a page about a study
  armwright report results/q1-ga results/q1-cmaes  # compares two runs, or two studies: comparison.html
  armwright report results/irb4600-auto-seed1 --case test/2:17
  armwright report results/q1 --json | jq .verdict

The page is a single file that opens from disk, without a network. For the run of an arm, it shows the motion in 3D.
'armwright plot' writes its figures as SVG files. 'armwright watch' shows the page while a study runs.)";

struct ReportOptions {
  PageInput input;
  std::string out;
  bool json = false;
};

// Throws Error{usage} if the file exists and is not a page. A newer page may replace an older one.
void check_target(const std::filesystem::path& file) {
  if (path_exists(file) && !(regular_file_exists(file) && is_page_file(file))) {
    throw Error(ErrorKind::usage, fmt::format("{}: exists and is not a page of armwright; choose "
                                              "another name with --out",
                                              file.string()));
  }
}

int run_report(const ReportOptions& options, Session& session) {
  std::filesystem::path file = options.out;
  if (!options.json) {
    get_page_assets();  // throws before anything is computed if this build has no page
    if (file.empty() && !options.input.other.empty()) {
      file = "comparison.html";
    } else if (file.empty()) {
      if (regular_file_exists(options.input.source)) {
        throw Error(ErrorKind::usage,
                    fmt::format("{}: name the new page with --out", options.input.source));
      }
      file = std::filesystem::path(options.input.source) / "report.html";
    }
    check_target(file);
  }
  const std::optional<std::string> data = options.input.make_data(session);
  if (!data) {
    write_message(fmt::format("{}; nothing was written", describe_stop(session.stop.reason())));
    return get_stop_code(session.stop.reason());
  }
  if (options.json) {
    write_stdout(*data + "\n");
    return exit_code::kDone;
  }
  const std::string html = make_page_html(get_page_title(*data), *data);
  write_file_atomically(file, html);
  write_stdout(fmt::format("{} ({:.1f} MB): open it in a browser\n", sanitize(file.string()),
                           static_cast<double>(html.size()) / 1e6));
  return exit_code::kDone;
}

}  // namespace

void add_report(CLI::App& app, Session& session) {
  auto options = std::make_shared<ReportOptions>();
  CLI::App* command =
      add_command(app, session, "report", "Write a page about a run or a study: figures and motion",
                  kReportExamples);
  options->input.add_to(*command);
  command->add_option("OTHER", options->input.other,
                      "A second folder: the page compares both, which must be two runs or two "
                      "studies");
  auto* out =
      command
          ->add_option("--out", options->out,
                       "The page's file (default: FOLDER/report.html, or comparison.html in "
                       "the current folder for two folders); only a page may be replaced")
          ->type_name("FILE")
          ->group("Output");
  command->add_flag("--json", options->json, "Print the page's data as JSON, and write no page")
      ->group("Output")
      ->excludes(out);
  command->callback([options, &session] {
    session.action = [options, &session] { return run_report(*options, session); };
  });
}

}  // namespace armwright
