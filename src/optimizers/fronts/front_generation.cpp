#include "optimizers/fronts/front_generation.hpp"

#include <utility>

#include "optimizers/interface/feasibility.hpp"

namespace armwright {

FrontGeneration::FrontGeneration(Evaluator& evaluator)
    : evaluator_(evaluator), space_(evaluator.problem().variables) {}

std::vector<FrontMember> FrontGeneration::make_first(std::size_t size, double spread,
                                                     RandomStream& random) const {
  std::vector<FrontMember> members;
  for (std::vector<double>& coordinates : space_.draw_population(size, spread, random)) {
    members.push_back({.coordinates = std::move(coordinates), .objectives = {}});
  }
  return members;
}

bool FrontGeneration::evaluate(std::vector<FrontMember>& parents,
                               std::vector<FrontMember>& children) {
  evaluator_.begin_generation();
  has_changed_cases_ = !parents.empty() && evaluator_.case_changes() != case_changes_;
  case_changes_ = evaluator_.case_changes();
  std::vector<FrontMember*> asked;
  if (has_changed_cases_) {
    for (FrontMember& parent : parents) {
      asked.push_back(&parent);
    }
  }
  for (FrontMember& child : children) {
    asked.push_back(&child);
  }
  std::vector<std::vector<double>> points;
  for (const FrontMember* member : asked) {
    points.push_back(space_.to_point(member->coordinates));
  }
  std::vector<Score> scores = evaluator_.evaluate(points);
  if (scores.size() < asked.size()) {
    return false;
  }
  for (std::size_t i = 0; i < asked.size(); ++i) {
    asked[i]->violation = calc_fitness(evaluator_.problem(), scores[i]).violation;
    asked[i]->objectives = std::move(scores[i].objectives);
  }
  return true;
}

OptimizerRow make_front_row(std::string_view name) {
  OptimizerRow row;
  row.name = name;
  row.capabilities = {.constraints = true,
                      .multi_objective = true,
                      .batch = true,
                      .noisy = true,
                      .stochastic = true,
                      .generations = true};
  row.requirements = {.objectives = 2};
  return row;
}

std::vector<OptimizerRow> make_front_rows() {
  return {make_mode_row(), make_nsga3_row()};
}

}  // namespace armwright
