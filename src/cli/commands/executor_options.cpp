#include "cli/commands/executor_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>

#include "base/error.hpp"
#include "base/text.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/terminal.hpp"
#include "study/compare/cell.hpp"
#include "study/compare/plugin_consent.hpp"
#include "study/compare/study_folder.hpp"
#include "study/executor/mpi_transport.hpp"
#include "study/matrix/chunks.hpp"
#include "study/matrix/slurm.hpp"

namespace armwright {
namespace {

constexpr const char* kDefaultChunk = "60s";

struct Work {
  std::size_t cells = 0;  // all cells of the study
  std::size_t left = 0;   // those that have not ended
  std::vector<Chunk> chunks;
};

Work plan_work(const ExecutorOptions& options, const StudyPlan& plan,
               const std::filesystem::path& folder, unsigned jobs) {
  const double least_s =
      parse_duration_s("--chunk", options.chunk.empty() ? kDefaultChunk : options.chunk);
  const std::vector<Cell> cells = list_cells(plan);
  std::vector<Cell> left;
  for (const Cell& cell : cells) {
    if (!is_study_folder(folder) || !load_cell(plan, cell, folder)) {
      left.push_back(cell);
    }
  }
  std::vector<double> durations_s = measure_cell_durations_s(plan);
  for (double& duration_s : durations_s) {
    duration_s /= jobs;
  }
  return {cells.size(), left.size(), plan_chunks(left, durations_s, least_s)};
}

// "5 to 8", or "5"
std::string describe_range(const std::string& least, const std::string& most) {
  return least == most ? least : least + " to " + most;
}

std::string describe_work(const ExecutorOptions& options, const StudyPlan& plan,
                          const std::filesystem::path& folder, unsigned jobs, const Work& work) {
  std::string text =
      fmt::format("cells    {}, of which {} are done\n", work.cells, work.cells - work.left);
  if (work.chunks.empty()) {
    return text;
  }
  const auto [fewest, most] = std::ranges::minmax_element(
      work.chunks, {}, [](const Chunk& chunk) { return chunk.cells.size(); });
  const auto [shortest, longest] = std::ranges::minmax_element(work.chunks, {}, &Chunk::expected_s);
  double total_s = 0;
  for (const Chunk& chunk : work.chunks) {
    total_s += chunk.expected_s;
  }
  text += fmt::format(
      "chunks   {}, of {} cells\n", work.chunks.size(),
      describe_range(std::to_string(fewest->cells.size()), std::to_string(most->cells.size())));
  text += fmt::format(
      "time     about {} per chunk, {} in all (measured here on a few simulations;\n"
      "         optimizers with much computation of their own take longer)\n",
      describe_range(format_duration(shortest->expected_s), format_duration(longest->expected_s)),
      format_duration(total_s));
  text += fmt::format(
      "memory   about {:.0f} MiB per task at most, without the memory of optimizers and plugins\n",
      estimate_cell_memory_mib(plan));
  if (options.name == "slurm") {
    const auto words = make_sbatch_words(plan, work.chunks, {folder, jobs, options.sbatch},
                                         choose_submission_folder(folder));
    text += "submit   " + sanitize(quote_command(words)) + "\n";
  }
  return text;
}

CellScriptRequest make_script_request(const std::filesystem::path& folder, unsigned jobs) {
  CellScriptRequest script;
  script.study = std::filesystem::absolute(folder).lexically_normal();
  script.program = std::filesystem::read_symlink("/proc/self/exe");
  script.folder = std::filesystem::current_path();
  if (const char* configs = std::getenv("ARMWRIGHT_CONFIGS")) {
    script.configs = configs;
  }
  script.jobs = jobs;
  return script;
}

int submit(const StudyPlan& plan, const SlurmRequest& request, const Work& work,
           const std::string& script, const Session& session) {
  const std::string job = submit_to_slurm(plan, work.chunks, request, script);
  write_stdout(
      fmt::format("job {0}: {1} of cells\n"
                  "  squeue -j {0}\n"
                  "  {2}\n"
                  "When all jobs have ended:\n"
                  "  {3}\n",
                  job, format_count(work.chunks.size(), "chunk"),
                  quote_own_command(session, {"status", request.study.string()}),
                  quote_own_command(session, {"merge", request.study.string()})));
  return exit_code::kDone;
}

}  // namespace

void ExecutorOptions::add_to(CLI::App& command) {
  command
      .add_option("--executor", name,
                  "Where the cells run: local, in processes of this machine; mpi, on the ranks of\n"
                  "an mpirun; slurm, as a job array; script, by a bash script that is printed\n"
                  "(default: mpi under mpirun, otherwise local)")
      ->type_name("NAME");
  command
      .add_option(
          "--chunk", chunk,
          fmt::format("For slurm and script: a chunk has as many cells as take at least this time\n"
                      "(default: {})",
                      kDefaultChunk))
      ->type_name("DURATION");
  command
      .add_option("--sbatch", sbatch,
                  "For slurm: another word for sbatch, as in --sbatch=--partition=short;\n"
                  "repeatable")
      ->type_name("WORD")
      ->allow_extra_args(false);
}

bool ExecutorOptions::is_elsewhere() const {
  const std::vector<std::string> names = {"local", "mpi", "slurm", "script"};
  if (!name.empty() && std::ranges::find(names, name) == names.end()) {
    throw Error(ErrorKind::usage, describe_unknown("executor", name, names));
  }
  const bool has_ranks = find_rank_place().has_value();
  if (has_ranks && !name.empty() && name != "mpi") {
    throw Error(ErrorKind::usage,
                fmt::format("mpirun has started several ranks, but --executor is {}; start the "
                            "program without mpirun, or leave --executor out",
                            name));
  }
  if (name == "mpi" && !has_ranks) {
    throw Error(ErrorKind::usage,
                "--executor mpi needs ranks that mpirun starts: 'mpirun --enable-recovery -n 4 "
                "armwright compare ...'; see docs/clusters.md");
  }
  const auto refuse_flag = [&](const char* flag, const char* executors) {
    throw Error(ErrorKind::usage,
                fmt::format("{} is for --executor {}, but the executor is {}", flag, executors,
                            !name.empty() ? name
                            : has_ranks   ? "mpi"
                                          : "local"));
  };
  const bool elsewhere = name == "slurm" || name == "script";
  if (!elsewhere && !chunk.empty()) {
    refuse_flag("--chunk", "slurm or script");
  }
  if (name != "slurm" && !sbatch.empty()) {
    refuse_flag("--sbatch", "slurm");
  }
  return elsewhere;
}

int hand_over_cells(const ExecutorOptions& options, const StudyPlan& plan,
                    const std::filesystem::path& path, unsigned jobs, bool dry_run,
                    Session& session) {
  if (dry_run) {
    write_stdout(describe_work(options, plan, path, jobs, plan_work(options, plan, path, jobs)));
    return exit_code::kDone;
  }
  {
    const StudyFolder folder(path, plan);
    remember_study(path, plan.problems);
    for (const std::string& addition : folder.additions()) {
      write_message("new in the plan: " + addition);
    }
  }  // releases the folder's lock, which the jobs need
  const Work work = plan_work(options, plan, path, jobs);
  if (work.chunks.empty()) {
    write_message("all cells are done. To make tables and verdict:\n" +
                  quote_own_command(session, {"merge", path.string()}));
    return exit_code::kDone;
  }
  const std::string script = make_cell_script(plan, work.chunks, make_script_request(path, jobs));
  if (options.name == "slurm") {
    return submit(plan, {path, jobs, options.sbatch}, work, script, session);
  }
  write_stdout(script);
  return exit_code::kDone;
}

}  // namespace armwright
