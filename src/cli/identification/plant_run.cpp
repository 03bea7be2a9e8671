#include "cli/identification/plant_run.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iterator>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/toml_text.hpp"
#include "cli/terminal/progress_bar.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/terminal.hpp"
#include "study/run/run_folder.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {

std::string write_list(const std::vector<std::string>& words) {
  std::vector<std::string> quoted;
  std::ranges::transform(words, std::back_inserter(quoted), quote_toml);
  return "[" + join(quoted, ", ") + "]";
}

void PlantRunOptions::add_run_flags(CLI::App& command, const std::string& fallback,
                                    const std::string& report) {
  add_to(command);
  overrides.add_to(command);
  add_jobs_flag(command, jobs);
  add_time_limit_flag(command, time_limit);
  folder.add_to(command, "run", fallback);
  command.add_flag("--json", json, "Print " + report)->group("Output");
  command.add_flag("--quiet,-q", quiet, "Show no progress")->group("Output");
}

void PlantRunOptions::add_setting(const std::string& table, const std::string& key,
                                  const std::string& given, const std::string& value) {
  if (!given.empty()) {
    overrides.set.push_back(fmt::format("{}.{}={}", table, key, value));
  }
}

void PlantRunOptions::add_shared_settings(const std::string& table) {
  add_setting(table, "fit", fit, write_list(split(fit, ',')));
  add_setting(table, "payload_kg", payload, payload);
  add_setting(table, "payload_com_m", payload_com, "[" + payload_com + "]");
}

RunRequest PlantRunOptions::make_request(Session& session) const {
  if (overrides.robot.empty() &&
      std::ranges::find(overrides.set, "robot.urdf", get_override_key) == overrides.set.end()) {
    throw Error(ErrorKind::usage,
                "--robot is required: the URDF or MJCF file of the robot, or a shipped robot "
                "(armwright list robots)");
  }
  RunRequest request;
  request.jobs = parse_jobs(jobs);
  apply_time_limit(time_limit, session.stop);
  request.plan = make_plan();
  request.folder = folder.choose(make_folder_name(request.plan, get_overrides()));
  request.command_line = session.command_line;
  return request;
}

std::optional<RunResult> PlantRunOptions::execute(const RunRequest& request, std::size_t parameters,
                                                  std::span<const std::string> notes,
                                                  const std::string& what, Session& session) const {
  const LoadedProblem& loaded = request.plan.problem;
  if (!quiet) {
    write_message(fmt::format("{}: {} parameters, optimizer {}, folder {}", loaded.name, parameters,
                              request.plan.optimizer.name, request.folder.string()));
    std::ranges::for_each(notes, write_message);
  }
  catch_signals(session.stop);
  ProgressBar bar(quiet, get_scalar_quantity(loaded.problem->description().objectives));
  LockedObserver observer(bar);
  auto result = execute_run(request, session.stop, observer);
  bar.clear();
  if (result && !result->winner) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{} could be evaluated: {}", what, result->first_failure));
  }
  return result;
}

}  // namespace armwright
