#include "problems/tracking/tracking_objective.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/text.hpp"

namespace armwright {
namespace {

using Kind = TrackingObjective::Kind;
using Statistic = TrackingObjective::Statistic;

double calc_mean(std::span<const double> errors_m) {
  double sum = 0;
  for (const double error_m : errors_m) {
    sum += error_m;
  }
  return sum / static_cast<double>(errors_m.size());
}

double calc_cvar(std::span<const double> errors_m, double share) {
  std::vector<double> sorted(errors_m.begin(), errors_m.end());
  std::ranges::sort(sorted, std::ranges::greater());
  const double counted = share * static_cast<double>(sorted.size());
  const auto whole = std::min(static_cast<std::size_t>(counted), sorted.size());
  double sum = 0;
  for (std::size_t i = 0; i < whole; ++i) {
    sum += sorted[i];
  }
  if (whole < sorted.size()) {
    sum += (counted - static_cast<double>(whole)) * sorted[whole];
  }
  return sum / counted;
}

// Returns the sum of the terms without unit.
double calc_sum(const TrackingObjective& objective, const ObjectiveTerms& terms) {
  double sum = terms.error_m / objective.error_scale_m;
  if (objective.has_torque()) {
    sum += objective.torque_weight * terms.torque_n_m / objective.torque_scale_n_m;
  }
  if (objective.energy_weight > 0) {
    sum += objective.energy_weight * terms.energy_j / objective.energy_scale_j;
  }
  if (objective.duration_weight > 0) {
    sum += objective.duration_weight * terms.duration_s / objective.duration_scale_s;
  }
  return sum;
}

// Returns the name of the sum: "error, torque and energy".
std::string describe_sum(const TrackingObjective& objective) {
  std::vector<std::string> parts = {describe_error(objective)};
  if (objective.has_torque()) {
    parts.emplace_back("torque");
  }
  if (objective.energy_weight > 0) {
    parts.emplace_back("energy");
  }
  if (objective.duration_weight > 0) {
    parts.emplace_back("duration");
  }
  const std::string last = parts.back();
  parts.pop_back();
  return fmt::format("{} and {}", join(parts, ", "), last);
}

// A quantity of fronts: its key in files, its name and unit, and its number.
struct FrontRow {
  std::string key;
  Quantity named;  // the name of the error depends on its statistic
  double ObjectiveTerms::*value;
};

// Returns the quantities in the order of TrackingQuantity.
const std::vector<FrontRow>& front_table() {
  static const std::vector<FrontRow> table = {
      {"error", {"error", "m"}, &ObjectiveTerms::error_m},
      {"torque", {"total torque", "N m"}, &ObjectiveTerms::torque_n_m},
      {"energy", {"energy", "J"}, &ObjectiveTerms::energy_j},
      {"duration", {"duration", "s"}, &ObjectiveTerms::duration_s},
      {"peak_torque", {"peak torque", "N m"}, &ObjectiveTerms::peak_torque_n_m},
      {"rms_torque", {"RMS torque", "N m"}, &ObjectiveTerms::rms_torque_n_m},
      {"moving_mass", {"moving mass", "kg"}, &ObjectiveTerms::moving_mass_kg},
      {"deflection", {"deflection", "m"}, &ObjectiveTerms::deflection_m},
  };
  return table;
}

// Returns the name and unit of a quantity of a front.
Quantity describe_term(const TrackingObjective& objective, const WeightedQuantity& term,
                       std::span<const Quantity> required) {
  const std::vector<FrontRow>& table = front_table();
  if (term.quantity >= table.size()) {
    return required[term.quantity - table.size()];
  }
  Quantity named = table[term.quantity].named;
  if (term.quantity == static_cast<std::size_t>(TrackingQuantity::error)) {
    named.name = describe_error(objective);
  }
  return named;
}

double get_term(const WeightedQuantity& term, const ObjectiveTerms& terms) {
  const std::vector<FrontRow>& table = front_table();
  return term.quantity < table.size() ? terms.*table[term.quantity].value
                                      : terms.required[term.quantity - table.size()];
}

}  // namespace

const std::vector<std::string>& tracking_quantity_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> keys;
    for (const FrontRow& row : front_table()) {
      keys.push_back(row.key);
    }
    return keys;
  }();
  return names;
}

bool TrackingObjective::is_sum() const {
  return kind == Kind::error_and_torque ||
         (kind == Kind::error && (energy_weight > 0 || duration_weight > 0));
}

