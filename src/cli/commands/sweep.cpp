// armwright sweep: evaluates one design while one setting of the problem takes several values.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/text.hpp"
#include "cli/commands/commands.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/progress_bar.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/table.hpp"
#include "cli/terminal/terminal.hpp"
#include "cli/views/design_and_problem.hpp"
#include "problems/config/design_file.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr const char* kSweepExamples = R"(Examples:
  armwright sweep q4-speed                         # the error of the E6 design over the speed, as the thesis's Q4
  armwright sweep q2-e6 --design table-a10 --parameter task.load_kg --values 0,5,10,20
  armwright sweep q1-complex --design table-a5 --parameter task.signal --values ramp,complex --cases 50 --csv -

A problem may have a table [sweep] with the setting, its values and the design. Flags override it.)";

struct SweepOptions {
  std::string problem;
  std::string design;
  std::string parameter;
  std::string values;
  OverrideOptions overrides;
  CaseOptions cases;
  std::string jobs;
  std::string csv;
  bool json = false;
  bool quiet = false;
};

struct SweepRow {
  std::string value;
  DesignEvaluation evaluation;
};

// The sweep that the flags choose, or that of the problem's table [sweep].
struct ChosenSweep {
  std::string parameter;
  std::vector<std::string> values;
  std::string design;
};

ChosenSweep choose_sweep(const SweepOptions& options, const LoadedProblem& problem) {
  ChosenSweep chosen;
  if (problem.sweep) {
    chosen.parameter = problem.sweep->parameter;
    chosen.design = problem.sweep->design;
    for (const double value : problem.sweep->values) {
      chosen.values.push_back(format_exact(value));
    }
  }
  if (!options.parameter.empty() && options.parameter != chosen.parameter) {
    chosen.parameter = options.parameter;
    chosen.values.clear();  // they are values of the other setting
  }
  if (!options.values.empty()) {
    chosen.values = split(options.values, ',');
  }
  if (!options.design.empty()) {
    chosen.design = options.design;
  }
  const auto demand = [&](bool there, const char* flag, const char* example) {
    if (!there) {
      throw Error(
          ErrorKind::usage,
          fmt::format("{} is missing, and problem '{}' has no sweep of its own; for example {} {}",
                      flag, problem.name, flag, example));
    }
  };
  demand(!chosen.parameter.empty(), "--parameter", "task.speed_m_per_s");
  demand(!chosen.values.empty(), "--values", "0.5,1,1.5");
  demand(!chosen.design.empty(), "--design", "table-a10");
  if (std::any_of(chosen.values.begin(), chosen.values.end(),
                  [](const std::string& value) { return value.empty(); })) {
    throw Error(ErrorKind::usage,
                fmt::format("--values is '{}'; it must be values with a single comma between them",
                            sanitize(options.values)));
  }
  return chosen;
}

std::string format_json(const ChosenSweep& sweep, const std::vector<SweepRow>& rows) {
  json list = json::array();
  for (const SweepRow& row : rows) {
    const ErrorSummary& summary = row.evaluation.summary;
    const auto number = parse_finite(row.value);
    list.push_back({{"value", number ? json(*number) : json(sanitize(row.value))},
                    {"cases", summary.cases},
                    {"mean_error_m", to_json_value(summary.mean)},
                    {"median_error_m", to_json_value(summary.median)},
                    {"percentile_95_error_m", to_json_value(summary.percentile_95)},
                    {"worst_error_m", to_json_value(summary.worst)},
                    {"failures", summary.failures}});
  }
  return json{{"parameter", sanitize(sweep.parameter)},
              {"design", sanitize(sweep.design)},
              {"rows", list}}
             .dump(1) +
         "\n";
}

std::string format_csv(const std::vector<SweepRow>& rows) {
  std::string text =
      "value,cases,mean_error_m,median_error_m,percentile_95_error_m,worst_error_m,failures\n";
  const auto number = [](std::optional<double> value) { return value ? format_exact(*value) : ""; };
  for (const SweepRow& row : rows) {
    const ErrorSummary& summary = row.evaluation.summary;
    text += fmt::format("{},{},{},{},{},{},{}\n", quote_csv(row.value), summary.cases,
                        number(summary.mean), number(summary.median), number(summary.percentile_95),
                        number(summary.worst), summary.failures);
  }
  return text;
}

std::string format_text(const ChosenSweep& sweep, const std::vector<SweepRow>& rows,
                        const Style& style) {
  constexpr double kLongestBar = 24;
  double least = HUGE_VAL;
  double most = 0;
  for (const SweepRow& row : rows) {
    if (const auto mean = row.evaluation.summary.mean; mean && *mean > 0) {
      least = std::min(least, *mean);
      most = std::max(most, *mean);
    }
  }
  // A bar has at least one character. Its full length stands for the range of the values, but for
  // at least one decade.
  const double decades = std::max(1.0, std::log10(most / least));
  const auto make_bar = [&](std::optional<double> mean) {
    if (!mean || *mean <= 0) {
      return std::string();
    }
    const double length = 1 + (kLongestBar - 1) * std::log10(*mean / least) / decades;
    return std::string(static_cast<std::size_t>(std::lround(length)), '#');
  };
  Table table({{sweep.parameter, true},
               {"mean mm"},
               {"median mm"},
               {"worst mm"},
               {"failures"},
               {"mean, logarithmic", false}});
  for (const SweepRow& row : rows) {
    const ErrorSummary& summary = row.evaluation.summary;
    table.add_row({sanitize(row.value), format_mm(summary.mean), format_mm(summary.median),
                   format_mm(summary.worst),
                   fmt::format("{} of {}", summary.failures, summary.cases),
                   make_bar(summary.mean)});
  }
  return table.format(style);
}

