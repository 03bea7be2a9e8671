// armwright reproduce: compares every published result of the shipped designs with ours.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/folder.hpp"
#include "base/text.hpp"
#include "cli/commands/commands.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/progress_bar.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/table.hpp"
#include "cli/terminal/terminal.hpp"
#include "cli/views/design_and_problem.hpp"
#include "report/reproduction/reproduction.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr const char* kReproduceExamples = R"(Examples:
  armwright reproduce                              # all published results, each on 500 test cases
  armwright reproduce --cases 20 --table A.10      # a quick check of one design
  armwright reproduce --csv - > reproduced.csv
  armwright reproduce --out                        # all results that the thesis's figures need, kept in results/reproduction

The thesis of 2010 from which armwright began tuned the controllers of an ABB IRB 4600-40/2.55 with a genetic algorithm
(docs/figures.md). This command evaluates every published design on the problem it was made for, under the conditions
that its source states. The test cases are ours, as the thesis drew its own. The ratio is our mean error divided by the
published one. Errors are mean distances between the tip and its target.

With --out, the command also optimizes again what the thesis optimized without printing the designs (the initial
experiment, E1 to E5), with its genetic algorithm on the engine articulated, and sweeps its E6 design over the speed.
That takes some minutes. The folder keeps all results. If Ctrl-C, a time limit or a crash interrupts the command, the
same command resumes it.)";

constexpr const char* kDefaultFolder = "results/reproduction";

struct ReproduceOptions {
  std::string cases;
  std::vector<std::string> tables;
  EngineFlags engines;
  std::string jobs;
  std::string time_limit;
  FolderOptions folder;
  std::string csv;
  bool json = false;
  bool quiet = false;
};

std::string describe_conditions(const ReproductionPart& published) {
  std::string text = published.problem;
  for (const std::string& change : published.overrides) {
    text += " " + change;
  }
  return text;
}

std::string format_text(const std::vector<PartResult>& rows, const Style& style) {
  Table table({{"published as", false},
               {"problem", false},
               {"published mm"},
               {"ours mm"},
               {"ratio"},
               {"median mm"},
               {"worst mm"},
               {"failures"},
               {"torque N m"}});
  std::uint64_t cases = 0;
  std::uint64_t failures = 0;
  std::size_t compared = 0;
  double least = 0;
  double most = 0;
  for (const PartResult& row : rows) {
    const ErrorSummary summary = row.calc_summary();
    const auto ratio = row.calc_ratio();
    table.add_row({sanitize(row.part.label), describe_conditions(row.part),
                   format_mm(row.part.published_error_m), format_mm(summary.mean),
                   ratio ? format_significant(*ratio, 3) : "-", format_mm(summary.median),
                   format_mm(summary.worst),
                   fmt::format("{} of {}", summary.failures, summary.cases),
                   format_significant(row.total_torque_n_m)});
    cases += summary.cases;
    failures += summary.failures;
    if (ratio) {
      least = compared == 0 ? *ratio : std::min(least, *ratio);
      most = std::max(most, *ratio);
      ++compared;
    }
  }
  std::string text =
      table.format(style) + fmt::format("\n{}, {}, {}", format_count(rows.size(), "result"),
                                        format_count(cases, "simulated case"),
                                        format_count(failures, "failure"));
  if (compared > 0) {
    text += fmt::format("; {} with a published number; ours are {} to {} times as large", compared,
                        format_significant(least, 3), format_significant(most, 3));
  }
  return text + "\n";
}

std::string format_json(const std::vector<PartResult>& rows) {
  json list = json::array();
  for (const PartResult& row : rows) {
    const ErrorSummary summary = row.calc_summary();
    list.push_back({{"label", row.part.label},
                    {"design", row.part.design},
                    {"problem", row.part.problem},
                    {"set", row.part.overrides},
                    {"where", row.part.where},
                    {"published_error_m", to_json_value(row.part.published_error_m)},
                    {"cases", summary.cases},
                    {"mean_error_m", to_json_value(summary.mean)},
                    {"ratio", to_json_value(row.calc_ratio())},
                    {"median_error_m", to_json_value(summary.median)},
                    {"percentile_95_error_m", to_json_value(summary.percentile_95)},
                    {"worst_error_m", to_json_value(summary.worst)},
                    {"failures", summary.failures},
                    {"total_torque_n_m", row.total_torque_n_m}});
  }
  return json{{"results", list}}.dump(1) + "\n";
}