void TrackingObjective::set_front(std::vector<WeightedQuantity> terms) {
  kind = Kind::front;
  front = std::move(terms);
  torque_weight = energy_weight = duration_weight = 0;
  for (const WeightedQuantity& term : front) {
    switch (static_cast<TrackingQuantity>(term.quantity)) {
      case TrackingQuantity::error:
        error_scale_m = term.weight > 0 ? term.scale / term.weight : error_scale_m;
        break;
      case TrackingQuantity::torque:
        torque_weight = term.weight;
        torque_scale_n_m = term.scale;
        break;
      case TrackingQuantity::energy:
        energy_weight = term.weight;
        energy_scale_j = term.scale;
        break;
      case TrackingQuantity::duration:
        duration_weight = term.weight;
        duration_scale_s = term.scale;
        break;
      default:
        break;
    }
  }
}

bool TrackingObjective::has_in_front(TrackingQuantity quantity) const {
  return std::ranges::any_of(front, [&](const WeightedQuantity& term) {
    return term.quantity == static_cast<std::size_t>(quantity);
  });
}

bool TrackingObjective::has_torque() const {
  switch (kind) {
    case Kind::error:
    case Kind::error_with_torque_limit:
      return false;
    case Kind::front:
      return has_in_front(TrackingQuantity::torque);
    case Kind::error_and_torque:
    case Kind::torque_with_error_limit:
      break;
  }
  return true;
}

bool TrackingObjective::has_residuals() const {
  if (kind == Kind::front) {
    // A term that is no mean of squares has no residual, and an error that does not count has no scale.
    const auto has_residual = [](const WeightedQuantity& term) {
      const auto quantity = static_cast<TrackingQuantity>(term.quantity);
      return quantity == TrackingQuantity::error ? term.weight > 0
                                                 : quantity <= TrackingQuantity::duration;
    };
    return statistic == Statistic::mean && has_in_front(TrackingQuantity::error) &&
           std::ranges::all_of(front, has_residual);
  }
  return statistic == Statistic::mean && kind != Kind::torque_with_error_limit &&
         kind != Kind::error_with_torque_limit;
}

std::string describe_error(const TrackingObjective& objective) {
  switch (objective.statistic) {
    case Statistic::mean:
      break;
    case Statistic::worst:
      return "worst error";
    case Statistic::cvar:
      return fmt::format("error of the worst {:g} %", 100 * objective.cvar_share);
    case Statistic::mean_with_failures:
      return "error with failures";
  }
  return "error";
}

std::vector<Quantity> describe_objectives(const TrackingObjective& objective,
                                          std::span<const Quantity> required) {
  const auto describe = [&](const std::string& name, const std::string& unit) {
    if (!objective.logarithm) {
      return Quantity{name, unit};
    }
    return Quantity{
        unit == "1" ? fmt::format("ln({})", name) : fmt::format("ln({} / 1 {})", name, unit), "1"};
  };
  if (objective.is_sum()) {
    return {describe(describe_sum(objective), "1")};
  }
  switch (objective.kind) {
    case Kind::front: {
      std::vector<Quantity> objectives;
      for (const WeightedQuantity& term : objective.front) {
        objectives.push_back(describe_term(objective, term, required));
      }
      return objectives;
    }
    case Kind::torque_with_error_limit:
      return {describe("total torque", "N m")};
    case Kind::error:
    case Kind::error_and_torque:
    case Kind::error_with_torque_limit:
      break;
  }
  return {describe(describe_error(objective), "m")};
}

double calc_resolution(const TrackingObjective& objective) {
  const double share = kErrorResolution_m / objective.error_scale_m;
  switch (objective.kind) {
    case Kind::front:  // of the weighted sum
      return objective.has_in_front(TrackingQuantity::error) ? share : 0;
    case Kind::torque_with_error_limit:
      return objective.torque_scale_n_m * share;
    case Kind::error:
    case Kind::error_and_torque:
    case Kind::error_with_torque_limit:
      break;
  }
  return objective.is_sum() ? share : kErrorResolution_m;
}

double calc_error_statistic(const TrackingObjective& objective, std::span<const double> errors_m,
                            double lost_share) {
  switch (objective.statistic) {
    case Statistic::mean:
      break;
    case Statistic::worst:
      return std::ranges::max(errors_m);
    case Statistic::cvar:
      return calc_cvar(errors_m, objective.cvar_share);
    case Statistic::mean_with_failures:
      return calc_mean(errors_m) + objective.failure_penalty_m * lost_share;
  }
  return calc_mean(errors_m);
}

