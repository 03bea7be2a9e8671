// Processes of this machine, as /proc shows them.
#pragma once

#include <string>
#include <vector>

namespace armwright {

// 0 if the process is gone or waits only to be reaped.
int find_parent(int pid);
bool is_alive(int pid);
// Of user and system, so far; 0 if it is gone.
double measure_cpu_s(int pid);
// All that live and have this in their environment: "NAME=value".
std::vector<int> list_processes_with(const std::string& variable);

}  // namespace armwright
