// Makes the parts of a run's page that show the course of training.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "problems/config/design_file.hpp"
#include "problems/config/values_file.hpp"
#include "report/evidence/page_json.hpp"
#include "report/page/run_parts.hpp"
#include "study/run/winner_record.hpp"
#include "study/statistics/summary.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr std::size_t kMostGenerations = 1000;
constexpr std::size_t kMostBlocks = 400;
constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

// Returns the scalar objective of a feasible evaluation, otherwise nothing.
std::optional<double> get_value(const ProblemDescription& problem, const EvaluationRecord& record) {
  return is_feasible(record.evaluation)
             ? std::optional(calc_scalar(problem, record.evaluation.objectives))
             : std::nullopt;
}

// Returns the feasible record with the least objective, the first of equals; null if there is none.
const EvaluationRecord* find_best(const ProblemDescription& problem,
                                  const std::vector<EvaluationRecord>& records) {
  const EvaluationRecord* best = nullptr;
  double least = 0;
  for (const EvaluationRecord& record : records) {
    const auto value = get_value(problem, record);
    if (value && (best == nullptr || *value < least)) {
      best = &record;
      least = *value;
    }
  }
  return best;
}

// Reads one part. The records of a whole run may not fit into the memory.
std::vector<EvaluationRecord> read_part(const RecordedRun& run, const HistoryPart& part) {
  std::vector<EvaluationRecord> records;
  records.reserve(part.count);
  for (std::size_t i = 0; i < part.count; ++i) {
    records.push_back(run.journal.training[part.first + i]);
  }
  return records;
}

struct PartSummary {
  double best = kNoValue, mean = kNoValue, worst = kNoValue;
  std::uint64_t failed = 0;
};

PartSummary summarize_part(const ProblemDescription& problem,
                           const std::vector<EvaluationRecord>& records) {
  PartSummary summary;
  double sum = 0;
  double count = 0;
  for (const EvaluationRecord& record : records) {
    summary.failed += record.evaluation.objectives.empty() ? 1 : 0;
    if (const auto value = get_value(problem, record)) {
      summary.best = std::fmin(summary.best, *value);  // fmin ignores NaN
      summary.worst = std::fmax(summary.worst, *value);
      sum += *value;
      ++count;
    }
  }
  summary.mean = count > 0 ? sum / count : kNoValue;
  return summary;
}

}  // namespace

History divide_history(const RecordedEvaluations& training) {
  History history;
  history.by_generation = !training.empty() && training.back().generation > 0;
  const std::size_t block = (training.size() + kMostBlocks - 1) / kMostBlocks;
  std::int64_t cases = 0;
  std::size_t number = 0;
  std::vector<HistoryPart> parts;
  for (const EvaluationRecord& record : training) {
    const bool begins =
        parts.empty() || (history.by_generation ? record.generation != parts.back().index
                                                : parts.back().count == block);
    if (begins) {
      parts.push_back({.first = number});
    }
    cases += static_cast<std::int64_t>(record.calc_charge());
    HistoryPart& part = parts.back();
    part.index = history.by_generation ? record.generation : record.index + 1;
    part.cases = cases;
    ++part.count;
    ++number;
  }
  const std::size_t stride = (parts.size() + kMostGenerations - 1) / kMostGenerations;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (i % stride == 0 || i + 1 == parts.size()) {
      history.parts.push_back(parts[i]);
    }
  }
  history.left_out = parts.size() - history.parts.size();
  return history;
}

std::vector<Incumbent> thin_out(const std::vector<Incumbent>& incumbents, std::size_t most) {
  if (incumbents.size() <= most) {
    return incumbents;
  }
  std::vector<Incumbent> some;
  for (std::size_t i = 0; i < most; ++i) {
    some.push_back(incumbents[i * (incumbents.size() - 1) / (most - 1)]);
  }
  return some;
}

json make_training(const RecordedRun& run, const History& history, json incumbents) {
  const ProblemDescription description = run.describe();
  json training = {{"unit", history.by_generation ? "generation" : "evaluations"},
                   {"schedule", to_text(run.schedule)},
                   {"budget", run.budget},
                   {"incumbents", std::move(incumbents)}};
  for (const char* key : {"index", "cases", "best", "mean", "worst", "failed"}) {
    training[key] = json::array();
  }
  for (const HistoryPart& part : history.parts) {
    const PartSummary summary = summarize_part(description, read_part(run, part));
    training["index"].push_back(part.index);
    training["cases"].push_back(part.cases);
    training["best"].push_back(finite_or_null(summary.best));
    training["mean"].push_back(finite_or_null(summary.mean));
    training["worst"].push_back(finite_or_null(summary.worst));
    training["failed"].push_back(summary.failed);
  }
  return training;
}

