#include "process/process_watch.hpp"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>

namespace armwright {

std::optional<ProcessMemory> measure_memory(const std::string& process) {
  std::ifstream file("/proc/" + process + "/statm");
  std::int64_t size = 0, resident = 0, shared = 0, text = 0, library = 0, data = 0;
  if (!(file >> size >> resident >> shared >> text >> library >> data)) {
    return std::nullopt;
  }
  const std::int64_t page = sysconf(_SC_PAGESIZE);
  return ProcessMemory{.resident_bytes = resident * page, .data_bytes = data * page};
}

bool has_ended(pid_t child) {
  siginfo_t info{};
  return waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
         info.si_pid == child;
}

void kill_group(pid_t child) {
  kill(-child, SIGKILL);
  kill(child, SIGKILL);  // the child may not lead its group yet
}

int reap(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

std::string describe_signal(int signal) {
  return fmt::format("was killed by signal {} ({})", signal, strsignal(signal));
}

void WakingTime::restart() {
  last_ = Clock::now();
  passed_s_ = 0;
}

void WakingTime::look() {
  constexpr double kLongestWait_s = 0.2;  // twice the longest time between two calls
  const Clock::time_point now = Clock::now();
  passed_s_ += std::min(std::chrono::duration<double>(now - last_).count(), kLongestWait_s);
  last_ = now;
}

}  // namespace armwright
