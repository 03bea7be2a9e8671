// The checks of `armwright doctor` on this machine and installation. Each check states one fact. If
// something is missing, the check also says how to get it.
#pragma once

#include <string>
#include <vector>

namespace armwright {

enum class CheckState {
  good,
  lacking,  // armwright works without it, perhaps with fewer features
  bad       // without it an arm cannot be optimized
};
const char* to_string(CheckState state);  // "good", "lacking", "bad"

struct SystemCheck {
  std::string group;  // "program", "engines", ...
  std::string name;
  CheckState state = CheckState::good;
  std::string found;
  std::string remedy = {};  // what the user can do; empty if nothing is needed
};

// Makes all checks, group by group. It creates a file in the folder of the results and removes it.
// Throws nothing of its own: a fault is a check with the state `bad`.
std::vector<SystemCheck> check_system();

// The parts of check_system(); each adds its checks.
void check_program(std::vector<SystemCheck>& checks);  // the build and the files beside it
void check_machine(std::vector<SystemCheck>& checks);  // processor, memory, limits, terminal
void check_results_folder(std::vector<SystemCheck>& checks);

}  // namespace armwright
