#include "study/run/case_growth.hpp"

#include <algorithm>
#include <cmath>

namespace armwright {

CaseGrowth::CaseGrowth(const RunPlan& plan)
    : variables_(plan.problem.problem->description().variables.size()),
      factor_(plan.schedule.factor),
      cases_(plan.schedule.cases),
      most_(static_cast<int>(plan.problem.sets.training_cases > 0
                                 ? std::int64_t{plan.problem.sets.training_cases}
                                 : kMostCases)) {}

void CaseGrowth::add(const EvaluationRecord& record, double objective) {
  const double before = best_.empty() ? std::numeric_limits<double>::infinity() : best_.back();
  if (objective < before) {
    best_errors_ = record.evaluation.case_errors;
  }
  best_.push_back(std::min(before, objective));
}

// Returns the standard error of the best objective between cases.
double CaseGrowth::calc_noise() const {
  const auto count = static_cast<double>(best_errors_.size());
  double mean = 0;
  for (const double error : best_errors_) {
    mean += error / count;
  }
  double spread = mean;
  if (best_errors_.size() > 1) {
    double square = 0;
    for (const double error : best_errors_) {
      square += (error - mean) * (error - mean);
    }
    spread = std::sqrt(square / (count - 1));
  }
  const double noise = std::abs(best_.back()) * spread / (mean * std::sqrt(count));
  return std::isfinite(noise) ? noise : 0;  // errors of zero have no spread
}

bool CaseGrowth::grow(std::uint64_t cases_left) {
  const std::size_t window = std::max(variables_, best_.size() - generation_begin_);
  generation_begin_ = best_.size();
  if (best_.size() <= window || cases_ >= most_) {
    return false;
  }
  const double gain = best_[best_.size() - 1 - window] - best_.back();
  const double wanted = std::max(cases_ + 1.0, std::round(cases_ * factor_));
  const int next = static_cast<int>(std::min(wanted, static_cast<double>(most_)));
  const bool is_gain = !(gain < calc_noise());
  if (is_gain || (variables_ + 1) * static_cast<std::uint64_t>(next) > cases_left) {
    return false;
  }
  cases_ = next;
  best_.clear();
  best_errors_.clear();
  generation_begin_ = 0;
  return true;
}

}  // namespace armwright
