#include "cli/app.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iterator>
#include <new>
#include <span>
#include <string_view>
#include <system_error>
#include <tuple>

#include "base/build_info.hpp"
#include "base/error.hpp"
#include "base/file_descriptor.hpp"
#include "base/read_limit.hpp"
#include "base/text.hpp"
#include "cli/commands/commands.hpp"
#include "cli/identification/identification_commands.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/terminal.hpp"
#include "cli/terminal/typed_flags.hpp"
#include "process/command_words.hpp"
#include "sim/simd/simd_level.hpp"
#include "study/executor/mpi_transport.hpp"

namespace armwright {
namespace {

constexpr const char* kSummary =
    "Tunes and designs robot arms by simulation, with interchangeable optimizers that need no "
    "derivatives.";

constexpr const char* kFooter = R"(Examples:
  armwright list problems                          # the problems that can be optimized
  armwright list optimizers ga                     # one optimizer and its options
  armwright optimize q1-complex --seed 1           # tune the arm as in the thesis; resumes if interrupted
  armwright compare --preset smoke                 # compare optimizers, with statistics
  armwright compare q1 --executor slurm            # the same on a cluster, followed by status and merge
  armwright rerun results/q1 q1-complex/ga/r03     # repeat one run of a study and compare all bits
  armwright evaluate table-a10                     # a published design on 500 test cases
  armwright verify table-a10                       # check the design with other engines, time steps and masses
  armwright reproduce                              # the published results of the thesis beside ours
  armwright report results/q1                      # write a page with figures and the arm's motion in 3D
  armwright export results/q1 --format csv         # write its evaluations as csv, ioh, coco or json
  armwright doctor results/q1                      # check the stored files; without a folder, this machine
  armwright manual optimize                        # the manual page of a command

'armwright COMMAND --help' explains a command, with examples.

Results go to standard output, progress and messages to standard error. NO_COLOR and --color control colours.

Exit codes:
  0    done
  2    wrong usage or configuration
  3    done, but something failed (a case without a number, nothing feasible found, a design that does not hold)
  4    an input file (robot, path, design, test cases, a recorded run) cannot be used, or exceeds --read-limit
  5    another process writes this folder, or has taken over this cell
  74   reading or writing failed, or no memory is left
  75   stopped by a time limit or SIGTERM; the same command resumes
  130  interrupted (Ctrl-C); the same command resumes
  1    a bug in armwright

Environment: ARMWRIGHT_JOBS, ARMWRIGHT_SEED and ARMWRIGHT_READ_LIMIT are used if --jobs, --seed and --read-limit are not
given. ARMWRIGHT_CONFIGS names the folder of the shipped configuration. ARMWRIGHT_SIMD limits the instruction set that is chosen without --simd.)";

// What `armwright` alone prints.
constexpr const char* kGuide =
    R"(armwright tunes and designs robot arms by simulation. It also optimizes functions, and programs of your own.

Three commands to begin with:
  armwright list problems                       # what can be optimized
  armwright optimize irb4600                    # tune a robot arm; the numbers appear here
  armwright report results/irb4600-auto-seed1   # the tuned arm as a page, with its motion in 3D

Help:
  armwright --help                              # all commands, with examples
  armwright COMMAND --help                      # one command: its arguments, flags and examples
  armwright doctor                              # whether this machine meets the requirements
)";

// Returns what --version prints: version, commit, compiler, processor, SIMD levels and libraries.
std::string describe_version() {
  const auto build = describe_build();
  std::string text = fmt::format("armwright {}\n", get_version());
  const auto add = [&text](const std::string& what, const std::string& value) {
    text += fmt::format("  {:<13} {}\n", what, value);
  };
  add("git", build.at("git"));
  add("compiler", build.at("compiler"));
  add("build type", build.at("build_type"));
  add("processor", build.at("cpu"));
  add("SIMD levels", fmt::format("{}; default {}", join(supported_simd_names(), ", "),
                                 to_string(find_best_simd())));
  add("host", build.at("host"));
  text += "Libraries it was built with:\n";
  std::vector<std::string> missing;
  for (const auto& [library, version] : list_libraries()) {
    if (version.empty()) {
      missing.push_back(library);
    } else {
      add(library, version);
    }
  }
  if (!missing.empty()) {
    text += fmt::format("Not in this build: {}\n", join(missing, ", "));
  }
  return text;
}

