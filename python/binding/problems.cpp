// Problems, their test cases, and evaluations of points.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "arrays.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "host.hpp"
#include "parts.hpp"
#include "problems/config/path_survey.hpp"
#include "problems/user/user_problem.hpp"
#include "study/executor/case_executor.hpp"
#include "study/run/run_observer.hpp"
#include "user_problems.hpp"

namespace armwright::python {
namespace {

std::unique_ptr<ProblemHandle> load(const std::string& name,
                                    const std::vector<std::string>& settings) {
  const py::gil_scoped_release released;
  return std::make_unique<ProblemHandle>(
      ProblemHandle{name, settings, load_problem(name, settings)});
}

// Returns a problem of Python. It cannot be simulated before load_for_call().
std::unique_ptr<ProblemHandle> load_python(const std::string& name, const std::string& description,
                                           py::object answer, py::object enter_worker,
                                           const ServerLimits& limits, bool isolate,
                                           bool is_batched,
                                           const std::vector<std::string>& settings) {
  auto problem = make_python_problem({.name = name,
                                      .answer = share(std::move(answer)),
                                      .enter_worker = share(std::move(enter_worker)),
                                      .limits = limits,
                                      .isolate = isolate,
                                      .is_batched = is_batched},
                                     description);
  UserProgram program{.name = name, .description = problem->description};
  LoadedProblem loaded = load_problem(name, settings, engine_table(), {.hosts = {program}});
  return std::make_unique<ProblemHandle>(
      ProblemHandle{name, settings, std::move(loaded), std::move(problem)});
}

CaseRole read_role(const std::string& role) {
  return role == "training"     ? CaseRole::training
         : role == "validation" ? CaseRole::validation
                                : CaseRole::test;
}

// The results of points, one row per point. Several threads may write different rows at the same
// time, without the GIL.
class Table {
 public:
  Table(const ProblemDescription& problem, std::size_t points, std::size_t cases)
      : objectives_(make_matrix(points, problem.objectives.size())),
        constraints_(make_matrix(points, problem.constraints.size())),
        metrics_(make_matrix(points, problem.metrics.size())),
        case_errors_(make_matrix(points, cases)),
        status_(static_cast<py::ssize_t>(points)),
        objectives_begin_(objectives_.mutable_data()),
        constraints_begin_(constraints_.mutable_data()),
        metrics_begin_(metrics_.mutable_data()),
        errors_begin_(case_errors_.mutable_data()),
        status_begin_(status_.mutable_data()),
        widths_{problem.objectives.size(), problem.constraints.size(), problem.metrics.size(),
                cases} {}

  // Writes a row. A missing number becomes infinite. Missing objectives become the penalty that
  // optimizers see.
  void put(std::size_t row, const Evaluation& evaluation, std::span<const double> penalty) {
    const bool failed = evaluation.objectives.empty();
    copy(failed ? penalty : std::span<const double>(evaluation.objectives), objectives_begin_, row,
         widths_[0]);
    copy(failed ? std::span<const double>() : evaluation.constraint_values, constraints_begin_, row,
         widths_[1]);
    copy(failed ? std::span<const double>() : evaluation.metrics, metrics_begin_, row, widths_[2]);
    copy(evaluation.case_errors, errors_begin_, row, widths_[3]);
    status_begin_[row] = static_cast<std::uint8_t>(evaluation.status);
  }

  py::tuple take() {
    return py::make_tuple(objectives_, constraints_, metrics_, case_errors_, status_);
  }

 private:
  static void copy(std::span<const double> values, double* begin, std::size_t row,
                   std::size_t width) {
    for (std::size_t i = 0; i < width; ++i) {
      begin[row * width + i] = i < values.size() && !std::isnan(values[i]) ? values[i] : kNothing;
    }
  }

