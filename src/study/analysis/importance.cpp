#include "study/analysis/importance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <nlohmann/json.hpp>
#include <numeric>
#include <span>
#include <utility>

#include "base/error.hpp"
#include "base/folder.hpp"
#include "base/text.hpp"
#include "optimizers/interface/search_space.hpp"
#include "problems/user/user_problem.hpp"
#include "study/executor/case_executor.hpp"
#include "study/journal/journal.hpp"
#include "study/run/run.hpp"
#include "study/statistics/values.hpp"

namespace armwright {
namespace {

namespace fs = std::filesystem;

constexpr double kHalfWidth = 0.1;            // of the region near the winner
constexpr std::size_t kMostPoints = 1000;     // of a model; more would only take time
constexpr std::size_t kFewestNear = 200;      // points near the winner, or
constexpr std::size_t kNearPerVariable = 20;  // this many per variable
constexpr std::size_t kFewestRows = 8;        // of a design
constexpr const char* kRegionNames[] = {"run", "winner", "design"};
constexpr const char* kScaleNames[] = {"plain", "logarithm", "ranks"};
constexpr const char* kTermNames[] = {"linear", "squares", "products"};

// Of longer runs only every 2nd, 4th, ... usable evaluation is kept, so that ten million of them take
// no more memory than this many.
constexpr std::size_t kMostKept = 65'536;

// The evaluations of a run that an analysis can use, as coordinates of SearchSpace divided by the
// width of the box.
struct RecordedPoints {
  SearchSpace space;
  JournalContent journal;
  std::vector<std::size_t> numbers = {};  // of the usable evaluations
  std::vector<double> values = {};
  std::vector<double> winner = {};  // a decision vector; empty if the run has no number
  std::size_t left_out = 0;
  std::size_t usable = 0;  // kept or not

