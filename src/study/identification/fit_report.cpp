#include "study/identification/fit_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/text.hpp"
#include "problems/config/plant_file.hpp"

namespace armwright {
namespace {

using Eigen::Index;
using nlohmann::json;

// A motion has at most so many samples, unless they were fewer than kLeastRate_hz: the page shows the
// arm as it moved.
constexpr Index kMostShown = 1000;
constexpr double kLeastRate_hz = 25;

Index choose_stride(const FittedMotion& motion) {
  const Index for_count = (motion.efforts.rows() + kMostShown - 1) / kMostShown;
  const auto for_rate = static_cast<Index>(1 / (kLeastRate_hz * motion.period_s) + 1e-9);
  return std::max<Index>(1, std::min(for_count, for_rate));
}

json write_set(const FitSet& set) {
  json joints = json::array();
  for (const JointFit& joint : set.joints) {
    joints.push_back({{"joint", joint.joint},
                      {"unit", joint.unit},
                      {"deviation", joint.deviation},
                      {"rms_before", joint.before},
                      {"rms_after", joint.after},
                      {"whiteness_p", joint.whiteness_p},
                      {"independent_s", joint.independent_s}});
  }
  return {{"logs", set.logs},
          {"joints", joints},
          {"error_before", set.before},
          {"error_after", set.after}};
}

// The recorded and the modelled efforts, every n-th sample.
json write_motion(const FittedMotion& motion, std::span<const double> own,
                  std::span<const double> x) {
  const Eigen::VectorXd before = motion.model.calc(own, false).motor;
  const Eigen::VectorXd after = motion.model.calc(x, false).motor;
  const Index n = motion.efforts.cols();
  const Index stride = choose_stride(motion);
  json times = json::array(), recorded = json::array(), old_model = json::array(),
       new_model = json::array(), positions = json::array();
  for (Index i = 0; i < n; ++i) {
    for (json* list : {&recorded, &old_model, &new_model, &positions}) {
      list->push_back(json::array());
    }
  }
  for (Index k = 0; k < motion.efforts.rows(); k += stride) {
    times.push_back(static_cast<double>(k) * motion.period_s);
    for (Index i = 0; i < n; ++i) {
      const auto joint = static_cast<std::size_t>(i);
      recorded[joint].push_back(motion.efforts(k, i));
      old_model[joint].push_back(before[k * n + i]);
      new_model[joint].push_back(after[k * n + i]);
      positions[joint].push_back(motion.model.motion().positions(k, i));
    }
  }
  return {{"log", motion.name},   {"times_s", times},          {"positions", positions},
          {"recorded", recorded}, {"model_before", old_model}, {"model_after", new_model}};
}

}  // namespace

std::string to_json(const IdentificationProblem& problem, std::span<const double> x,
                    const FitAnalysis& analysis, const std::vector<std::string>& doubts) {
  json parameters = json::array();
  for (const FittedParameter& parameter : analysis.parameters) {
    parameters.push_back({{"name", parameter.name},
                          {"unit", parameter.unit},
                          {"before", parameter.before},
                          {"start", parameter.start},
                          {"value", parameter.value},
                          {"standard_error", parameter.standard_error},
                          {"lower", parameter.lower},
                          {"upper", parameter.upper},
                          {"determined", parameter.is_determined},
                          {"at_bound", parameter.is_at_bound}});
  }
  json correlations = json::array();
  for (const FitAnalysis::Correlation& pair : analysis.correlations) {
    correlations.push_back({{"first", pair.first}, {"second", pair.second}, {"value", pair.value}});
  }
  json motions = json::array();
  for (const auto* set : {&problem.fitted(), &problem.held_back()}) {
    for (const FittedMotion& motion : *set) {
      motions.push_back(write_motion(motion, problem.own_values(), x));
    }
  }
  json all = {{"robot", problem.robot().name},
              {"doubts", doubts},
              {"parameters", parameters},
              {"undetermined", analysis.undetermined},
              {"correlations", correlations},
              {"condition", analysis.condition},
              {"fitted", write_set(analysis.fitted)},
              {"motions", motions}};
  if (!problem.held_back().empty()) {
    all["held_back"] = write_set(analysis.judged);
  }
  return all.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

IdentificationFiles make_identification_files(
    const IdentificationProblem& problem, std::span<const double> x,
    const std::map<std::string, std::string>& input_hashes, bool is_converged) {
  const FitAnalysis analysis = analyse_fit(problem, x);
  FittedPlant fitted = make_fitted_plant(problem, x, analysis);
  for (const std::string& log : analysis.fitted.logs) {
    const auto hash = input_hashes.find(std::filesystem::path(log).filename().string());
    fitted.logs.push_back(hash == input_hashes.end() ? log : log + " " + hash->second);
  }
  return {write_plant(make_fitted_robot(problem, x), problem.plain_robot(), fitted,
                      fmt::format("# The plant of {}, identified by armwright from {}.\n",
                                  sanitize(problem.robot().name),
                                  sanitize(join(analysis.fitted.logs, ", ")))),
          to_json(problem, x, analysis, list_doubts(analysis, is_converged))};
}

std::vector<std::string> list_doubts(const FitAnalysis& analysis, bool is_converged) {
  std::vector<std::string> doubts;
  if (!is_converged) {
    doubts.emplace_back(
        "the optimizer was still moving when its budget ended: give a larger --budget");
  }
  std::vector<std::string> ends;
  for (const FittedParameter& parameter : analysis.parameters) {
    if (parameter.is_at_bound) {
      ends.push_back(parameter.name);
    }
  }
  if (!ends.empty()) {
    doubts.push_back(fmt::format(
        "{} at the end of the range that is searched: {}; the model, a column or a unit may be "
        "wrong, or the motion does not tell {}",
        ends.size() == 1 ? "a parameter is" : "parameters are", join(ends, ", "),
        ends.size() == 1 ? "it" : "them"));
  }
  const FitSet& judged = analysis.judged.joints.empty() ? analysis.fitted : analysis.judged;
  if (judged.after >= judged.before) {
    doubts.push_back(fmt::format("the fitted plant explains {} no better than the robot did before",
                                 join(judged.logs, ", ")));
  }
  return doubts;
}

}  // namespace armwright
