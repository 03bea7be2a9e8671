// armwright watch: serves the page of a run or study to this machine while the run or study is in
// progress.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <optional>

#include "base/stop_signal.hpp"
#include "base/text.hpp"
#include "cli/commands/commands.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/browser.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/terminal.hpp"
#include "report/page/page_data.hpp"
#include "report/page/page_server.hpp"
#include "report/page/progress_meter.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {
namespace {

constexpr const char* kWatchExamples = R"(Examples:
  armwright compare configs/studies/q1.toml &      # start a study
  armwright watch results/q1                       # print an address and open it; Ctrl-C ends the command
  armwright watch results/q1 --port 8642 --no-open

The command only reads, and it answers only this machine (127.0.0.1); over ssh, forward the port with ssh -L. The address
has a random part, without which other users of the machine get nothing: pass it on only to people who may see the
page. On a terminal, the page opens in the browser $BROWSER, or with xdg-open if there is a display.

While the run or study is in progress, the page begins with a progress bar, the time left, the simulations per second,
the cells that are running, and failures. The page leaves out figures that need simulations (the motion in 3D, curves on the test set); 'armwright report' makes them.)";

struct WatchOptions {
  std::string folder;
  std::string port = "0";
  bool no_open = false;
};

// The page is made without showing progress.
class SilentObserver final : public RunObserver {
 public:
  void on_progress(const Progress&) override {}
  void on_message(const std::string&) override {}
};

int run_watch(const WatchOptions& options, Session& session) {
  const int port = static_cast<int>(parse_count("--port", options.port, 0, 65535));
  catch_signals(session.stop);
  ProgressMeter meter;
  const auto make_data = [&] {
    PageOptions page;
    page.simulate = false;
    page.meter = &meter;
    SilentObserver observer;
    const auto data = make_page_data(options.folder, page, session.stop, observer);
    if (!data) {
      throw WorkStopped{};
    }
    return *data;
  };
  try {
    const std::string first = make_data();  // throws now if there is nothing to show
    PageServer server(port, get_page_title(first), make_data);
    std::optional<OpenedAddress> opened;
    if (!options.no_open) {
      opened.emplace(server.url());
    }
    write_stdout(
        fmt::format("{} shows {}; Ctrl-C ends it\n", server.url(), sanitize(options.folder)));
    server.serve(session.stop);
  } catch (const WorkStopped&) {
    // The stop came while a page was made.
  }
  return session.stop.reason() == StopReason::interrupted ? exit_code::kDone
                                                          : get_stop_code(session.stop.reason());
}

}  // namespace

void add_watch(CLI::App& app, Session& session) {
  auto options = std::make_shared<WatchOptions>();
  CLI::App* command = add_command(
      app, session, "watch", "Serve the page of a run or a study to this machine while it runs",
      kWatchExamples);
  command->add_option("FOLDER", options->folder, "The folder of a run, a study or a reproduction")
      ->required();
  command->add_option("--port", options->port, "Port of 127.0.0.1 (default: 0, any free port)")
      ->type_name("N");
  command->add_flag("--no-open", options->no_open, "Do not open the page in a browser");
  command->callback([options, &session] {
    session.action = [options, &session] { return run_watch(*options, session); };
  });
}

}  // namespace armwright
