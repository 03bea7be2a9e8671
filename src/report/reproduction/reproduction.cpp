#include "report/reproduction/reproduction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "base/error.hpp"
#include "base/folder_checksums.hpp"

namespace armwright {
namespace {

// Passes on the messages of a run, after the run's name.
class RunMessages final : public RunObserver {
 public:
  RunMessages(std::string name, RunObserver& observer)
      : name_(std::move(name)), observer_(observer) {}
  // All runs share one progress bar, but their objectives have different units. So none is shown.
  void on_progress(const Progress& progress) override {
    Progress shown = progress;
    shown.best_objective = std::numeric_limits<double>::quiet_NaN();
    observer_.on_progress(shown);
  }
  void on_message(const std::string& message) override {
    observer_.on_message(fmt::format("{}: {}", name_, message));
  }

 private:
  std::string name_;
  RunObserver& observer_;
};

class Executor {
 public:
  Executor(ReproductionPlan& plan, ReproductionFolder* folder, const std::string& program,
           unsigned jobs, StopSignal& stop, RunObserver& observer)
      : plan_(plan),
        folder_(folder),
        program_(program),
        jobs_(jobs),
        stop_(stop),
        observer_(observer) {
    for (const PlannedPart& part : plan_.parts) {
      progress_.total += is_computed(part) ? 0 : part.cases;
    }
  }

  std::optional<std::vector<PartResult>> execute() {
    std::vector<PartResult> results;
    for (PlannedPart& part : plan_.parts) {
      if (is_computed(part)) {
        results.push_back(*folder_->find(part.part.label));
      } else {
        auto result = make_result(part);
        if (!result) {
          return std::nullopt;
        }
        if (folder_ != nullptr) {
          folder_->add(*result);
        }
        results.push_back(std::move(*result));
      }
      part.problem = {};  // frees the targets, which the next part cannot use
    }
    return results;
  }

 private:
  bool is_computed(const PlannedPart& part) const {
    return folder_ != nullptr && folder_->find(part.part.label) != nullptr;
  }

  std::optional<PartResult> make_result(const PlannedPart& part) {
    const TrackingProblem& problem = *part.problem.tracking();
    const auto design = find_design(part);
    if (!design) {
      return std::nullopt;
    }
    const ChosenCases cases{problem.get_set(part.problem.sets.test), part.cases};
    const auto evaluation =
        evaluate_with_progress(problem, *design, cases, jobs_, stop_, observer_, progress_);
    if (!evaluation) {
      return std::nullopt;
    }
    progress_.done += part.cases;
    const auto points = static_cast<std::size_t>(problem.config().workspace.points);
    return PartResult{.part = part.part,
                      .inputs_sha256 = calc_inputs_hash(plan_, part),
                      .engine = problem.config().engines.judging_name,
                      .test_set = cases.set.name(),
                      .case_errors = get_case_errors(evaluation->results),
                      .failures = list_failures(evaluation->results),
                      .points = calc_point_statistics(evaluation->results, points),
                      .total_torque_n_m = calc_total_effort(*design)};
  }

  // Returns the part's design. If a run has to find it, makes the run first; returns nothing if
  // that was stopped.
  std::optional<ArmDesign> find_design(const PlannedPart& part) {
    if (part.part.run.empty()) {
      return part.design;
    }
    const auto folder = folder_->get_run_folder(part.part.run);
    const auto run = std::ranges::find(plan_.runs, part.part.run,
                                       [](const RunPlan& one) { return one.problem.name; });
    if (!execute(*run, folder)) {
      return std::nullopt;
    }
    FolderChecksums(folder).check("winner.toml");
    return load_design((folder / "winner.toml").string()).design;
  }

  // Makes or continues a run. Returns false if it was stopped.
  bool execute(const RunPlan& run, const std::filesystem::path& folder) {
    if (path_exists(folder / "result.json")) {
      return true;
    }
    RunRequest request;
    request.plan = run;
    request.folder = folder;
    request.root = folder_->path();
    request.jobs = jobs_;
    request.command_line = make_run_command(program_, run, folder);
    RunMessages messages(run.problem.name, observer_);
    const auto result = execute_run(request, stop_, messages);
    if (result && !result->winner) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("{}: this run has no winner: none of its designs has a result",
                              folder.string()));
    }
    return result.has_value();
  }

  ReproductionPlan& plan_;
  ReproductionFolder* const folder_;  // not owned; null: results are not kept
  const std::string& program_;
  const unsigned jobs_;
  StopSignal& stop_;
  RunObserver& observer_;
  Progress progress_;
};

}  // namespace

std::optional<std::vector<PartResult>> execute_reproduction(ReproductionPlan& plan,
                                                            ReproductionFolder* folder,
                                                            const std::string& program,
                                                            unsigned jobs, StopSignal& stop,
                                                            RunObserver& observer) {
  if (folder == nullptr && !plan.runs.empty()) {
    throw Error(ErrorKind::usage, "what is optimized anew needs a folder to be kept in");
  }
  return Executor(plan, folder, program, jobs, stop, observer).execute();
}

std::vector<std::string> make_run_command(const std::string& program, const RunPlan& run,
                                          const std::filesystem::path& folder) {
  return {program,
          "optimize",
          run.problem.name,
          "--optimizer",
          run.optimizer.name,
          "--seed",
          std::to_string(run.seed),
          "--engine",
          run.problem.tracking()->config().engines.training_name,
          "--judging-engine",
          run.problem.tracking()->config().engines.judging_name,
          "--out",
          folder.string()};
}

}  // namespace armwright
