#include "problems/user/command_server.hpp"

#include <fmt/format.h>
#include <stdlib.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <optional>
#include <set>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
#include "base/text.hpp"
#include "problems/user/case_messages.hpp"
#include "process/json_message.hpp"
#include "process/line_process.hpp"
#include "process/output_log.hpp"
#include "process/stop_scope.hpp"

namespace armwright {
namespace {

constexpr const char* kCasePlaces[] = {"seed", "case", "role", "folder"};

// A folder for one case, which is removed at the end of the scope if it is not kept.
class WorkingFolder {
 public:
  explicit WorkingFolder(const std::filesystem::path& workspace) {
    std::string name = (workspace / "armwright-case-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
      fail_io(name, "create this folder (command.workspace)", errno);
    }
    path_ = name;
  }
  ~WorkingFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  WorkingFolder(const WorkingFolder&) = delete;
  WorkingFolder& operator=(const WorkingFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

  // Gives the folder a name that lasts. A folder of an earlier evaluation of the same case is
  // replaced. If another process does the same at this moment, one of both is kept.
  void keep_as(const std::string& name) const {
    const std::filesystem::path target = path_.parent_path() / name;
    std::error_code ignored;
    std::filesystem::remove_all(target, ignored);
    std::filesystem::rename(path_, target, ignored);
  }

 private:
  std::filesystem::path path_;
};

void write_plainly(const std::filesystem::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) {
    fail_io(file, "write", errno);
  }
}

// Returns whether a signal killed the command, or a process whose end it passes on as shells do.
bool is_death_by_signal(const std::optional<int>& exit_code) {
  constexpr int kShellBase = 128;
  constexpr int kLastSignal = 31;
  return !exit_code || (*exit_code > kShellBase && *exit_code <= kShellBase + kLastSignal);
}

class CommandServer final : public CaseServer {
 public:
  explicit CommandServer(std::shared_ptr<const CommandPlan> plan) : plan_(std::move(plan)) {}

  void answer(std::span<const CaseJob> jobs, std::vector<CaseAnswer>& answers) override {
    for (const CaseJob& job : jobs) {
      answers.push_back(run(job));
    }
  }

 private:
  CaseAnswer run(const CaseJob& job) const {
    const std::vector<std::string> values = list_values(job);
    const WorkingFolder folder(plan_->workspace.empty() ? std::filesystem::temp_directory_path()
                                                        : plan_->workspace);
    for (const CommandPlan::Input& input : plan_->inputs) {
      write_plainly(folder.path() / input.file, input.text.fill(values));
    }
    std::vector<std::string> words;
    for (const Template& word : plan_->words) {
      words.push_back(word.fill(values));
    }
    const bool keeps = plan_->keep != KeepFolders::none;
    OutputLog log(keeps ? folder.path() / "armwright.stderr" : "", OutputLog::Begin::anew);
    std::string output;
    const CaseAnswer answer = run(words, folder.path(), log, output);
    if (plan_->keep == KeepFolders::all ||
        (plan_->keep == KeepFolders::failed && answer.status != EvaluationStatus::ok)) {
      write_plainly(folder.path() / "armwright.command", quote_command(words) + "\n");
      write_plainly(folder.path() / "armwright.stdout", output);
      folder.keep_as(make_kept_name(job, values));
    }
    return answer;
  }

  // Returns the values of the places, in the order of list_places().
  std::vector<std::string> list_values(const CaseJob& job) const {
    std::vector<std::string> values;
    const auto& variables = plan_->description.variables;
    for (std::size_t i = 0; i < variables.size(); ++i) {
      values.push_back(format_value(variables[i], job.x[i]));
    }
    values.push_back(std::to_string(calc_case_seed(*job.block, job.number)));
    values.push_back(std::to_string(job.number));
    values.emplace_back(to_string(job.block->role));
    values.push_back(plan_->folder.string());
    return values;
  }

  static const char* to_string(CaseRole role) {
    return role == CaseRole::training     ? "training"
           : role == CaseRole::validation ? "validation"
                                          : "test";
  }

  static std::string make_kept_name(const CaseJob& job, const std::vector<std::string>& values) {
    std::string text = job.block->set;
    for (const std::string& value : values) {
      text += '\n' + value;
    }
    return fmt::format("{}-case{}-{}", to_string(job.block->role), job.number,
                       calc_sha256_hex(text).substr(0, 12));
  }

