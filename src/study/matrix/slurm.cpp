#include "study/matrix/slurm.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "study/compare/study_folder.hpp"
#include "study/compare/study_plan.hpp"
#include "study/matrix/command_output.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr const char* kSubmissionRecord = "submission.json";
constexpr int kSubmissionFormat = 1;
constexpr std::size_t kSubmissionLimit_bytes = std::size_t{1} << 20;

bool is_job_number(std::string_view text) {
  return !text.empty() && text.size() < 20 &&
         text.find_first_not_of("0123456789") == std::string_view::npos;
}

// Reads the output of sbatch --parsable: one line with NUMBER or NUMBER;CLUSTER.
std::string parse_job(const CommandOutput& output) {
  const std::string line = output.out.substr(0, output.out.find('\n'));
  const std::string job = line.substr(0, line.find(';'));
  if (!is_job_number(job)) {
    throw Error(ErrorKind::usage,
                fmt::format("sbatch printed '{}' instead of the number of the job; check with "
                            "squeue whether it was submitted",
                            sanitize(line)));
  }
  return job;
}

std::string join_streams(const CommandOutput& output) {
  std::string text = output.err + output.out;
  while (!text.empty() && text.back() == '\n') {
    text.pop_back();
  }
  std::vector<std::string> lines;
  for (const std::string& line : split(text, '\n')) {
    lines.push_back("  " + sanitize(line));
  }
  return join(lines, "\n");
}

std::string read_submitted_job(const std::filesystem::path& file) {
  const std::string text = read_json_file(file, kSubmissionLimit_bytes);
  try {
    const json j = json::parse(text);
    const std::string job = j.at("job");
    if (j.at("format") != kSubmissionFormat || !is_job_number(job)) {
      throw std::runtime_error("this version cannot read its format or job");
    }
    return job;
  } catch (const std::exception& error) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: is not what armwright wrote ({}); remove it once no job of this "
                            "study is in the queue",
                            file.string(), sanitize(error.what())));
  }
}

std::string to_json(const StudyPlan& plan, const std::string& job, std::size_t chunks,
                    std::span<const std::string> words) {
  const auto now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  const json j = {{"format", kSubmissionFormat},
                  {"job", job},
                  {"chunks", chunks},
                  {"plan_sha256", calc_plan_hash(plan)},
                  {"submitted", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now))},
                  {"command_line", words}};
  return j.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

std::filesystem::path get_submissions(const std::filesystem::path& study) {
  return std::filesystem::absolute(study).lexically_normal() / "submissions";
}

Folder make_submissions(const std::filesystem::path& study) {
  const auto submissions = get_submissions(study);
  return Folder::make(submissions, submissions.parent_path());
}

// Creates a folder that no other process uses, even if another one submits at the same time.
Folder claim_submission_folder(const Folder& submissions, const std::filesystem::path& study) {
  while (true) {
    const auto folder = choose_submission_folder(study);
    if (::mkdirat(submissions.get(), folder.filename().c_str(), 0777) == 0) {
      return Folder::make(folder, submissions.path());
    }
    if (errno != EEXIST) {
      fail_io(folder, "create this folder", errno);
    }
  }
}

// Records the job, or cancels it if that fails: an unrecorded job would be submitted again.
void record_submission(const Folder& folder, const std::string& job, const std::string& record) {
  try {
    write_file_atomically(folder, kSubmissionRecord, record);
  } catch (const Error&) {
    run_command(std::vector<std::string>{"scancel", job});
    throw;
  }
}