  Numbers objectives_, constraints_, metrics_, case_errors_;
  py::array_t<std::uint8_t> status_;
  double* objectives_begin_;
  double* constraints_begin_;
  double* metrics_begin_;
  double* errors_begin_;
  std::uint8_t* status_begin_;
  std::array<std::size_t, 4> widths_;
};

struct EvaluateRequest {
  std::string role;
  std::string set;
  std::vector<std::uint64_t> numbers;
  bool residuals = false;
  bool jacobian = false;
  unsigned jobs = 1;
};

// Returns how many points to evaluate at a time, so that their results need about 100 MB.
std::size_t count_at_once(std::size_t cases) {
  constexpr std::size_t kMostPairs = 1 << 18;
  return std::max<std::size_t>(1, kMostPairs / std::max<std::size_t>(cases, 1));
}

// Returns ((objectives, constraints, metrics, case errors, status), reasons by row, residuals,
// Jacobians). Residuals and Jacobians are lists of rows.
py::tuple evaluate(const ProblemHandle& handle, const Numbers& points,
                   const EvaluateRequest& request, const py::object& listener) {
  check_points(points, handle.loaded.problem->description().variables, "X", true);
  const auto count = static_cast<std::size_t>(points.shape(0));
  const CaseBlock block{read_role(request.role), request.set, request.numbers};
  const auto jobs = static_cast<unsigned>(
      std::min<std::size_t>(request.jobs, std::max<std::size_t>(1, count * block.numbers.size())));
  Host host(listener);
  const LoadedProblem loaded = load_for_call(handle, host, jobs);
  const Problem& problem = *loaded.problem;
  Table table(problem.description(), count, block.numbers.size());
  const std::vector<double> penalty = problem.penalty_objectives();
  const std::size_t kept = request.residuals || request.jacobian ? count : 0;
  std::vector<std::vector<double>> residuals(kept), jacobians(kept);
  std::map<std::size_t, std::string> reasons;
  std::vector<std::span<const double>> rows;
  for (std::size_t row = 0; row < count; ++row) {
    rows.push_back(get_row(points, static_cast<py::ssize_t>(row)));
  }
  host.run([&] {
    ThreadExecutor executor(jobs);
    std::mutex mutex;  // guards reasons and progress
    Progress progress;
    progress.phase = block.role;
    progress.total = std::uint64_t{count} * block.numbers.size();
    const std::size_t at_once = count_at_once(block.numbers.size());
    for (std::size_t first = 0; first < count && !host.stop().requested(); first += at_once) {
      const auto some = std::span(rows).subspan(first, std::min(at_once, count - first));
      executor.evaluate(problem, some, block,
                        {request.residuals || request.jacobian, request.jacobian}, host.stop(),
                        [&](std::size_t candidate, Evaluation evaluation) {
                          const std::size_t row = first + candidate;
                          table.put(row, evaluation, penalty);
                          if (kept > 0) {
                            residuals[row] = std::move(evaluation.residuals);
                            jacobians[row] = std::move(evaluation.jacobian);
                          }
                          const std::lock_guard lock(mutex);
                          if (evaluation.status != EvaluationStatus::ok) {
                            reasons[row] = std::move(evaluation.reason);
                          }
                          progress.done += block.numbers.size();
                          host.on_progress(progress);
                        });
    }
  });
  const py::object none = py::none();
  return py::make_tuple(table.take(), reasons,
                        request.residuals ? py::object(make_ragged(residuals)) : none,
                        request.jacobian ? py::object(make_ragged(jacobians)) : none);
}

// Returns an array (cases, points, 3) in metres. Throws Error{usage} for a function.
py::array_t<double> list_cases(const ProblemHandle& handle, const std::string& set_name,
                               std::uint64_t first, std::uint64_t count) {
  if (handle.loaded.tracking() == nullptr) {
    throw Error(ErrorKind::usage,
                fmt::format("problem '{}' has no arm, so its test cases have no points",
                            handle.loaded.name));
  }
  const TestSet set = handle.loaded.tracking()->get_set(set_name);
  const std::size_t points = count > 0 ? set.make_case(first).points_m.size() : 0;
  py::array_t<double> cases(
      {static_cast<py::ssize_t>(count), static_cast<py::ssize_t>(points), py::ssize_t{3}});
  double* value = cases.mutable_data();
  const py::gil_scoped_release released;
  for (std::uint64_t number = first; number < first + count; ++number) {
    for (const Eigen::Vector3d& point_m : set.make_case(number).points_m) {
      value = std::copy_n(point_m.data(), 3, value);
    }
  }
  return cases;
}

// Returns the names of what the user's problem answers: objectives, constraints and metrics.
py::tuple list_outputs(const ProblemHandle& handle) {
  const UserDescription* description = find_user_description(*handle.loaded.problem);
  if (description == nullptr) {
    throw Error(
        ErrorKind::usage,
        fmt::format("armwright simulates {} itself; optimize() runs it. Ask and tell need a "
                    "problem of your own",
                    sanitize(handle.loaded.name)));
  }
  std::vector<std::string> objectives, constraints, metrics;
  for (const UserObjective& objective : description->objectives) {
    objectives.push_back(objective.quantity.name);
  }
  for (const UserConstraint& constraint : description->constraints) {
    constraints.push_back(constraint.quantity.name);
  }
  for (const Quantity& metric : description->metrics) {
    metrics.push_back(metric.name);
  }
  return py::make_tuple(objectives, constraints, metrics);
}

}  // namespace

LoadedProblem load_for_call(const ProblemHandle& handle, Host& host, unsigned jobs) {
  if (!handle.python) {
    return handle.loaded;
  }
  return load_problem(handle.name, handle.settings, engine_table(),
                      {.hosts = {make_program(handle.python, host, jobs)}});
}

void add_problems(py::module_& module) {
  module.def("list_problems", [] {
    std::vector<std::pair<std::string, std::string>> titles;
    for (const ProblemTitle& problem : list_problems()) {
      titles.emplace_back(problem.name, problem.title);
    }
    return titles;
  });
  py::list statuses;
  for (const auto status :
       {EvaluationStatus::ok, EvaluationStatus::diverged, EvaluationStatus::unreachable,
        EvaluationStatus::timed_out, EvaluationStatus::failed, EvaluationStatus::abandoned}) {
    statuses.append(to_string(status));  // in the order of their numbers
  }
  module.attr("STATUSES") = py::tuple(statuses);
  module.def("load_python_problem",
             [](const std::string& name, const std::string& description, py::object answer,
                py::object enter_worker, double time_limit_s, double memory_mib, bool isolate,
                bool is_batched, const std::vector<std::string>& settings) {
               return load_python(name, description, std::move(answer), std::move(enter_worker),
                                  {.time_limit_s = time_limit_s, .memory_mib = memory_mib}, isolate,
                                  is_batched, settings);
             });
  py::class_<ProblemHandle>(module, "Problem")
      .def(py::init(&load))
      .def_readonly("asked_name", &ProblemHandle::name)
      .def_readonly("settings", &ProblemHandle::settings)
      .def_property_readonly("is_python",
                             [](const ProblemHandle& handle) { return handle.python != nullptr; })
      .def("describe", [](const ProblemHandle& handle) { return describe(handle.loaded).dump(); })
      .def("penalty",
           [](const ProblemHandle& handle) { return handle.loaded.problem->penalty_objectives(); })
      .def("outputs", &list_outputs)
      .def("check_paths", [](const ProblemHandle& handle) { return check_paths(handle.loaded); })
      .def("cases", &list_cases)
      .def("evaluate",
           [](const ProblemHandle& handle, const Numbers& points, const std::string& role,
              const std::string& set, std::vector<std::uint64_t> numbers, bool residuals,
              bool jacobian, unsigned jobs, const py::object& listener) {
             return evaluate(handle, points,
                             {role, set, std::move(numbers), residuals, jacobian, jobs}, listener);
           });
  add_designs(module);
}

}  // namespace armwright::python
