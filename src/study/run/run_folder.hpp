// A run's folder: manifest.json (what was asked for, and by what it was made), journal (the truth),
// lock, optimizer.log (what a plugin printed), and what was derived from the journal: result.json,
// winner.toml, convergence.csv, results.sqlite, winner-trajectory.csv. Nothing is ever overwritten
// by another run, and two processes never write one folder.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "study/run/run_lock.hpp"
#include "study/run/run_plan.hpp"

namespace armwright {

class RunFolder {
 public:
  // Creates the folder or opens it to resume: takes the lock, then writes the manifest or compares
  // it. Error{busy}; Error{io}; Error{usage} with every difference if the recorded configuration is
  // not `plan`.
  RunFolder(const std::filesystem::path& path, const RunPlan& plan,
            std::span<const std::string> command_line);

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path journal() const { return path_ / "journal"; }
  // What an optimizer's own processes print.
  std::filesystem::path log() const { return path_ / "optimizer.log"; }
  std::filesystem::path result() const { return path_ / "result.json"; }
  // Why a resumed run may not replay: recorded and present version, compiler or CPU differ. Empty
  // if they do not.
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  std::filesystem::path path_;
  RunLock lock_;
  std::vector<std::string> warnings_;
};

// results/NAME, or with `fresh` the first free of NAME, NAME-002, NAME-003, ...
std::filesystem::path choose_run_folder(const std::filesystem::path& parent,
                                        const std::string& name, bool fresh);

}  // namespace armwright
