// Measuring child processes.
#include "process/process_watch.hpp"

#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <limits>
#include <vector>

namespace armwright {
namespace {

constexpr std::size_t kHoardBytes = std::size_t{200} << 20;

// Becomes a chain of processes. The last of them says that it is ready, waits for a byte, takes
// memory, says so, and waits for its end.
[[noreturn]] void become_chain(int length, int commands, int reports) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (length > 1) {
    if (fork() == 0) {
      become_chain(length - 1, commands, reports);
    }
    while (true) {
      pause();
    }
  }
  char byte = 0;
  std::vector<char> hoard;
  while (::write(reports, &byte, 1) == 1 && ::read(commands, &byte, 1) == 1) {
    hoard.assign(kHoardBytes, 1);
  }
  _exit(0);
}

TEST(ProcessWatch, MeasuresADeepTreeWithFewOpenFiles) {
  std::array<int, 2> commands{};
  std::array<int, 2> reports{};
  ASSERT_EQ(pipe(commands.data()), 0);
  ASSERT_EQ(pipe(reports.data()), 0);
  const pid_t first = fork();
  if (first == 0) {
    setpgid(0, 0);
    become_chain(60, commands[0], reports[1]);
  }
  char byte = 0;
  rlimit before{};
  getrlimit(RLIMIT_NOFILE, &before);
  rlimit few = before;
  few.rlim_cur = 30;
  EXPECT_EQ(setrlimit(RLIMIT_NOFILE, &few), 0);
  const double none = std::numeric_limits<double>::infinity();
  EXPECT_EQ(::read(reports[0], &byte, 1), 1);
  const double small_mib = measure_tree_mib(first, none);
  EXPECT_EQ(::write(commands[1], &byte, 1), 1);
  EXPECT_EQ(::read(reports[0], &byte, 1), 1);
  const double large_mib = measure_tree_mib(first, none);
  setrlimit(RLIMIT_NOFILE, &before);
  EXPECT_GT(large_mib - small_mib, kHoardBytes / kMib / 2);
  setpgid(first, first);
  kill_group(first);
  reap(first);
  for (const int end : {commands[0], commands[1], reports[0], reports[1]}) {
    close(end);
  }
}

}  // namespace
}  // namespace armwright
