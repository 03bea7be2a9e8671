// Another program run to its end, and what it printed.
#pragma once

#include <span>
#include <string>

namespace armwright {

struct CommandOutput {
  int exit_code = 0;  // 128 + N: ended by signal N
  std::string out;
  std::string err;
};

// The program is looked for on the PATH; its input is empty. Of each stream a MiB is kept.
// Error{usage} if there is no such program; Error{io}.
CommandOutput run_command(std::span<const std::string> words);

}  // namespace armwright