  std::vector<double> calc_shares(std::span<const double> x) const {
    std::vector<double> shares = space.to_coordinates(x);
    for (std::size_t i = 0; i < shares.size(); ++i) {
      const double width = space.upper()[i] - space.lower()[i];
      shares[i] = width > 0 ? (shares[i] - space.lower()[i]) / width : 0.5;
    }
    return shares;
  }
};

RecordedPoints read_points(const fs::path& folder, const ProblemDescription& description) {
  RecordedPoints points{.space = SearchSpace(description.variables),
                        .journal = read_journal(folder / "journal")};
  double best = kInfinity;
  std::size_t stride = 1;
  for (std::size_t number = 0; number < points.journal.training.size(); ++number) {
    const EvaluationRecord record = points.journal.training[number];
    const bool is_whole = record.evaluation.status == EvaluationStatus::ok &&
                          !record.evaluation.objectives.empty() &&
                          record.x.size() == description.variables.size();
    const double value =
        is_whole ? calc_scalar(description, record.evaluation.objectives) : kInfinity;
    if (!std::isfinite(value)) {
      ++points.left_out;
      continue;
    }
    if (points.usable++ % stride == 0) {
      points.numbers.push_back(number);
      points.values.push_back(value);
    }
    if (points.numbers.size() > kMostKept) {
      stride *= 2;
      for (std::size_t i = 0; 2 * i < points.numbers.size(); ++i) {
        points.numbers[i] = points.numbers[2 * i];
        points.values[i] = points.values[2 * i];
      }
      points.numbers.resize((points.numbers.size() + 1) / 2);
      points.values.resize(points.numbers.size());
    }
    if (value < best && is_feasible(record.evaluation)) {
      best = value;
      points.winner = record.x;
    }
  }
  if (path_exists(folder / "result.json")) {
    const RunResult result = load_result(folder);
    if (result.winner) {
      points.winner = result.judged[*result.winner].candidate.x;
    }
  }
  return points;
}

// The tail is heavy if the upper half of the middle 90 % is this many times as long as the lower.
ValueScale choose_scale(std::span<const double> values) {
  constexpr double kHeavy = 10;
  const double low = calc_quantile(values, 0.05);
  const double middle = calc_quantile(values, 0.5);
  const double high = calc_quantile(values, 0.95);
  if (high - middle <= kHeavy * (middle - low)) {
    return ValueScale::plain;
  }
  return std::ranges::min(values) > 0 ? ValueScale::logarithm : ValueScale::ranks;
}

std::vector<double> apply_scale(ValueScale scale, std::vector<double> values) {
  if (scale == ValueScale::logarithm) {
    for (double& value : values) {
      value = std::log(value);
    }
  } else if (scale == ValueScale::ranks) {
    std::vector<double> sorted = values;
    std::ranges::sort(sorted);
    for (double& value : values) {
      // Equal values have the mean of their ranks.
      const auto [first, last] = std::ranges::equal_range(sorted, value);
      value = 0.5 * static_cast<double>((first - sorted.begin()) + (last - sorted.begin()));
    }
  }
  return values;
}

// Returns at most kMostPoints of the places, evenly spread.
std::vector<std::size_t> thin_out(std::vector<std::size_t> places) {
  if (places.size() <= kMostPoints) {
    return places;
  }
  std::vector<std::size_t> fewer;
  for (std::size_t i = 0; i < kMostPoints; ++i) {
    fewer.push_back(places[i * (places.size() - 1) / (kMostPoints - 1)]);
  }
  return fewer;
}

std::string judge(double explained) {
  const double percent = 100 * std::max(0.0, explained);
  if (explained < kEnoughExplained) {
    return fmt::format(
        "A model explains only {:.0f} % of the differences: too little. Do not rely on these "
        "numbers.",
        percent);
  }
  return fmt::format("A model explains {:.0f} % of the differences: {}.", percent,
                     explained < 0.8 ? "rely on the order of the largest, not on the numbers"
                                     : "the numbers can be relied on within their intervals");
}

// Fits a model to the points at `places` of points.numbers. Adds a part, or a note without one.
void add_model(const RecordedPoints& points, ImportancePart part,
               const std::vector<std::size_t>& places, Importance& importance) {
  std::vector<std::vector<double>> rows;
  std::vector<double> values;
  for (const std::size_t place : thin_out(places)) {
    rows.push_back(points.calc_shares(points.journal.training[points.numbers[place]].x));
    values.push_back(points.values[place]);
  }
  const auto model =
      calc_model_sensitivity(rows, apply_scale(importance.scale, std::move(values)), "importance");
  if (!model) {
    importance.notes.push_back(fmt::format(
        "There is no analysis {}: its {} are too few, or all equal.", describe_region(part),
        rows.size() == 1 ? "1 evaluation" : fmt::format("{} evaluations", rows.size())));
    return;
  }
  part.points = rows.size();
  part.explained = model->explained;
  part.terms = model->terms;
  part.judgement = judge(model->explained);
  part.variables = model->variables;
  importance.parts.push_back(std::move(part));
}

void add_near_winner(const RecordedPoints& points, Importance& importance) {
  const std::vector<double> winner = points.calc_shares(points.winner);
  std::vector<double> distances;
  for (const std::size_t number : points.numbers) {
    const std::vector<double> shares = points.calc_shares(points.journal.training[number].x);
    double distance = 0;
    for (std::size_t i = 0; i < shares.size(); ++i) {
      distance = std::max(distance, std::abs(shares[i] - winner[i]));
    }
    distances.push_back(distance);
  }
  std::vector<double> sorted = distances;
  std::ranges::sort(sorted);
  const std::size_t wanted = std::max(kFewestNear, kNearPerVariable * winner.size());
  const double half_width = std::max(kHalfWidth, sorted[std::min(wanted, sorted.size()) - 1]);
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    if (distances[i] <= half_width) {
      places.push_back(i);
    }
  }
  if (places.size() == distances.size()) {
    importance.notes.push_back(
        "All evaluations are as near to the winner as an analysis of its neighbourhood needs, so "
        "that the run has one part only.");
    return;
  }
  add_model(points, {.region = ImportanceRegion::winner, .half_width = half_width}, places,
            importance);
}

// Returns the variables with bounds around the winner. A discrete one has its neighbours, and a
// category all of its words, in half a step more than their values.
std::vector<DecisionVariable> bound_around(const RecordedPoints& points,
                                           std::vector<DecisionVariable> variables) {
  const std::vector<double> shares = points.calc_shares(points.winner);
  std::vector<double> lower = points.space.lower();
  std::vector<double> upper = points.space.upper();
  for (std::size_t i = 0; i < variables.size(); ++i) {
    const double width = upper[i] - lower[i];
    const double from = lower[i];
    lower[i] = from + std::max(0.0, shares[i] - kHalfWidth) * width;
    upper[i] = from + std::min(1.0, shares[i] + kHalfWidth) * width;
  }
  lower = points.space.to_point(lower);
  upper = points.space.to_point(upper);
  for (std::size_t i = 0; i < variables.size(); ++i) {
    DecisionVariable& variable = variables[i];
    if (variable.type == VariableType::real) {
      variable.lower = std::clamp(std::min(lower[i], upper[i]), variable.lower, variable.upper);
      variable.upper = std::clamp(std::max(lower[i], upper[i]), variable.lower, variable.upper);
    } else {
      const double reach =
          std::max(1.0, std::floor(kHalfWidth * (variable.upper - variable.lower)));
      const bool has_all = variable.type == VariableType::category;
      const double least =
          has_all ? variable.lower : std::max(variable.lower, points.winner[i] - reach);
      const double most =
          has_all ? variable.upper : std::min(variable.upper, points.winner[i] + reach);
      variable.lower = least - 0.5;
      variable.upper = most + 0.5;
      variable.scale = Scale::linear;
    }
    variable.start = points.winner[i];
  }
  return variables;
}

nlohmann::json to_json_interval(double value, const Interval& interval) {
  return {{"value", value}, {"lower", interval.lower}, {"upper", interval.upper}};
}

}  // namespace