std::vector<std::string> list_commands(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) {
    names.push_back(command->get_name());
  }
  return names;
}

std::vector<std::string> list_flags(const CLI::App& app) {
  std::vector<std::string> flags;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) {
      flags.push_back("--" + name);
    }
  }
  return flags;
}

// Returns the innermost subcommand on the command line, and its full name in `name`.
const CLI::App& find_chosen(const CLI::App& app, std::string& name) {
  name = app.get_name();
  const CLI::App* chosen = &app;
  while (!chosen->get_subcommands().empty()) {
    chosen = chosen->get_subcommands().back();
    name += " " + chosen->get_name();
  }
  return *chosen;
}

// Returns the message for a command of the user that the shell has split, as --optimizer python3
// mine.py: the words after its first one are left over. Empty if there is none.
std::string describe_split_command(const CLI::App& chosen, const std::vector<std::string>& extras) {
  for (const auto& [option, kind, flag] : {std::tuple{"--optimizer", "optimizer", "--optimizer "},
                                           std::tuple{"PROBLEM", "problem", ""}}) {
    const CLI::Option* const found = chosen.get_option_no_throw(option);
    if (found == nullptr || found->count() == 0 || !is_interpreter(found->results().front())) {
      continue;
    }
    std::vector<std::string> words = {found->results().front()};
    const CLI::Option* const problem = chosen.get_option_no_throw("PROBLEM");
    const bool has_taken_script = problem != nullptr && problem != found && problem->count() > 0 &&
                                  !suggest_exec(problem->results().front()).empty();
    if (has_taken_script) {
      words.push_back(problem->results().front());
    } else {
      std::ranges::copy(extras, std::back_inserter(words));
    }
    return describe_missing_exec(kind, join(words, " "), flag);
  }
  return "";
}

// Returns what is wrong with the command line. The parser's own messages are less helpful.
std::string describe_mistake(const CLI::App& app, const CLI::ParseError& error) {
  std::string name;
  const CLI::App& chosen = find_chosen(app, name);
  const std::string see = fmt::format("\nSee '{} --help'", name);
  const auto extras = app.remaining(true);
  const auto flag = std::find_if(extras.begin(), extras.end(), [](const std::string& text) {
    return text.size() > 1 && text[0] == '-';
  });
  if (const std::string split = describe_split_command(chosen, extras);
      !extras.empty() && !split.empty()) {
    return split + see;
  }
  const auto commands = list_commands(chosen);
  if (!commands.empty() && !extras.empty() && flag != extras.begin()) {
    return describe_unknown("command", extras.front(), commands) + see;
  }
  if (flag != extras.end()) {
    const std::string typed = flag->substr(0, flag->find('='));
    return describe_unknown("flag", typed, list_flags(chosen)) + see;
  }
  if (!commands.empty()) {
    return fmt::format("a command is missing. Valid: {}", list_valid("", commands)) + see;
  }
  if (!extras.empty()) {
    return fmt::format("unexpected argument '{}'", sanitize(extras.front())) + see;
  }
  const std::string what = error.what();
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr) {
    const std::string which = what.substr(0, what.find(':'));
    return which + (what.ends_with("missing") ? " needs a value" : " is given more than once") +
           see;
  }
  return what + see;
}

// Returns whether the command that was given shows no progress.
bool is_quiet(const CLI::App& app) {
  const CLI::Option* quiet = app.get_option_no_throw("--quiet");
  return (quiet != nullptr && quiet->count() > 0) ||
         std::ranges::any_of(app.get_subcommands(),
                             [](const CLI::App* command) { return is_quiet(*command); });
}

