// The side of a user's problem that computes: a program, a shared library in a process of its own, a
// function of the host program, or a command per case. A UserProblem asks it.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "problems/interface/problem.hpp"
#include "problems/user/user_description.hpp"

namespace armwright {

// The answer to one CaseJob, in the order and in the signs of the user's description. The numbers
// may be NaN or infinite: the UserProblem makes a failed case of them.
struct CaseAnswer {
  EvaluationStatus status = EvaluationStatus::ok;
  std::string reason;
  // Text that a warning adds to the reason, as in "; the last that it printed: ...". It is not
  // recorded, because it may differ each time.
  std::string details;
  std::vector<double> objectives;
  std::vector<double> constraints;
  std::vector<double> metrics;
  std::vector<double> residuals;
};

// A server crashed, or did not answer in time, or took too much memory. It cannot be asked any more.
// The message completes a sentence that begins with the server: "ended with exit code 3".
class ServerFailure : public std::runtime_error {
 public:
  explicit ServerFailure(const std::string& what,
                         EvaluationStatus status = EvaluationStatus::failed,
                         std::string details = "")
      : std::runtime_error(what), status_(status), details_(std::move(details)) {}
  EvaluationStatus status() const { return status_; }
  const std::string& details() const { return details_; }  // as CaseAnswer::details

 private:
  EvaluationStatus status_;
  std::string details_;
};

// Answers jobs, one call at a time.
class CaseServer {
 public:
  virtual ~CaseServer() = default;
  // Appends one answer per job to `answers`, which is empty. All jobs belong to one block. Throws
  // ServerFailure, after the answers that came before it, and ProtocolError if the server breaks its
  // contract, which ends the run.
  virtual void answer(std::span<const CaseJob> jobs, std::vector<CaseAnswer>& answers) = 0;
  // Returns what a case leaves beside its numbers. Throws as answer() does.
  virtual CaseRecord record(const CaseJob& /*job*/) { return {}; }
};

// Limits of the servers of a problem.
struct ServerLimits {
  double time_limit_s = 60;  // per case
  double memory_mib = 4096;  // growth of a process since its start
};

// Starts a server. It may be called from any thread and in forked children. Throws Error if the
// program cannot be started or does not describe itself as it did.
using StartServer = std::function<std::unique_ptr<CaseServer>()>;

// What a user's problem is made of.
struct UserProgram {
  std::string name;  // as the user typed it: "exec:python3 motor.py"
  UserDescription description = {};
  StartServer start = {};    // null: the problem can be read and not simulated
  std::string why_not = {};  // without `start`: what the user can do
};

}  // namespace armwright
