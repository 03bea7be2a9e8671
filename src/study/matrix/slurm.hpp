// Submits a study's cells as a Slurm job array:
//   STUDY/submissions/001, 002, ...   run.sh, submission.json, task-N.log
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "study/matrix/chunks.hpp"

namespace armwright {

struct SlurmRequest {
  std::filesystem::path study;
  unsigned jobs = 1;                    // threads per task
  std::vector<std::string> more_words;  // user's options for sbatch, placed after armwright's
};

// Returns the next free STUDY/submissions/NNN. Creates nothing.
std::filesystem::path choose_submission_folder(const std::filesystem::path& study);

// Returns a generous time limit for every task. A task that reaches it resumes when it is started
// again, but must wait in the queue first.
long calc_time_limit_min(std::span<const Chunk> chunks);

// Returns the command line that submits `folder`/run.sh.
std::vector<std::string> make_sbatch_words(const StudyPlan& plan, std::span<const Chunk> chunks,
                                           const SlurmRequest& request,
                                           const std::filesystem::path& folder);

// Writes the script, submits it and returns the job's number. Throws Error{busy} while a job of an
// earlier submission is in the queue, or another process submits for the study. Throws Error{usage}
// if squeue is missing or fails. Throws Error{usage} with Slurm's message if Slurm refuses, and
// then removes the submission's folder. Throws Error{bad_data} for an earlier submission.json that
// cannot be read.
std::string submit_to_slurm(const StudyPlan& plan, std::span<const Chunk> chunks,
                            const SlurmRequest& request, const std::string& script);

}  // namespace armwright
