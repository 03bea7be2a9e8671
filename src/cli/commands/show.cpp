// armwright show: prints the result of a run or a study from its folder.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/folder.hpp"
#include "base/folder_checksums.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "cli/commands/commands.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/progress_bar.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/terminal.hpp"
#include "cli/views/identification_view.hpp"
#include "cli/views/importance_view.hpp"
#include "cli/views/result_view.hpp"
#include "cli/views/study_view.hpp"
#include "study/analysis/final_check.hpp"
#include "study/analysis/importance.hpp"
#include "study/analysis/study_tables.hpp"
#include "study/journal/journal.hpp"
#include "study/run/json_values.hpp"
#include "study/run/run.hpp"
#include "study/run/run_folder.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr const char* kShowExamples = R"(Examples:
  armwright show results/irb4600-auto-seed1
  armwright show results/q1                        # a study: its tables and verdict
  armwright show results/irb4600-auto-seed1 --json | jq .winner.test_summary
  armwright show results/irb4600-auto-seed1 --importance   # which variables matter

If a run or a study is not complete, the command prints how far it is and how to resume it. It changes nothing.
'armwright status' shows more about the cells of a study that several processes or machines run.)";

struct ShowOptions {
  std::string folder;
  bool json = false;
  bool importance = false;
  std::string simulations;  // of a design for the importance
  std::string jobs;
};

struct UnfinishedRun {
  std::uint64_t evaluations = 0;
  std::uint64_t cases = 0;
  std::uint64_t judgements = 0;
  std::int64_t budget = 0;
  std::vector<std::string> command_line;
  bool is_asked = false;  // its evaluations are told (armwright ask)
};

UnfinishedRun read_unfinished(const std::filesystem::path& folder) {
  constexpr std::size_t kLimit_bytes = std::size_t{16} << 20;
  const auto file = folder / "manifest.json";
  UnfinishedRun run;
  try {
    const json manifest = json::parse(read_checked_json(file, kLimit_bytes));
    run.command_line = manifest.at("command_line").get<std::vector<std::string>>();
    const json& settings = manifest.at("configuration").at("run");
    run.is_asked = is_asked_run(settings);
    run.budget = whole_from_json<std::int64_t>(settings.at("budget"));
  } catch (const json::exception& error) {
    throw Error(ErrorKind::bad_data, fmt::format("{}: is not a manifest that armwright wrote ({})",
                                                 file.string(), describe_json_error(error.what())));
  }
  if (path_exists(folder / "journal")) {
    const JournalContent journal = read_journal(folder / "journal");
    run.evaluations = journal.training.size();
    run.judgements = journal.judgements.size();
    for (const EvaluationRecord& record : journal.training) {
      run.cases += record.calc_charge();
    }
  }
  return run;
}

int show_study(const ShowOptions& options, const Session& session) {
  const std::filesystem::path folder = options.folder;
  const StudyPlan plan = load_study_plan(folder);
  StudyResult result = analyze_study(plan, folder);
  load_final_checks(plan, folder, result);
  if (options.json) {
    write_stdout(to_json(plan, result));
  } else if (result.missing.empty()) {
    write_stdout(describe_study(plan, result, folder, session));
  } else {
    const std::vector<std::string> command = {session.command_line.front(), "compare",
                                              (folder / "study.toml").string(), "--out",
                                              folder.string()};
    write_stdout(
        fmt::format("{}: this study is not complete\n  {} of {} have ended\nTo "
                    "resume:\n  {}\n",
                    sanitize(folder.string()), result.cells.size() - result.missing.size(),
                    format_count(result.cells.size(), "cell"), sanitize(quote_command(command))));
  }
  return exit_code::kDone;
}

// Prints what identify has printed.
void show_identification(const std::filesystem::path& folder, const Style& style) {
  const auto file = folder / kIdentificationFile;
  try {
    write_stdout(describe_identification(
        json::parse(read_checked_json(file, kIdentificationLimit_bytes)), folder, style));
  } catch (const json::exception& error) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: is not an identification that armwright wrote ({})",
                            sanitize(file.string()), describe_json_error(error.what())));
  }
}