Importance calc_importance(const fs::path& folder, const ProblemDescription& description) {
  const RecordedPoints points = read_points(folder, description);
  Importance importance;
  importance.objective = get_scalar_quantity(description.objectives);
  importance.evaluations = points.usable;
  importance.left_out = points.left_out;
  for (const DecisionVariable& variable : description.variables) {
    importance.variables.push_back(variable.name);
  }
  if (!description.constraints.empty()) {
    importance.notes.push_back(
        "The objective alone is analysed, without the constraints and their violation.");
  }
  if (points.values.empty()) {
    importance.notes.push_back("No evaluation of the run has an objective yet.");
    return importance;
  }
  importance.scale = choose_scale(points.values);
  if (!points.winner.empty()) {
    add_near_winner(points, importance);
  }
  std::vector<std::size_t> all(points.numbers.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  add_model(points, {.region = ImportanceRegion::run}, all, importance);
  return importance;
}

bool add_simulated_importance(const fs::path& folder, const Problem& problem,
                              std::int64_t simulations, unsigned jobs, StopSignal& stop,
                              RunObserver& observer, Importance& importance) {
  require_server(problem);
  const RecordedPoints points = read_points(folder, problem.description());
  if (points.winner.empty() || points.numbers.empty()) {
    throw Error(ErrorKind::usage,
                fmt::format("{}: the run has no design with a number yet, around which designs "
                            "could be simulated",
                            sanitize(folder.string())));
  }
  CaseBlock block = points.journal.training.front().cases;
  const std::size_t n = points.winner.size();
  const std::size_t per_row = (n + 2) * block.numbers.size();
  const std::size_t rows =
      static_cast<std::size_t>(std::max(std::int64_t{0}, simulations)) / per_row;
  if (rows < kFewestRows) {
    throw Error(ErrorKind::usage,
                fmt::format("--simulations is {}; a design for {} variables on {} training {} "
                            "needs at least {}",
                            simulations, n, block.numbers.size(),
                            block.numbers.size() == 1 ? "case" : "cases", kFewestRows * per_row));
  }
  const std::vector<DecisionVariable> variables =
      bound_around(points, problem.description().variables);
  const SearchSpace space(variables);
  std::vector<std::vector<double>> designs =
      make_sensitivity_design(space.lower(), space.upper(), rows, "importance/design");
  std::vector<std::span<const double>> candidates;
  for (std::vector<double>& design : designs) {
    design = space.to_point(design);
    for (std::size_t i = 0; i < n; ++i) {
      design[i] = settle_value(problem.description().variables[i], design[i]);
    }
    candidates.emplace_back(design);
  }
  std::vector<double> values(designs.size(), std::numeric_limits<double>::quiet_NaN());
  Progress progress{.phase = CaseRole::training, .total = candidates.size() * block.numbers.size()};
  std::mutex mutex;  // guards the progress
  ThreadExecutor executor(jobs);
  executor.evaluate(problem, candidates, block, {}, stop,
                    [&](std::size_t candidate, const Evaluation& evaluation) {
                      const double value =
                          evaluation.status == EvaluationStatus::ok &&
                                  !evaluation.objectives.empty()
                              ? calc_scalar(problem.description(), evaluation.objectives)
                              : kInfinity;
                      if (std::isfinite(value)) {
                        values[candidate] = value;
                      }
                      const std::lock_guard lock(mutex);
                      progress.done += block.numbers.size();
                      observer.on_progress(progress);
                    });
  if (stop.requested()) {
    return false;
  }
  std::vector<std::size_t> known;
  std::vector<double> numbers;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isnan(values[i])) {
      known.push_back(i);
      numbers.push_back(values[i]);
    }
  }
  // The scale of the run, if the new values allow it.
  const bool is_positive = !numbers.empty() && std::ranges::min(numbers) > 0;
  const ValueScale scale = importance.scale == ValueScale::logarithm && !is_positive
                               ? ValueScale::ranks
                               : importance.scale;
  numbers = apply_scale(scale, std::move(numbers));
  for (std::size_t i = 0; i < known.size(); ++i) {
    values[known[i]] = numbers[i];
  }
  ImportancePart part{
      .region = ImportanceRegion::design, .half_width = kHalfWidth, .points = designs.size()};
  const auto indices = calc_design_sensitivity(values, n, "importance/design");
  if (!indices) {
    importance.notes.push_back(
        "The simulated designs give no analysis: too many failed, or all of their values are "
        "equal.");
    return true;
  }
  part.judgement = fmt::format("{} designs were simulated, {} of them failed; no model is used.",
                               designs.size(), designs.size() - known.size());
  part.variables = *indices;
  importance.parts.insert(importance.parts.begin(), std::move(part));
  return true;
}

