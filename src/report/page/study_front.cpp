// Fronts of a study's page: the non-dominated points of every replicate, and the surfaces that a
// share of the replicates attains.
#include <algorithm>

#include "report/evidence/page_json.hpp"
#include "report/page/study_parts.hpp"
#include "study/statistics/pareto.hpp"
#include "study/statistics/summary.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using Points = std::vector<std::vector<double>>;

constexpr std::size_t kMostPoints = 200;  // per replicate and per surface
constexpr double kShares[] = {0.25, 0.5, 0.75};

// Keeps at most kMostPoints points, evenly spread in their order, with the first and the last.
Points thin(Points points) {
  if (points.size() <= kMostPoints) {
    return points;
  }
  Points kept;
  for (std::size_t i = 0; i < kMostPoints; ++i) {
    kept.push_back(std::move(points[i * (points.size() - 1) / (kMostPoints - 1)]));
  }
  return kept;
}

// Returns the non-dominated points, sorted by the first objective.
Points find_front(const Points& points) {
  Points front;
  for (const std::size_t i : find_non_dominated(points)) {
    front.push_back(points[i]);
  }
  std::ranges::sort(front);
  return front;
}

json make_values(const std::vector<double>& point) {
  json values = json::array();
  for (const double value : point) {
    values.push_back(finite_or_null(round_shown(value)));
  }
  return values;
}

json make_surfaces(std::span<const Points> fronts) {
  json surfaces = json::array();
  for (const double share : kShares) {
    json corners = json::array();
    for (const auto& corner : thin(calc_attainment_surface(fronts, share))) {
      corners.push_back(make_values(corner));
    }
    surfaces.push_back({{"share", share}, {"points", std::move(corners)}});
  }
  return surfaces;
}

}  // namespace

json make_study_front(const StudyPlan& plan, const StudyProblem& studied,
                      std::span<const CellOutcome> cells, const ProblemResult& result) {
  if (!result.has_front) {
    return nullptr;
  }
  const ProblemDescription& problem = studied.loaded.problem->description();
  json objectives = json::array();
  for (const Quantity& objective : problem.objectives) {
    objectives.push_back(make_quantity(objective, !studied.loaded.tracking()));
  }
  json optimizers = json::array();
  for (std::size_t o = 0; o < plan.optimizers.size(); ++o) {
    const StudyOptimizer& optimizer = plan.optimizers[o];
    const std::vector<double>& igd_plus = result.optimizers[o].igd_plus;
    json points = json::array();
    std::vector<Points> fronts;
    for (const CellOutcome* cell : list_cells_of(cells, optimizer.label)) {
      fronts.push_back(find_front(cell->front));
      for (const auto& point : thin(fronts.back())) {
        points.push_back({{"values", make_values(point)}, {"replicate", cell->replicate}});
      }
    }
    const bool is_plane = problem.objectives.size() == 2 && !fronts.empty();
    optimizers.push_back(
        {{"points", std::move(points)},
         {"igd_plus", igd_plus.empty() ? json() : finite_or_null(calc_spread(igd_plus).median)},
         {"attainment", is_plane ? make_surfaces(fronts) : json::array()}});
  }
  return {{"objectives", std::move(objectives)},
          {"reference_point", finite_or_null(result.reference_point)},
          {"optimizers", std::move(optimizers)}};
}

}  // namespace armwright
