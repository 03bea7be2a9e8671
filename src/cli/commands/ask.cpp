// armwright ask, armwright tell: a run whose evaluations somebody else makes.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "cli/commands/commands.hpp"
#include "cli/commands/plan_options.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/table.hpp"
#include "cli/terminal/terminal.hpp"
#include "cli/views/result_view.hpp"
#include "problems/user/user_problem.hpp"
#include "study/run/ask_tell.hpp"
#include "study/run/run_folder.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr const char* kAskExamples = R"(Examples:
  armwright ask results/bench --problem bench.toml --optimizer cmaes --budget 60   # begins a run
  armwright ask results/bench --count 4                   # the next four points
  armwright ask results/bench --csv next.csv              # a table to fill in for armwright tell
  armwright ask results/bench --waiting                   # the points that have no result yet

Use ask and tell if armwright cannot start what computes a point: an experiment on hardware, or a job in the queue of
another system. Each point has an identifier, and armwright tell takes results in any order. No point is handed out
twice. An optimizer asks for the points of a generation together, and goes on when all of them have a result. A
sequential optimizer asks for one point at a time. When the budget is spent, ask ends the run and prints its result.
The run's folder is an ordinary one: show, report, export and doctor read it.)";

constexpr const char* kTellExamples = R"(Examples:
  armwright tell results/bench results.csv
  echo '{"id": 3, "objectives": [0.52]}' | armwright tell results/bench /dev/stdin
  echo '{"id": 4, "missing": "the fuse blew"}' | armwright tell results/bench /dev/stdin

A CSV file has a header with the column id, one column per objective, constraint and metric, and if needed the column
missing with the reason why a point has no result. Columns of variables are ignored. JSON lines have the fields id,
objectives, constraints, metrics and residuals, or id and missing. Results come in any order. If one line is refused,
none of the file is recorded.)";

struct AskOptions : PlanOptions {
  std::string folder;
  std::string count;
  std::string csv;
  bool waiting = false;
  bool json = false;
};

// Prints warnings of a run; its progress is no news here.
class Warnings final : public RunObserver {
 public:
  void on_progress(const Progress& /*progress*/) override {}
  void on_message(const std::string& message) override {
    if (message.starts_with("warning") || message.starts_with("error")) {
      write_message(message);
    }
  }
};

