// What identify and excite share: flags, and a run of their problem.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli/commands/plan_options.hpp"
#include "cli/terminal/arguments.hpp"
#include "study/run/run.hpp"

namespace armwright {

struct Session;

struct PlantRunOptions : PlanOptions {
  std::string fit, payload, payload_com;
  std::string jobs, time_limit;
  FolderOptions folder;
  bool json = false;
  bool quiet = false;

  // Adds the flags of a run. `fallback` is the default folder, `report` the file that --json prints.
  void add_run_flags(CLI::App& command, const std::string& fallback, const std::string& report);
  // Makes a setting of a flag that was given. `table` is the problem's table.
  void add_setting(const std::string& table, const std::string& key, const std::string& given,
                   const std::string& value);
  // Does so for --fit, --payload and --payload-com.
  void add_shared_settings(const std::string& table);
  RunRequest make_request(Session& session) const;
  // Executes the run. Returns nothing if it was stopped. Throws Error{bad_data} "WHAT could be
  // evaluated: REASON" if there is no winner.
  std::optional<RunResult> execute(const RunRequest& request, std::size_t parameters,
                                   std::span<const std::string> notes, const std::string& what,
                                   Session& session) const;
};

// Returns the words as a list in TOML.
std::string write_list(const std::vector<std::string>& words);

}  // namespace armwright
