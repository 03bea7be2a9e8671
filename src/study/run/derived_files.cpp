#include "study/run/derived_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <vector>

#include "base/bits.hpp"
#include "base/file.hpp"
#include "base/folder_checksums.hpp"
#include "base/text.hpp"
#include "problems/config/design_file.hpp"
#include "problems/config/values_file.hpp"
#include "problems/identification/identification_problem.hpp"
#include "problems/user/user_problem.hpp"
#include "study/identification/fit_report.hpp"
#include "study/run/run.hpp"
#include "study/run/winner_record.hpp"

namespace armwright {
namespace {

// Writes one row per generation or, for optimizers without generations, one row per improvement.
// Only feasible evaluations count.
void write_convergence_csv(const Folder& folder, const ProblemDescription& problem,
                           const RecordedEvaluations& training) {
  struct Row {
    std::uint64_t evaluations = 0, cases = 0, generation = 0, counted = 0;
    double best = 0, sum = 0;
  };
  AtomicFile file(folder, "convergence.csv");
  file.write("evaluations,cases,generation,best_objective,mean_objective\n");
  std::optional<Row> row;
  const auto write_row = [&] {
    if (row) {
      file.write(fmt::format("{},{},{},{},{}\n", row->evaluations, row->cases, row->generation,
                             format_exact(row->best),
                             format_exact(row->sum / static_cast<double>(row->counted))));
    }
  };
  std::uint64_t cases = 0;
  for (const EvaluationRecord& record : training) {
    cases += record.calc_charge();
    if (!is_feasible(record.evaluation)) {
      continue;
    }
    const double objective = calc_scalar(problem, record.evaluation.objectives);
    const bool same_generation =
        record.generation > 0 && row && row->generation == record.generation;
    if (!same_generation) {
      if (record.generation == 0 && row && objective >= row->best) {
        continue;
      }
      write_row();
      row = Row{.generation = record.generation, .best = objective};
    }
    row->evaluations = record.index + 1;
    row->cases = cases;
    row->best = std::min(row->best, objective);
    row->sum += objective;
    ++row->counted;
  }
  write_row();
  file.commit();
}

// Returns the judged designs of a problem with several objectives, sorted by the first objective on
// the validation set. `on_front` is 0 if another design has no more failed cases and is at least as
// good in every objective, else 1.
std::string make_front_csv(const RunResult& result) {
  std::vector<const JudgedCandidate*> rows;
  for (const JudgedCandidate& judged : result.judged) {
    if (!judged.validation.objectives.empty()) {
      rows.push_back(&judged);
    }
  }
  std::ranges::stable_sort(rows, {}, [](const auto* row) { return row->validation.objectives[0]; });
  const auto covers = [](const Evaluation& a, const Evaluation& b) {
    return a.failed_cases <= b.failed_cases && a.objectives != b.objectives &&
           std::ranges::equal(a.objectives, b.objectives, std::less_equal{});
  };
  std::string csv = "evaluation,on_front,failed_cases";
  for (const Quantity& objective : result.objectives) {
    csv += "," + quote_csv(fmt::format("{} [{}]", objective.name, objective.unit));
  }
  for (const std::string& name : result.variable_names) {
    csv += "," + quote_csv(name);
  }
  csv += "\n";
  for (const JudgedCandidate* row : rows) {
    const bool covered = std::ranges::any_of(
        rows, [&](const auto* other) { return covers(other->validation, row->validation); });
    csv += fmt::format("{},{},{}", row->candidate.evaluation, covered ? 0 : 1,
                       row->validation.failed_cases);
    for (const double objective : row->validation.objectives) {
      csv += "," + format_exact(objective);
    }
    for (std::size_t i = 0; i < row->candidate.x.size(); ++i) {
      const double value = row->candidate.x[i];
      const DecisionVariable* const discrete = find_discrete(result, i);
      const bool is_word = discrete != nullptr && discrete->type == VariableType::category;
      csv += "," + (is_word ? quote_csv(format_value(*discrete, value)) : format_exact(value));
    }
    csv += "\n";
  }
  return csv;
}

std::string make_winner_toml(const RunPlan& plan, const RunResult& result,
                             const std::vector<double>& x) {
  const TrackingProblem& tracking = *plan.problem.tracking();
  DesignFile file = make_design_file(tracking.config().robot, tracking.make_design(x));
  file.name = make_run_name(plan);
  file.title = fmt::format("Winner of {} on {}", plan.optimizer.name, plan.problem.name);
  file.source = fmt::format("armwright, {} with seed {}; the manifest.json of its run says all",
                            plan.optimizer.name, plan.seed);
  std::string toml = to_toml(file);
  if (result.test_summary.mean) {
    toml = fmt::format("# Mean error on {} ({} cases): {} m, {} failed.\n", result.test_set,
                       result.test_summary.cases, format_exact(*result.test_summary.mean),
                       result.test_summary.failures) +
           toml;
  }
  return toml;
}

// Returns the winner as values of its variables, with its objectives on the test set, in the user's
// signs for a problem of the user.
std::string make_values_toml(const RunPlan& plan, const RunResult& result,
                             const std::vector<double>& x) {
  const ProblemDescription& problem = plan.problem.problem->description();
  ValuesFile file;
  file.title = fmt::format("Winner of {} on {}", plan.optimizer.name, plan.problem.name);
  file.source = fmt::format("armwright, {} with seed {}; the manifest.json of its run says all",
                            plan.optimizer.name, plan.seed);
  file.variables = list_values(problem.variables, x);
  for (std::size_t i = 0; i < result.test.objectives.size(); ++i) {
    const UserDescription* own = find_user_description(*plan.problem.problem);
    const bool is_maximised = own != nullptr && own->objectives[i].is_maximised;
    file.objectives.push_back(
        {own != nullptr ? own->objectives[i].quantity : problem.objectives[i],
         is_maximised ? -result.test.objectives[i] : result.test.objectives[i]});
  }
  return to_toml(file);
}

// Returns the validation and test records of the result's candidates, numbered as in the result. A
// run that failed and was started again may have judged designs that are no candidates any more.
std::vector<EvaluationRecord> select_judgements(const JournalContent& journal,
                                                const RunResult& result) {
  std::vector<EvaluationRecord> selected;
  for (EvaluationRecord record : journal.judgements) {
    const auto judged = std::ranges::find_if(result.judged, [&](const JudgedCandidate& one) {
      return same_bits(one.candidate.x, record.x);
    });
    const auto place = static_cast<std::size_t>(judged - result.judged.begin());
    const bool is_test = record.cases.role == CaseRole::test;
    if (judged == result.judged.end() || (is_test && result.winner != place)) {
      continue;
    }
    record.index = is_test ? 0 : place;
    const bool is_doubled = std::ranges::any_of(selected, [&](const EvaluationRecord& one) {
      return one.cases.role == record.cases.role && one.index == record.index;
    });
    if (!is_doubled) {  // the first record counts, as in a resumed run
      selected.push_back(std::move(record));
    }
  }
  // The journal has them in the order of completion; the tables must not depend on threads.
  std::ranges::stable_sort(selected, {}, [](const EvaluationRecord& record) {
    return std::pair(record.cases.role, record.index);
  });
  return selected;
}

}  // namespace

std::string make_trajectory_csv(const TrackingProblem& problem, const TrackingResult& result) {
  std::string csv = "time_s";
  for (const Joint& joint : problem.config().robot.joints) {
    for (const char* quantity : {"q_rad", "target_rad", "effort_n_m"}) {
      csv += "," + quote_csv(fmt::format("{}_{}", joint.name, quantity));
    }
  }
  csv += ",tip_x_m,tip_y_m,tip_z_m,target_x_m,target_y_m,target_z_m,error_m\n";
  for (const TrajectorySample& sample : result.trajectory) {
    csv += format_exact(sample.time_s);
    for (std::size_t i = 0; i < sample.q.size(); ++i) {
      csv += fmt::format(",{},{},{}", sample.q[i], sample.target_q[i], sample.effort[i]);
    }
    csv += fmt::format(",{},{},{},{},{},{},{}\n", sample.tip_m.x(), sample.tip_m.y(),
                       sample.tip_m.z(), sample.target_m.x(), sample.target_m.y(),
                       sample.target_m.z(), (sample.tip_m - sample.target_m).norm());
  }
  return csv;
}

bool are_derived_files_there(const RunFolder& folder, const RunPlan& plan, DerivedFiles derived) {
  const bool is_own = has_values(*plan.problem.problem);
  const auto is_there = [&](const char* name) { return path_exists(folder.path() / name); };
  if (!is_there("result.json")) {
    return false;
  }
  const FolderChecksums checksums(folder.path());
  if ((folder.has_checksums() || checksums.is_there()) && !checksums.covers("result.json")) {
    return false;  // a kill or the user has removed checksums
  }
  const RunResult result = load_result(folder.path());
  if (!result.failure.empty()) {
    return false;
  }
  if (derived == DerivedFiles::winner) {
    return !result.winner || !(result.tracking || is_own) || is_there("winner.toml");
  }
  if (!is_there("convergence.csv") || !is_there("results.sqlite")) {
    return false;
  }
  if (result.objectives.size() > 1 && !is_there("front.csv")) {
    return false;
  }
  if (result.winner && is_own && !are_record_files_there(folder, plan)) {
    return false;
  }
  if (result.winner && find_identification(*plan.problem.problem) != nullptr &&
      !(is_there(kPlantFile) && is_there(kIdentificationFile))) {
    return false;
  }
  return !result.winner || !result.tracking ||
         (is_there("winner.toml") && is_there("winner-trajectory.csv"));
}

void write_derived_files(const RunFolder& folder, const RunPlan& plan, const RunResult& result,
                         JournalContent journal, DerivedFiles derived,
                         const std::function<void()>& before_last) {
  const Folder& files = folder.folder();
  const bool all = derived == DerivedFiles::all;
  std::vector<std::string> changing = derived_file_names();
  changing.emplace_back("journal");
  const auto covered = FolderChecksums(files).lines();
  for (const auto& [name, hash] : covered) {
    if (name.starts_with(kWinnerFiles)) {
      changing.push_back(name);
    }
  }
  FolderChecksums(files).drop(changing);
  files.remove(kCheckFile);  // of the winner that the folder had
  if (all) {
    write_convergence_csv(files, plan.problem.problem->description(), journal.training);
    journal.judgements = select_judgements(journal, result);
    write_database(files, "results.sqlite", plan.problem.problem->description(), journal);
  }
  if (all && result.objectives.size() > 1) {
    write_file_atomically(files, "front.csv", make_front_csv(result));
  }
  if (result.winner && plan.problem.tracking()) {
    const TrackingProblem& tracking = *plan.problem.tracking();
    const auto& x = result.judged[*result.winner].candidate.x;
    write_file_atomically(files, "winner.toml", make_winner_toml(plan, result, x));
    if (all) {
      const TrackingResult motion =
          tracking.track(tracking.make_design(x), tracking.get_set(plan.problem.sets.test), 0,
                         {.error_series = false, .trajectory = true});
      write_file_atomically(files, "winner-trajectory.csv", make_trajectory_csv(tracking, motion));
    }
  }
  if (result.winner && has_values(*plan.problem.problem)) {
    const auto& x = result.judged[*result.winner].candidate.x;
    write_file_atomically(files, "winner.toml", make_values_toml(plan, result, x));
    if (all && has_record(plan)) {
      write_record_files(files, plan, x);
    }
  }
  if (const auto* identification = find_identification(*plan.problem.problem);
      result.winner && all && identification != nullptr) {
    const IdentificationFiles made = make_identification_files(
        *identification, result.judged[*result.winner].candidate.x, plan.problem.input_hashes,
        !(result.ended_by_budget() && plan.optimizer.capabilities.local));
    write_file_atomically(files, kPlantFile, made.plant);
    write_file_atomically(files, kIdentificationFile, made.identification);
  }
  before_last();
  write_file_atomically(files, "result.json", to_json(result));
  cover_run(files, result.failure.empty());
}

}  // namespace armwright
