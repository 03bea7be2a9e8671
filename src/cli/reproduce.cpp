// armwright reproduce: every published result of the shipped designs beside ours.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iterator>

#include "base/error.hpp"
#include "base/text.hpp"
#include "cli/design_evaluation.hpp"
#include "cli/format.hpp"
#include "cli/json.hpp"
#include "cli/progress_bar.hpp"
#include "cli/session.hpp"
#include "cli/signals.hpp"
#include "cli/table.hpp"
#include "cli/terminal.hpp"
#include "problems/config_files.hpp"
#include "problems/design_file.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr const char* kExamples = R"(Examples:
  armwright reproduce                              # all published results, on 500 test cases each
  armwright reproduce --cases 20 --table A.10      # a quick look at one design
  armwright reproduce --csv - > reproduced.csv

Every published design is evaluated on the problem it was made for, under the conditions its source states. The
test cases are ours: the thesis drew its own. The ratio is our mean error over the published one.)";

struct ReproduceOptions {
  std::string cases;
  std::vector<std::string> tables;
  EngineFlags engines;
  JobsOption jobs;
  std::string csv;
  bool json = false;
  bool quiet = false;
};

struct Entry {
  std::string design_name;
  ArmDesign design;
  PublishedResult published;
  LoadedProblem problem;
  ChosenCases cases;
};

struct Reproduced {
  std::string design_name;
  PublishedResult published;
  DesignEvaluation evaluation;

  std::optional<double> calc_ratio() const {
    const auto mean = evaluation.summary.mean;
    return published.error_m && mean ? std::optional(*mean / *published.error_m) : std::nullopt;
  }
};

// "table-a10" -> {"table-a", 10}: so that A.5 comes before A.10.
std::pair<std::string, long long> get_natural_key(const std::string& name) {
  const std::size_t digits = name.find_last_not_of("0123456789") + 1;
  return {name.substr(0, digits), parse_integer(name.substr(digits)).value_or(-1)};
}

// What people call the table of a shipped design: "table-a10" is A.10.
std::string get_table_name(const std::string& design) {
  constexpr std::string_view kPrefix = "table-a";
  return design.starts_with(kPrefix) ? "A." + design.substr(kPrefix.size()) : design;
}

std::vector<std::string> choose_designs(const std::vector<std::string>& tables) {
  std::vector<std::string> designs;
  for (const std::string& name : list_configs("designs")) {
    if (!load_design(name).published.empty()) {
      designs.push_back(name);
    }
  }
  std::sort(designs.begin(), designs.end(), [](const std::string& a, const std::string& b) {
    return get_natural_key(a) < get_natural_key(b);
  });
  if (tables.empty()) {
    return designs;
  }
  std::vector<std::string> valid;
  for (const std::string& design : designs) {
    valid.push_back(get_table_name(design));
  }
  std::vector<bool> wanted(designs.size());
  for (const std::string& table : tables) {
    const auto named = std::find(valid.begin(), valid.end(), table);
    const auto found = std::find(designs.begin(), designs.end(), table);
    if (named == valid.end() && found == designs.end()) {
      throw Error(ErrorKind::usage, describe_unknown("table", table, valid));
    }
    wanted[static_cast<std::size_t>(named != valid.end() ? named - valid.begin()
                                                         : found - designs.begin())] = true;
  }
  std::vector<std::string> chosen;
  for (std::size_t i = 0; i < designs.size(); ++i) {
    if (wanted[i]) {
      chosen.push_back(designs[i]);
    }
  }
  return chosen;
}

std::vector<Entry> load_entries(const ReproduceOptions& options) {
  std::vector<Entry> entries;
  const std::vector<std::string> flags = options.engines.get();
  CaseOptions cases;
  cases.cases = options.cases;
  for (const std::string& name : choose_designs(options.tables)) {
    const DesignFile file = load_design(name);
    for (const PublishedResult& published : file.published) {
      std::vector<std::string> overrides = published.overrides;
      std::ranges::copy(flags, std::back_inserter(overrides));
      LoadedProblem problem = load_problem(published.problem, overrides);
      require_tracking(problem).check_design(file.design);
      ChosenCases chosen = choose_cases(problem, cases);
      entries.push_back({name, file.design, published, std::move(problem), std::move(chosen)});
    }
  }
  return entries;
}

std::string describe_conditions(const PublishedResult& published) {
  std::string text = published.problem;
  for (const std::string& change : published.overrides) {
    text += " " + change;
  }
  return text;
}

std::string format_text(const std::vector<Reproduced>& rows, const Style& style) {
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
  for (const Reproduced& row : rows) {
    const ErrorSummary& summary = row.evaluation.summary;
    const auto ratio = row.calc_ratio();
    table.add_row({sanitize(row.published.label), describe_conditions(row.published),
                   format_mm(row.published.error_m), format_mm(summary.mean),
                   ratio ? format_significant(*ratio, 3) : "-", format_mm(summary.median),
                   format_mm(summary.worst),
                   fmt::format("{} of {}", summary.failures, summary.cases),
                   format_significant(row.evaluation.total_torque_n_m)});
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
    text += fmt::format("; {} with a published number, ours being {} to {} times that", compared,
                        format_significant(least, 3), format_significant(most, 3));
  }
  return text + "\n";
}