// Limits what this process reads, and also the jobs and ranks that it starts: they inherit the
// environment.
void apply_read_limit(const CLI::App& app, Session& session) {
  ReadLimit limit;
  if (!session.read_limit.empty()) {
    limit = parse_read_limit(session.read_limit);
    ::setenv("ARMWRIGHT_READ_LIMIT", session.read_limit.c_str(), 1);
  }
  set_read_limit(limit, session.stop, [quiet = is_quiet(app)](const std::string& progress) {
    if (!quiet) {
      write_message(progress);
    }
  });
}

[[noreturn]] void refuse_empty_value(std::string_view flag) {
  throw Error(ErrorKind::usage,
              fmt::format("{} has an empty value; give it a value or leave it out", flag));
}

// Throws Error{usage} for "--flag=", of which the parser would take the next word as the value.
void refuse_empty_assignments(std::span<char* const> words) {
  for (const std::string_view word : words) {
    if (word == "--") {
      return;
    }
    if (word.starts_with("--") && word.find('=') == word.size() - 1) {
      refuse_empty_value(word.substr(0, word.size() - 1));
    }
  }
}

// Throws Error{usage} for an empty value, which would count as if it were not there.
void refuse_empty_values(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    if (std::ranges::find(option->results(), "") != option->results().end()) {
      refuse_empty_value(option->get_name());
    }
  }
  for (const CLI::App* command : app.get_subcommands()) {
    refuse_empty_values(*command);
  }
}

int parse_and_run(CLI::App& app, Session& session, int argc, char** argv) {
  if (argc == 1) {
    write_stdout(kGuide);
    return exit_code::kDone;
  }
  refuse_empty_assignments(std::span(argv, static_cast<std::size_t>(argc)).subspan(1));
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    write_stdout(app.help());
    return exit_code::kDone;
  } catch (const CLI::CallForVersion&) {
    write_stdout(describe_version());
    return exit_code::kDone;
  } catch (const CLI::ParseError& error) {
    throw Error(ErrorKind::usage, describe_mistake(app, error));
  }
  refuse_empty_values(app);
  const std::vector<std::string> choices = {"auto", "always", "never"};
  if (std::find(choices.begin(), choices.end(), session.color) == choices.end()) {
    throw Error(ErrorKind::usage, describe_unknown("--color", session.color, choices));
  }
  apply_read_limit(app, session);
  const auto place = find_rank_place();
  if (place && !session.shares_work) {
    if (place->rank > 0) {
      return exit_code::kDone;
    }
    write_message(fmt::format(
        "note: only the first of {} ranks works; only optimize and compare use all ranks",
        place->size));
  }
  return session.action();
}

// Opens /dev/null in place of each closed standard stream. Otherwise the next file that is opened,
// perhaps a journal, would get the stream's number and the printed text. It is opened for reading
// only, so that printing fails with an error.
void occupy_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) < 0 && ::open("/dev/null", O_RDONLY) != stream) {
      throw Error(ErrorKind::io, "/dev/null: cannot open it in place of a closed standard stream");
    }
  }
}

int get_exit_code(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::usage:
      return exit_code::kUsage;
    case ErrorKind::bad_data:
      return exit_code::kBadData;
    case ErrorKind::busy:
      return exit_code::kBusy;
    case ErrorKind::io:
      break;
  }
  return exit_code::kIo;
}

// Tells the user that no memory is left. Does not allocate.
void report_no_memory() {
  constexpr std::string_view kMessage =
      "armwright: error: no memory left; use fewer --jobs or a smaller problem, or raise the limit "
      "of memory (ulimit -v)\n";
  [[maybe_unused]] const ssize_t put = ::write(STDERR_FILENO, kMessage.data(), kMessage.size());
}

constexpr std::size_t kPage_bytes = 4096;

// What ends the program by default: it prints the exception and aborts.
std::terminate_handler g_end_of_library = nullptr;

// Ends the program if an exception leaves a thread, a function that must not throw, or the
// initialization of a library.
[[noreturn]] void end_uncaught() {
  if (const auto exception = std::current_exception()) {
    try {
      std::rethrow_exception(exception);
    } catch (const std::bad_alloc&) {
      report_no_memory();
      ::_exit(exit_code::kIo);
    } catch (...) {
    }
  } else if (std::malloc(kPage_bytes) == nullptr) {  // not even an exception can be made
    report_no_memory();
    ::_exit(exit_code::kIo);
  }
  g_end_of_library();
  std::abort();
}

