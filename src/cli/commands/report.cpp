// armwright report: one HTML page of a run, a comparison or a reproduction.

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "cli/commands/page_input.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/terminal.hpp"
#include "report/page/page_data.hpp"
#include "report/page/page_file.hpp"

namespace armwright {
namespace {

constexpr const char* kReportExamples = R"(Examples:
  armwright report results/q1-complex-ga-seed1     # writes results/q1-complex-ga-seed1/report.html
  armwright report results/q1 --out q1.html        # of a comparison
  armwright report results/q1-complex-ga-seed1 --case test/2:17
  armwright report results/q1 --json | jq .verdict

The page is one file that needs nothing else: it opens from disk, without network. Of an arm's run it shows the
motion in 3D. 'armwright plot' writes its figures as SVG files, 'armwright watch' shows it while a study runs.)";

struct ReportOptions {
  PageInput input;
  std::string out;
  bool json = false;
};

// A page may be replaced by a newer one, and nothing else.
void check_target(const std::filesystem::path& file) {
  if (std::filesystem::exists(file) && !is_page_file(file)) {
    throw Error(ErrorKind::usage, fmt::format("{}: is there and is no page of armwright's; choose "
                                              "another name with --out",
                                              file.string()));
  }
}

int run_report(const ReportOptions& options, Session& session) {
  std::filesystem::path file = options.out;
  if (!options.json) {
    get_page_assets();  // says so before anything is computed, if there are none
    if (file.empty()) {
      if (std::filesystem::is_regular_file(options.input.source)) {
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
  CLI::App* command = add_command(
      app, session, "report", "Write a page that shows a run or a comparison: figures and motion",
      kReportExamples);
  options->input.add_to(*command);
  auto* out = command
                  ->add_option("--out", options->out,
                               "The page's file (default: FOLDER/report.html); an older page is "
                               "replaced, anything else is not")
                  ->type_name("FILE")
                  ->group("Output");
  command->add_flag("--json", options->json, "Print the page's data as JSON instead")
      ->group("Output")
      ->excludes(out);
  command->callback([options, &session] {
    session.action = [options, &session] { return run_report(*options, session); };
  });
}

}  // namespace armwright
