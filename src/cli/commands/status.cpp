// armwright status: shows the state of all cells of a study.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/text.hpp"
#include "cli/commands/commands.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/table.hpp"
#include "cli/terminal/terminal.hpp"
#include "study/matrix/cell_selection.hpp"
#include "study/matrix/study_status.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr const char* kStatusExamples = R"(Examples:
  armwright status results/q1                         # on any machine that sees the folder
  armwright status results/q1 --json

A cell is one run of a study: an optimizer on a problem in a replicate.

done     the cell has its result
failed   the cell has a result, but its optimizer has failed
broken   the cell's last attempt ended with the error that is shown
running  a process runs the cell and has written a sign of life within the last minute
silent   a process ran the cell, but its sign of life is older
left     the cell has not begun, or was stopped in order

To resume cells that are broken, silent or left, use the same command as before: compare, or the batch system's script
(docs/clusters.md). This command changes nothing. 'armwright show' prints the results of a complete study.)";

struct StatusOptions {
  std::string study;
  bool json = false;
};

std::string describe_cell_status(const StudyPlan& plan, const CellStatus& status) {
  const std::string name = make_cell_name(plan, status.cell);
  switch (status.state) {
    case CellState::running: {
      const auto cases = status.attempt ? status.attempt->cases : std::nullopt;
      return fmt::format("{}: {}{}", name, describe_holder(status),
                         cases ? fmt::format(", {} of {} cases", *cases, plan.budget) : "");
    }
    case CellState::silent:
      return fmt::format("{}: {}, silent for {}", name, describe_holder(status),
                         format_duration(status.attempt->silence_s.value_or(0)));
    default:
      return name + ": " + sanitize(status.error);
  }
}

std::string describe_notable(const StudyPlan& plan, const StudyStatus& status, CellState state,
                             const Style& style) {
  constexpr int kMostShown = 20;
  std::string text;
  int shown = 0;
  for (const CellStatus& one : status.notable) {
    if (one.state == state && shown++ < kMostShown) {
      text += "  " + describe_cell_status(plan, one) + "\n";
    }
  }
  if (shown > kMostShown) {
    text += fmt::format("  and {} more (--json has all)\n", shown - kMostShown);
  }
  return text.empty() ? "" : "\n" + style.bold(to_string(state)) + "\n" + text;
}

std::string describe_next(const RecordedStudy& study, const StudyStatus& status,
                          const Session& session) {
  const std::string folder = study.folder.string();
  const std::size_t ended = status.count(CellState::done) + status.count(CellState::failed);
  if (ended == list_cells(study.plan).size()) {
    return "\nAll cells have ended. To make tables and verdict:\n  " +
           quote_own_command(session, {"merge", folder}) + "\n";
  }
  const std::string plan = (study.folder / "study.toml").string();
  return "\nTo run the remaining cells here or on a cluster (when no cell is running any more):\n "
         " " +
         quote_own_command(session, {"compare", plan, "--out", folder}) + "\n  " +
         quote_own_command(session, {"compare", plan, "--out", folder, "--executor", "slurm"}) +
         "\n";
}

std::string format_text(const RecordedStudy& study, const StudyStatus& status,
                        const Session& session) {
  const Style style = make_style(Stream::out, session.color);
  std::vector<Column> columns = {{"problem", false}, {"optimizer", false}};
  for (std::size_t state = 0; state < kCellStates; ++state) {
    columns.push_back({to_string(static_cast<CellState>(state))});
  }
  Table table(columns);
  const auto add = [&](const std::string& problem, const std::string& optimizer,
                       const StudyStatus::Counts& counts) {
    std::vector<std::string> row = {problem, optimizer};
    for (const std::size_t count : counts) {
      row.push_back(count == 0 ? "" : std::to_string(count));
    }
    table.add_row(std::move(row));
  };
  for (const StudyStatus::Row& row : status.rows) {
    add(study.plan.problems[row.problem].label, study.plan.optimizers[row.optimizer].label,
        row.counts);
  }
  add("all", "", status.counts);
  std::string text = table.format(style);
  for (const CellState state :
       {CellState::running, CellState::silent, CellState::broken, CellState::failed}) {
    text += describe_notable(study.plan, status, state, style);
  }
  if (!status.writer.empty()) {
    text += fmt::format("\nOne process runs the whole study: {}\n", status.writer);
  }
  return text + describe_next(study, status, session);
}

json counts_to_json(const StudyStatus::Counts& counts) {
  json j = json::object();
  for (std::size_t state = 0; state < kCellStates; ++state) {
    j[to_string(static_cast<CellState>(state))] = counts[state];
  }
  return j;
}

json to_json(const StudyPlan& plan, const CellStatus& status) {
  json j = {{"cell", make_cell_name(plan, status.cell)}, {"state", to_string(status.state)}};
  if (!status.writer.empty()) {
    j["writer"] = status.writer;
  }
  if (!status.error.empty()) {
    j["error"] = sanitize(status.error);
  }
  if (status.attempt) {
    const AttemptState& attempt = *status.attempt;
    j["attempt"] = attempt.token;
    j["silence_s"] = attempt.silence_s ? json(*attempt.silence_s) : json();
    j["cases"] = attempt.cases ? json(*attempt.cases) : json();
    if (attempt.record) {
      j["host"] = attempt.record->host;
      j["pid"] = attempt.record->pid;
      j["job"] = attempt.record->job;
      j["started"] = attempt.record->started;
    }
  }
  return j;
}

std::string to_json(const RecordedStudy& study, const StudyStatus& status) {
  json rows = json::array();
  for (const StudyStatus::Row& row : status.rows) {
    json j = counts_to_json(row.counts);
    j["problem"] = study.plan.problems[row.problem].label;
    j["optimizer"] = study.plan.optimizers[row.optimizer].label;
    rows.push_back(std::move(j));
  }
  json cells = json::array();
  for (const CellStatus& one : status.notable) {
    cells.push_back(to_json(study.plan, one));
  }
  const json j = {{"study", study.plan.name},
                  {"folder", study.folder.string()},
                  {"writer", status.writer.empty() ? json() : json(status.writer)},
                  {"budget", study.plan.budget},
                  {"cells", list_cells(study.plan).size()},
                  {"counts", counts_to_json(status.counts)},
                  {"rows", rows},
                  {"notable", cells}};
  return j.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

int run_status(const StatusOptions& options, const Session& session) {
  const RecordedStudy study = load_recorded_study(options.study);
  const StudyStatus status = read_study_status(study.plan, study.folder);
  write_stdout(options.json ? to_json(study, status) : format_text(study, status, session));
  return exit_code::kDone;
}

}  // namespace

void add_status(CLI::App& app, Session& session) {
  auto options = std::make_shared<StatusOptions>();
  CLI::App* command = add_command(
      app, session, "status", "Show the state of a study's cells, and the processes that run them",
      kStatusExamples);
  command->add_option("STUDY", options->study, "The folder of a study, or its study.toml")
      ->required();
  command->add_flag("--json", options->json, "Print as JSON")->group("Output");
  command->callback([options, &session] {
    session.action = [options, &session] { return run_status(*options, session); };
  });
}

}  // namespace armwright
