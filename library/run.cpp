// The library behind include/armwright/run.h: connects a request of a host program with the run of
// study/run. Only the functions of that header are visible outside (exports.map).
#include "armwright/run.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <link.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/build_info.hpp"
#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
#include "base/stop_signal.hpp"
#include "base/text.hpp"
#include "base/toml_text.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "problems/config/problem_loader.hpp"
#include "problems/user/native_problem.hpp"
#include "problems/user/user_problem.hpp"
#include "process/json_message.hpp"
#include "study/run/run.hpp"
#include "study/run/run_folder.hpp"

namespace armwright {
namespace {

constexpr std::size_t kMostProgramBytes = std::size_t{1} << 32;
constexpr std::int64_t kMostBudget = 1'000'000'000'000;
constexpr std::uint32_t kMostJobs = 4096;
constexpr double kLongest_s = 1e9;  // the limit of --time-limit

// Returns the request. Fields that the header of the host program does not have are zero.
struct armwright_run_request read_request(const struct armwright_run_request* raw) {
  constexpr std::size_t kFirstSize = sizeof(struct armwright_run_request);
  if (raw == nullptr || raw->struct_size < kFirstSize) {
    throw Error(ErrorKind::usage,
                fmt::format("the request is NULL or says that its struct has fewer than {} bytes",
                            kFirstSize));
  }
  struct armwright_run_request request {};
  std::memcpy(&request, raw, std::min(raw->struct_size, sizeof request));
  return request;
}

std::vector<std::string> read_texts(const char* const* texts, std::size_t count, const char* name) {
  if (count > 0 && (texts == nullptr || std::count(texts, texts + count, nullptr) > 0)) {
    throw Error(ErrorKind::usage, fmt::format("{} are NULL, and their count is {}", name, count));
  }
  return {texts, texts + count};
}

// Returns the file with the code that computes the problem: the program itself or one of its
// shared libraries.
std::filesystem::path find_code(const struct armwright_user_problem& problem) {
  Dl_info info{};
  link_map* object = nullptr;
  const bool is_known = dladdr1(reinterpret_cast<const void*>(problem.evaluate), &info,
                                reinterpret_cast<void**>(&object), RTLD_DL_LINKMAP) != 0;
  if (is_known && object != nullptr && *object->l_name != '\0') {
    return object->l_name;
  }
  std::error_code ignored;
  return std::filesystem::read_symlink("/proc/self/exe", ignored);
}

// Loads the problem as if it had been recorded, and gives it the functions of the host program.
LoadedProblem load_host_problem(const struct armwright_user_problem& native,
                                std::vector<std::string> settings) {
  try {
    const UserDescription described =
        read_user_description(read_message(to_json(describe_native_problem(native))));
    const std::string name = "host:" + described.name;
    settings.push_back("program.description=" + quote_toml(to_json(described)));
    LoadedProblem loaded = load_problem(name, settings);
    loaded.problem = make_user_problem(
        {.name = name,
         .description = described,
         .start = [&native, described] { return make_native_server(native, described); },
         .why_not = ""});
    const auto code = find_code(native);
    loaded.input_hashes[code.filename().string()] =
        calc_sha256_hex(read_file(code, kMostProgramBytes));
    return loaded;
  } catch (const ProtocolError& error) {
    throw Error(ErrorKind::bad_data,
                fmt::format("the problem of this program: it {}", error.what()));
  }
}

// Passes progress and messages on to the host program.
class HostObserver final : public RunObserver {
 public:
  explicit HostObserver(const struct armwright_run_request& request) : request_(request) {}

  void on_progress(const Progress& progress) override {
    if (request_.on_progress != nullptr) {
      const struct armwright_run_progress passed {
        .struct_size = sizeof(struct armwright_run_progress), .phase = to_string(progress.phase),
        .done = progress.done, .total = progress.total, .best = progress.best_objective
      };
      request_.on_progress(request_.context, &passed);
    }
  }
  void on_message(const std::string& message) override {
    if (request_.on_message != nullptr) {
      request_.on_message(request_.context, message.c_str());
    }
  }

