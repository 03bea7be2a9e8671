#include "problems/user/library_server.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "armwright/plugin.h"
#include "base/error.hpp"
#include "base/file.hpp"
#include "base/read_limit.hpp"
#include "base/text.hpp"
#include "problems/user/case_messages.hpp"
#include "problems/user/native_problem.hpp"
#include "process/child_process.hpp"
#include "process/command_words.hpp"
#include "process/json_message.hpp"
#include "process/output_log.hpp"
#include "process/packet.hpp"
#include "process/stop_scope.hpp"

namespace armwright {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kOpening_s = 60;  // until the description arrives
// The child sends the answers that it has after this time, so that the time limit holds per case.
constexpr std::chrono::milliseconds kAnswering{50};

enum class QuestionKind : std::uint8_t { evaluate, record };

// Opens a library and finds the problem in it. The library stays open. Throws ProtocolError.
struct armwright_user_problem open_problem(const std::filesystem::path& file) {
  void* const library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    throw ProtocolError(fmt::format("is no shared library that can be opened: {}", dlerror()));
  }
  void* const symbol = dlsym(library, ARMWRIGHT_PROBLEM_SYMBOL);
  if (symbol == nullptr && dlsym(library, ARMWRIGHT_PLUGIN_SYMBOL) != nullptr) {
    throw ProtocolError("is an optimizer and no problem; name it with --optimizer");
  }
  if (symbol == nullptr) {
    throw ProtocolError(
        fmt::format("exports no function '{0}'; a problem defines ARMWRIGHT_PROBLEM_EXPORT const "
                    "struct armwright_user_problem* {0}(void), in C++ as extern \"C\" or by the "
                    "macro ARMWRIGHT_PROBLEM of armwright/problem.hpp",
                    ARMWRIGHT_PROBLEM_SYMBOL));
  }
  return read_native_problem(reinterpret_cast<decltype(&::armwright_user_problem)>(symbol)());
}

// The child's side: answers questions until the parent ends it.
class LibraryHost {
 public:
  LibraryHost(const struct armwright_user_problem& problem, ParentLink& parent)
      : problem_(problem), caller_(problem_), parent_(parent) {}

  [[noreturn]] void serve() {
    while (true) {
      const std::string packet = parent_.receive();
      PacketReader reader(packet);
      const auto kind = reader.get<QuestionKind>();
      const auto id = reader.get<std::uint64_t>();
      read_questions(reader);
      if (kind == QuestionKind::record) {
        record(id);
      } else {
        answer(id);
      }
    }
  }

 private:
  void read_questions(PacketReader& reader) {
    const auto role = reader.get<std::int32_t>();
    const auto wants_residuals = reader.get<std::int32_t>();
    set_ = reader.get_text();
    points_ = reader.get_numbers();
    questions_.resize(reader.get<std::uint64_t>());
    for (std::size_t i = 0; i < questions_.size(); ++i) {
      const auto number = reader.get<std::uint64_t>();
      const auto seed = reader.get<std::uint64_t>();
      questions_[i] = {.struct_size = sizeof(armwright_case),
                       .x = points_.data() + i * problem_.variable_count,
                       .number = number,
                       .seed = seed,
                       .set = set_.c_str(),
                       .role = role,
                       .wants_residuals = wants_residuals};
    }
  }

  void answer(std::uint64_t id) {
    std::size_t sent = 0;
    auto last = Clock::now();
    caller_.ask(questions_, [&](std::size_t answered) {
      if (answered < questions_.size() && Clock::now() - last < kAnswering) {
        return;
      }
      PacketWriter writer;
      writer.put(true);
      writer.put(id);
      writer.put(std::uint64_t{answered - sent});
      for (; sent < answered; ++sent) {
        const NativeCaller::Answer one = caller_.answer(sent);
        writer.put(one.status);
        if (one.status != ARMWRIGHT_CASE_OK) {
          writer.put(
              std::string_view(one.reason, strnlen(one.reason, NativeCaller::kReasonBytes - 1)));
          continue;
        }
        writer.put(one.numbers);
        writer.put(std::span<const double>(one.residuals));
      }
      send(writer);
      last = Clock::now();
    });
  }

  void record(std::uint64_t id) {
    PacketWriter writer;
    try {
      const std::string text = caller_.record(questions_.front(), id);
      writer.put(true);
      writer.put(std::string_view(text));
    } catch (const ProtocolError& error) {
      writer.put(false);
      writer.put(std::string_view(error.what()));
    }
    send(writer);
  }

  void send(const PacketWriter& writer) {
    if (getpid() != process_) {
      _exit(EXIT_FAILURE);  // the library has forked, and its child has returned here
    }
    parent_.send(writer.bytes());
  }

