// Runs another program to its end and returns its output.
#pragma once

#include <span>
#include <string>

namespace armwright {

struct CommandOutput {
  int exit_code = 0;  // 128 + N if signal N ended the program
  std::string out;
  std::string err;
};

// Runs the program words[0] with the arguments that follow, and blocks until it ends. The program
// is looked up on the PATH; its input is empty. Keeps one MiB of each output stream. Throws
// Error{usage} if the program does not exist, or Error{io}.
CommandOutput run_command(std::span<const std::string> words);

}  // namespace armwright
