// Designs of arms, judged on test cases as `armwright evaluate` judges them.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "arrays.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "host.hpp"
#include "parts.hpp"
#include "problems/config/design_file.hpp"
#include "problems/tracking/requirement_grade.hpp"
#include "sim/controllers/controller.hpp"
#include "sim/tracking/test_case.hpp"
#include "study/run/design_evaluation.hpp"
#include "study/run/json_values.hpp"

namespace armwright::python {
namespace {

using nlohmann::json;

DesignFile make_design_file(const LoadedProblem& problem, const std::string& name,
                            ArmDesign design) {
  DesignFile file;
  file.name = name;
  file.title = fmt::format("A design for {}", problem.name);
  file.source = "armwright in Python";
  for (const Joint& joint : require_tracking(problem).config().robot.joints) {
    file.joint_names.push_back(joint.name);
  }
  file.design = std::move(design);
  return file;
}

// Makes the design of one row of the variables' values.
ArmDesign make_design(const LoadedProblem& problem, const Numbers& point) {
  const TrackingProblem& tracking = require_tracking(problem);
  check_points(point, tracking.description().variables, "x", false);
  return tracking.make_design(get_row(point, 0));
}

TestSet read_cases(const std::vector<Numbers>& cases) {
  std::vector<TestCase> all;
  for (std::size_t number = 0; number < cases.size(); ++number) {
    const Numbers& points = cases[number];
    if (points.ndim() != 2 || points.shape(1) != 3) {
      throw Error(
          ErrorKind::usage,
          fmt::format(
              "cases[{}] must have the shape (points, 3): x, y, z in metres, one row per point",
              number));
    }
    TestCase one;
    for (py::ssize_t k = 0; k < points.shape(0); ++k) {
      one.points_m.emplace_back(points.at(k, 0), points.at(k, 1), points.at(k, 2));
    }
    if (const auto fault = find_fault(one)) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("cases: case {}, point {} {}", number, fault->point, fault->what));
    }
    all.push_back(std::move(one));
  }
  if (all.empty()) {
    throw Error(ErrorKind::usage, "cases is empty; it must hold at least one test case");
  }
  return TestSet::make_from_cases(std::move(all));
}

json judge(const TrackingProblem& problem, const DesignEvaluation& evaluation) {
  const auto& requirements = problem.description().requirements;
  std::vector<std::optional<double>> worst(requirements.size());
  for (std::size_t number = 0; number < evaluation.results.size(); ++number) {
    for (std::size_t i = 0; get_error(evaluation.results[number]) && i < requirements.size(); ++i) {
      const auto& value = evaluation.required[number][i].value;
      if (value && (!worst[i] || *value > *worst[i])) {
        worst[i] = value;
      }
    }
  }
  json list = json::array();
  for (const JudgedRequirement& judged :
       judge_requirements(requirements, worst, evaluation.summary.without_number == 0)) {
    const Limit& limit = judged.requirement.limit;
    list.push_back({{"name", limit.quantity.name},
                    {"unit", limit.quantity.unit},
                    {"limit", limit.value},
                    {"use", judged.requirement.is_constraint ? "constraint" : "report"},
                    {"value", optional_to_json(judged.value)},
                    {"ratio", optional_to_json(judged.ratio)},
                    {"grade", to_string(judged.grade)}});
  }
  return list;
}

// Returns the summary with the keys that `armwright evaluate --json` prints.
json summarize(const DesignEvaluation& evaluation, const std::string& design,
               const std::string& problem, const std::string& set) {
  const ErrorSummary& summary = evaluation.summary;
  json all = {{"design", design},
              {"problem", problem},
              {"test_set", set},
              {"cases", summary.cases},
              {"mean_error_m", optional_to_json(summary.mean)},
              {"median_error_m", optional_to_json(summary.median)},
              {"percentile_95_error_m", optional_to_json(summary.percentile_95)},
              {"worst_error_m", optional_to_json(summary.worst)},
              {"failures", summary.failures},
              {"without_number", summary.without_number},
              {"total_torque_n_m", optional_to_json(evaluation.efforts.torque_n_m)},
              {"mean_energy_j", optional_to_json(evaluation.mean_energy_j)}};
  add_motion(evaluation.motion, evaluation.efforts, all);
  return all;
}

// Evaluates a design on the first `count` cases of a set. `design` is a name or a path, "start", or
// a row of numbers. `set` is the name of a set, or a list of arrays (points, 3). Returns summary
// and requirements as JSON, and for every case status, reason, error, energy and the errors of its
// points.
py::tuple evaluate_design(const ProblemHandle& handle, const py::object& design_argument,
                          const py::object& set, std::uint64_t count, unsigned jobs,
                          const py::object& listener) {
  LoadedProblem problem = handle.loaded;
  DesignFile file;
  if (!py::isinstance<py::str>(design_argument)) {
    file = make_design_file(problem, "x", make_design(problem, design_argument.cast<Numbers>()));
  } else if (design_argument.cast<std::string>() == kStartDesign) {
    file = make_design_file(problem, kStartDesign, require_tracking(problem).config().start);
  } else {
    file = load_design(design_argument.cast<std::string>());
    if (find_controller(file.design.controller).feed_forward != FeedForward::none) {
      // The problem computes this controller's precomputed efforts together with its targets.
      std::vector<std::string> settings = handle.settings;
      settings.insert(settings.begin(), "control.controller=" + file.design.controller);
      problem = load_problem(handle.name, settings);
    }
  }
  const TrackingProblem& tracking = require_tracking(problem);
  tracking.check_design(file.design);
  const bool is_named = py::isinstance<py::str>(set);
  const ChosenCases cases{is_named ? tracking.get_set(set.cast<std::string>())
                                   : read_cases(set.cast<std::vector<Numbers>>()),
                          count, true};
  std::optional<DesignEvaluation> evaluation;
  Host host(listener);
  host.run([&] {
    evaluation = evaluate_with_progress(tracking, file.design, cases, jobs, host.stop(), host,
                                        {.total = cases.count});
  });
  if (!evaluation) {
    throw Error(ErrorKind::usage, "the evaluation was stopped");  // the host has thrown the reason
  }
  const json all = {{"summary", summarize(*evaluation, file.name, problem.name, cases.set.name())},
                    {"requirements", judge(tracking, *evaluation)}};
  std::vector<std::string> statuses, reasons;
  std::vector<double> errors, energies;
  std::vector<std::vector<double>> point_errors;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();  // masked below
  for (const TrackingResult& result : evaluation->results) {
    const auto error = get_error(result);
    statuses.emplace_back(to_string(result.status));
    reasons.push_back(sanitize(result.reason));
    errors.push_back(error.value_or(kNone));
    energies.push_back(error ? result.energy_j : kNone);
    point_errors.push_back(result.point_error_m);
  }
  return py::make_tuple(all.dump(), statuses, reasons, make_ragged({errors}),
                        make_ragged({energies}), make_ragged(point_errors));
}

}  // namespace

void add_designs(py::module_& module) {
  module.def("evaluate_design",
             [](const ProblemHandle& handle, const py::object& design, const py::object& set,
                std::uint64_t count, unsigned jobs, const py::object& listener) {
               return evaluate_design(handle, design, set, count, jobs, listener);
             });
  module.def("design_toml", [](const ProblemHandle& handle, const Numbers& point,
                               const std::string& name) {
    return to_toml(make_design_file(handle.loaded, name, make_design(handle.loaded, point)));
  });
}

}  // namespace armwright::python
