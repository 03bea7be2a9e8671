#include "cli/terminal/signals.hpp"

#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <string_view>

#include "cli/terminal/session.hpp"

namespace armwright {
namespace {

// A signal handler reaches nothing but globals.
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
      "\narmwright: stopping when the simulations in progress are done; once more stops at once\n";
  if (number == SIGINT) {
    [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, kNotice.data(), kNotice.size());
  }
  errno = saved;
}

}  // namespace

void catch_signals(StopSignal& stop) {
  g_stop = &stop;
  // SIGXCPU: a limit of processor time, which batch systems set; it comes again every second.
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

}  // namespace armwright
