// Reads a problem's objective: the metrics, their weights and the limits.

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/text.hpp"
#include "problems/config/problem_readers.hpp"
#include "problems/tracking/tracking_config.hpp"

namespace armwright {
namespace {

constexpr Range kPositive{.lower = 0, .upper = 1e12, .lower_open = true};
constexpr Range kWeight{.lower = 0, .upper = 1e6};
constexpr const char* kErrorVsTorque = "error_vs_torque";

const Setting<bool> kObjectiveLogarithm{
    "logarithm", false,
    "whether the natural logarithm of the objective is minimised; the minimiser is the same"};
const Setting<std::string> kObjectiveStatistic{
    "statistic", one_of({"mean", "worst", "cvar", "mean_with_failures"}),  // as in the enum
    "mean", "how the errors of the cases become one number"};
const Setting<double> kObjectiveCvarShare{
    "cvar_share",
    {.lower = 0, .upper = 1, .lower_open = true},
    TrackingObjective{}.cvar_share,
    "for the statistic cvar: share of the worst cases whose mean counts"};
const Setting<double> kObjectiveFailurePenalty{
    "failure_penalty_m", kPositive, TrackingObjective{}.failure_penalty_m,
    "for mean_with_failures: what is added if every case fails; in proportion for fewer"};
const Setting<double> kObjectiveTorqueWeight{"torque_weight", kWeight, 1,
                                             "for error_and_torque: weight of the total torque"};
const Setting<double> kObjectiveTorqueScale{"torque_scale_n_m", kPositive,
                                            TrackingObjective{}.torque_scale_n_m,
                                            "total torque that counts 1"};
const Setting<double> kObjectiveErrorScale{
    "error_scale_m", kPositive, TrackingObjective{}.error_scale_m, "error that counts 1"};
const Setting<double> kObjectiveEnergyWeight{
    "energy_weight", kWeight, 0, "for error and error_and_torque: weight of the energy"};
const Setting<double> kObjectiveEnergyScale{
    "energy_scale_j", kPositive, kNoDefault,
    "energy that counts 1; required if its weight is above 0"};
const Setting<double> kObjectiveDurationWeight{
    "duration_weight", kWeight, 0, "for error and error_and_torque: weight of the duration"};
const Setting<double> kObjectiveDurationScale{
    "duration_scale_s", kPositive, kNoDefault,
    "duration that counts 1; required if its weight is above 0"};
const Setting<double> kObjectiveErrorLimit{"error_limit_m", kPositive, kNoDefault,
                                           "for torque_with_error_limit and front: largest error"};
const Setting<double> kObjectiveTorqueLimit{
    "total_torque_limit_n_m", kPositive, kNoDefault,
    "for error_with_torque_limit and front: largest total torque"};

const Setting<std::vector<double>> kObjectiveWeights{
    "weights", Range{.lower = 0, .upper = 1e12}, std::vector<double>{},
    "one weight per quantity, in their weighted sum (default: 1)"};
const Setting<std::vector<double>> kObjectiveScales{
    "scales", Range{.lower = 0, .upper = 1e12, .lower_open = true}, std::vector<double>{},
    "what of each quantity counts 1 in that sum (default: 1; in a front, error_scale_m and "
    "torque_scale_n_m of these two, and the limit of a requirement)"};

void read_statistic(const ConfigTable& table, TrackingObjective& objective) {
  objective.statistic =
      static_cast<TrackingObjective::Statistic>(table.get_choice(kObjectiveStatistic));
  for (const auto* setting : {&kObjectiveCvarShare, &kObjectiveFailurePenalty}) {
    if (table.has(*setting) && !table.has(kObjectiveStatistic)) {
      table.refuse(*setting,
                   "it does nothing to the mean; set objective.statistic to cvar or "
                   "mean_with_failures, or leave it out");
    }
  }
  objective.cvar_share = table.get(kObjectiveCvarShare);
  objective.failure_penalty_m = table.get(kObjectiveFailurePenalty);
}

// Reads one term of the objective's sum: its weight and, if that is not 0, its scale.
void read_term(const ConfigTable& table, const Setting<double>& weight_setting,
               const Setting<double>& scale_setting, const TrackingObjective& objective,
               double& weight, double& scale) {
  weight = table.get(weight_setting);
  if (weight == 0) {
    table.has(scale_setting);  // the scale may stay in the file while the weight is 0
    return;
  }
  if (objective.kind != TrackingObjective::Kind::error &&
      objective.kind != TrackingObjective::Kind::error_and_torque) {
    table.refuse(weight_setting,
                 "only the kinds error and error_and_torque are sums; choose one of them or leave "
                 "it out");
  }
  scale = table.get(scale_setting);
}

}  // namespace

const Setting<std::string> kObjectiveKind{
    "kind",
    // in the order of the enum, with a front of 1.0 at the end
    one_of({"error", "error_and_torque", "torque_with_error_limit", "error_with_torque_limit",
            "front", kErrorVsTorque}),
    "error",
    "what is minimised: one number, or each of objective.quantities (front). error_vs_torque is "
    "the front of these two. For the kind motion: sum (the default) or front"};

const Setting<std::vector<std::string>> kObjectiveQuantities{
    "quantities", kNoDefault,
    "what is minimised. In a front: error, torque, energy, duration, peak_torque, rms_torque, "
    "moving_mass, deflection (of [tubes]), and the quantity of a [[requirement]]. For the kind "
    "motion: duration (the default), jerk, energy, peak_torque, rms_torque, clearance (made "
    "large), deflection and tool_speed"};

const SettingTable kObjectiveSettings{
    .key = "objective",
    .settings = {&kObjectiveKind, &kObjectiveLogarithm, &kObjectiveStatistic, &kObjectiveCvarShare,
                 &kObjectiveFailurePenalty, &kObjectiveTorqueWeight, &kObjectiveTorqueScale,
                 &kObjectiveErrorScale, &kObjectiveEnergyWeight, &kObjectiveEnergyScale,
                 &kObjectiveDurationWeight, &kObjectiveDurationScale, &kObjectiveErrorLimit,
                 &kObjectiveTorqueLimit, &kObjectiveQuantities, &kObjectiveWeights,
                 &kObjectiveScales}};

TrackingObjective read_objective(const ConfigTable& table) {
  using Kind = TrackingObjective::Kind;
  TrackingObjective objective;
  objective.kind = static_cast<Kind>(
      std::min(table.get_choice(kObjectiveKind), static_cast<std::size_t>(Kind::front)));
  objective.logarithm = table.get(kObjectiveLogarithm);
  if (objective.logarithm && objective.kind == Kind::front) {
    table.refuse(kObjectiveLogarithm,
                 "the objectives of a front are compared as they are; leave it out");
  }
  objective.torque_weight = table.get(kObjectiveTorqueWeight);
  objective.error_scale_m = table.get(kObjectiveErrorScale);
  objective.torque_scale_n_m = table.get(kObjectiveTorqueScale);
  // A limit of another kind is not read and so refused, because it would limit nothing.
  if (objective.kind == Kind::torque_with_error_limit) {
    objective.error_limit_m = table.get(kObjectiveErrorLimit);
  }
  if (objective.kind == Kind::error_with_torque_limit) {
    objective.total_torque_limit_n_m = table.get(kObjectiveTorqueLimit);
  }
  if (objective.kind == Kind::front) {
    objective.error_limit_m = table.find(kObjectiveErrorLimit).value_or(0);
    objective.total_torque_limit_n_m = table.find(kObjectiveTorqueLimit).value_or(0);
  }
  read_statistic(table, objective);
  read_term(table, kObjectiveEnergyWeight, kObjectiveEnergyScale, objective,
            objective.energy_weight, objective.energy_scale_j);
  read_term(table, kObjectiveDurationWeight, kObjectiveDurationScale, objective,
            objective.duration_weight, objective.duration_scale_s);
  return objective;
}

std::vector<WeightedQuantity> read_quantities(const ConfigTable& table,
                                              const std::vector<std::string>& names,
                                              const std::vector<std::string>& known,
                                              bool is_front) {
  if (names.size() < (is_front ? 2 : 1)) {
    table.refuse(kObjectiveQuantities,
                 is_front ? "a front needs at least two quantities; for one, choose another "
                            "objective.kind"
                          : "it must name at least one quantity");
  }
  const std::vector<double> weights = table.get(kObjectiveWeights),
                            scales = table.get(kObjectiveScales);
  for (const auto& [setting, values] :
       {std::pair{&kObjectiveWeights, &weights}, std::pair{&kObjectiveScales, &scales}}) {
    if (!values->empty() && values->size() != names.size()) {
      table.refuse(*setting,
                   fmt::format("it must hold {} numbers, one per quantity", names.size()));
    }
  }
  std::vector<WeightedQuantity> terms;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto found = std::ranges::find(known, names[i]);
    if (found == known.end()) {
      table.refuse(kObjectiveQuantities, describe_unknown("quantity", names[i], known));
    }
    if (std::ranges::count(names, names[i]) > 1) {
      table.refuse(kObjectiveQuantities, fmt::format("'{}' stands there twice", names[i]));
    }
    terms.push_back({static_cast<std::size_t>(found - known.begin()),
                     weights.empty() ? 1 : weights[i], scales.empty() ? 1 : scales[i]});
  }
  return terms;
}