std::string format_json(const std::vector<AskedPoint>& points, std::size_t waiting,
                        const ProblemDescription& problem) {
  json all = {{"points", json::array()}, {"waiting", waiting}};
  for (const AskedPoint& point : points) {
    json x = json::object();
    for (std::size_t i = 0; i < point.x.size(); ++i) {
      x[problem.variables[i].name] = to_json_value(problem.variables[i], point.x[i]);
    }
    all["points"].push_back({{"id", point.id}, {"x", std::move(x)}});
  }
  return all.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

std::string format_csv(const std::vector<AskedPoint>& points, const ProblemDescription& problem,
                       const UserDescription& description) {
  std::string text = "id";
  std::string blanks;
  for (const DecisionVariable& variable : problem.variables) {
    text += "," + quote_csv(variable.name);
  }
  const auto add_blank = [&](const std::string& name) {
    text += "," + quote_csv(name);
    blanks += ",";
  };
  for (const UserObjective& objective : description.objectives) {
    add_blank(objective.quantity.name);
  }
  for (const UserConstraint& constraint : description.constraints) {
    add_blank(constraint.quantity.name);
  }
  for (const Quantity& metric : description.metrics) {
    add_blank(metric.name);
  }
  add_blank("missing");
  text += "\n";
  for (const AskedPoint& point : points) {
    text += fmt::format("{}", point.id);
    for (std::size_t i = 0; i < point.x.size(); ++i) {
      text += "," + quote_csv(format_value(problem.variables[i], point.x[i]));
    }
    text += blanks + "\n";
  }
  return text;
}

std::string format_text(const std::vector<AskedPoint>& points, const ProblemDescription& problem,
                        const Style& style) {
  std::vector<Column> columns = {{"id"}};
  for (const DecisionVariable& variable : problem.variables) {
    columns.push_back({variable.unit.empty()
                           ? sanitize(variable.name)
                           : sanitize(fmt::format("{} [{}]", variable.name, variable.unit)),
                       variable.type != VariableType::category});
  }
  Table table(columns);
  for (const AskedPoint& point : points) {
    std::vector<std::string> row = {fmt::format("{}", point.id)};
    for (std::size_t i = 0; i < point.x.size(); ++i) {
      row.push_back(sanitize(format_value(problem.variables[i], point.x[i])));
    }
    table.add_row(row);
  }
  return table.format(style, 0);
}

std::string list_ids(const std::vector<AskedPoint>& points) {
  constexpr std::size_t kMost = 20;
  std::vector<std::string> ids;
  for (std::size_t i = 0; i < std::min(points.size(), kMost); ++i) {
    ids.push_back(fmt::format("{}", points[i].id));
  }
  return join(ids, ", ") + (points.size() > kMost ? ", ..." : "");
}

int run_ask(const AskOptions& options, Session& session) {
  constexpr std::int64_t kMostPoints = 1'000'000;
  if (options.json && options.csv == "-") {
    throw Error(ErrorKind::usage, "only one of --json and --csv - can write to standard output");
  }
  const std::int64_t count =
      options.count.empty() ? kMostPoints : parse_count("--count", options.count, 1, kMostPoints);
  RunRequest request;
  request.folder = options.folder;
  request.command_line = session.command_line;
  const bool is_recorded = path_exists(request.folder / "manifest.json");
  if (!is_recorded && options.waiting) {
    throw Error(ErrorKind::usage, fmt::format("{}: is not the folder of a run, so no point waits",
                                              sanitize(options.folder)));
  }
  request.plan = is_recorded && options.problem.empty() ? load_recorded_plan(request.folder)
                                                        : options.make_plan();
  const ProblemDescription& problem = request.plan.problem.problem->description();
  const UserDescription* description = find_user_description(*request.plan.problem.problem);
  Warnings warnings;
  const AskOutcome outcome =
      ask(request, options.waiting ? 0 : static_cast<std::size_t>(count), warnings);
  const Style style = make_style(Stream::out, session.color);
  if (outcome.result) {
    write_message("the run has ended; there are no more points");
    write_stdout(options.json ? to_json(*outcome.result)
                              : describe_result(*outcome.result, request.folder, style));
    return get_result_code(*outcome.result);
  }
  const auto& points = options.waiting ? outcome.waiting : outcome.points;
  if (points.empty()) {
    write_message(options.waiting
                      ? "no point waits for a result"
                      : fmt::format("the optimizer needs the results of the points {} before it "
                                    "asks for others:\n  {}",
                                    list_ids(outcome.waiting),
                                    quote_own_command(session, {"tell", options.folder, "FILE"})));
  }
  if (!options.csv.empty()) {
    write_output(options.csv, format_csv(points, problem, *description));
  }
  if (options.json) {
    write_stdout(format_json(points, outcome.waiting.size(), problem));
  } else if (options.csv != "-" && !points.empty()) {
    write_stdout(format_text(points, problem, style));
  }
  return exit_code::kDone;
}

struct TellOptions {
  std::string folder;
  std::string file;
};

int run_tell(const TellOptions& options) {
  constexpr std::size_t kLimit_bytes = std::size_t{64} << 20;
  const LoadedProblem loaded = load_problem_of_run(options.folder);
  const Problem& problem = *loaded.problem;
  if (find_user_description(problem) == nullptr) {
    throw Error(ErrorKind::usage,
                fmt::format("{}: armwright simulates the problem of this run itself; 'armwright "
                            "optimize' goes on with it",
                            sanitize(options.folder)));
  }
  const std::string text = read_input(options.file, kLimit_bytes);
  const auto answers = read_told(text, sanitize(options.file), problem);
  tell(options.folder, problem, answers);
  write_message(fmt::format("{} recorded", format_count(answers.size(), "result")));
  return exit_code::kDone;
}

}  // namespace

void add_ask(CLI::App& app, Session& session) {
  auto options = std::make_shared<AskOptions>();
  CLI::App* command =
      add_command(app, session, "ask", "Print the next points of a run that you evaluate yourself",
                  kAskExamples);
  command->add_option("RUN", options->folder, "The folder of the run; made if it does not exist")
      ->required();
  command
      ->add_option("--problem,-p", options->problem,
                   "The problem (default: that of the run; required to begin a run)")
      ->type_name("PROBLEM");
  options->add_to(*command);
  command
      ->add_option("--set", options->overrides.set,
                   "Another value for a setting of the problem; repeatable")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  command
      ->add_option("--count,-n", options->count,
                   "At most this many points (default: all that the optimizer asks for)")
      ->type_name("N");
  command->add_flag("--waiting", options->waiting,
                    "Print the points that were handed out and have no result");
  command
      ->add_option("--csv", options->csv,
                   "Write the points as a table to fill in; - is standard output")
      ->type_name("FILE")
      ->group("Output");
  command->add_flag("--json", options->json, "Print the points as JSON")->group("Output");
  command->callback([options, &session] {
    session.action = [options, &session] { return run_ask(*options, session); };
  });
}

void add_tell(CLI::App& app, Session& session) {
  auto options = std::make_shared<TellOptions>();
  CLI::App* command = add_command(app, session, "tell",
                                  "Record the results of points of armwright ask", kTellExamples);
  command->add_option("RUN", options->folder, "The folder of the run")->required();
  command->add_option("FILE", options->file, "The results, as CSV or JSON lines")->required();
  command->callback(
      [options, &session] { session.action = [options] { return run_tell(*options); }; });
}

}  // namespace armwright