// Returns a job of an earlier submission that is still in the queue, or nothing. Throws
// Error{usage} if squeue is missing or fails, and Error{bad_data} for a submission.json that cannot
// be read.
std::optional<std::string> find_queued_job(const std::filesystem::path& study) {
  std::error_code error;
  std::vector<std::filesystem::path> records;
  for (std::filesystem::directory_iterator entry(get_submissions(study), error), end;
       !error && entry != end; entry.increment(error)) {
    if (path_exists(entry->path() / kSubmissionRecord)) {
      records.push_back(entry->path() / kSubmissionRecord);
    }
  }
  std::ranges::sort(records);
  for (const auto& record : records) {
    const std::string job = read_submitted_job(record);
    const CommandOutput queue = run_command(std::vector<std::string>{"squeue", "-h", "-j", job});
    // Slurm forgets a job some minutes after its end.
    const bool is_forgotten = queue.err.find("Invalid job id") != std::string::npos;
    if (queue.exit_code != 0 && !is_forgotten) {
      throw Error(ErrorKind::usage,
                  fmt::format("squeue cannot tell whether job {} of this study is still in the "
                              "queue (exit code {}):\n{}",
                              job, queue.exit_code, join_streams(queue)));
    }
    if (queue.exit_code == 0 && !queue.out.empty()) {
      return job;
    }
  }
  return std::nullopt;
}

}  // namespace

std::filesystem::path choose_submission_folder(const std::filesystem::path& study) {
  const auto submissions = get_submissions(study);
  for (int number = 1;; ++number) {
    const auto folder = submissions / fmt::format("{:03}", number);
    if (!path_exists(folder)) {
      return folder;
    }
  }
}

long calc_time_limit_min(std::span<const Chunk> chunks) {
  double longest_s = 0;
  for (const Chunk& chunk : chunks) {
    longest_s = std::max(longest_s, chunk.expected_s);
  }
  constexpr double kReserve = 4;  // for slower nodes and optimizers that compute much
  constexpr double kStart_min = 10;
  return std::lround(std::ceil(kReserve * longest_s / 60 + kStart_min));
}

std::vector<std::string> make_sbatch_words(const StudyPlan& plan, std::span<const Chunk> chunks,
                                           const SlurmRequest& request,
                                           const std::filesystem::path& folder) {
  // In file names, Slurm reads % as the begin of a pattern and %% as one percent sign.
  std::string log = folder.string();
  for (std::size_t at = log.find('%'); at != std::string::npos; at = log.find('%', at + 2)) {
    log.insert(at, 1, '%');
  }
  std::vector<std::string> words = {"sbatch",
                                    "--parsable",
                                    fmt::format("--array=1-{}", chunks.size()),
                                    "--requeue",
                                    "--open-mode=append",
                                    "--job-name=armwright-" + escape_name(plan.name),
                                    fmt::format("--output={}/task-%a.log", log),
                                    fmt::format("--time={}", calc_time_limit_min(chunks)),
                                    fmt::format("--cpus-per-task={}", request.jobs)};
  words.insert(words.end(), request.more_words.begin(), request.more_words.end());
  words.push_back((folder / "run.sh").string());
  return words;
}

std::string submit_to_slurm(const StudyPlan& plan, std::span<const Chunk> chunks,
                            const SlurmRequest& request, const std::string& script) {
  const Folder submissions = make_submissions(request.study);
  const RunLock lock(submissions);
  if (const auto job = find_queued_job(request.study)) {
    throw Error(ErrorKind::busy,
                fmt::format("job {0} of this study is still in the queue (squeue -j {0}); wait for "
                            "it, or end it with: scancel {0}",
                            *job));
  }
  const Folder folder = claim_submission_folder(submissions, request.study);
  const auto words = make_sbatch_words(plan, chunks, request, folder.path());
  try {
    write_file_atomically(folder, "run.sh", script);
    const CommandOutput output = run_command(words);
    if (output.exit_code != 0) {
      throw Error(ErrorKind::usage,
                  fmt::format("sbatch refuses (exit code {}):\n{}\nIt was:\n{}", output.exit_code,
                              join_streams(output), sanitize(quote_command(words))));
    }
    const std::string job = parse_job(output);
    record_submission(folder, job, to_json(plan, job, chunks.size(), words));
    return job;
  } catch (const Error&) {
    std::error_code ignored;
    std::filesystem::remove_all(folder.path(), ignored);
    throw;
  }
}

}  // namespace armwright
