#include "study/matrix/attempt.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "study/run/json_values.hpp"
#include "study/run/run_lock.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr int kAttemptFormat = 1;
constexpr std::size_t kAttemptLimit_bytes = std::size_t{64} << 10;
constexpr const char* kAttemptRecord = "attempt.json";
constexpr const char* kSignOfLife = "alive";
constexpr const char* kErrorRecord = "error.txt";

std::string get_variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

// The environment variables in which a batch system names a job and its index in a job array.
struct BatchSystem {
  const char* name;
  const char* job;
  const char* entry;
};
constexpr BatchSystem kBatchSystems[] = {
    {"slurm", "SLURM_ARRAY_JOB_ID", "SLURM_ARRAY_TASK_ID"},
    {"slurm", "SLURM_JOB_ID", nullptr},
    {"pbs", "PBS_JOBID", nullptr},  // includes the index
    {"lsf", "LSB_JOBID", "LSB_JOBINDEX"},
    {"sge", "JOB_ID", "SGE_TASK_ID"},
};

std::string find_job() {
  for (const BatchSystem& system : kBatchSystems) {
    const std::string job = get_variable(system.job);
    if (job.empty()) {
      continue;
    }
    const std::string entry = system.entry == nullptr ? "" : get_variable(system.entry);
    return sanitize(fmt::format("{} {}{}{}", system.name, job, entry.empty() ? "" : "_", entry));
  }
  return "";
}

std::optional<std::string> read_if_there(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) {
    return std::nullopt;
  }
  try {
    return read_file(file, kAttemptLimit_bytes);
  } catch (const Error&) {
    return std::nullopt;  // removed in the meantime, or not a file that armwright wrote
  }
}

std::optional<std::uint64_t> parse_sign_of_life(const std::string& text,
                                                const std::filesystem::path& file) {
  try {
    check_json_depth(text, file.string());
    return whole_from_json(json::parse(text).at("cases"));
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

std::string describe_successor(int token) {
  return fmt::format("superseded by attempt {}", token);
}

}  // namespace

std::filesystem::path make_attempts_path(const StudyPlan& plan, const Cell& cell,
                                         const std::filesystem::path& study) {
  return study / kAttemptsFolder / make_cell_path(plan, cell).lexically_relative("cells");
}

std::vector<int> list_tokens(const std::filesystem::path& attempts) {
  std::vector<int> tokens;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(attempts, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    constexpr std::size_t kMostDigits = 9;
    if (name.size() <= kMostDigits && name.find_first_not_of("0123456789") == std::string::npos) {
      tokens.push_back(static_cast<int>(parse_integer(name).value_or(0)));
    }
  }
  if (error && error != std::errc::no_such_file_or_directory) {
    fail_io(attempts, "list it", error.value());
  }
  std::ranges::sort(tokens);
  return tokens;
}

std::filesystem::path make_token_path(const std::filesystem::path& attempts, int token) {
  return attempts / fmt::format("{:03}", token);
}

AttemptRecord describe_this_process(std::int64_t begun_s) {
  const auto now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  return {get_host_name(), ::getpid(), find_job(),
          fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now)), begun_s};
}

