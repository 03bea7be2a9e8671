// armwright rerun: repeats one run of a study and compares all bits of the results.

#include "study/compare/rerun.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/text.hpp"
#include "cli/commands/commands.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/progress_bar.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/terminal.hpp"
#include "study/compare/cell.hpp"
#include "study/compare/cell_comparison.hpp"
#include "study/compare/study_folder.hpp"

namespace armwright {
namespace {

constexpr const char* kRerunExamples = R"(Examples:
  armwright rerun results/q1 q1-complex/ga/r03
  armwright rerun results/q1 q1-complex/ga/r03 --jobs 1 --json

The command repeats the recorded run with the same training cases, start, seed and options. Then it compares all
evaluations, the judgements, the result and the winner with those of the study, bit for bit. The exit code is 0 if they
are identical and 3 if they differ. The study is not changed. A label with characters other than letters, digits, '_',
'-' and '.' can be given as it is or as its folder is named.)";

struct RerunOptions {
  std::string study;
  std::string cell;
  std::string jobs;
  std::string time_limit;
  std::string out;
  bool trust = false;
  bool json = false;
  bool quiet = false;
};

std::string describe_cell(const StudyPlan& plan, const Cell& cell) {
  return fmt::format("{} on {}, replicate {}", plan.optimizers[cell.optimizer].label,
                     plan.problems[cell.problem].label, cell.replicate);
}

void check_recorded(const RerunOptions& options, const StudyPlan& plan, const Cell& cell,
                    const std::string& program) {
  if (load_cell(plan, cell, options.study)) {
    return;
  }
  const std::filesystem::path study = options.study;
  const std::vector<std::string> words = {program, "compare", (study / "study.toml").string(),
                                          "--out", options.study};
  throw Error(
      ErrorKind::usage,
      fmt::format("{}: {} has not ended in this study, so there is nothing to compare with. "
                  "To resume the study:\n{}",
                  sanitize(options.study), describe_cell(plan, cell),
                  sanitize(quote_command(words))));
}

std::filesystem::path choose_folder(const RerunOptions& options, const StudyPlan& plan,
                                    const Cell& cell) {
  if (options.out.empty()) {
    return choose_rerun_folder(options.study, plan, cell);
  }
  if (has_ended(options.out)) {
    throw Error(
        ErrorKind::usage,
        fmt::format("--out is '{}', which holds a run that has ended; choose another folder",
                    sanitize(options.out)));
  }
  return options.out;
}

std::string to_json(const std::string& cell, const std::filesystem::path& recorded,
                    const std::filesystem::path& folder, const CellComparison& comparison,
                    const std::vector<std::string>& causes) {
  nlohmann::json difference = nullptr;
  if (const auto& found = comparison.difference) {
    difference = {{"where", found->where},
                  {"field", found->field},
                  {"recorded", found->recorded},
                  {"now", found->now}};
  }
  const nlohmann::json j = {{"cell", cell},
                            {"recorded", recorded.string()},
                            {"folder", folder.string()},
                            {"identical", !comparison.difference},
                            {"evaluations", comparison.evaluations},
                            {"judgements", comparison.judgements},
                            {"files", comparison.files},
                            {"difference", difference},
                            {"likely_causes", causes}};
  return j.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

// "120 evaluations, 9 judgements, result.json and cell.json"
std::string describe_same(const CellComparison& comparison) {
  std::vector<std::string> parts = {format_count(comparison.evaluations, "evaluation"),
                                    format_count(comparison.judgements, "judgement")};
  parts.insert(parts.end(), comparison.files.begin(), comparison.files.end());
  const std::string last = parts.back();
  parts.pop_back();
  return join(parts, ", ") + " and " + last;
}

std::string format_text(const std::filesystem::path& recorded, const std::filesystem::path& folder,
                        const CellComparison& comparison, const std::vector<std::string>& causes) {
  const std::string folders =
      fmt::format("study  {}\nrerun  {}\n", sanitize(recorded.string()), sanitize(folder.string()));
  if (!comparison.difference) {
    return fmt::format("identical: {} are the same to the last bit\n", describe_same(comparison)) +
           folders;
  }
  const CellDifference& found = *comparison.difference;
  std::string text = fmt::format("different: {}, {}: recorded {}, now {}\n", found.where,
                                 found.field, found.recorded, found.now);
  text += fmt::format("Before that, {} are the same.\n", describe_same(comparison)) + folders;
  for (const std::string& cause : causes) {
    text += cause + "\n";
  }
  return text;
}

int run_rerun(const RerunOptions& options, Session& session) {
  const unsigned jobs = parse_jobs(options.jobs);
  apply_time_limit(options.time_limit, session.stop);
  const StudyPlan plan = load_study_plan(options.study, make_asker(options.trust));
  const Cell cell = find_cell(plan, options.cell);
  check_recorded(options, plan, cell, session.command_line.front());
  const auto folder = choose_folder(options, plan, cell);
  if (!options.quiet) {
    write_message(describe_cell(plan, cell));
    write_message(fmt::format("folder {} ({})", sanitize(folder.string()),
                              path_exists(folder) ? "found" : "new"));
  }
  catch_signals(session.stop);
  ProgressBar bar(
      options.quiet,
      get_scalar_quantity(plan.problems[cell.problem].loaded.problem->description().objectives));
  const CellRequest where{
      .folder = folder,
      .root = options.out.empty() ? std::filesystem::path(options.study) : folder,
      .jobs = jobs,
      .command_line = session.command_line};
  const auto outcome = run_cell(plan, cell, where, session.stop, bar);
  bar.clear();
  if (!outcome) {
    return end_stopped(session, session.command_line);
  }
  const auto recorded = std::filesystem::path(options.study) / make_cell_path(plan, cell);
  const CellComparison comparison = compare_cells(recorded, folder);
  std::vector<std::string> causes;
  if (comparison.difference) {
    causes = list_likely_causes(recorded, folder);
  }
  write_stdout(options.json ? to_json(options.cell, recorded, folder, comparison, causes)
                            : format_text(recorded, folder, comparison, causes));
  return comparison.difference ? exit_code::kFailed : exit_code::kDone;
}

}  // namespace

void add_rerun(CLI::App& app, Session& session) {
  auto options = std::make_shared<RerunOptions>();
  CLI::App* command =
      add_command(app, session, "rerun",
                  "Repeat one cell of a study and compare all bits of the results", kRerunExamples);
  command->add_option("STUDY", options->study, "The folder of a study")->required();
  command->add_option("CELL", options->cell, "The run: PROBLEM/OPTIMIZER/rNN")->required();
  add_jobs_flag(*command, options->jobs);
  add_time_limit_flag(*command, options->time_limit);
  add_trust_flag(*command, options->trust);
  command
      ->add_option(
          "--out", options->out,
          "The new run's folder (default: STUDY/reruns/PROBLEM/OPTIMIZER/rNN, or the first\n"
          "of rNN-002, ... that does not exist); nothing is overwritten")
      ->type_name("FOLDER")
      ->group("Output");
  command->add_flag("--json", options->json, "Print the comparison as JSON")->group("Output");
  command->add_flag("--quiet,-q", options->quiet, "Show no progress")->group("Output");
  command->callback([options, &session] {
    session.action = [options, &session] { return run_rerun(*options, session); };
  });
}

}  // namespace armwright
