// The errors that a caller can cause. Each kind has a documented exit code of the command line. A
// failed simulation is no error but a status (sim/tracking); a bug of armwright is an assertion.
#pragma once

#include <stdexcept>
#include <string>

namespace armwright {

enum class ErrorKind {
  usage,     // a wrong flag, name or configuration; exit code 2
  bad_data,  // an input file (URDF, test cases, design, journal) that cannot be used; exit code 4
  busy,      // another process writes this folder; exit code 5
  io,        // the operating system refused to read or write; exit code 74
};

class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  ErrorKind kind() const { return kind_; }

 private:
  ErrorKind kind_;
};

}  // namespace armwright
