#include "cli/commands/page_input.hpp"

#include <CLI/CLI.hpp>

#include "base/error.hpp"
#include "base/folder.hpp"
#include "cli/terminal/progress_bar.hpp"
#include "cli/terminal/session.hpp"
#include "report/page/page_data.hpp"
#include "report/page/page_file.hpp"

namespace armwright {

void PageInput::add_to(CLI::App& command) {
  command
      .add_option("FOLDER", source,
                  "The folder of a run, a study or a reproduction, finished or not; or a page that "
                  "'armwright report' has written")
      ->required();
  command
      .add_option(
          "--case", cases,
          "Also show the motion in this case, as in test/2:17; repeatable (shown without it: the "
          "median test case, the 95th percentile, the worst, up to three failures, the first, and "
          "a "
          "training case)")
      ->type_name("SET:NUMBER")
      ->allow_extra_args(false);
  add_jobs_flag(command, jobs);
  command.add_flag("--quiet,-q", quiet, "Show no progress")->group("Output");
}

std::optional<std::string> PageInput::make_data(Session& session) const {
  for (const std::string& one : {source, other}) {
    if (!other.empty() && regular_file_exists(one)) {
      throw Error(ErrorKind::usage,
                  one + ": is a file; a comparison is made from two folders of runs or studies");
    }
  }
  if (regular_file_exists(source)) {
    if (!cases.empty()) {
      throw Error(
          ErrorKind::usage,
          "--case needs the folder that the page was made from, as it simulates; a page holds "
          "only the cases that were simulated for it");
    }
    return read_page_data(source);
  }
  PageOptions options;
  options.jobs = parse_jobs(jobs);
  options.cases = cases;
  catch_signals(session.stop);
  ProgressBar bar(quiet, {"error", "m"});
  return other.empty() ? make_page_data(source, options, session.stop, bar)
                       : make_comparison_page(source, other, options, session.stop, bar);
}

}  // namespace armwright
