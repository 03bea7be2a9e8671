// The flags of `armwright compare` that choose where the cells of a study run. A batch system and a
// script call 'armwright cell' for each chunk of cells.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/terminal/session.hpp"
#include "study/compare/study_plan.hpp"

namespace CLI {
class App;
}

namespace armwright {

// The flags --executor, --chunk and --sbatch.
struct ExecutorOptions {
  std::string name;  // empty: mpi if mpirun has started the program, otherwise local
  std::string chunk;
  std::vector<std::string> sbatch;

  void add_to(CLI::App& command);
  // Returns whether a script or a batch system runs the cells. Throws Error{usage} for an unknown
  // executor, for flags that belong to another executor, and if the executor does not fit to
  // mpirun.
  bool is_elsewhere() const;
};

// Creates the study's folder and gives its unfinished cells to the executor: submits them to slurm,
// or prints the script. Each cell gets `jobs` threads. With `dry_run`, it only prints the chunks
// and the command that would submit them. Returns the exit code. Throws Error{usage} if the folder
// holds another study, Error{busy} and Error{io}.
int hand_over_cells(const ExecutorOptions& options, const StudyPlan& plan,
                    const std::filesystem::path& folder, unsigned jobs, bool dry_run,
                    Session& session);

}  // namespace armwright