void read_front(const ConfigTable& table, TrackingConfig& config) {
  using Of = TrackingQuantity;
  TrackingObjective& objective = config.objective;
  if (objective.kind != TrackingObjective::Kind::front) {
    return;
  }
  if (table.get(kObjectiveKind) == kErrorVsTorque) {
    objective.set_front({{static_cast<std::size_t>(Of::error), 1, objective.error_scale_m},
                         {static_cast<std::size_t>(Of::torque), objective.torque_weight,
                          objective.torque_scale_n_m}});
    return;
  }
  std::vector<std::string> known = tracking_quantity_names();
  const std::size_t first = known.size();
  for (const Requirement& requirement : config.requirements) {
    known.push_back(get_requirement_row(requirement.quantity).key);
  }
  const std::vector<std::string> names = table.get(kObjectiveQuantities);
  for (const std::string& name : names) {
    const auto& rows = requirement_table();
    if (std::ranges::find(known, name) == known.end() &&
        std::ranges::find(rows, name, &RequirementRow::key) != rows.end()) {
      table.refuse(
          kObjectiveQuantities,
          fmt::format("'{0}' is measured for a [[requirement]] only; add one with quantity "
                      "= \"{0}\", whose limit also bounds what lost cases count",
                      name));
    }
  }
  std::vector<WeightedQuantity> terms = read_quantities(table, names, known, true);
  const auto refuse_constant = [&](std::size_t term, const char* why) {
    table.refuse(kObjectiveQuantities,
                 fmt::format("'{}' is the same for all designs here; {}", names[term], why));
  };
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const auto quantity = static_cast<Of>(std::min(terms[i].quantity, first));
    if (quantity == Of::torque && std::ranges::none_of(config.parameters, is_effort)) {
      refuse_constant(i, "add effort_min and effort_max to variables.optimize");
    }
    if (quantity == Of::duration && !changes_speed(config)) {
      refuse_constant(i, "set variables.task = [\"speed\"]");
    }
    if (quantity == Of::moving_mass && !has_mass_metric(config)) {
      refuse_constant(i, "add length_scale or section_scale to variables.optimize, or [motors]");
    }
    if (quantity == Of::deflection && (!has_deflection_metric(config) || !changes_links(config))) {
      refuse_constant(i,
                      "give the arm [tubes], and add tube_diameter, tube_wall or length_scale to "
                      "variables.optimize");
    }
    if (!table.has(kObjectiveScales)) {
      terms[i].scale = quantity == Of::error    ? objective.error_scale_m
                       : quantity == Of::torque ? objective.torque_scale_n_m
                       : quantity == Of::requirement
                           ? config.requirements[terms[i].quantity - first].limit
                           : 1;
    }
  }
  objective.set_front(std::move(terms));
}

void check_limits(const ConfigTable& table, const TrackingConfig& config) {
  using Kind = TrackingObjective::Kind;
  ArmDesign weakest = config.start;
  bool changes_torque = false;
  for (const DesignParameter& parameter : config.parameters) {
    if (is_effort(parameter)) {
      get_parameter(weakest, parameter) /= config.bounds_factor;
      changes_torque = true;
    }
  }
  const double least_n_m = calc_total_effort(weakest);
  if (config.objective.kind == Kind::torque_with_error_limit && !changes_torque) {
    table.refuse(
        kObjectiveKind,
        fmt::format("no effort limit is optimized, so that the total torque is always {:g} "
                    "N m; add effort_min and effort_max to variables.optimize",
                    least_n_m));
  }
  if (config.objective.total_torque_limit_n_m > 0 &&
      least_n_m > config.objective.total_torque_limit_n_m) {
    table.refuse(kObjectiveTorqueLimit,
                 fmt::format("no design within the bounds has less than {:g} N m; raise it or "
                             "variables.bounds_factor",
                             least_n_m));
  }
}

}  // namespace armwright
