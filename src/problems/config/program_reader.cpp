// [program]: a problem that a user has written.

#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
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
constexpr std::size_t kProgramLimit_bytes = std::size_t{1} << 30;

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
                                     "processes may grow; beyond it the case "
                                     "is a failed case"};
const Setting<std::string> kProgramDescription{
    "description", "",
    "for the kind program: its description of itself as JSON, which armwright records; with it, "
    "the problem is read without starting the program"};

// Returns the problem of a program that uses armwright as a library (armwright/run.h). Only that
// program can compute it.
UserProgram make_host_problem(const std::string& name, const std::string& recorded) {
  UserProgram made;
  made.name = name;
  made.why_not =
      "it is computed by the program that uses armwright as a library and began the run, and only "
      "that program can continue it: start it again (armwright/run.h)";
  if (recorded.empty()) {
    throw Error(ErrorKind::usage, fmt::format("problem '{}': {}", sanitize(name), made.why_not));
  }
  made.description = read_recorded_description(recorded, name);
  return made;
}

UserProgram make_program(const std::string& command, const ServerLimits& limits,
                         const std::string& recorded, const ConfigTable& table) {
  if (command.starts_with(kExec)) {
    return make_program_problem(std::string_view(command).substr(kExec.size()), limits, recorded);
  }
  if (command.starts_with(kHost)) {
    return make_host_problem(command, recorded);
  }
  // A recorded problem is read without its library, which may be gone.
  if (is_problem_library(command) || (!recorded.empty() && command.find('/') != command.npos)) {
    return make_library_problem(command, limits, recorded);
  }
  table.refuse(kProgramCommand,
               "it must begin with exec:, as in \"exec:python3 motor.py\", or be the path of a "
               "shared library, as in \"./libmotor.so\"");
}

// Returns the files that decide what a program computes: the words of a command that are files, or a
// library that exists.
std::vector<std::string> list_files(const std::string& command) {
  if (command.starts_with(kExec)) {
    return list_program_files(std::string_view(command).substr(kExec.size()));
  }
  std::error_code ignored;
  return !command.starts_with(kHost) && std::filesystem::is_regular_file(command, ignored)
             ? std::vector{command}
             : std::vector<std::string>{};
}

}  // namespace

const SettingTable kProgramSettings{
    .key = "program",
    .settings = {&kProgramCommand, &kProgramTimeLimit, &kProgramMemory, &kProgramDescription}};

bool is_program_name(std::string_view name) {
  return name.starts_with(kExec) || name.starts_with(kHost) || is_problem_library(name);
}

void load_program(const ConfigTable& table, LoadedProblem& loaded) {
  const ConfigTable program = table.get_table(kProgramSettings);
  const std::string command = program.get(kProgramCommand);
  const ServerLimits limits{.time_limit_s = program.get(kProgramTimeLimit),
                            .memory_mib = program.get(kProgramMemory)};
  UserProgram made = make_program(command, limits, program.get(kProgramDescription), program);
  program.settle(kProgramDescription, to_json(made.description));
  loaded.program = command;
  loaded.name = made.description.name;
  loaded.title = made.description.summary;
  loaded.sets.training_cases = made.description.training_cases;
  loaded.sets.validation_cases = static_cast<int>(made.description.validation_cases);
  loaded.sets.test_cases = static_cast<int>(made.description.test_cases);
  for (const std::string& file : list_files(command)) {
    loaded.input_hashes[file] = calc_sha256_hex(read_file(file, kProgramLimit_bytes));
  }
  loaded.problem = make_user_problem(std::move(made));
}

}  // namespace armwright
