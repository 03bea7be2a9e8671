// armwright doctor: checks whether stored files are intact, or whether this machine meets
// armwright's requirements.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/stop_signal.hpp"
#include "base/text.hpp"
#include "cli/commands/commands.hpp"
#include "cli/commands/system_check.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/table.hpp"
#include "cli/terminal/terminal.hpp"
#include "cli/views/store_view.hpp"
#include "study/survey/store_repair.hpp"
#include "study/survey/store_survey.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr const char* kDoctorExamples = R"(Examples:
  armwright doctor                                 # check whether this machine meets armwright's requirements
  armwright doctor results/irb4600-auto-seed1     # check whether the files of this run are intact
  armwright doctor results/q1                      # check all cells of a study
  armwright doctor results/q1 --repair             # make a copy, results/q1.repaired, without damaged records
  armwright doctor results/q1 --json | jq .damaged

The command only reads, also while a run is writing; --repair does not change the original. The exit code is 0 if
everything is intact, or if nothing is missing on the machine, 3 if something that optimizing needs is missing, 4 if a
stored file is damaged, and 5 if --repair finds a process that writes the folder. docs/doctor.md explains the checks.)";

struct DoctorOptions {
  std::string folder;
  std::string out;
  bool repair = false;
  bool json = false;
};

std::string describe_checks(const std::vector<SystemCheck>& checks, const Style& style) {
  std::string text;
  for (auto group = checks.begin(); group != checks.end();) {
    const auto end = std::find_if(
        group, checks.end(), [&](const SystemCheck& check) { return check.group != group->group; });
    Table table({{"", false}, {"", false}, {"", false, true}});
    for (auto check = group; check != end; ++check) {
      const bool is_good = check->state == CheckState::good;
      table.add_row({is_good                           ? ""
                     : check->state == CheckState::bad ? "BAD"
                                                       : "no",
                     check->name,
                     check->found + (check->remedy.empty() ? "" : ". To do: " + check->remedy)});
    }
    text += style.bold(group->group) + "\n" + table.format(style, 2, get_text_width(Stream::out));
    group = end;
  }
  return text;
}

int check_installation(const DoctorOptions& options, const Session& session) {
  const std::vector<SystemCheck> checks = check_system();
  const auto count = [&](CheckState state) {
    return static_cast<unsigned long long>(std::ranges::count(checks, state, &SystemCheck::state));
  };
  const bool is_usable = count(CheckState::bad) == 0;
  if (options.json) {
    json list = json::array();
    for (const SystemCheck& check : checks) {
      list.push_back({{"group", check.group},
                      {"name", check.name},
                      {"state", to_string(check.state)},
                      {"found", check.found},
                      {"remedy", check.remedy}});
    }
    write_stdout(json{{"usable", is_usable}, {"checks", list}}.dump(1) + "\n");
  } else {
    const Style style = make_style(Stream::out, session.color);
    const std::string optional =
        count(CheckState::lacking) == 0
            ? ""
            : fmt::format(" ({} that armwright can do without)",
                          format_count(count(CheckState::lacking), "thing"));
    write_stdout(describe_checks(checks, style) + "\n" +
                 (is_usable ? "Everything that optimizing an arm needs is there" + optional + ".\n"
                            : fmt::format("{} must be fixed before an arm can be optimized.\n",
                                          format_count(count(CheckState::bad), "thing"))));
  }
  return is_usable ? exit_code::kDone : exit_code::kFailed;
}

int check_store(const DoctorOptions& options, const Session& session) {
  const StoreSurvey survey = survey_store(options.folder);
  const std::string& program = session.command_line.front();
  if (options.json) {
    write_stdout(to_json(survey, program).dump(1) + "\n");
  } else {
    write_stdout(describe_survey(survey, program, make_style(Stream::out, session.color)));
  }
  return survey.is_damaged() ? exit_code::kBadData : exit_code::kDone;
}

int repair(const DoctorOptions& options, Session& session) {
  const std::filesystem::path folder = options.folder;
  const auto target =
      options.out.empty() ? choose_repaired_folder(folder) : std::filesystem::path(options.out);
  catch_signals(session.stop);
  std::optional<StoreRepair> repaired;
  try {
    repaired = repair_store(folder, target, session.stop);
  } catch (const WorkStopped&) {
    write_message(fmt::format("{}: no copy was made", describe_stop(session.stop.reason())));
    return get_stop_code(session.stop.reason());
  }
  const std::string& program = session.command_line.front();
  if (!repaired) {
    if (options.json) {
      write_stdout(json{{"copy", nullptr}}.dump(1) + "\n");
    } else {
      write_stdout(fmt::format("{}: all stored files are intact; no copy was made\n",
                               sanitize(folder.string())));
    }
    return exit_code::kDone;
  }
  const StoreSurvey copy = survey_store(repaired->copy);
  if (options.json) {
    write_stdout(to_json(*repaired, copy, program).dump(1) + "\n");
  } else {
    write_stdout(describe_repair(*repaired, copy, program));
  }
  return exit_code::kDone;
}

int run_doctor(const DoctorOptions& options, Session& session) {
  if (!options.out.empty() && !options.repair) {
    throw Error(ErrorKind::usage,
                "--out names the copy that --repair makes; give both flags or neither");
  }
  if (!options.folder.empty()) {
    return options.repair ? repair(options, session) : check_store(options, session);
  }
  if (options.repair) {
    throw Error(ErrorKind::usage,
                "--repair needs a FOLDER: the folder of a run, a study or a reproduction");
  }
  return check_installation(options, session);
}

}  // namespace

void add_doctor(CLI::App& app, Session& session) {
  auto options = std::make_shared<DoctorOptions>();
  CLI::App* command = add_command(
      app, session, "doctor",
      "Check the files in a folder and repair them, or check this machine and installation",
      kDoctorExamples);
  command->add_option("FOLDER", options->folder,
                      "The folder of a run, a study or a reproduction\n"
                      "(without it, the machine and the installation are checked)");
  command->add_flag("--repair", options->repair,
                    "Make a copy without the damaged records, which can be resumed");
  command
      ->add_option("--out", options->out,
                   "The folder of the copy that --repair makes (default: FOLDER.repaired)")
      ->type_name("FOLDER")
      ->group("Output");
  command->add_flag("--json", options->json, "Print the findings as JSON")->group("Output");
  command->callback([options, &session] {
    session.action = [options, &session] { return run_doctor(*options, session); };
  });
}

}  // namespace armwright