  const struct armwright_user_problem problem_;
  NativeCaller caller_;
  ParentLink& parent_;
  const pid_t process_ = getpid();
  std::string set_;
  std::vector<double> points_;
  std::vector<armwright_case> questions_;
};

// Does all work of a child. First it sends (true, description, whether it answers in batches) or
// (false, reason).
void run_library(const std::filesystem::path& file, ParentLink& parent) {
  PacketWriter writer;
  std::optional<struct armwright_user_problem> problem;
  try {
    problem = open_problem(file);
    const std::string description = to_json(describe_native_problem(*problem));
    writer.put(true);
    writer.put(std::string_view(description));
    writer.put(problem->evaluate_batch != nullptr);
  } catch (const ProtocolError& error) {
    writer.put(false);
    writer.put(std::string_view(error.what()));
  }
  parent.send(writer.bytes());
  if (problem) {
    LibraryHost(*problem, parent).serve();
  }
}

// The parent's side of a child that has the library open.
class LibraryProcess {
 public:
  // Throws Error{bad_data} if the library is no problem.
  LibraryProcess(std::string name, const std::filesystem::path& file, double memory_mib)
      : name_(std::move(name)),
        child_([file](ParentLink& parent) { run_library(file, parent); },
               {.silence_s = std::numeric_limits<double>::infinity(), .memory_mib = memory_mib},
               &log_) {
    try {
      const std::string packet = receive(kOpening_s);
      PacketReader reader(packet);
      const bool is_problem = reader.get<bool>();
      const std::string text = reader.get_text();
      if (!is_problem) {
        throw ProtocolError(sanitize(text));
      }
      description_ = read_user_description(read_message(text));
      has_batches_ = reader.get<bool>();
    } catch (const ServerFailure& failure) {
      await_work_stop();
      fail(fmt::format("{} while it was opened", failure.what()));
    } catch (const ProtocolError& error) {
      fail(error.what());
    } catch (const PacketError& error) {
      fail(fmt::format("sent {} while it was opened", error.what()));
    }
  }

  const UserDescription& description() const { return description_; }
  bool has_batches() const { return has_batches_; }
  std::string describe_log() const { return describe_printed(log_.last_lines()); }

  void send(const PacketWriter& packet, double limit_s) {
    WakingTime silence;
    if (child_.send(packet.bytes(), [&] { return is_late(silence, limit_s); })) {
      throw_late(limit_s);
    }
  }

  std::string receive(double limit_s) {
    WakingTime silence;
    std::string message;
    try {
      switch (child_.receive([&] { return is_late(silence, limit_s); }, message)) {
        case ChildProcess::Event::message:
          return message;
        case ChildProcess::Event::given_up:
          throw_late(limit_s);
        case ChildProcess::Event::finished:
          break;
      }
    } catch (const ChildFailure& failure) {
      const bool is_limit = *failure.limit() != '\0';
      fail_case(fmt::format("{}{}", failure.what(), is_limit ? " (program.memory_mib)" : ""));
    }
    fail_case("ended without an answer");
  }

 private:
  static bool is_late(WakingTime& silence, double limit_s) {
    check_work_stop();
    check_reading();
    silence.look();
    return silence.get_s() > limit_s;
  }
  [[noreturn]] void throw_late(double limit_s) const {
    fail_case(fmt::format("has been silent for {:g} s (program.time_limit_s)", limit_s),
              EvaluationStatus::timed_out);
  }
  [[noreturn]] void fail_case(const std::string& what,
                              EvaluationStatus status = EvaluationStatus::failed) const {
    throw ServerFailure(what, status, describe_log());
  }
  [[noreturn]] void fail(const std::string& fault) const {
    throw Error(ErrorKind::bad_data,
                fmt::format("problem '{}': it {}{}", sanitize(name_), fault, describe_log()));
  }

  std::string name_;
  OutputLog log_;
  ChildProcess child_;
  UserDescription description_;
  bool has_batches_ = false;
};

class LibraryServer final : public CaseServer {
 public:
  LibraryServer(const std::string& name, const std::filesystem::path& file, ServerLimits limits,
                const UserDescription& recorded)
      : limits_(limits), process_(name, file, limits.memory_mib) {
    check_same_description(name, recorded, process_.description());
  }

  void answer(std::span<const CaseJob> jobs, std::vector<CaseAnswer>& answers) override {
    answers.reserve(jobs.size());
    while (!jobs.empty()) {
      const std::size_t count = std::min(jobs.size(), NativeCaller::kMostQuestions);
      answer_some(jobs.first(count), answers);
      jobs = jobs.subspan(count);
    }
  }

  CaseRecord record(const CaseJob& job) override {
    process_.send(make_packet(QuestionKind::record, {&job, 1}), limits_.time_limit_s);
    const std::string packet = process_.receive(limits_.time_limit_s);
    CaseRecord record;
    read_checked([&] {
      PacketReader reader(packet);
      const bool is_record = reader.get<bool>();
      const std::string text = reader.get_text();
      if (!is_record) {
        throw ProtocolError(sanitize(text));
      }
      record = read_record(read_message(text), id_);
    });
    return record;
  }

