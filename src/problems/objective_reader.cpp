#include "problems/objective_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "problems/tracking_description.hpp"

namespace armwright {

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
  const Range positive{.lower = 0, .upper = 1e12, .lower_open = true};
  objective.torque_weight = table.get_number_or("torque_weight", 1, {.lower = 0, .upper = 1e6});
  objective.error_scale_m = table.get_number_or("error_scale_m", objective.error_scale_m, positive);
  objective.torque_scale_n_m =
      table.get_number_or("torque_scale_n_m", objective.torque_scale_n_m, positive);
  // Read where they count only: elsewhere a limit is refused, as it would hold nobody back.
  if (objective.kind == Kind::torque_with_error_limit) {
    objective.error_limit_m = table.get_number("error_limit_m", positive);
  }
  if (objective.kind == Kind::error_with_torque_limit) {
    objective.total_torque_limit_n_m = table.get_number("total_torque_limit_n_m", positive);
  }
  return objective;
}

void check_limits(const ConfigTable& table, const TrackingConfig& config) {
  using Kind = TrackingObjective::Kind;
  ArmDesign weakest = config.start;
  bool changes_torque = false;
  for (const DesignParameter& parameter : config.parameters) {
    if (parameter.kind != DesignParameter::Kind::gain) {
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
