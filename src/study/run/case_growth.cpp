#include "study/run/case_growth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace armwright {

CaseGrowth::CaseGrowth(const RunPlan& plan)
    : problem_(*plan.problem.problem),
      factor_(plan.schedule.factor),
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

// Returns the standard error of the best objective between cases.
double CaseGrowth::calc_noise() const {
  if (case_objectives_.size() < 2) {
    return std::numeric_limits<double>::infinity();
  }
  const auto count = static_cast<double>(case_objectives_.size());
  const double mean =
      std::accumulate(case_objectives_.begin(), case_objectives_.end(), 0.0) / count;
  double square = 0;
  for (const double objective : case_objectives_) {
    square += (objective - mean) * (objective - mean);
  }
  return std::sqrt(square / (count - 1) / count);
}

bool CaseGrowth::grow(std::uint64_t cases_left) {
  const std::size_t n = problem_.description().variables.size();
  const std::size_t window = std::max(3 * n, best_.size() - generation_begin_);
  generation_begin_ = best_.size();
  if (best_.size() <= window || cases_ >= most_) {
    return false;
  }
  const double gain = best_[best_.size() - 1 - window] - best_.back();
  const double wanted = std::max(cases_ + 1.0, std::round(cases_ * factor_));
  const int next = static_cast<int>(std::min(wanted, static_cast<double>(most_)));
  const bool is_gain = !(gain < calc_noise());  // also if no design is feasible yet
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
