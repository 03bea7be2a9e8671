#include "optimizers/interface/differences.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

namespace armwright {
namespace {

struct Shift {
  std::optional<std::size_t> above;  // places in the batch
  std::optional<std::size_t> below;
};

// Adds the points that one variable's derivative needs to the batch.
Shift add_shifts(const SearchSpace& space, const DifferenceSettings& settings,
                 const std::vector<double>& base, std::size_t variable,
                 std::vector<std::vector<double>>& batch) {
  const double lower = space.lower()[variable];
  const double upper = space.upper()[variable];
  const double step = settings.step * (upper - lower);
  const auto add = [&](double coordinate) -> std::optional<std::size_t> {
    if (coordinate < lower || coordinate > upper) {
      return std::nullopt;
    }
    batch.push_back(base);
    batch.back()[variable] = coordinate;
    return batch.size() - 1;
  };
  Shift shift;
  shift.above = add(base[variable] + step);
  if (settings.central || !shift.above) {
    shift.below = add(base[variable] - step);
  }
  return shift;
}

}  // namespace

OptionSpec make_differences_option(const char* fallback) {
  return {.name = "differences",
          .description = "of the derivatives: forward (a point for each variable) or central (two)",
          .fallback = std::string(fallback),
          .choices = {"forward", "central"}};
}

DifferenceSettings read_differences(const Options& options) {
  return {.central = options.get_text("differences") == "central",
          .step = options.get_number("step")};
}

std::vector<Score> DifferencedFunction::evaluate(const std::vector<std::vector<double>>& batch) {
  std::vector<Score> scores = function_.evaluate_batch(batch);
  for (std::size_t i = 0; i < batch.size(); ++i) {
    remember_best(batch[i], scores[i]);
  }
  return scores;
}

void DifferencedFunction::remember_best(const std::vector<double>& coordinates,
                                        const Score& score) {
  const auto calc = [&](const Score& one) {
    return calc_scalar(function_.evaluator().problem(), one.objectives);
  };
  if (score.status == EvaluationStatus::ok && (!best_ || calc(score) < calc(best_->score))) {
    best_ = {coordinates, score};
  }
}

const DifferencedFunction::Place& DifferencedFunction::evaluate_exactly(
    const std::vector<double>& coordinates) {
  const Score score = function_.evaluate_with_jacobian(coordinates);
  remember_best(coordinates, score);
  Place& place = places_[coordinates];
  place.values = values_of_(score);
  const std::vector<double> residual_slopes = residual_slopes_(score);
  const std::vector<double> point_slopes = space().calc_point_slopes(coordinates);
  const std::size_t n = coordinates.size();
  if (place.values.empty() || score.jacobian.size() != place.values.size() * n) {
    place.values.clear();  // a place without derivatives is of no use
    return place;
  }
  place.derivatives.assign(n, std::vector<double>(place.values.size()));
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < place.values.size(); ++k) {
      const double slope = residual_slopes[k] * score.jacobian[k * n + i] * point_slopes[i];
      place.derivatives[i][k] = std::isfinite(slope) ? slope : 0;
    }
  }
  return place;
}

const DifferencedFunction::Place& DifferencedFunction::evaluate_place(
    const std::vector<double>& coordinates, bool with_derivatives) {
  const auto known = places_.find(coordinates);
  const bool is_known = known != places_.end();
  if (is_known &&
      (!with_derivatives || known->second.values.empty() || !known->second.derivatives.empty())) {
    return known->second;
  }
  if (with_derivatives && residual_slopes_) {
    return evaluate_exactly(coordinates);
  }
  std::vector<std::vector<double>> batch;
  if (!is_known) {
    batch.push_back(coordinates);
  }
  std::vector<Shift> shifts;
  if (with_derivatives) {
    for (std::size_t i = 0; i < coordinates.size(); ++i) {
      shifts.push_back(add_shifts(space(), settings_, coordinates, i, batch));
    }
  }
  const std::vector<Score> scores = evaluate(batch);
  Place& place = is_known ? known->second : places_[coordinates];
  if (!is_known) {
    place.values = values_of_(scores.front());
  }
  if (!with_derivatives || place.values.empty()) {
    return place;
  }
  // The position and values of one side; those of the base point if the side is not usable.
  const auto look = [&](std::optional<std::size_t> side, std::size_t variable) {
    if (side) {
      std::vector<double> values = values_of_(scores[*side]);
      if (values.size() == place.values.size()) {
        return std::pair(batch[*side][variable], std::move(values));
      }
    }
    return std::pair(coordinates[variable], place.values);
  };
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    const auto [top, values_above] = look(shifts[i].above, i);
    const auto [bottom, values_below] = look(shifts[i].below, i);
    std::vector<double> column(place.values.size(), 0.0);
    for (std::size_t k = 0; k < column.size() && top > bottom; ++k) {
      const double slope = (values_above[k] - values_below[k]) / (top - bottom);
      column[k] = std::isfinite(slope) ? slope : 0;
    }
    place.derivatives.push_back(std::move(column));
  }
  return place;
}

}  // namespace armwright
