// A study's cells as a job array of Slurm's:
//   STUDY/submissions/001, 002, ...   run.sh, submission.json, task-N.log
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "study/matrix/chunks.hpp"

namespace armwright {

struct SlurmRequest {
  std::filesystem::path study;
  unsigned jobs = 1;                    // threads a task
  std::vector<std::string> more_words;  // of sbatch, after ours
};

// STUDY/submissions/NNN, the next free.
std::filesystem::path choose_submission_folder(const std::filesystem::path& study);

// Generous: a task that is ended goes on in its next life, but loses a queue's time.
long calc_time_limit_min(std::span<const Chunk> chunks);

// The command line that submits `folder`/run.sh.
std::vector<std::string> make_sbatch_words(const StudyPlan& plan, std::span<const Chunk> chunks,
                                           const SlurmRequest& request,
                                           const std::filesystem::path& folder);

// A job of an earlier submission that is still in the queue; nothing if there is none. Error{usage}
// without squeue, or if it fails; Error{bad_data} for a submission.json that cannot be read.
std::optional<std::string> find_queued_job(const std::filesystem::path& study);

struct Submission {
  std::string job;
  std::filesystem::path folder;
};
// Writes the script and submits it; one at a time for a study. Error{usage} with Slurm's own words
// if it refuses, and then nothing stays behind; Error{busy} while an earlier submission is in the
// queue.
Submission submit_to_slurm(const StudyPlan& plan, std::span<const Chunk> chunks,
                           const SlurmRequest& request, const std::string& script);

}  // namespace armwright
