#include "report/evidence/sweep_data.hpp"

#include "report/evidence/distance_response.hpp"
#include "report/evidence/page_json.hpp"

namespace armwright {

using nlohmann::json;

json make_speed_sweep(PageSimulator& simulator, const TrackingProblem& problem,
                      const SweepRequest& request, std::span<const NamedDesign> designs) {
  json series = json::array();
  for (const NamedDesign& design : designs) {
    series.push_back({{"name", design.name},
                      {"mean_m", json::array()},
                      {"standard_error_m", json::array()},
                      {"median_m", json::array()},
                      {"failures", json::array()}});
  }
  for (const double speed_m_per_s : request.speeds_m_per_s) {
    TrackingConfig config = problem.config();
    config.task.speed_m_per_s = speed_m_per_s;
    const TrackingProblem at_speed(std::move(config));
    const TestSet set = problem.get_set(request.set);
    for (std::size_t i = 0; i < designs.size(); ++i) {
      const auto results = simulator.evaluate(at_speed, designs[i].design, set, 0, request.cases);
      const ErrorSummary summary = summarize_cases(results);
      series[i]["mean_m"].push_back(finite_or_null(summary.mean));
      series[i]["standard_error_m"].push_back(
          finite_or_null(calc_standard_error(get_case_errors(results))));
      series[i]["median_m"].push_back(finite_or_null(summary.median));
      series[i]["failures"].push_back(summary.failures);
    }
  }
  return {{"parameter", "task.speed_m_per_s"},
          {"quantity", make_quantity({"average speed", "m/s"})},
          {"values", request.speeds_m_per_s},
          {"nominal", problem.config().task.speed_m_per_s},
          {"cases", request.cases},
          {"engine", problem.config().engines.judging_name},
          {"command", request.command},
          {"series", std::move(series)}};
}

}  // namespace armwright