// Runs before the initialization of shared libraries, of which some allocate: only the executable's
// own .preinit_array comes before them. The address sanitizer is not ready then.
[[gnu::no_sanitize_address]] void watch_uncaught() {
  g_end_of_library = std::set_terminate(end_uncaught);
}
[[gnu::section(".preinit_array"), gnu::used]] void (*g_before_libraries)() = watch_uncaught;

// The other ranks parse the same words and read the same files as rank 0, so they would print the
// same messages.
void silence_worker_ranks() {
  const auto place = find_rank_place();
  if (place && place->rank > 0) {
    const FileDescriptor nothing(::open("/dev/null", O_WRONLY | O_CLOEXEC));
    ::dup2(nothing.get(), STDOUT_FILENO);
    ::dup2(nothing.get(), STDERR_FILENO);
  }
}

int run_command(Session& session, int argc, char** argv) {
  try {
    occupy_standard_streams();
    silence_worker_ranks();
    session.command_line.assign(argv, argv + argc);
    CLI::App app;
    add_all_commands(app, session);
    return parse_and_run(app, session, argc, argv);
  } catch (const BrokenPipe&) {
    return exit_code::kIo;
  } catch (const Error& error) {
    write_message("error: " + name_typed_flags(error.what(), session.command_line));
    return get_exit_code(error.kind());
  } catch (const std::filesystem::filesystem_error& error) {
    write_message(fmt::format("error: {}: the system refuses access: {}", error.path1().string(),
                              error.code().message()));
    return exit_code::kIo;
  } catch (const std::system_error& error) {  // for example, no thread can start
    write_message(std::string("error: ") + error.what());
    return exit_code::kIo;
  } catch (const WorkStopped&) {
    write_message(describe_stop(session.stop.reason()));
    return get_stop_code(session.stop.reason());
  } catch (const std::bad_alloc&) {
    throw;  // run_app() ends without allocating
  } catch (const std::exception& error) {
    write_message(std::string("error: a bug in armwright, please report it: ") + error.what());
    return exit_code::kInternal;
  }
}

}  // namespace

void add_all_commands(CLI::App& app, Session& session) {
  app.name("armwright");
  app.description(kSummary);
  app.set_version_flag(
      "--version", std::string("asked for"),
      "Version, compiler, processor and libraries (as JSON: armwright doctor --json)");
  app.get_formatter()->column_width(30);
  app.footer(kFooter);
  app.require_subcommand(1);
  add_list(app, session);
  add_optimize(app, session);
  add_identify(app, session);
  add_excite(app, session);
  add_ask(app, session);
  add_tell(app, session);
  add_compare(app, session);
  add_cell(app, session);
  add_status(app, session);
  add_merge(app, session);
  add_rerun(app, session);
  add_evaluate(app, session);
  add_sweep(app, session);
  add_verify(app, session);
  add_reproduce(app, session);
  add_testset(app, session);
  add_show(app, session);
  add_report(app, session);
  add_plot(app, session);
  add_watch(app, session);
  add_export(app, session);
  add_import(app, session);
  add_check_plugin(app, session);
  add_new_plugin(app, session);
  add_check_problem(app, session);
  add_new_problem(app, session);
  add_doctor(app, session);
  add_manual(app, session);
  add_completion(app, session);
}

int run_app(int argc, char** argv) {
  // With these signals ignored, a closed pipe and a file beyond its size limit are errors of
  // write().
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  Session session;
  int code = exit_code::kIo;
  try {
    code = run_command(session, argc, argv);
  } catch (const std::bad_alloc&) {
    report_no_memory();
  }
  if (session.must_abort_ranks) {
    std::fflush(nullptr);
    abort_mpi(code);
  }
  // If the command line is wrong, mpirun shall see one failed rank, not one per worker.
  const auto place = find_rank_place();
  return place && place->rank > 0 ? exit_code::kDone : code;
}

}  // namespace armwright
