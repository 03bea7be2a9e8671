#include "cli/terminal/session.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <string_view>

#include "base/text.hpp"
#include "cli/terminal/terminal.hpp"

namespace armwright {
namespace {

// Globals, as a signal handler has no arguments of its own.
std::atomic<StopSignal*> g_stop = nullptr;
std::atomic<bool> g_signalled = false;
static_assert(std::atomic<StopSignal*>::is_always_lock_free);
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void handle_signal(int number) {
  const int saved = errno;
  StopSignal& stop = *g_stop.load();
  if (g_signalled.exchange(true)) {
    ::_exit(number == SIGINT ? exit_code::kInterrupted : exit_code::kStopped);
  }
  stop.request(number == SIGINT ? StopReason::interrupted : StopReason::terminated);
  constexpr std::string_view kNotice =
      "\narmwright: stopping soon, with all results so far on disk; press Ctrl-C again to stop at "
      "once\n";
  if (number == SIGINT) {
    [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, kNotice.data(), kNotice.size());
  }
  errno = saved;
}

}  // namespace

std::string quote_own_command(const Session& session, std::vector<std::string> words) {
  words.insert(words.begin(), session.command_line.front());
  return sanitize(quote_command(words));
}

void catch_signals(StopSignal& stop) {
  g_stop = &stop;
  // SIGXCPU signals a limit of processor time, which batch systems set. It is sent every second.
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGXCPU}) {
    struct sigaction before {};
    ::sigaction(number, nullptr, &before);
    if (before.sa_handler == SIG_IGN) {
      continue;
    }
    struct sigaction action {};
    action.sa_handler = handle_signal;
    action.sa_flags = SA_RESTART;
    ::sigemptyset(&action.sa_mask);
    ::sigaction(number, &action, nullptr);
  }
}

int get_stop_code(StopReason reason) {
  return reason == StopReason::interrupted ? exit_code::kInterrupted : exit_code::kStopped;
}

const char* describe_stop(StopReason reason) {
  switch (reason) {
    case StopReason::interrupted:
      return "interrupted";
    case StopReason::terminated:
      return "stopped by a signal";
    case StopReason::time_limit:
      return "stopped: the time limit is reached";
    case StopReason::none:
      break;
  }
  return "stopped";
}

int end_stopped(const Session& session, std::span<const std::string> command) {
  const StopReason reason = session.stop.reason();
  write_message(fmt::format("{}; nothing is lost. To resume:\n{}", describe_stop(reason),
                            quote_command(command)));
  return get_stop_code(reason);
}

}  // namespace armwright