std::string format_csv(const std::vector<PartResult>& rows) {
  std::string text =
      "label,design,problem,set,published_error_m,cases,mean_error_m,ratio,median_error_m,"
      "percentile_95_error_m,worst_error_m,failures,total_torque_n_m\n";
  const auto number = [](std::optional<double> value) { return value ? format_exact(*value) : ""; };
  for (const PartResult& row : rows) {
    const ErrorSummary summary = row.calc_summary();
    text +=
        fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", quote_csv(row.part.label),
                    quote_csv(row.part.design), quote_csv(row.part.problem),
                    quote_csv(join(row.part.overrides, " ")), number(row.part.published_error_m),
                    summary.cases, number(summary.mean), number(row.calc_ratio()),
                    number(summary.median), number(summary.percentile_95), number(summary.worst),
                    summary.failures, format_exact(row.total_torque_n_m));
  }
  return text;
}

// Returns the command that resumes it: the typed command, without --new, which would begin another
// folder.
std::vector<std::string> make_command(const ReproduceOptions& options, const Session& session,
                                      const ReproductionFolder& folder) {
  if (!options.folder.another) {
    return session.command_line;
  }
  std::vector<std::string> words;
  for (const std::string& word : session.command_line) {
    if (word != "--new") {
      words.push_back(word);
    }
  }
  words.insert(words.end(), {"--out", folder.path().string()});
  return words;
}

// Returns a table of the designs that were optimized again, beside their published numbers.
std::string format_runs(const std::vector<PartResult>& results, const Style& style) {
  Table table({{"optimized anew", false},
               {"mean mm"},
               {"median mm"},
               {"failures"},
               {"torque N m"},
               {"published N m"}});
  bool any = false;
  for (const PartResult& row : results) {
    if (row.part.kind == ReproductionPart::Kind::anew) {
      const ErrorSummary summary = row.calc_summary();
      const auto& torque = row.part.published_torque_n_m;
      table.add_row({sanitize(row.part.label), format_mm(summary.mean), format_mm(summary.median),
                     fmt::format("{} of {}", summary.failures, summary.cases),
                     format_significant(row.total_torque_n_m),
                     torque ? format_significant(*torque) : "-"});
      any = true;
    }
  }
  return any ? "\n" + table.format(style) : "";
}

// Speeds of ODE and of the engine of the runs on one core of 2020. They serve only the notice
// below.
constexpr double kCasesPerJobAndSecond = 70;
constexpr double kRunCasesPerJobAndSecond = 4000;

void announce(const ReproduceOptions& options, const ReproductionPlan& plan,
              const ReproductionFolder* folder, unsigned jobs) {
  std::uint64_t cases = 0;
  std::size_t there = 0;
  double expected_s = 0;
  for (const PlannedPart& part : plan.parts) {
    const bool is_there = folder != nullptr && folder->find(part.part.label) != nullptr;
    there += is_there ? 1 : 0;
    cases += is_there ? 0 : part.cases;
  }
  expected_s += static_cast<double>(cases) / (kCasesPerJobAndSecond * jobs);
  std::size_t runs = 0;
  for (const RunPlan& run : plan.runs) {
    if (!path_exists(folder->get_run_folder(run.problem.name) / "result.json")) {
      expected_s += static_cast<double>(run.budget) / (kRunCasesPerJobAndSecond * jobs);
      ++runs;
    }
  }
  const bool slow = options.engines.engine.empty() || options.engines.engine == "ode";
  std::string text = fmt::format(
      "{} on {} in all",
      format_count(plan.parts.size() - there, folder == nullptr ? "published result" : "result"),
      format_count(cases, "case"));
  if (runs > 0) {
    text += fmt::format(" and {}", format_count(runs, "run"));
  }
  write_message(fmt::format("{}; {}on {}", text,
                            slow ? fmt::format("about {} ", format_duration(expected_s)) : "",
                            format_count(jobs, "thread")));
  if (folder != nullptr) {
    write_message(fmt::format("folder {} ({} of {} results exist already)", folder->path().string(),
                              there, plan.parts.size()));
  }
}