int run_sweep(const SweepOptions& options, Session& session) {
  const unsigned jobs = parse_jobs(options.jobs);
  const std::vector<std::string> overrides = options.overrides.get();
  const LoadedProblem base = load_problem(options.problem, overrides);
  require_tracking(base);
  const ChosenSweep sweep = choose_sweep(options, base);
  const DesignFile design = load_design(sweep.design);
  if (design.design.speed_m_per_s && sweep.parameter == "task.speed_m_per_s") {
    throw Error(
        ErrorKind::usage,
        fmt::format("the design {} has a speed of its own, which replaces task.speed_m_per_s; "
                    "remove speed_m_per_s from its file to sweep the speed",
                    sanitize(sweep.design)));
  }
  // All values are validated before the first is simulated.
  std::vector<LoadedProblem> problems;
  for (const std::string& value : sweep.values) {
    auto all = overrides;
    for (const std::string& flag : options.overrides.engines.get()) {
      if (get_override_key(flag) == sweep.parameter) {
        throw Error(
            ErrorKind::usage,
            fmt::format("--parameter {} takes several values, but a flag means --set {}; leave "
                        "the flag out",
                        sanitize(sweep.parameter), flag));
      }
    }
    all.push_back(sweep.parameter + "=" + value);
    problems.push_back(load_problem(options.problem, all));
    require_tracking(problems.back()).check_design(design.design);
  }
  const ChosenCases chosen = choose_cases(base, options.cases);

  catch_signals(session.stop);
  ProgressBar bar(options.quiet, {"error", "m"});
  std::vector<SweepRow> rows;
  Progress progress;
  for (const LoadedProblem& problem : problems) {
    progress.total += choose_cases(problem, options.cases).count;
  }
  for (std::size_t i = 0; i < problems.size(); ++i) {
    // The swept setting may change the cases, for example by the workspace, and the target tables.
    const ChosenCases cases = choose_cases(problems[i], options.cases);
    auto evaluation = evaluate_with_progress(*problems[i].tracking(), design.design, cases, jobs,
                                             session.stop, bar, progress);
    problems[i] = {};
    if (!evaluation) {
      bar.clear();
      write_message(fmt::format("{}; nothing was written", describe_stop(session.stop.reason())));
      return get_stop_code(session.stop.reason());
    }
    progress.done += cases.count;
    rows.push_back({sweep.values[i], std::move(*evaluation)});
  }
  bar.clear();
  bool failed = false;
  for (const SweepRow& row : rows) {
    report_failures(list_failures(row.evaluation.results),
                    fmt::format("{}={}, ", sweep.parameter, row.value));
    failed = failed || row.evaluation.summary.without_number > 0;
  }
  if (!options.csv.empty()) {
    write_output(options.csv, format_csv(rows));
  }
  if (options.json) {
    write_stdout(format_json(sweep, rows));
  } else if (options.csv != "-") {
    write_stdout(format_text(sweep, rows, make_style(Stream::out, session.color)));
  }
  return failed ? exit_code::kFailed : exit_code::kDone;
}

}  // namespace

void add_sweep(CLI::App& app, Session& session) {
  auto options = std::make_shared<SweepOptions>();
  CLI::App* command = add_command(
      app, session, "sweep",
      "Evaluate a design while one setting of the problem takes several values", kSweepExamples);
  command
      ->add_option("PROBLEM", options->problem,
                   "A problem file, or the name of a shipped problem (armwright list problems)")
      ->required();
  command->add_option("--design", options->design, "The design (armwright list designs)")
      ->type_name("DESIGN");
  command->add_option("--parameter", options->parameter, "The setting, as in task.speed_m_per_s")
      ->type_name("KEY");
  command->add_option("--values", options->values, "Its values")->type_name("A,B,...");
  options->overrides.add_to(*command);
  options->cases.add_to(*command);
  add_jobs_flag(*command, options->jobs);
  auto* as_json =
      command->add_flag("--json", options->json, "Print the table as JSON")->group("Output");
  command->add_option("--csv", options->csv, "Write the table as CSV; - is standard output")
      ->type_name("FILE")
      ->group("Output")
      ->excludes(as_json);
  command->add_flag("--quiet,-q", options->quiet, "Show no progress")->group("Output");
  command->callback([options, &session] {
    session.action = [options, &session] { return run_sweep(*options, session); };
  });
}

}  // namespace armwright
