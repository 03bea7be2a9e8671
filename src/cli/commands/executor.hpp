// --executor of armwright compare: where the cells run. All others than this machine's own
// processes call the same command, 'armwright cell'.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/terminal/session.hpp"
#include "study/compare/study_plan.hpp"

namespace armwright {

struct ExecutorOptions {
  std::string name;  // empty: mpi where mpirun has started the program, local elsewhere
  std::string chunk;
  std::vector<std::string> sbatch;

  void add_to(CLI::App& command);
  // Whether the cells are left to others: a script or a batch system. Error{usage} for a name that
  // does not exist, and for flags that only others have.
  bool is_elsewhere() const;
};

struct HandOver {
  std::filesystem::path folder;  // the study's
  unsigned jobs = 1;             // threads a cell
  bool dry_run = false;
};
// Creates the study's folder and leaves its unfinished cells to the executor; with `dry_run` only
// says what that would be. The exit code.
int hand_over(const ExecutorOptions& options, const StudyPlan& plan, const HandOver& request,
              Session& session);

}  // namespace armwright
