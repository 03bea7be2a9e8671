// What one call of the program carries along, the exit codes, and the subcommands. Each subcommand
// has a file of its own: it adds itself to the parser and leaves, when chosen, its work as an
// action.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/stop_signal.hpp"

namespace CLI {
class App;
}

namespace armwright {

// Documented in --help.
namespace exit_code {
inline constexpr int kDone = 0;
inline constexpr int kInternal = 1;  // a bug of ours, or no memory left
inline constexpr int kUsage = 2;
inline constexpr int kFailed = 3;  // done, but something failed
inline constexpr int kBadData = 4;
inline constexpr int kBusy = 5;
inline constexpr int kIo = 74;
inline constexpr int kStopped = 75;
inline constexpr int kInterrupted = 130;
}  // namespace exit_code

struct Session {
  std::vector<std::string> command_line;  // as typed, the program's name included
  std::string color = "auto";
  StopSignal stop;
  std::function<int()> action;    // of the chosen subcommand; its result is the exit code
  bool shares_work = false;       // the chosen subcommand: out over ranks, if there are any
  bool must_abort_ranks = false;  // at the end: some are missing (cli/team.hpp)
};

void add_list(CLI::App& app, Session& session);
void add_optimize(CLI::App& app, Session& session);
void add_compare(CLI::App& app, Session& session);
void add_cell(CLI::App& app, Session& session);
void add_status(CLI::App& app, Session& session);
void add_merge(CLI::App& app, Session& session);
void add_rerun(CLI::App& app, Session& session);
void add_evaluate(CLI::App& app, Session& session);
void add_sweep(CLI::App& app, Session& session);
void add_verify(CLI::App& app, Session& session);
void add_reproduce(CLI::App& app, Session& session);
void add_testset(CLI::App& app, Session& session);
void add_show(CLI::App& app, Session& session);
void add_report(CLI::App& app, Session& session);
void add_plot(CLI::App& app, Session& session);
void add_watch(CLI::App& app, Session& session);
void add_export(CLI::App& app, Session& session);
void add_import(CLI::App& app, Session& session);
void add_check_plugin(CLI::App& app, Session& session);
void add_new_plugin(CLI::App& app, Session& session);
void add_doctor(CLI::App& app, Session& session);
void add_manual(CLI::App& app, Session& session);
void add_completion(CLI::App& app, Session& session);

// The program itself: its name, what it says of itself, and all of the above.
void add_all_commands(CLI::App& app, Session& session);

// A command to try next, with the program named as the user named it.
std::string quote_own_command(const Session& session, std::vector<std::string> words);

// The exit code of a run or evaluation that was stopped.
int get_stop_code(StopReason reason);
// "interrupted", "time limit reached", ...
const char* describe_stop(StopReason reason);
// Of a command that was stopped and can be gone on with: says so, with the words that do. The exit
// code.
int end_stopped(const Session& session, std::span<const std::string> command);

}  // namespace armwright
