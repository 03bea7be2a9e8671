#include "problems/config/objective_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "problems/tracking/tracking_config.hpp"

namespace armwright {
namespace {

constexpr Range kPositive{.lower = 0, .upper = 1e12, .lower_open = true};
constexpr Range kWeight{.lower = 0, .upper = 1e6};

void read_statistic(const ConfigTable& table, TrackingObjective& objective) {
  using Statistic = TrackingObjective::Statistic;
  static const std::vector<std::string> names = {"mean", "worst", "cvar", "mean_with_failures"};
  const std::string name = table.get_choice("statistic", names, "mean");
  objective.statistic = static_cast<Statistic>(std::ranges::find(names, name) - names.begin());
  for (const char* key : {"cvar_share", "failure_penalty_m"}) {
    if (table.has(key) && !table.has("statistic")) {
      table.refuse(key,
                   "it does nothing to the mean; set objective.statistic to cvar or "
                   "mean_with_failures, or leave it out");
    }
  }
  objective.cvar_share = table.get_number_or("cvar_share", objective.cvar_share,
                                             {.lower = 0, .upper = 1, .lower_open = true});
  objective.failure_penalty_m =
      table.get_number_or("failure_penalty_m", objective.failure_penalty_m, kPositive);
}

// A part of the objective's sum: its weight and, where that is not 0, its scale.
void read_part(const ConfigTable& table, std::string_view weight_key, std::string_view scale_key,
               const TrackingObjective& objective, double& weight, double& scale) {
  weight = table.get_number_or(weight_key, 0, kWeight);
  if (weight == 0) {
    table.has(scale_key);  // stays allowed where a weight is switched off
    return;
  }
  if (objective.kind != TrackingObjective::Kind::error &&
      objective.kind != TrackingObjective::Kind::error_and_torque) {
    table.refuse(weight_key,
                 "only the kinds error and error_and_torque are sums; choose one of them or leave "
                 "it out");
  }
  scale = table.get_number(scale_key, kPositive);
}

}  // namespace

TrackingObjective read_objective(const ConfigTable& table) {
  using Kind = TrackingObjective::Kind;
  static const std::vector<std::pair<std::string, Kind>> rows = {
      {"error", Kind::error},
      {"error_and_torque", Kind::error_and_torque},
      {"error_vs_torque", Kind::error_vs_torque},
      {"torque_with_error_limit", Kind::torque_with_error_limit},
      {"error_with_torque_limit", Kind::error_with_torque_limit}};
  std::vector<std::string> kinds;
  std::ranges::transform(rows, std::back_inserter(kinds),
                         [](const auto& row) { return row.first; });
  TrackingObjective objective;
  const std::string kind = table.get_choice("kind", kinds, "error");
  objective.kind = std::ranges::find(rows, kind, [](const auto& row) { return row.first; })->second;
  objective.logarithm = table.get_bool_or("logarithm", false);
  if (objective.logarithm && objective.kind == Kind::error_vs_torque) {
    table.refuse("logarithm", "two objectives are compared as they are; leave it out");
  }
  objective.torque_weight = table.get_number_or("torque_weight", 1, kWeight);
  objective.error_scale_m =
      table.get_number_or("error_scale_m", objective.error_scale_m, kPositive);
  objective.torque_scale_n_m =
      table.get_number_or("torque_scale_n_m", objective.torque_scale_n_m, kPositive);
  // Read where they count only: elsewhere a limit is refused, as it would hold nobody back.
  if (objective.kind == Kind::torque_with_error_limit) {
    objective.error_limit_m = table.get_number("error_limit_m", kPositive);
  }
  if (objective.kind == Kind::error_with_torque_limit) {
    objective.total_torque_limit_n_m = table.get_number("total_torque_limit_n_m", kPositive);
  }
  read_statistic(table, objective);
  read_part(table, "energy_weight", "energy_scale_j", objective, objective.energy_weight,
            objective.energy_scale_j);
  read_part(table, "duration_weight", "duration_scale_s", objective, objective.duration_weight,
            objective.duration_scale_s);
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
  const double least_n_m = calc_total_torque_n_m(weakest);
  if (config.objective.kind == Kind::torque_with_error_limit && !changes_torque) {
    table.refuse(
        "kind", fmt::format("no effort limit is optimized, so that the total torque is always {:g} "
                            "N m; add effort_min and effort_max to variables.optimize",
                            least_n_m));
  }
  if (config.objective.kind == Kind::error_with_torque_limit &&
      least_n_m > config.objective.total_torque_limit_n_m) {
    table.refuse("total_torque_limit_n_m",
                 fmt::format("no design within the bounds has less than {:g} N m; raise it or "
                             "variables.bounds_factor",
                             least_n_m));
  }
}

}  // namespace armwright