std::string format_json(const std::vector<Reproduced>& rows) {
  json list = json::array();
  for (const Reproduced& row : rows) {
    const ErrorSummary& summary = row.evaluation.summary;
    list.push_back({{"label", row.published.label},
                    {"design", row.design_name},
                    {"problem", row.published.problem},
                    {"set", row.published.overrides},
                    {"where", row.published.where},
                    {"published_error_m", to_json_value(row.published.error_m)},
                    {"cases", summary.cases},
                    {"mean_error_m", to_json_value(summary.mean)},
                    {"ratio", to_json_value(row.calc_ratio())},
                    {"median_error_m", to_json_value(summary.median)},
                    {"percentile_95_error_m", to_json_value(summary.percentile_95)},
                    {"worst_error_m", to_json_value(summary.worst)},
                    {"failures", summary.failures},
                    {"total_torque_n_m", row.evaluation.total_torque_n_m}});
  }
  return json{{"results", list}}.dump(1) + "\n";
}

std::string format_csv(const std::vector<Reproduced>& rows) {
  std::string text =
      "label,design,problem,set,published_error_m,cases,mean_error_m,ratio,median_error_m,"
      "percentile_95_error_m,worst_error_m,failures,total_torque_n_m\n";
  const auto number = [](std::optional<double> value) { return value ? format_exact(*value) : ""; };
  for (const Reproduced& row : rows) {
    const ErrorSummary& summary = row.evaluation.summary;
    text +=
        fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", quote_csv(row.published.label),
                    quote_csv(row.design_name), quote_csv(row.published.problem),
                    quote_csv(join(row.published.overrides, " ")), number(row.published.error_m),
                    summary.cases, number(summary.mean), number(row.calc_ratio()),
                    number(summary.median), number(summary.percentile_95), number(summary.worst),
                    summary.failures, format_exact(row.evaluation.total_torque_n_m));
  }
  return text;
}

int run_reproduce(const ReproduceOptions& options, Session& session) {
  constexpr double kCasesPerJobAndSecond = 70;  // ODE on a core of 2020; only for the notice below
  const unsigned jobs = options.jobs.get();
  std::vector<Entry> entries = load_entries(options);
  BarShare share;
  for (const Entry& entry : entries) {
    share.total += entry.cases.count;
  }
  if (!options.quiet) {
    const bool slow = options.engines.engine.empty() || options.engines.engine == "ode";
    const double expected_s = static_cast<double>(share.total) / (kCasesPerJobAndSecond * jobs);
    write_message(fmt::format("{} on {} in all; {}on {}",
                              format_count(entries.size(), "published result"),
                              format_count(share.total, "case"),
                              slow ? fmt::format("about {} ", format_duration(expected_s)) : "",
                              format_count(jobs, "thread")));
  }
  catch_signals(session.stop);
  ProgressBar bar(options.quiet, {"error", "m"});
  std::vector<Reproduced> rows;
  for (Entry& entry : entries) {
    auto evaluation = evaluate_with_progress(*entry.problem.tracking, entry.design, entry.cases,
                                             jobs, session.stop, bar, share);
    entry.problem = {};  // its targets are of no use to the next
    if (!evaluation) {
      bar.clear();
      write_message(fmt::format("{}; nothing was written", describe_stop(session.stop.reason())));
      return get_stop_code(session.stop.reason());
    }
    share.done_before += entry.cases.count;
    rows.push_back({entry.design_name, entry.published, std::move(*evaluation)});
  }
  bar.clear();
  bool failed = false;
  for (const Reproduced& row : rows) {
    report_failures(row.evaluation, row.published.label + ", ");
    failed = failed || row.evaluation.summary.without_number > 0;
  }
  if (!options.csv.empty()) {
    write_output(options.csv, format_csv(rows));
  }
  if (options.json) {
    write_stdout(format_json(rows));
  } else if (options.csv != "-") {
    write_stdout(format_text(rows, make_style(Stream::out, session.color)));
  }
  return failed ? exit_code::kFailed : exit_code::kDone;
}

}  // namespace

void add_reproduce(CLI::App& app, Session& session) {
  auto options = std::make_shared<ReproduceOptions>();
  CLI::App* command =
      add_command(app, session, "reproduce",
                  "Evaluate every published design beside its published result", kExamples);
  command
      ->add_option("--cases", options->cases,
                   "Use the first N test cases (default: as many as each problem says, 500)")
      ->type_name("N");
  command->add_option("--table", options->tables, "Only this design, as in A.10; repeatable")
      ->type_name("NAME")
      ->allow_extra_args(false);
  options->engines.add_to(*command, false);
  options->jobs.add_to(*command);
  auto* as_json =
      command->add_flag("--json", options->json, "Print the results as JSON")->group("Output");
  command->add_option("--csv", options->csv, "Write the results as CSV; - is standard output")
      ->type_name("FILE")
      ->group("Output")
      ->excludes(as_json);
  command->add_flag("--quiet,-q", options->quiet, "No progress")->group("Output");
  command->callback([options, &session] {
    session.action = [options, &session] { return run_reproduce(*options, session); };
  });
}

}  // namespace armwright
