#include "optimizers/differences.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace armwright {

DifferencedFunction::Shift DifferencedFunction::add_shifts(
    const std::vector<double>& base, std::size_t variable,
    std::vector<std::vector<double>>& batch) const {
  const double lower = space().lower()[variable];
  const double upper = space().upper()[variable];
  const double step = settings_.step * (upper - lower);
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
  if (settings_.central || !shift.above) {
    shift.below = add(base[variable] - step);
  }
  return shift;
}

std::vector<Score> DifferencedFunction::evaluate(const std::vector<std::vector<double>>& batch) {
  std::vector<Score> scores = function_.evaluate_batch(batch);
  const auto calc = [&](const Score& score) {
    return calc_scalar(function_.evaluator().problem(), score.objectives);
  };
  for (std::size_t i = 0; i < batch.size(); ++i) {
    if (scores[i].status == EvaluationStatus::ok &&
        (!best_ || calc(scores[i]) < calc(best_->score))) {
      best_ = {batch[i], scores[i]};
    }
  }
  return scores;
}

const DifferencedFunction::Place& DifferencedFunction::look_at(
    const std::vector<double>& coordinates, bool with_derivatives) {
  const auto known = places_.find(coordinates);
  const bool is_known = known != places_.end();
  if (is_known &&
      (!with_derivatives || known->second.values.empty() || !known->second.derivatives.empty())) {
    return known->second;
  }
  std::vector<std::vector<double>> batch;
  if (!is_known) {
    batch.push_back(coordinates);
  }
  std::vector<Shift> shifts;
  if (with_derivatives) {
    for (std::size_t i = 0; i < coordinates.size(); ++i) {
      shifts.push_back(add_shifts(coordinates, i, batch));
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
  // A side's position and values, the base's own where there is nothing usable.
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