std::vector<double> calc_objectives(const TrackingObjective& objective,
                                    const ObjectiveTerms& terms) {
  // Far below the value of any arm; it keeps the logarithm finite.
  constexpr double kLeast = 1e-300;
  const auto apply_scale = [&](double value) {
    return objective.logarithm ? std::log(std::max(value, kLeast)) : value;
  };
  if (objective.is_sum()) {
    return {apply_scale(calc_sum(objective, terms))};
  }
  switch (objective.kind) {
    case Kind::front: {
      std::vector<double> objectives;
      for (const WeightedQuantity& term : objective.front) {
        objectives.push_back(get_term(term, terms));
      }
      return objectives;
    }
    case Kind::torque_with_error_limit:
      return {apply_scale(terms.torque_n_m)};
    case Kind::error:
    case Kind::error_and_torque:
    case Kind::error_with_torque_limit:
      break;
  }
  return {apply_scale(terms.error_m)};
}

std::vector<double> calc_constraints(const TrackingObjective& objective,
                                     const ObjectiveTerms& terms) {
  std::vector<double> constraints;
  if (objective.error_limit_m > 0) {
    constraints.push_back(terms.error_m / objective.error_limit_m - 1);
  }
  if (objective.total_torque_limit_n_m > 0) {
    constraints.push_back(terms.torque_n_m / objective.total_torque_limit_n_m - 1);
  }
  return constraints;
}

std::vector<double> calc_residuals(const TrackingObjective& objective, const ArmDesign& design,
                                   const ObjectiveTerms& terms,
                                   std::span<const CaseOutcome> outcomes, double cases) {
  // The residuals of a front are those of its weighted sum.
  const bool has_scale = objective.is_sum() || objective.kind == Kind::front;
  std::vector<double> residuals;
  for (const CaseOutcome& outcome : outcomes) {
    const double share = cases * static_cast<double>(outcome.residuals.size()) *
                         (has_scale ? objective.error_scale_m : 1);
    for (const double error_m : outcome.residuals) {
      residuals.push_back(std::sqrt(error_m / share));
    }
  }
  if (objective.has_torque()) {
    for (const JointDrive& joint : design.joints) {
      residuals.push_back(std::sqrt(objective.torque_weight * calc_largest_effort(joint) /
                                    objective.torque_scale_n_m));
    }
  }
  if (objective.energy_weight > 0) {
    residuals.push_back(
        std::sqrt(objective.energy_weight * terms.energy_j / objective.energy_scale_j));
  }
  if (objective.duration_weight > 0) {
    residuals.push_back(
        std::sqrt(objective.duration_weight * terms.duration_s / objective.duration_scale_s));
  }
  return residuals;
}

std::vector<double> calc_jacobian(const TrackingObjective& objective, const ArmDesign& design,
                                  std::span<const ArmDesign> directions,
                                  std::span<const CaseOutcome> outcomes,
                                  std::span<const double> residuals) {
  std::vector<double> jacobian;
  const std::size_t n = directions.size();
  // For a residual r = sqrt(c v) of a value v: dr = r / (2 v) dv.
  const auto calc_share = [](double residual, double value) {
    return value > 0 ? residual / (2 * value) : 0;
  };
  std::size_t row = 0;
  for (const CaseOutcome& outcome : outcomes) {
    if (!outcome.has_error) {
      continue;
    }
    if (outcome.jacobian.empty()) {
      return {};  // the jobs did not ask for derivatives
    }
    for (std::size_t k = 0; k < outcome.residuals.size(); ++k, ++row) {
      const double share = calc_share(residuals[row], outcome.residuals[k]);
      for (std::size_t i = 0; i < n; ++i) {
        jacobian.push_back(share * outcome.jacobian[k * n + i]);
      }
    }
  }
  const std::size_t drives = objective.has_torque() ? design.joints.size() : 0;
  for (std::size_t joint = 0; joint < drives; ++joint, ++row) {
    const EffortLimits& limits = design.joints[joint].limits;
    const double share = calc_share(residuals[row], calc_largest_effort(design.joints[joint]));
    for (const ArmDesign& direction : directions) {
      const EffortLimits& change = direction.joints[joint].limits;
      jacobian.push_back(share * (-limits.min < limits.max ? change.max : -change.min));
    }
  }
  jacobian.resize(residuals.size() * n, 0.0);  // the duration does not depend on the gains
  return jacobian;
}

}  // namespace armwright
