#include "study/analysis/final_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/bits.hpp"
#include "base/error.hpp"
#include "base/file.hpp"
#include "base/folder_checksums.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "study/compare/study_plan.hpp"
#include "study/executor/case_executor.hpp"
#include "study/run/json_values.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr std::size_t kCheckLimit_bytes = std::size_t{1} << 20;

// Returns the name of a check's file in the study's folder.
std::string make_check_name(const StudyProblem& problem, const std::string& optimizer) {
  return fmt::format("final/{}/{}.json", escape_name(problem.label), escape_name(optimizer));
}

std::optional<FinalCheck> load_check(const FolderChecksums& checksums,
                                     const std::filesystem::path& study, const std::string& name,
                                     const StudyPlan& plan, const CellOutcome& cell) {
  const auto file = study / name;
  if (!path_exists(file)) {
    return std::nullopt;
  }
  const std::string text = checksums.read(name, kCheckLimit_bytes);
  check_json_depth(text, file.string());
  try {
    const json j = json::parse(text);
    if (j.at("engine") != plan.final_engine ||
        !same_bits(j.at("x").get<std::vector<double>>(), cell.x)) {
      return std::nullopt;  // another design or engine, from an earlier plan
    }
    return FinalCheck{cell.replicate, plan.final_engine, value_from_json(j.at("value")),
                      summary_from_json(j.at("test"))};
  } catch (const json::exception& error) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: is not what armwright wrote ({}); remove it, and the same command "
                            "makes it again",
                            file.string(), sanitize(error.what())));
  }
}

// Its checksum is written with those of the study's tables (cover_study()).
void save_check(const std::filesystem::path& study, const std::string& name,
                const FinalCheck& check, const CellOutcome& cell) {
  const json j = {{"engine", check.engine},
                  {"replicate", check.replicate},
                  {"x", cell.x},
                  {"value", value_to_json(check.value)},
                  {"test", summary_to_json(check.errors)}};
  FolderChecksums(study).drop({&name, 1});
  const Folder folder = Folder::make((study / name).parent_path(), study);
  write_file_atomically(folder, std::filesystem::path(name).filename().string(), j.dump(1) + "\n");
}

// Loads the problem with the settings of the optimizer, but with the final engine.
LoadedProblem load_on_engine(const StudyProblem& problem, const StudyOptimizer& optimizer,
                             const std::string& engine) {
  constexpr std::string_view kReplaced[] = {"physics.engine", "physics.judging_engine",
                                            "physics.precision", "physics.simd"};
  std::vector<std::string> settings;
  for (const std::string& setting : problem.settings) {
    if (std::ranges::find(kReplaced, setting.substr(0, setting.find('='))) == std::end(kReplaced)) {
      settings.push_back(setting);
    }
  }
  settings.insert(settings.end(), optimizer.settings.begin(), optimizer.settings.end());
  settings.push_back("physics.engine=" + engine);
  settings.push_back("physics.judging_engine=" + engine);
  return load_problem(problem.name, settings);
}

// Returns the check with the value that the study compares. The file holds the objective.
FinalCheck as_compared(const StudyPlan& plan, FinalCheck check) {
  if (plan.value == StudyValue::failures && check.errors.cases > 0) {
    check.value =
        static_cast<double>(check.errors.failures) / static_cast<double>(check.errors.cases);
  }
  return check;
}

// Adds the recorded checks. For each of the others, calls `on_missing` with the cell, its outcome,
// the file's name, and the place for the check.
void visit_checks(const StudyPlan& plan, const std::filesystem::path& study, StudyResult& result,
                  const auto& on_missing) {
  const FolderChecksums checksums(study);
  for (std::size_t p = 0; p < plan.problems.size() && !plan.final_engine.empty(); ++p) {
    const StudyProblem& problem = plan.problems[p];
    for (std::size_t o = 0; o < plan.optimizers.size() && problem.loaded.tracking(); ++o) {
      const std::string& optimizer = plan.optimizers[o].label;
      const CellOutcome* best = find_best_cell(result.cells, problem.label, optimizer);
      if (best == nullptr) {
        continue;
      }
      const std::string file = make_check_name(problem, optimizer);
      auto& check = result.problems[p].optimizers[o].final_check;
      check = load_check(checksums, study, file, plan, *best);
      if (check) {
        check = as_compared(plan, *check);
      } else {
        on_missing(Cell{p, o, best->replicate}, *best, file, check);
      }
    }
  }
}

}  // namespace

const CellOutcome* find_best_cell(std::span<const CellOutcome> cells, const std::string& problem,
                                  const std::string& optimizer) {
  const CellOutcome* best = nullptr;
  for (const CellOutcome& cell : cells) {
    if (cell.problem == problem && cell.optimizer == optimizer && !cell.x.empty() &&
        (best == nullptr || cell.validation_value < best->validation_value)) {
      best = &cell;
    }
  }
  return best;
}

void load_final_checks(const StudyPlan& plan, const std::filesystem::path& study,
                       StudyResult& result) {
  visit_checks(plan, study, result, [](const Cell&, const CellOutcome&, const auto&, auto&) {});
}

bool add_final_checks(const StudyPlan& plan, const std::filesystem::path& study, unsigned jobs,
                      StopSignal& stop, RunObserver& observer, StudyResult& result) {
  struct Missing {
    Cell cell;
    const CellOutcome* best;
    std::string file;
    std::optional<FinalCheck>* check;
  };
  std::vector<Missing> missing;
  visit_checks(plan, study, result,
               [&](const Cell& cell, const CellOutcome& best, const auto& file, auto& check) {
                 missing.push_back({cell, &best, file, &check});
               });
  Progress progress;
  progress.phase = CaseRole::test;
  for (const Missing& one : missing) {
    progress.total +=
        static_cast<std::uint64_t>(plan.problems[one.cell.problem].loaded.sets.test_cases);
  }
  ThreadExecutor executor(jobs);
  for (const Missing& one : missing) {
    observer.on_progress(progress);
    const LoadedProblem judged = load_on_engine(
        plan.problems[one.cell.problem], plan.optimizers[one.cell.optimizer], plan.final_engine);
    CaseBlock block{CaseRole::test, judged.sets.test,
                    std::vector<std::uint64_t>(static_cast<std::size_t>(judged.sets.test_cases))};
    std::iota(block.numbers.begin(), block.numbers.end(), std::uint64_t{0});
    Evaluation evaluation;
    const std::span<const double> x = one.best->x;
    executor.evaluate(*judged.problem, {&x, 1}, block, {}, stop,
                      [&](std::size_t, Evaluation done) { evaluation = std::move(done); });
    if (stop.requested()) {
      return false;
    }
    progress.done += block.numbers.size();
    const FinalCheck check{
        one.best->replicate, plan.final_engine,
        calc_test_value(judged.problem->description(), evaluation, plan.constraint_tolerance),
        summarize(evaluation.case_errors, kFailureError_m)};
    save_check(study, one.file, check, *one.best);
    *one.check = as_compared(plan, check);
  }
  return true;
}

}  // namespace armwright
