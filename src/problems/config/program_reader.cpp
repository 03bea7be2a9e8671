// [program]: a problem that a user has written.

#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"
#include "base/text.hpp"
#include "problems/config/problem_readers.hpp"
#include "problems/user/library_server.hpp"
#include "problems/user/program_server.hpp"
#include "problems/user/user_problem.hpp"
#include "process/command_words.hpp"

namespace armwright {
namespace {

constexpr std::string_view kExec = "exec:";
constexpr std::string_view kHost = "host:";
constexpr std::string_view kPython = "python:";

const Setting<std::string> kProgramCommand{
    "command", kNoDefault,
    "for the kind program: what computes it; exec:COMMAND is a program that answers questions in "
    "JSON lines, ./NAME.so a shared library"};
const Setting<double> kProgramTimeLimit{
    "time_limit_s",
    {.lower = 0, .upper = 1e7, .lower_open = true},
    ServerLimits{}.time_limit_s,
    "for the kind program: longest time for one case; a case that takes longer is a failed case, "
    "and the program is started again"};
const Setting<double> kProgramMemory{"memory_mib",
                                     {.lower = 1, .upper = 1e7},
                                     ServerLimits{}.memory_mib,
                                     "for the kind program: how much the memory of one of its "
                                     "processes may grow, of a program together with what it has "
                                     "started; beyond it the case is a failed case"};
const Setting<std::string> kProgramDescription{
    "description", "",
    "for the kind program: its description of itself as JSON, which armwright records; with it, "
    "the problem is read without starting the program"};

// Returns what to do with a problem that a host program computes; empty for other problems.
std::string explain_host_problem(std::string_view command) {
  if (command.starts_with(kPython)) {
    return "it belongs to a program in Python; run it from there (docs/python.md). show, report "
           "and export work without it";
  }
  return command.starts_with(kHost)
             ? "it is computed by the program that uses armwright as a library and began the run, "
               "and only that program can continue it: start it again (armwright/run.h)"
             : "";
}

// Describes a problem by its program, or takes the recorded description, and sets how it starts.
UserProgram make_program(const std::string& command, const ServerLimits& limits,
                         const std::string& recorded, const ProgramSource& programs,
                         const ConfigTable& table) {
  const auto host = std::ranges::find(programs.hosts, command, &UserProgram::name);
  if (host != programs.hosts.end()) {
    if (!recorded.empty()) {
      check_same_description(command, read_recorded_description(recorded, command),
                             host->description);
    }
    return *host;
  }
  UserProgram program{.name = command, .why_not = explain_host_problem(command)};
  const bool is_host = !program.why_not.empty();
  const bool is_exec = command.starts_with(kExec);
  // A recorded problem is read without its library, which may be gone.
  if (!is_host && !is_exec && !is_problem_library(command) &&
      (recorded.empty() || command.find('/') == std::string::npos)) {
    table.refuse(kProgramCommand,
                 "it must begin with exec:, as in \"exec:python3 motor.py\", or be the path of a "
                 "shared library, as in \"./libmotor.so\"");
  }
  const std::string words = is_exec ? command.substr(kExec.size()) : "";
  if (!recorded.empty()) {
    program.description = read_recorded_description(recorded, command);
  } else if (is_host) {
    throw Error(ErrorKind::usage,
                fmt::format("problem '{}': {}", sanitize(command), program.why_not));
  } else if (!programs.may_describe) {
    throw Error(ErrorKind::bad_data,
                fmt::format("problem '{}': its description is not recorded (program.description), "
                            "and this command starts no program. The file of a study of your own "
                            "must have another name than study.toml, or lie in another folder than "
                            "the cells of a study",
                            sanitize(command)));
  } else {
    program.description = is_exec ? describe_program(words) : describe_library(command, limits);
  }
  if (is_host) {
    return program;
  }
  if (!programs.may_simulate) {
    program.why_not = kStartsNothing;
  } else if (is_exec) {
    program.start = make_program_start(words, limits, program.description);
  } else {
    program.start = make_library_start(command, limits, program.description);
  }
  return program;
}

// Returns the files that decide what a program computes: the words of a command that are files, or a
// library that exists.
std::vector<std::string> list_files(const std::string& command) {
  if (command.starts_with(kExec)) {
    return list_program_files(std::string_view(command).substr(kExec.size()));
  }
  std::error_code ignored;
  return explain_host_problem(command).empty() && std::filesystem::is_regular_file(command, ignored)
             ? std::vector{command}
             : std::vector<std::string>{};
}

}  // namespace

const SettingTable kProgramSettings{
    .key = "program",
    .settings = {&kProgramCommand, &kProgramTimeLimit, &kProgramMemory, &kProgramDescription}};

bool is_program_name(std::string_view name) {
  return name.starts_with(kExec) || !explain_host_problem(name).empty() || is_problem_library(name);
}

void set_user_cases(const UserDescription& description, LoadedProblem& loaded) {
  loaded.sets.training_cases = description.training_cases;
  loaded.sets.validation_cases = static_cast<int>(description.validation_cases);
  loaded.sets.test_cases = static_cast<int>(description.test_cases);
  loaded.is_deterministic = description.is_deterministic;
}

void load_program(const ConfigTable& table, const ProgramSource& programs, LoadedProblem& loaded) {
  const ConfigTable program = table.get_table(kProgramSettings);
  const std::string command = program.get(kProgramCommand);
  const ServerLimits limits{.time_limit_s = program.get(kProgramTimeLimit),
                            .memory_mib = program.get(kProgramMemory)};
  UserProgram made =
      make_program(command, limits, program.get(kProgramDescription), programs, program);
  program.settle(kProgramDescription, to_json(made.description));
  loaded.program = command;
  loaded.name = made.description.name;
  loaded.title = made.description.summary;
  set_user_cases(made.description, loaded);
  for (const std::string& file : list_files(command)) {
    loaded.input_hashes[file] = calc_program_hash(file);
  }
  loaded.problem = make_user_problem(std::move(made));
}

}  // namespace armwright
