#include "process/process_watch.hpp"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <system_error>

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

namespace {

// Returns a process and its descendants. Has the files of one process open at a time, however deep
// the tree is.
std::vector<pid_t> list_tree(pid_t process) {
  constexpr std::size_t kMostProcesses = 10'000;
  std::vector<pid_t> tree = {process};
  for (std::size_t i = 0; i < tree.size(); ++i) {
    std::error_code ignored;  // the process may end at any time
    const std::filesystem::directory_iterator threads("/proc/" + std::to_string(tree[i]) + "/task",
                                                      ignored);
    for (auto thread = begin(threads); thread != end(threads); thread.increment(ignored)) {
      std::ifstream children(thread->path() / "children");
      for (pid_t child = 0; tree.size() < kMostProcesses && children >> child;) {
        tree.push_back(child);
      }
    }
  }
  return tree;
}

// Returns the resident memory where a page of n processes counts 1/n; nothing if the process has
// ended or the kernel does not tell it.
std::optional<double> measure_share_mib(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/smaps_rollup");
  std::string line;
  while (std::getline(file, line)) {
    double kib = 0;
    if (std::sscanf(line.c_str(), "Pss: %lf kB", &kib) == 1) {
      return kib / 1024;
    }
  }
  return std::nullopt;
}

}  // namespace

double measure_tree_mib(pid_t process, double exact_above_mib) {
  const std::vector<pid_t> tree = list_tree(process);
  std::vector<double> resident_mib;
  for (const pid_t one : tree) {
    const auto memory = measure_memory(std::to_string(one));
    resident_mib.push_back(memory ? static_cast<double>(memory->resident_bytes) / kMib : 0);
  }
  const auto sum = [&] { return std::accumulate(resident_mib.begin(), resident_mib.end(), 0.0); };
  if (tree.size() > 1 && sum() > exact_above_mib) {
    for (std::size_t i = 0; i < tree.size(); ++i) {
      resident_mib[i] = measure_share_mib(tree[i]).value_or(resident_mib[i]);
    }
  }
  return sum();
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
