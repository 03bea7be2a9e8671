// Problems that are Python classes. A class answers the questions of docs/problem-protocol.md, within
// this process or in forked worker processes.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <string>

#include "problems/user/case_server.hpp"

namespace armwright::python {

class Host;

struct PythonProblem {
  std::string name;  // "python:motor"
  UserDescription description = {};
  // Called as answer(question, send). It calls send(message) with one message or more.
  std::shared_ptr<pybind11::object> answer = {};
  std::shared_ptr<pybind11::object> enter_worker = {};  // called without arguments in a new worker
  ServerLimits limits = {};                             // of workers
  bool isolate = false;     // whether it runs in a worker even if one job runs at a time
  bool is_batched = false;  // it answers all cases of a question at once
};

// Reads the description, the message "problem". Throws Error{usage} that says what is wrong with it.
std::shared_ptr<const PythonProblem> make_python_problem(PythonProblem problem,
                                                         const std::string& description);

// Returns the problem for one call from Python with `jobs` threads. It may be simulated only while
// `host` runs work. KeyboardInterrupt during a simulation ends the work with WorkStopped, and the
// host has it.
UserProgram make_program(std::shared_ptr<const PythonProblem> problem, Host& host, unsigned jobs);

}  // namespace armwright::python