 private:
  // Appends the answers to at most kMostQuestions jobs.
  void answer_some(std::span<const CaseJob> jobs, std::vector<CaseAnswer>& answers) {
    const std::size_t wanted = answers.size() + jobs.size();
    const double limit_s = limits_.time_limit_s;
    process_.send(make_packet(QuestionKind::evaluate, jobs), limit_s);
    while (answers.size() < wanted) {
      const std::string packet = process_.receive(limit_s);
      read_checked([&] {
        PacketReader reader(packet);
        if (!reader.get<bool>() || reader.get<std::uint64_t>() != id_) {
          throw PacketError("an answer to another question");
        }
        for (auto left = reader.get<std::uint64_t>(); left > 0; --left) {
          if (answers.size() == wanted) {
            throw PacketError("more answers than questions");
          }
          answers.push_back(read_answer(reader));
        }
      });
    }
  }

  PacketWriter make_packet(QuestionKind kind, std::span<const CaseJob> jobs) {
    const UserDescription& description = process_.description();
    const armwright_case first = make_native_question(description, jobs.front());
    points_.clear();
    for (const CaseJob& job : jobs) {
      points_.insert(points_.end(), job.x.begin(), job.x.end());
    }
    PacketWriter packet;
    packet.put(kind);
    packet.put(++id_);
    packet.put(first.role);
    packet.put(first.wants_residuals);
    packet.put(std::string_view(first.set));
    packet.put(std::span<const double>(points_));
    packet.put(std::uint64_t{jobs.size()});
    std::uint64_t seed = first.seed;
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      if (i > 0 && jobs[i].number != jobs[i - 1].number) {
        seed = calc_case_seed(*jobs[i].block, jobs[i].number);
      }
      packet.put(jobs[i].number);
      packet.put(seed);
    }
    return packet;
  }

  CaseAnswer read_answer(PacketReader& reader) const {
    const UserDescription& description = process_.description();
    const auto status = reader.get<std::int32_t>();
    if (status != ARMWRIGHT_CASE_OK) {
      return make_answer(description, status, reader.get_text(), {}, {});
    }
    const std::vector<double> numbers = reader.get_numbers();
    if (numbers.size() != description.objectives.size() + description.constraints.size() +
                              description.metrics.size()) {
      throw PacketError("an answer of another length");
    }
    return make_answer(description, status, "", numbers, reader.get_numbers());
  }

  // Calls `read` and adds what the library printed to its errors.
  void read_checked(const std::function<void()>& read) const {
    try {
      read();
    } catch (const PacketError& error) {
      throw ProtocolError(fmt::format("sent {}{}", error.what(), process_.describe_log()));
    } catch (const ProtocolError& error) {
      throw ProtocolError(error.what() + process_.describe_log());
    }
  }

  ServerLimits limits_;
  LibraryProcess process_;
  std::uint64_t id_ = 0;
  std::vector<double> points_;
};

bool is_library_file(const std::filesystem::path& file) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(file, ignored);
}

void require_library_file(const std::string& name, const std::filesystem::path& file) {
  if (!is_library_file(file)) {
    throw Error(ErrorKind::usage,
                fmt::format("problem '{}': there is no such file; a problem in a shared library "
                            "is given by its path",
                            sanitize(name)));
  }
}

}  // namespace

bool is_problem_library(std::string_view name) {
  if (name.ends_with(".so")) {
    return true;
  }
  if (name.find('/') == std::string_view::npos || !is_library_file(name)) {
    return false;
  }
  static constexpr std::string_view kElf =
      "\x7f"
      "ELF";
  std::array<char, 4> begin{};
  std::ifstream(std::filesystem::path(name), std::ios::binary).read(begin.data(), begin.size());
  return std::string_view(begin.data(), begin.size()) == kElf;
}

UserDescription describe_library(const std::string& name, const ServerLimits& limits) {
  const std::filesystem::path file = std::filesystem::absolute(name);
  require_library_file(name, file);
  return LibraryProcess(name, file, limits.memory_mib).description();
}

StartServer make_library_start(const std::string& name, const ServerLimits& limits,
                               const UserDescription& description) {
  const std::filesystem::path file = std::filesystem::absolute(name);
  const std::string hash = is_library_file(file) ? calc_program_hash(file) : "";
  return [=]() -> std::unique_ptr<CaseServer> {
    require_library_file(name, file);
    if (calc_program_hash(file) != hash) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("problem '{}': it is no longer the file that it was when this "
                              "program started; start this program again",
                              sanitize(name)));
    }
    return std::make_unique<LibraryServer>(name, file, limits, description);
  };
}

}  // namespace armwright