 private:
  const struct armwright_run_request& request_;
};

template <class Value>
Value read_or(std::optional<Value> (*read)(std::string_view), const char* text, Value otherwise,
              const char* name, std::string_view forms) {
  if (text == nullptr) {
    return otherwise;
  }
  const auto value = read(text);
  if (!value) {
    throw Error(ErrorKind::usage,
                fmt::format("{} is '{}'; it must be {}", name, sanitize(text), forms));
  }
  return *value;
}

RunPlan make_plan(const struct armwright_run_request& request,
                  const struct armwright_user_problem& native) {
  RunPlan plan;
  plan.problem = load_host_problem(
      native, read_texts(request.settings, request.setting_count, "the settings"));
  plan.optimizer =
      load_optimizer(request.optimizer == nullptr ? plan.problem.optimizer : request.optimizer);
  plan.options = Options::parse(plan.optimizer.name, plan.optimizer.options,
                                read_texts(request.options, request.option_count, "the options"));
  if (request.seed > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
    throw Error(ErrorKind::usage,
                fmt::format("the seed is {}; it must be at most 2^63 - 1", request.seed));
  }
  plan.seed = request.seed;
  if (request.budget < 0 || request.budget > kMostBudget) {
    throw Error(ErrorKind::usage, fmt::format("the budget is {}; it must be from 1 to {}",
                                              request.budget, kMostBudget));
  }
  plan.budget = request.budget == 0 ? plan.problem.budget : request.budget;
  plan.schedule =
      read_or(&read_schedule, request.schedule, choose_schedule(plan.problem, plan.optimizer),
              "the schedule", kScheduleForms);
  plan.racing =
      read_or(&read_racing, request.racing, plan.problem.racing, "the racing", kRacingForms);
  check_plan(plan);
  return plan;
}

std::filesystem::path choose_folder(const struct armwright_run_request& request,
                                    const RunPlan& plan) {
  if (request.folder == nullptr) {
    const std::vector<std::string> settings =
        read_texts(request.settings, request.setting_count, "the settings");
    return choose_run_folder("results", make_folder_name(plan, settings), false);
  }
  const auto path = std::filesystem::path(request.folder).lexically_normal();
  return path.has_filename() ? path : path.parent_path();  // "results/mine/"
}

// Returns the words of this process's command line, for the manifest.
std::vector<std::string> read_command_line() {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20;
  try {
    std::vector<std::string> words = split(read_file("/proc/self/cmdline", kMostBytes), '\0');
    if (!words.empty() && words.back().empty()) {
      words.pop_back();
    }
    return words;
  } catch (const Error&) {
    return {};
  }
}

// A result with the memory that it points to.
struct OwnedResult : armwright_run_result {
  std::string folder_text;
  RunResult result;
  std::vector<double> objective_values;
  std::vector<double> constraint_values;
};

const struct armwright_run_result* make_result(const std::filesystem::path& folder,
                                               std::optional<RunResult> result,
                                               const UserDescription& described) {
  auto owned = std::make_unique<OwnedResult>();
  owned->folder_text = folder.string();
  armwright_run_result& raw = *owned;
  raw.struct_size = sizeof raw;
  raw.folder = owned->folder_text.c_str();
  raw.end_reason = "";
  raw.failure = "";
  if (result) {
    owned->result = std::move(*result);
    const RunResult& all = owned->result;
    raw.is_finished = 1;
    raw.end_reason = all.end_reason.c_str();
    raw.failure = all.failure.c_str();
    raw.evaluations = all.counts.evaluations;
    raw.failed_evaluations = all.counts.failed;
    if (all.winner && !all.test.objectives.empty()) {
      for (std::size_t i = 0; i < all.test.objectives.size(); ++i) {
        const double value = all.test.objectives[i];
        owned->objective_values.push_back(described.objectives[i].is_maximised ? -value : value);
      }
      for (std::size_t i = 0; i < all.test.constraint_values.size(); ++i) {
        const double value = all.test.constraint_values[i];
        const auto& limit = described.constraints[i].limit;
        owned->constraint_values.push_back(limit ? (value + 1) * *limit : value);
      }
      const std::vector<double>& x = all.judged[*all.winner].candidate.x;
      raw.has_winner = 1;
      raw.is_feasible = is_proven_feasible(all.test) ? 1 : 0;
      raw.variable_count = x.size();
      raw.x = x.data();
      raw.objective_count = owned->objective_values.size();
      raw.objectives = owned->objective_values.data();
      raw.constraint_count = owned->constraint_values.size();
      raw.constraints = owned->constraint_values.data();
    }
  }
  return owned.release();
}

const struct armwright_run_result* run(const struct armwright_run_request& request) {
  struct armwright_user_problem native {};
  try {
    native = read_native_problem(request.problem);
  } catch (const ProtocolError& error) {
    throw Error(ErrorKind::usage, fmt::format("the problem of this program: it {}", error.what()));
  }
  if (request.jobs > kMostJobs) {
    throw Error(ErrorKind::usage,
                fmt::format("jobs is {}; it must be at most {}", request.jobs, kMostJobs));
  }
  if (!(request.time_limit_s >= 0 && request.time_limit_s <= kLongest_s)) {
    throw Error(
        ErrorKind::usage,
        fmt::format("time_limit_s is {}; it must be from 0, which stands for no limit, to {}",
                    request.time_limit_s, kLongest_s));
  }
  RunRequest own;
  own.plan = make_plan(request, native);
  own.folder = choose_folder(request, own.plan);
  own.jobs = std::max<std::uint32_t>(request.jobs, 1);
  own.command_line = read_command_line();
  StopSignal stop;
  if (request.must_stop != nullptr) {
    stop.set_lookout([&] {
      if (request.must_stop(request.context) != 0) {
        stop.request(StopReason::interrupted);
      }
    });
  }
  if (request.time_limit_s > 0) {
    stop.set_deadline(StopSignal::Clock::now() +
                      std::chrono::duration_cast<StopSignal::Clock::duration>(
                          std::chrono::duration<double>(request.time_limit_s)));
  }
  HostObserver observer(request);
  std::optional<RunResult> result = execute_run(own, stop, observer);
  return make_result(own.folder, std::move(result), describe_native_problem(native));
}

int get_code(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::usage:
      return ARMWRIGHT_RUN_USAGE;
    case ErrorKind::bad_data:
      return ARMWRIGHT_RUN_BAD_DATA;
    case ErrorKind::busy:
      return ARMWRIGHT_RUN_BUSY;
    case ErrorKind::io:
      break;
  }
  return ARMWRIGHT_RUN_IO;
}

}  // namespace
}  // namespace armwright

