// The file that contains armwright's code: the running program, or a shared library of another
// program (libarmwright.so, the Python module). Other files of an installation lie relative to it.
#pragma once

#include <filesystem>

namespace armwright {

struct OwnFile {
  std::filesystem::path path;  // absolute and without links; empty if the system does not tell
  bool is_program = false;
};

OwnFile find_own_file();

}  // namespace armwright