void show(const ReproduceOptions& options, const std::vector<PartResult>& results,
          const Session& session) {
  std::vector<PartResult> rows;
  std::ranges::copy_if(results, std::back_inserter(rows), [](const PartResult& result) {
    return result.part.kind == ReproductionPart::Kind::published;
  });
  if (!options.csv.empty()) {
    write_output(options.csv, format_csv(rows));
  }
  if (options.json) {
    write_stdout(format_json(rows));
  } else if (options.csv != "-") {
    const Style style = make_style(Stream::out, session.color);
    write_stdout(format_text(rows, style) + format_runs(results, style));
  }
}

int run_reproduce(const ReproduceOptions& options, Session& session) {
  const bool is_kept = !options.folder.out.empty() || options.folder.another;
  ReproductionRequest request;
  request.tables = options.tables;
  request.overrides = options.engines.get();
  request.whole = is_kept;
  if (!options.cases.empty()) {
    request.cases =
        static_cast<std::uint64_t>(parse_count("--cases", options.cases, 1, kMostCases));
  }
  const unsigned jobs = parse_jobs(options.jobs);
  apply_time_limit(options.time_limit, session.stop);
  ReproductionPlan plan = plan_reproduction(request);
  std::optional<ReproductionFolder> folder;
  if (is_kept) {
    folder.emplace(options.folder.choose("reproduction"), plan);
  }
  if (!options.quiet) {
    announce(options, plan, folder ? &*folder : nullptr, jobs);
  }
  catch_signals(session.stop);
  ProgressBar bar(options.quiet, {"error", "m"});
  if (folder) {
    for (const std::string& warning : folder->warnings()) {
      bar.on_message("warning: " + warning + "; existing results are not computed again");
    }
  }
  const auto results = execute_reproduction(plan, folder ? &*folder : nullptr,
                                            session.command_line.front(), jobs, session.stop, bar);
  bar.clear();
  if (!results) {
    const char* stop = describe_stop(session.stop.reason());
    write_message(is_kept ? fmt::format("{}; nothing is lost. To resume:\n{}", stop,
                                        quote_command(make_command(options, session, *folder)))
                          : fmt::format("{}; nothing was written", stop));
    return get_stop_code(session.stop.reason());
  }
  bool failed = false;
  for (const PartResult& result : *results) {
    report_failures(result.failures, result.part.label + ", ");
    failed = failed || !result.failures.empty();
  }
  show(options, *results, session);
  if (folder && !options.quiet) {
    write_message(fmt::format("kept in {}", folder->path().string()));
  }
  return failed ? exit_code::kFailed : exit_code::kDone;
}

}  // namespace

void add_reproduce(CLI::App& app, Session& session) {
  auto options = std::make_shared<ReproduceOptions>();
  CLI::App* command =
      add_command(app, session, "reproduce",
                  "Evaluate every published design and compare it with its published result",
                  kReproduceExamples);
  command
      ->add_option("--cases", options->cases,
                   "Use the first N test cases (default: the number of each problem, 500)")
      ->type_name("N");
  command
      ->add_option("--table", options->tables, "Evaluate only this design, as in A.10; repeatable")
      ->type_name("NAME")
      ->allow_extra_args(false);
  options->engines.add_to(*command, false);
  add_jobs_flag(*command, options->jobs);
  add_time_limit_flag(*command, options->time_limit);
  options->folder.add_to(*command, "reproduction",
                         fmt::format("nothing is kept;\n--out alone: {}", kDefaultFolder));
  command->get_option("--out")->expected(0, 1)->default_str(kDefaultFolder);
  auto* as_json =
      command->add_flag("--json", options->json, "Print the results as JSON")->group("Output");
  command->add_option("--csv", options->csv, "Write the results as CSV; - is standard output")
      ->type_name("FILE")
      ->group("Output")
      ->excludes(as_json);
  command->add_flag("--quiet,-q", options->quiet, "Show no progress")->group("Output");
  command->callback([options, &session] {
    session.action = [options, &session] { return run_reproduce(*options, session); };
  });
}

}  // namespace armwright