int show_importance(const ShowOptions& options, Session& session) {
  const std::filesystem::path folder = options.folder;
  const unsigned jobs = parse_jobs(options.jobs);
  const LoadedProblem loaded = load_problem_of_run(folder);
  Importance importance = calc_importance(folder, loaded.problem->description());
  if (!options.simulations.empty()) {
    const std::int64_t simulations =
        parse_count("--simulations", options.simulations, 1, 1'000'000'000);
    catch_signals(session.stop);
    ProgressBar bar(options.json, importance.objective);
    const bool has_ended = add_simulated_importance(folder, *loaded.problem, simulations, jobs,
                                                    session.stop, bar, importance);
    bar.clear();
    if (!has_ended) {
      write_message(describe_stop(session.stop.reason()));
      return get_stop_code(session.stop.reason());
    }
  }
  write_stdout(options.json
                   ? to_json(importance)
                   : describe_importance(importance, make_style(Stream::out, session.color)));
  return exit_code::kDone;
}

int run_show(const ShowOptions& options, Session& session) {
  if (!options.importance && !options.simulations.empty()) {
    throw Error(ErrorKind::usage,
                "--simulations is for --importance, which is not given: give both, or neither");
  }
  const std::filesystem::path folder = options.folder;
  if (is_study_folder(folder)) {
    if (options.importance) {
      throw Error(ErrorKind::usage,
                  sanitize(folder.string()) +
                      ": is a study; --importance analyses one run, for example that of a cell in "
                      "its folder 'cells'");
    }
    return show_study(options, session);
  }
  if (!path_exists(folder / "manifest.json")) {
    const bool is_there = path_exists(folder);
    throw Error(ErrorKind::usage,
                sanitize(folder.string()) +
                    (is_there ? ": is not the folder of a run (it has no manifest.json) or of a "
                                "study (it has no study.toml)"
                              : ": there is no such folder"));
  }
  if (options.importance) {
    return show_importance(options, session);
  }
  if (path_exists(folder / "result.json")) {
    const RunResult result = load_result(folder);
    if (options.json) {
      write_stdout(make_result_json(result, folder));
    } else if (path_exists(folder / kIdentificationFile)) {
      show_identification(folder, make_style(Stream::out, session.color));
    } else {
      const Style style = make_style(Stream::out, session.color);
      write_stdout(describe_result(result, folder, style) + "\n" + describe_judged(result, style));
    }
    return get_result_code(result);
  }
  const UnfinishedRun run = read_unfinished(folder);
  std::vector<std::vector<std::string>> commands = {run.command_line};
  if (run.is_asked) {
    commands = {{session.command_line.front(), "ask", options.folder},
                {session.command_line.front(), "tell", options.folder, "FILE"}};
  }
  std::vector<std::string> lines;
  for (const std::vector<std::string>& words : commands) {
    lines.push_back(sanitize(quote_command(words)));
  }
  if (options.json) {
    const json state = {
        {"finished", false},    {"evaluations", run.evaluations}, {"cases", run.cases},
        {"budget", run.budget}, {"judgements", run.judgements},   {"resume", lines.front()}};
    write_stdout(state.dump(1) + "\n");
  } else {
    write_stdout(
        fmt::format("{}: this run is not complete\n"
                    "  {} on {} of {} recorded, {}\n"
                    "To resume:\n  {}\n",
                    sanitize(folder.string()), format_count(run.evaluations, "evaluation"),
                    run.cases, format_count(static_cast<unsigned long long>(run.budget), "case"),
                    format_count(run.judgements, "judgement"), join(lines, "\n  ")));
  }
  return exit_code::kDone;
}

}  // namespace

void add_show(CLI::App& app, Session& session) {
  auto options = std::make_shared<ShowOptions>();
  CLI::App* command = add_command(
      app, session, "show", "Show the result of a run or a study, or how far it is", kShowExamples);
  command->add_option("FOLDER", options->folder, "The folder of a run or a study")->required();
  command->add_flag("--importance", options->importance,
                    "Show which variables matter, near the winner and over the run: Sobol indices "
                    "of a model of the recorded evaluations");
  command
      ->add_option("--simulations", options->simulations,
                   "Simulate up to N test cases of designs around the winner for --importance, "
                   "which need no model")
      ->type_name("N");
  add_jobs_flag(*command, options->jobs);
  command->add_flag("--json", options->json, "Print as JSON")->group("Output");
  command->callback([options, &session] {
    session.action = [options, &session] { return run_show(*options, session); };
  });
}

}  // namespace armwright
