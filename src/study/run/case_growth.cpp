#include "study/run/case_growth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "study/statistics/summary.hpp"

namespace armwright {

CaseGrowth::CaseGrowth(const RunPlan& plan)
    : problem_(*plan.problem.problem),
      factor_(plan.schedule.factor),
      least_window_(plan.optimizer.capabilities.generations
                        ? 3 * problem_.description().variables.size()
                        : 1),
      cases_(plan.schedule.cases),
      most_(static_cast<int>(plan.problem.sets.training_cases > 0
                                 ? std::int64_t{plan.problem.sets.training_cases}
                                 : kMostCases)) {}

void CaseGrowth::add(const EvaluationRecord& record, double objective) {
  const double before = best_.empty() ? std::numeric_limits<double>::infinity() : best_.back();
  if (objective < before) {
    case_objectives_ = problem_.calc_case_objectives(record.x, record.evaluation);
  }
  best_.push_back(std::min(before, objective));
}

bool CaseGrowth::grow(std::uint64_t cases_left) {
  const std::size_t n = problem_.description().variables.size();
  const std::size_t window = std::max(least_window_, best_.size() - generation_begin_);
  generation_begin_ = best_.size();
  if (best_.size() <= window || cases_ >= most_) {
    return false;
  }
  const double gain = best_[best_.size() - 1 - window] - best_.back();
  const double wanted = std::max(cases_ + 1.0, std::round(cases_ * factor_));
  const int next = static_cast<int>(std::min(wanted, static_cast<double>(most_)));
  const double noise = calc_mean_and_error(case_objectives_).standard_error;
  // The noise of one case is unknown and may be larger than every gain. If no design is feasible
  // yet, the gain is no number, and the search goes on.
  const bool is_gain = case_objectives_.empty() || (!std::isnan(noise) && !(gain < noise));
  if (is_gain || (n + 1) * static_cast<std::uint64_t>(next) > cases_left) {
    return false;
  }
  cases_ = next;
  best_.clear();
  case_objectives_.clear();
  generation_begin_ = 0;
  return true;
}

}  // namespace armwright
