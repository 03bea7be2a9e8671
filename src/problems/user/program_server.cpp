#include "problems/user/program_server.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "base/error.hpp"
#include "base/read_limit.hpp"
#include "base/text.hpp"
#include "problems/user/case_messages.hpp"
#include "process/command_words.hpp"
#include "process/json_message.hpp"
#include "process/line_process.hpp"
#include "process/output_log.hpp"
#include "process/stop_scope.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr double kLoading_s = 60;    // until the description arrives; interpreters load slowly
constexpr double kProgramEnd_s = 1;  // until a program that was told to quit has ended

std::string make_hello_line() {
  return fmt::format(R"({{"type":"hello","protocol":{}}})", kProblemProtocol);
}

// Asks a program that has just started for its description. Throws Error{bad_data} that names it.
UserDescription ask_description(LineProcess& child, const OutputLog& log, const std::string& name) {
  std::string fault;
  try {
    child.send(make_hello_line(), kLoading_s);
    const auto line = child.receive(kLoading_s, [] {
      check_reading();  // Ctrl-C while a problem is loaded
      return false;
    });
    return read_user_description(read_message(line.value()));
  } catch (const ProtocolError& error) {
    fault = error.what();
  } catch (const LineProcessSilence& error) {
    fault = fmt::format("{} before it described itself. It must flush its output after each line",
                        error.what());
  } catch (const LineProcessFailure& error) {
    await_work_stop();
    fault = fmt::format("{} before it described itself", error.what());
  }
  throw Error(ErrorKind::bad_data, fmt::format("problem '{}': it {}{}", sanitize(name), fault,
                                               describe_printed(log.last_lines())));
}

class ProgramServer final : public CaseServer {
 public:
  ProgramServer(std::string name, const std::vector<std::string>& words, ServerLimits limits,
                const UserDescription& recorded)
      : name_(std::move(name)), limits_(limits), child_(words, log_) {
    description_ = ask_description(child_, log_, name_);
    check_same_description(name_, recorded, description_);
    child_.limit_memory(limits_.memory_mib);
  }

  void answer(std::span<const CaseJob> jobs, std::vector<CaseAnswer>& answers) override {
    ++id_;
    // Several jobs take little time together, or each is asked for alone.
    converse(make_question(description_, "evaluate", id_, jobs), [&](const json& message) {
      read_answers(message, description_, id_, jobs.size() - answers.size(), answers);
      return answers.size() == jobs.size();
    });
  }

  CaseRecord record(const CaseJob& job) override {
    CaseRecord record;
    ++id_;
    converse(make_question(description_, "record", id_, {&job, 1}), [&](const json& message) {
      record = read_record(message, id_);
      return true;
    });
    return record;
  }

 private:
  // Sends a question and hands the messages that follow to `take` until it returns true.
  void converse(const std::string& question, const std::function<bool(const json&)>& take) {
    const double limit_s = limits_.time_limit_s;
    try {
      child_.send(question, limit_s);
      while (!take(read_message(child_.receive(limit_s, [] { return false; }).value(), true))) {
      }
    } catch (const LineProcessMemory&) {
      fail(fmt::format("took more than {:g} MiB of memory (program.memory_mib)",
                       limits_.memory_mib));
    } catch (const LineProcessSilence& error) {
      fail(fmt::format("{} (program.time_limit_s)", error.what()), EvaluationStatus::timed_out);
    } catch (const LineProcessFailure& error) {
      fail(error.what());
    } catch (const ProtocolError& error) {
      throw ProtocolError(error.what() + describe_printed(log_.last_lines()));
    }
  }

  [[noreturn]] void fail(const std::string& what,
                         EvaluationStatus status = EvaluationStatus::failed) const {
    throw ServerFailure(what, status, describe_printed(log_.last_lines()));
  }

  std::string name_;
  ServerLimits limits_;
  UserDescription description_;
  OutputLog log_;
  LineProcess child_;
  std::uint64_t id_ = 0;
};

}  // namespace

UserDescription describe_program(std::string_view command) {
  OutputLog log;
  LineProcess child(split_command(command, "problem"), log);
  UserDescription description = ask_description(child, log, fmt::format("exec:{}", command));
  child.send(R"({"type":"quit"})", kProgramEnd_s);
  child.finish(kProgramEnd_s);
  return description;
}

StartServer make_program_start(std::string_view command, const ServerLimits& limits,
                               const UserDescription& description) {
  return [name = fmt::format("exec:{}", command), words = split_command(command, "problem"), limits,
          description]() -> std::unique_ptr<CaseServer> {
    return std::make_unique<ProgramServer>(name, words, limits, description);
  };
}

}  // namespace armwright