  // Runs the command. The reasons of failures are recorded, so they have neither a path nor what
  // the command wrote: both may differ each time. The details have what it wrote.
  CaseAnswer run(const std::vector<std::string>& words, const std::filesystem::path& folder,
                 OutputLog& log, std::string& output) const {
    const auto fail = [&](EvaluationStatus status, std::string_view what,
                          const std::string& found = "") {
      CaseAnswer answer;
      check_work_stop();  // what stops this process may have stopped the command, too
      answer.status = status;
      answer.reason = fmt::format("the command {}", what);
      answer.details = found + describe_printed(log.last_lines());
      return answer;
    };
    try {
      LineProcess process(words, log, folder);
      process.limit_memory(plan_->limits.memory_mib);
      LineProcess::Ending ending = process.complete(plan_->limits.time_limit_s, kMostResult_bytes);
      output = ending.output.substr(0, OutputLog::kHeadBytes);
      const bool reads_exit = std::ranges::any_of(plan_->readings, [](const ResultReading& one) {
        return one.kind == ResultReading::Kind::exit_code;
      });
      if (is_death_by_signal(ending.exit_code)) {
        await_work_stop();
      }
      if (!ending.exit_code || (*ending.exit_code != 0 && !reads_exit)) {
        return fail(EvaluationStatus::failed, ending.how);
      }
      return read(CommandResults(
          folder, ending.is_cut ? std::nullopt : std::optional(std::move(ending.output)),
          *ending.exit_code));
    } catch (const LineProcessSilence& error) {
      return fail(EvaluationStatus::timed_out,
                  fmt::format("{} (command.time_limit_s)", error.what()));
    } catch (const LineProcessFailure&) {  // its message has a measured size
      return fail(EvaluationStatus::failed,
                  fmt::format("took more than {:g} MiB of memory (command.memory_mib)",
                              plan_->limits.memory_mib));
    } catch (const MissingResult& missing) {
      return fail(EvaluationStatus::failed, fmt::format("left no result: {}", missing.what()),
                  missing.found());
    }
  }

  CaseAnswer read(CommandResults results) const {
    const UserDescription& description = plan_->description;
    CaseAnswer answer;
    auto reading = plan_->readings.begin();
    const auto take = [&](std::size_t count, std::vector<double>& values) {
      for (std::size_t i = 0; i < count; ++i) {
        values.push_back(results.read(*reading++));
      }
    };
    take(description.objectives.size(), answer.objectives);
    take(description.constraints.size(), answer.constraints);
    take(description.metrics.size(), answer.metrics);
    return answer;
  }

  std::shared_ptr<const CommandPlan> plan_;
};

}  // namespace

Template::Template(std::string_view text, const std::vector<std::string>& names) {
  parts_.emplace_back();
  while (!text.empty()) {
    const std::size_t brace = std::min(text.find('{'), text.size());
    parts_.back().text += text.substr(0, brace);
    text.remove_prefix(brace);
    if (text.starts_with("{{")) {
      parts_.back().text += '{';
      text.remove_prefix(2);
    } else if (!text.empty()) {
      const std::size_t end = text.find('}');
      const std::string name(text.substr(1, end == std::string_view::npos ? end : end - 1));
      if (end == std::string_view::npos || name.find('\n') != std::string::npos) {
        throw std::invalid_argument(fmt::format(
            "have no brace without its end, and it has {}; write {{{{ for a brace that is text",
            quote(std::string(text.substr(0, text.find('\n'))))));
      }
      const auto found = std::ranges::find(names, name);
      if (found == names.end()) {
        throw std::invalid_argument(
            fmt::format("have places for known names only: {}; write {{{{ for a brace that is text",
                        describe_unknown("place", name, names)));
      }
      parts_.back().name = static_cast<std::size_t>(found - names.begin());
      parts_.emplace_back();
      text.remove_prefix(end + 1);
    }
  }
}

std::string Template::fill(const std::vector<std::string>& values) const {
  std::string text;
  for (const Part& part : parts_) {
    text += part.text;
    if (part.name) {
      text += values[*part.name];
    }
  }
  return text;
}

bool Template::uses(std::size_t name) const {
  return std::ranges::any_of(parts_, [&](const Part& part) { return part.name == name; });
}

std::vector<std::string> list_places(const std::vector<DecisionVariable>& variables) {
  std::vector<std::string> names;
  for (const DecisionVariable& variable : variables) {
    names.push_back(variable.name);
  }
  names.insert(names.end(), std::begin(kCasePlaces), std::end(kCasePlaces));
  return names;
}

UserProgram make_command_problem(CommandPlan plan) {
  UserProgram program;
  program.name = plan.name;
  program.description = plan.description;
  program.start = [shared = std::make_shared<const CommandPlan>(std::move(plan))]()
      -> std::unique_ptr<CaseServer> { return std::make_unique<CommandServer>(shared); };
  return program;
}

}  // namespace armwright
