#include "e2e/processes.hpp"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <sstream>

#include "e2e/program.hpp"

namespace armwright {
namespace {

// Of /proc/PID/stat what stands behind the name in parentheses; empty for a process that is gone.
std::string read_stat(int pid) {
  const std::string stat = read_text("/proc/" + std::to_string(pid) + "/stat");
  const std::size_t name_end = stat.rfind(") ");
  return name_end == std::string::npos ? "" : stat.substr(name_end + 2);
}

std::string read_environment(int pid) {
  return '\0' + read_text("/proc/" + std::to_string(pid) + "/environ") + '\0';
}

}  // namespace

int find_parent(int pid) {
  std::istringstream stat(read_stat(pid));
  char state = 'X';
  int parent = 0;
  stat >> state >> parent;
  return state == 'Z' || state == 'X' ? 0 : parent;
}

bool is_alive(int pid) {
  return find_parent(pid) != 0;
}

double measure_cpu_s(int pid) {
  constexpr int kBeforeTimes = 11;  // state to cmajflt
  std::istringstream stat(read_stat(pid));
  std::string skipped;
  for (int i = 0; i < kBeforeTimes; ++i) {
    stat >> skipped;
  }
  double user = 0, system = 0;
  stat >> user >> system;
  return (user + system) / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

std::vector<int> list_processes_with(const std::string& variable) {
  std::vector<int> found;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    const std::string name = entry.path().filename().string();
    if (!std::ranges::all_of(name, [](unsigned char c) { return std::isdigit(c) != 0; })) {
      continue;
    }
    const int pid = std::stoi(name);
    if (is_alive(pid) && read_environment(pid).find('\0' + variable + '\0') != std::string::npos) {
      found.push_back(pid);
    }
  }
  return found;
}

}  // namespace armwright