std::string describe_region(const ImportancePart& part) {
  if (!part.half_width) {
    return "over the whole run";
  }
  return fmt::format("near the winner, within {:.0f} % of each variable's range",
                     100 * *part.half_width);
}

std::string describe_scale(const Importance& importance) {
  switch (importance.scale) {
    case ValueScale::plain:
      return importance.objective.name;
    case ValueScale::logarithm:
      return fmt::format("the logarithm of {}", importance.objective.name);
    case ValueScale::ranks:
      break;
  }
  return fmt::format("the ranks of {}", importance.objective.name);
}

std::string to_json(const Importance& importance) {
  nlohmann::json parts = nlohmann::json::array();
  for (const ImportancePart& part : importance.parts) {
    nlohmann::json variables = nlohmann::json::array();
    for (std::size_t i = 0; i < part.variables.size(); ++i) {
      const SobolIndices& one = part.variables[i];
      variables.push_back({{"name", sanitize(importance.variables[i])},
                           {"first", to_json_interval(one.first, one.first_interval)},
                           {"total", to_json_interval(one.total, one.total_interval)}});
    }
    nlohmann::json item = {{"region", kRegionNames[static_cast<int>(part.region)]},
                           {"words", describe_region(part)},
                           {"half_width", nullptr},
                           {"points", part.points},
                           {"explained", nullptr},
                           {"terms", nullptr},
                           {"judgement", part.judgement},
                           {"variables", std::move(variables)}};
    if (part.half_width) {
      item["half_width"] = *part.half_width;
    }
    if (part.explained) {
      item["explained"] = *part.explained;
      item["terms"] = kTermNames[static_cast<int>(part.terms)];
    }
    parts.push_back(std::move(item));
  }
  const nlohmann::json all = {{"objective",
                               {{"name", sanitize(importance.objective.name)},
                                {"unit", sanitize(importance.objective.unit)}}},
                              {"scale", kScaleNames[static_cast<int>(importance.scale)]},
                              {"value", sanitize(describe_scale(importance))},
                              {"evaluations", importance.evaluations},
                              {"left_out", importance.left_out},
                              {"parts", std::move(parts)},
                              {"notes", importance.notes}};
  return all.dump(1) + "\n";
}

}  // namespace armwright
