#include "cli/commands/page_input.hpp"

#include <CLI/CLI.hpp>

#include "base/error.hpp"
#include "cli/terminal/progress_bar.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/signals.hpp"
#include "report/page/page_data.hpp"
#include "report/page/page_file.hpp"

namespace armwright {

void PageInput::add_to(CLI::App& command) {
  command
      .add_option("FOLDER", source,
                  "The folder of a run, a comparison or a reproduction, finished or not; or a page "
                  "that report has written")
      ->required();
  command
      .add_option(
          "--case", cases,
          "Replay this test case as well, as in test/2:17; repeatable (the usual ones: the "
          "first of training; of the test set the first, median, worst and those that fail)")
      ->type_name("SET:NUMBER")
      ->allow_extra_args(false);
  jobs.add_to(command);
  command.add_flag("--quiet,-q", quiet, "No progress")->group("Output");
}

std::optional<std::string> PageInput::make_data(Session& session) const {
  if (std::filesystem::is_regular_file(source)) {
    if (!cases.empty()) {
      throw Error(ErrorKind::usage,
                  "--case simulates, for which the folder is needed that the page was made of; the "
                  "page itself holds only the cases that were simulated for it");
    }
    return read_page_data(source);
  }
  PageOptions options;
  options.jobs = jobs.get();
  options.cases = cases;
  catch_signals(session.stop);
  ProgressBar bar(quiet, {"error", "m"});
  return make_page_data(source, options, session.stop, bar);
}

}  // namespace armwright
