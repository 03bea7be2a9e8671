// Reads a problem's objective: the metrics, their weights and the limits.

#include <fmt/format.h>

#include "problems/config/problem_readers.hpp"
#include "problems/tracking/tracking_config.hpp"

namespace armwright {
namespace {

constexpr Range kPositive{.lower = 0, .upper = 1e12, .lower_open = true};
constexpr Range kWeight{.lower = 0, .upper = 1e6};

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
                                           "for torque_with_error_limit: largest error"};
const Setting<double> kObjectiveTorqueLimit{"total_torque_limit_n_m", kPositive, kNoDefault,
                                            "for error_with_torque_limit: largest total torque"};

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
    // in the order of the enum
    one_of({"error", "error_and_torque", "error_vs_torque", "torque_with_error_limit",
            "error_with_torque_limit"}),
    "error",
    "what is minimised; error_vs_torque minimises both as two objectives, the others are one "
    "number. For the kind motion: sum (the default) or front"};

const Setting<std::vector<std::string>> kObjectiveQuantities{
    "quantities", kNoDefault,
    "for the kind motion: what is minimised, of duration, jerk, energy, peak_torque, rms_torque, "
    "clearance (made large), deflection and tool_speed (default: duration)"};
const Setting<std::vector<double>> kObjectiveWeights{
    "weights", Range{.lower = 0, .upper = 1e12}, std::vector<double>{},
    "one weight per quantity, in their weighted sum (default: 1)"};
const Setting<std::vector<double>> kObjectiveScales{
    "scales", Range{.lower = 0, .upper = 1e12, .lower_open = true}, std::vector<double>{},
    "what of each quantity counts 1 in that sum (default: 1)"};

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
  objective.kind = static_cast<Kind>(table.get_choice(kObjectiveKind));
  objective.logarithm = table.get(kObjectiveLogarithm);
  if (objective.logarithm && objective.kind == Kind::error_vs_torque) {
    table.refuse(kObjectiveLogarithm, "two objectives are compared as they are; leave it out");
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
  read_statistic(table, objective);
  read_term(table, kObjectiveEnergyWeight, kObjectiveEnergyScale, objective,
            objective.energy_weight, objective.energy_scale_j);
  read_term(table, kObjectiveDurationWeight, kObjectiveDurationScale, objective,
            objective.duration_weight, objective.duration_scale_s);
  return objective;
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
  if (config.objective.kind == Kind::error_with_torque_limit &&
      least_n_m > config.objective.total_torque_limit_n_m) {
    table.refuse(kObjectiveTorqueLimit,
                 fmt::format("no design within the bounds has less than {:g} N m; raise it or "
                             "variables.bounds_factor",
                             least_n_m));
  }
}

}  // namespace armwright