int armwright_run(const struct armwright_run_request* request,
                  const struct armwright_run_result** result, char* message,
                  std::size_t message_size) {
  const auto fail = [&](int code, const char* what) {
    if (message != nullptr && message_size > 0) {
      const std::size_t count = std::min(std::strlen(what), message_size - 1);
      std::memcpy(message, what, count);
      message[count] = '\0';
    }
    return code;
  };
  if (result == nullptr) {
    return fail(ARMWRIGHT_RUN_USAGE, "the place for the result is NULL");
  }
  *result = nullptr;
  try {
    const struct armwright_run_request own = armwright::read_request(request);
    *result = armwright::run(own);
    return ARMWRIGHT_RUN_OK;
  } catch (const armwright::Error& error) {
    return fail(armwright::get_code(error.kind()), error.what());
  } catch (const std::exception& error) {
    return fail(ARMWRIGHT_RUN_INTERNAL, error.what());
  } catch (...) {
    return fail(ARMWRIGHT_RUN_INTERNAL, "something that is no std::exception was thrown");
  }
}

void armwright_free_result(const struct armwright_run_result* result) {
  delete static_cast<const armwright::OwnedResult*>(result);
}

const char* armwright_version(void) {
  static const std::string version = armwright::get_version();
  return version.c_str();
}
