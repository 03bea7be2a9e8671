#include "user_problems.hpp"

#include <fmt/format.h>

#include <limits>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/text.hpp"
#include "host.hpp"
#include "problems/user/case_messages.hpp"
#include "process/child_process.hpp"
#include "process/json_message.hpp"

namespace armwright::python {
namespace {

// The time after which Python sends the answers that it has (_SENDING_S in user_problem.py), with a
// reserve.
constexpr double kSending_s = 2;

// Needs the GIL. Returns a text that completes "the program ...".
std::string describe(const py::error_already_set& error) {
  const py::object explain = py::module_::import("armwright.optimizer").attr("_explain_failure");
  const py::tuple words = explain(to_exception(error));
  return sanitize(words[0].cast<std::string>().substr(3));  // without "it "
}

class PythonServer : public CaseServer {
 public:
  PythonServer(std::shared_ptr<const PythonProblem> problem, Host& host)
      : problem_(std::move(problem)), host_(host) {}

  void answer(std::span<const CaseJob> jobs, std::vector<CaseAnswer>& answers) override {
    ++id_;
    exchange(make_question(problem_->description, "evaluate", id_, jobs), jobs.size(),
             [&](const std::string& message) {
               read_answers(read_message(message, true), problem_->description, id_,
                            jobs.size() - answers.size(), answers);
               return answers.size() == jobs.size();
             });
  }

  CaseRecord record(const CaseJob& job) override {
    CaseRecord record;
    ++id_;
    exchange(make_question(problem_->description, "record", id_, {&job, 1}), 1,
             [&](const std::string& message) {
               record = read_record(read_message(message), id_);
               return true;
             });
    return record;
  }

 protected:
  using Take = std::function<bool(const std::string&)>;  // true: this was the last message

  // Asks Python a question about `cases` cases and hands its messages to `take`.
  virtual void exchange(const std::string& question, std::size_t cases, const Take& take) = 0;

  std::shared_ptr<const PythonProblem> problem_;
  Host& host_;

 private:
  std::uint64_t id_ = 0;
};

// Calls the class on the thread that simulates.
class InnerServer final : public PythonServer {
 public:
  using PythonServer::PythonServer;

 private:
  void exchange(const std::string& question, std::size_t /*cases*/, const Take& take) override {
    bool is_complete = false;
    for (const std::string& message : ask(question)) {
      is_complete = take(message);
    }
    if (!is_complete) {
      throw ProtocolError("sent fewer answers than it was asked for");
    }
  }

  std::vector<std::string> ask(const std::string& question) const {
    std::vector<std::string> messages;
    const py::gil_scoped_acquire gil;
    try {
      (*problem_->answer)(question, py::cpp_function([&messages](std::string message) {
                            messages.push_back(std::move(message));
                          }));
    } catch (py::error_already_set& error) {
      if (!error.matches(PyExc_Exception)) {  // KeyboardInterrupt
        host_.hold(error);
        throw WorkStopped{};
      }
      throw ServerFailure(describe(error));
    }
    return messages;
  }
};

// Calls the class in a forked process.
class WorkerServer final : public PythonServer {
 public:
  WorkerServer(std::shared_ptr<const PythonProblem> problem, Host& host)
      : PythonServer(std::move(problem), host) {
    // The parent measures the time itself, because it depends on the number of cases.
    const ProcessLimits limits{.silence_s = std::numeric_limits<double>::infinity(),
                               .memory_mib = problem_->limits.memory_mib};
    const py::gil_scoped_acquire gil;
    PyOS_BeforeFork();
    try {
      child_ = std::make_unique<ChildProcess>([this](ParentLink& parent) { work(parent); }, limits);
    } catch (...) {
      PyOS_AfterFork_Parent();
      throw;
    }
    PyOS_AfterFork_Parent();
  }

 private:
  // Answers questions, in the child, until the parent kills it.
  [[noreturn]] void work(ParentLink& parent) const {
    PyOS_AfterFork_Child();
    try {
      (*problem_->enter_worker)();
      const py::cpp_function send([&parent](const std::string& message) { parent.send(message); });
      while (true) {
        (*problem_->answer)(parent.receive(), send);
      }
    } catch (const py::error_already_set& error) {
      throw ChildFailure(describe(error));
    }
  }

  void exchange(const std::string& question, std::size_t cases, const Take& take) override {
    const double limit_s =
        problem_->limits.time_limit_s * (problem_->is_batched ? static_cast<double>(cases) : 1) +
        (cases > 1 ? kSending_s : 0);
    WakingTime waiting;
    const auto must_give_up = [&] {
      waiting.look();
      return waiting.get_s() > limit_s || is_interrupted();
    };
    try {
      bool is_complete = child_->send(question, must_give_up).has_value();
      std::string message;
      while (!is_complete &&
             child_->receive(must_give_up, message) == ChildProcess::Event::message) {
        if (take(message)) {
          return;
        }
        waiting.restart();
      }
    } catch (const ChildFailure& failure) {
      throw ServerFailure(failure.what());
    }
    if (is_interrupted()) {
      throw WorkStopped{};
    }
    throw ServerFailure(
        fmt::format("did not answer within {} s and had to be killed (time_limit_s)",
                    problem_->limits.time_limit_s),
        EvaluationStatus::timed_out);
  }

  bool is_interrupted() const {
    return host_.stop().requested() && host_.stop().reason() == StopReason::interrupted;
  }

  std::unique_ptr<ChildProcess> child_;
};

}  // namespace

std::shared_ptr<const PythonProblem> make_python_problem(PythonProblem problem,
                                                         const std::string& description) {
  try {
    problem.description = read_user_description(read_message(description));
  } catch (const ProtocolError& error) {
    throw Error(ErrorKind::usage,
                fmt::format("problem '{}' {}", sanitize(problem.name), error.what()));
  }
  return std::make_shared<const PythonProblem>(std::move(problem));
}

UserProgram make_program(std::shared_ptr<const PythonProblem> problem, Host& host, unsigned jobs) {
  UserProgram program{.name = problem->name, .description = problem->description};
  const bool forks = problem->isolate || jobs > 1;
  program.start = [problem = std::move(problem), &host, forks]() -> std::unique_ptr<CaseServer> {
    if (forks) {
      return std::make_unique<WorkerServer>(problem, host);
    }
    return std::make_unique<InnerServer>(problem, host);
  };
  return program;
}

}  // namespace armwright::python