std::string to_json(const AttemptRecord& record) {
  const json j = {{"format", kAttemptFormat},  {"host", record.host},
                  {"pid", record.pid},         {"job", record.job},
                  {"started", record.started}, {"process_begun_s", record.process_begun_s}};
  return j.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

AttemptRecord parse_attempt(const std::string& text, const std::filesystem::path& file) {
  check_json_depth(text, file.string());
  try {
    const json j = json::parse(text);
    if (j.at("format") != kAttemptFormat) {
      throw std::runtime_error("its format is not the one this version reads");
    }
    return {sanitize(j.at("host").get<std::string>()), whole_from_json<std::int64_t>(j.at("pid")),
            sanitize(j.at("job").get<std::string>()), sanitize(j.at("started").get<std::string>()),
            whole_from_json<std::int64_t>(j.at("process_begun_s"))};
  } catch (const std::exception& error) {
    throw Error(ErrorKind::bad_data, fmt::format("{}: is not what armwright wrote ({})",
                                                 file.string(), sanitize(error.what())));
  }
}

Attempt::Attempt(const std::filesystem::path& attempts, const std::filesystem::path& study,
                 std::int64_t process_begun_s)
    : attempts_(attempts), folder_(Folder::make(attempts, study)) {
  const std::vector<int> tokens = list_tokens(attempts);
  token_ = tokens.empty() ? 1 : tokens.back() + 1;
  while (true) {
    const auto path = make_token_path(attempts, token_);
    if (::mkdirat(folder_.get(), path.filename().c_str(), 0777) == 0) {
      folder_ = Folder::make(path, attempts);
      break;
    }
    // A network file system may create the folder and still report EEXIST. Its number is lost then.
    if (errno != EEXIST) {
      fail_io(path, "create this folder", errno);
    }
    ++token_;
  }
  record_ = to_json(describe_this_process(process_begun_s));
  write_file_atomically(folder_, kAttemptRecord, record_);
  tell_alive(0);
}

std::string Attempt::find_successor() const {
  const std::vector<int> tokens = list_tokens(attempts_);
  if (!tokens.empty() && tokens.back() > token_) {
    return describe_successor(tokens.back());
  }
  // A token that was removed can be taken by another process, so the record is compared.
  const auto record = read_if_there(folder_.path() / kAttemptRecord);
  const bool is_ours =
      std::ranges::binary_search(tokens, token_) && (!record || *record == record_);
  return is_ours ? "" : "superseded: its folder is gone; perhaps another attempt ended the cell";
}

void Attempt::tell_alive(std::uint64_t cases) const {
  write_file_atomically(folder_, kSignOfLife, json{{"cases", cases}}.dump() + "\n");
}

void Attempt::end_in_order() const {
  folder_.remove(kSignOfLife);
}

void Attempt::record_error(const std::string& error) const {
  write_file_atomically(folder_, kErrorRecord, sanitize(error) + "\n");
}

AttemptState read_attempt(const std::filesystem::path& attempts, int token) {
  const auto path = make_token_path(attempts, token);
  AttemptState state;
  state.token = token;
  if (const auto text = read_if_there(path / kAttemptRecord)) {
    try {
      state.record = parse_attempt(*text, path / kAttemptRecord);
    } catch (const Error&) {
      state.record.reset();
    }
  }
  if (const auto text = read_if_there(path / kSignOfLife)) {
    struct stat found {};
    if (::stat((path / kSignOfLife).c_str(), &found) == 0) {
      const auto written = std::chrono::system_clock::from_time_t(found.st_mtime);
      const std::chrono::duration<double> age = std::chrono::system_clock::now() - written;
      state.silence_s = std::max(0.0, age.count());  // the machines' clocks may differ
    }
    state.cases = parse_sign_of_life(*text, path / kSignOfLife);
  }
  if (const auto text = read_if_there(path / kErrorRecord)) {
    state.error = sanitize(text->substr(0, text->find('\n')));
    if (state.error.empty()) {
      state.error = "an error that is not recorded";
    }
  }
  return state;
}

std::string find_later_life(const std::filesystem::path& attempts, std::int64_t begun_s) {
  const std::string job = find_job();
  const std::vector<int> tokens = list_tokens(attempts);
  if (job.empty() || tokens.empty()) {
    return "";
  }
  // The clocks of a cluster differ much less than the time between two starts of a job.
  const AttemptState last = read_attempt(attempts, tokens.back());
  const bool is_later =
      last.record && last.record->job == job && last.record->process_begun_s > begun_s;
  return is_later ? describe_successor(last.token) : "";
}

}  // namespace armwright
