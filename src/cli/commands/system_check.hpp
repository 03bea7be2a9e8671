// What `armwright doctor` says of the machine and the installation: one line a fact, and for what
// is missing how to get it.
#pragma once

#include <string>
#include <vector>

namespace armwright {

enum class CheckState {
  good,
  lacking,  // armwright does without it, or with less
  bad       // optimizing an arm does not work without it
};
const char* to_string(CheckState state);  // "good", "lacking", "bad"

struct SystemCheck {
  std::string group;  // "program", "engines", ...
  std::string name;
  CheckState state = CheckState::good;
  std::string found;
  std::string remedy = {};  // what to do, where something is to be done
};

// Everything, group by group. Makes a file in the folder where results go, and removes it again.
std::vector<SystemCheck> check_system();

// Its parts. What was built into the program, and what lies beside it.
void check_program(std::vector<SystemCheck>& checks);
// What this machine and this folder allow.
void check_machine(std::vector<SystemCheck>& checks);
void check_results_folder(std::vector<SystemCheck>& checks);

}  // namespace armwright
