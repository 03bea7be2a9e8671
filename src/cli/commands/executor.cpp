#include "cli/commands/executor.hpp"

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
#include "study/compare/study_folder.hpp"
#include "study/executor/mpi_transport.hpp"
#include "study/matrix/chunks.hpp"
#include "study/matrix/slurm.hpp"

namespace armwright {
namespace {

constexpr const char* kDefaultChunk = "60s";

struct Work {
  std::size_t cells = 0;  // of the plan
  std::size_t left = 0;
  std::vector<Chunk> chunks;
};

Work plan_work(const ExecutorOptions& options, const StudyPlan& plan, const HandOver& request) {
  const double least_s =
      parse_duration_s("--chunk", options.chunk.empty() ? kDefaultChunk : options.chunk);
  const std::vector<Cell> cells = list_cells(plan);
  std::vector<Cell> left;
  for (const Cell& cell : cells) {
    if (!is_study_folder(request.folder) || !load_cell(plan, cell, request.folder)) {
      left.push_back(cell);
    }
  }
  std::vector<double> durations_s = measure_cell_durations_s(plan);
  for (double& duration_s : durations_s) {
    duration_s /= request.jobs;
  }
  return {cells.size(), left.size(), plan_chunks(left, durations_s, least_s)};
}

SlurmRequest make_slurm_request(const ExecutorOptions& options, const HandOver& request) {
  return {request.folder, request.jobs, options.sbatch};
}

// "5 to 8", or "5"
std::string describe_range(const std::string& least, const std::string& most) {
  return least == most ? least : least + " to " + most;
}

std::string describe_work(const ExecutorOptions& options, const StudyPlan& plan,
                          const HandOver& request, const Work& work) {
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
      "time     about {} a chunk, {} in all (measured here on a few simulations;\n"
      "         optimizers that think long take longer)\n",
      describe_range(format_duration(shortest->expected_s), format_duration(longest->expected_s)),
      format_duration(total_s));
  text += fmt::format(
      "memory   about {:.0f} MiB a task at most, besides what optimizers remember and plugins "
      "take\n",
      estimate_cell_memory_mib(plan));
  if (options.name == "slurm") {
    const auto words = make_sbatch_words(plan, work.chunks, make_slurm_request(options, request),
                                         choose_submission_folder(request.folder));
    text += "submit   " + sanitize(quote_command(words)) + "\n";
  }
  return text;
}

CellScriptRequest make_script_request(const HandOver& request) {
  CellScriptRequest script;
  script.study = std::filesystem::absolute(request.folder).lexically_normal();
  script.program = std::filesystem::read_symlink("/proc/self/exe");
  script.folder = std::filesystem::current_path();
  if (const char* configs = std::getenv("ARMWRIGHT_CONFIGS")) {
    script.configs = configs;
  }
  script.jobs = request.jobs;
  return script;
}

int submit(const ExecutorOptions& options, const StudyPlan& plan, const HandOver& request,
           const Work& work, const std::string& script, const Session& session) {
  const Submission submission =
      submit_to_slurm(plan, work.chunks, make_slurm_request(options, request), script);
  write_stdout(
      fmt::format("job {0}: {1} of cells\n"
                  "  squeue -j {0}\n"
                  "  {2}\n"
                  "When all has ended:\n"
                  "  {3}\n",
                  submission.job, format_count(work.chunks.size(), "chunk"),
                  quote_own_command(session, {"status", request.folder.string()}),
                  quote_own_command(session, {"merge", request.folder.string()})));
  return exit_code::kDone;
}

}  // namespace

void ExecutorOptions::add_to(CLI::App& command) {
  command
      .add_option("--executor", name,
                  "Where the work is done: local, by processes of this machine; mpi, by the ranks\n"
                  "of an mpirun; slurm, cells as a job array; script, cells by whatever runs the\n"
                  "bash script that is printed (default: mpi under mpirun, else local)")
      ->type_name("NAME");
  command
      .add_option(
          "--chunk", chunk,
          fmt::format("For slurm and script: cells in a row of at least this expected time\n"
                      "(default: {})",
                      kDefaultChunk))
      ->type_name("DURATION");
  command
      .add_option("--sbatch", sbatch,
                  "For slurm: a further word of sbatch's, as in --sbatch=--partition=short;\n"
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
                fmt::format("mpirun has started several ranks, and --executor is {}; start it "
                            "without mpirun, or leave the executor out",
                            name));
  }
  if (name == "mpi" && !has_ranks) {
    throw Error(ErrorKind::usage,
                "--executor mpi needs the ranks of an mpirun: 'mpirun --enable-recovery -n 4 "
                "armwright compare ...'; see docs/clusters.md");
  }
  const auto refuse_flag = [&](const char* flag, const char* executors) {
    throw Error(ErrorKind::usage,
                fmt::format("{} is for --executor {}, and the executor is {}", flag, executors,
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

int hand_over(const ExecutorOptions& options, const StudyPlan& plan, const HandOver& request,
              Session& session) {
  if (request.dry_run) {
    write_stdout(describe_work(options, plan, request, plan_work(options, plan, request)));
    return exit_code::kDone;
  }
  {
    const StudyFolder folder(request.folder, plan);
    for (const std::string& addition : folder.additions()) {
      write_message("new in the plan: " + addition);
    }
  }  // the jobs must find it free
  const Work work = plan_work(options, plan, request);
  if (work.chunks.empty()) {
    write_message("all cells are done. Tables and verdict:\n" +
                  quote_own_command(session, {"merge", request.folder.string()}));
    return exit_code::kDone;
  }
  const std::string script = make_cell_script(plan, work.chunks, make_script_request(request));
  if (options.name == "slurm") {
    return submit(options, plan, request, work, script, session);
  }
  write_stdout(script);
  return exit_code::kDone;
}

}  // namespace armwright
