// One call of the program: its command line, its stop signal and its exit code.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/stop_signal.hpp"

namespace armwright {

// The exit codes that 'armwright --help' documents.
namespace exit_code {
inline constexpr int kDone = 0;
inline constexpr int kInternal = 1;  // a bug of armwright
inline constexpr int kUsage = 2;
inline constexpr int kFailed = 3;  // the command finished, but something failed
inline constexpr int kBadData = 4;
inline constexpr int kBusy = 5;
inline constexpr int kIo = 74;  // reading or writing failed, or no memory is left
inline constexpr int kStopped = 75;
inline constexpr int kInterrupted = 130;
}  // namespace exit_code

// The state of one call, which all parts of the command line share.
struct Session {
  std::vector<std::string> command_line;  // as typed, including the program's name
  std::string color = "auto";
  std::string read_limit;  // as typed; empty stands for the default
  StopSignal stop;
  std::function<int()> action;    // the work of the chosen subcommand; it returns the exit code
  bool shares_work = false;       // whether the chosen subcommand uses all MPI ranks
  bool must_abort_ranks = false;  // whether MPI must be aborted at the end, as ranks are missing
};

// Returns a command line for the user to try next, quoted for the shell. It begins with the
// program's name as the user typed it.
std::string quote_own_command(const Session& session, std::vector<std::string> words);

// Makes SIGINT (Ctrl-C), SIGTERM, SIGHUP and SIGXCPU request a stop, so that the command can end in
// order and be resumed. `stop` must live until the process ends. A second signal ends the process
// at once, with exit code 130 for SIGINT and 75 for the others. A signal that the parent process
// ignored (nohup, background jobs) stays ignored.
void catch_signals(StopSignal& stop);

// Returns the exit code of a command that was stopped.
int get_stop_code(StopReason reason);
// Returns "interrupted", "stopped by a signal", "stopped: the time limit is reached" or "stopped".
const char* describe_stop(StopReason reason);
// Tells the user that the stopped command can be resumed, and with which words. Returns the exit
// code.
int end_stopped(const Session& session, std::span<const std::string> command);

}  // namespace armwright