json make_variables(const RecordedRun& run, const History& history) {
  const ProblemDescription description = run.describe();
  const std::vector<double> winner = run.result ? run.find_best() : std::vector<double>{};
  json list = json::array();
  for (std::size_t i = 0; i < description.variables.size(); ++i) {
    const DecisionVariable& variable = description.variables[i];
    list.push_back({{"name", variable.name},
                    {"unit", variable.unit},
                    {"type", to_string(variable.type)},
                    {"choices", variable.choices},
                    {"lower", variable.lower},
                    {"upper", variable.upper},
                    {"start", variable.start},
                    {"logarithmic", variable.scale == Scale::logarithmic},
                    {"winner", winner.empty() ? json(nullptr) : finite_or_null(winner[i])},
                    {"best", json::array()},
                    {"q1", json::array()},
                    {"median", json::array()},
                    {"q3", json::array()}});
  }
  std::vector<double> values;
  for (std::size_t k = 0; k < history.parts.size() && !list.empty(); ++k) {
    const auto records = read_part(run, history.parts[k]);
    const EvaluationRecord* const best = find_best(description, records);
    for (std::size_t i = 0; i < list.size(); ++i) {
      values.clear();
      for (const EvaluationRecord& record : records) {
        values.push_back(record.x[i]);
      }
      const Spread spread = calc_spread(values);
      list[i]["best"].push_back(best == nullptr ? json(nullptr) : finite_or_null(best->x[i]));
      list[i]["q1"].push_back(finite_or_null(spread.lower_quartile));
      list[i]["median"].push_back(finite_or_null(spread.median));
      list[i]["q3"].push_back(finite_or_null(spread.upper_quartile));
    }
  }
  return list;
}

namespace {

// Returns the file of a design of the front, as winner.toml of the run would have it, and the command
// that evaluates it; null if the problem cannot be rebuilt or has no such files.
json make_saved_design(const RecordedRun& run, const Candidate& candidate) {
  if (!run.problem) {
    return nullptr;
  }
  const std::string name = fmt::format("front-{}.toml", candidate.evaluation);
  const std::string title =
      fmt::format("Evaluation {} of a run on {}", candidate.evaluation, run.problem_name);
  const std::string source =
      fmt::format("armwright, the front of the run in {}", run.folder.string());
  std::string text;
  if (const TrackingProblem* tracking = run.tracking()) {
    DesignFile file =
        make_design_file(tracking->config().robot, tracking->make_design(candidate.x));
    file.name = fmt::format("front-{}", candidate.evaluation);
    file.title = title;
    file.source = source;
    text = to_toml(file);
  } else if (has_values(*run.problem->problem)) {
    text = to_toml(ValuesFile{
        .title = title,
        .source = source,
        .variables = list_values(run.problem->problem->description().variables, candidate.x),
        .objectives = {}});
  } else {
    return nullptr;
  }
  return {{"name", name}, {"text", text}, {"command", run.make_evaluate_command(name, {})}};
}

}  // namespace

json make_front(const RecordedRun& run) {
  if (!run.result || run.result->objectives.size() < 2) {
    return nullptr;
  }
  const RunResult& result = *run.result;
  // Returns whether `a` is as good as `b` in failures and all objectives, with other objectives.
  const auto covers = [](const Evaluation& a, const Evaluation& b) {
    return a.failed_cases <= b.failed_cases && a.objectives != b.objectives &&
           std::ranges::equal(a.objectives, b.objectives, std::less_equal{});
  };
  json points = json::array();
  json winner = nullptr;
  for (std::size_t i = 0; i < result.judged.size(); ++i) {
    const Evaluation& evaluation = result.judged[i].validation;
    if (evaluation.objectives.empty()) {
      continue;
    }
    const bool covered = std::ranges::any_of(result.judged, [&](const JudgedCandidate& other) {
      return !other.validation.objectives.empty() && covers(other.validation, evaluation);
    });
    if (result.winner == i) {
      winner = points.size();
    }
    points.push_back({{"values", evaluation.objectives},
                      {"on_front", !covered},
                      {"x", result.judged[i].candidate.x},
                      {"evaluation", result.judged[i].candidate.evaluation},
                      {"file", make_saved_design(run, result.judged[i].candidate)}});
  }
  json objectives = json::array();
  for (const Quantity& objective : result.objectives) {
    objectives.push_back(run.make_quantity(objective));
  }
  return {{"objectives", std::move(objectives)},
          {"points", std::move(points)},
          {"winner", std::move(winner)}};
}

}  // namespace armwright
