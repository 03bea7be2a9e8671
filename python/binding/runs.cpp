// Runs: makes or continues them as `armwright optimize` does, and reads them.
#include <fmt/format.h>

#include <limits>

#include "arrays.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "host.hpp"
#include "parts.hpp"
#include "study/analysis/importance.hpp"
#include "study/journal/journal.hpp"
#include "study/run/ask_tell.hpp"
#include "study/run/run.hpp"
#include "study/run/run_folder.hpp"

namespace armwright::python {
namespace {

// The user's settings of a run. An empty one stands for the problem's own.
struct RunQuestion {
  std::vector<std::string> options;  // KEY=VALUE
  std::uint64_t seed = 1;
  std::optional<std::int64_t> budget;
  std::optional<std::string> schedule;
  std::optional<std::string> racing;
};

RunPlan make_plan(const LoadedProblem& problem, OptimizerRow row, const RunQuestion& question) {
  RunPlan plan;
  plan.problem = problem;
  plan.optimizer = std::move(row);
  plan.options = Options::parse(plan.optimizer.name, plan.optimizer.options, question.options);
  plan.seed = question.seed;
  plan.budget = check_number("budget", question.budget.value_or(problem.budget), 0, kMostBudget);
  plan.schedule = question.schedule ? parse_schedule(*question.schedule)
                                    : choose_schedule(problem, plan.optimizer);
  plan.racing = problem.racing;
  if (question.racing) {
    const auto racing = read_racing(*question.racing);
    if (!racing) {
      throw Error(ErrorKind::usage, fmt::format("racing is '{}'; it must be {}",
                                                sanitize(*question.racing), kRacingForms));
    }
    plan.racing = *racing;
  }
  check_plan(plan);
  return plan;
}

// Returns the run's folder and its result as JSON. The result is None if the time limit ended the
// call first.
py::tuple optimize(const ProblemHandle& problem, const py::object& optimizer,
                   const RunQuestion& question, const Place& place,
                   const std::vector<std::string>& command, const py::object& listener) {
  Host host(listener);
  RunRequest request;
  request.plan =
      make_plan(load_for_call(problem, host, place.jobs), load_row(optimizer, host), question);
  request.folder = place.choose(make_folder_name(request.plan, problem.settings));
  request.jobs = place.jobs;
  request.command_line = command;
  request.command_line.insert(request.command_line.end(), {"--out", request.folder.string()});
  host.limit_time(place.time_limit_s);
  std::optional<RunResult> result;
  host.run([&] { result = execute_run(request, host.stop(), host); });
  return py::make_tuple(request.folder.string(),
                        result ? py::object(py::str(to_json(*result))) : py::none());
}

// Returns the run's folder, the points that are handed out and those that wait, each as (identifier,
// values), and whether the run has ended. Without a command, `armwright ask` continues the run.
py::tuple ask_for_points(const ProblemHandle& problem, const py::object& optimizer,
                         const RunQuestion& question, const Place& place,
                         const std::vector<std::string>& command, std::size_t count,
                         const py::object& listener) {
  Host host(listener);
  RunRequest request;
  request.plan =
      make_plan(load_for_call(problem, host, place.jobs), load_row(optimizer, host), question);
  request.folder = place.choose(make_folder_name(request.plan, problem.settings));
  request.command_line = command.empty()
                             ? std::vector<std::string>{"armwright", "ask", request.folder.string()}
                             : command;
  AskOutcome outcome;
  host.run([&] { outcome = ask(request, count, host); });
  const auto list = [](const std::vector<AskedPoint>& points) {
    std::vector<std::pair<std::uint64_t, std::vector<double>>> pairs;
    for (const AskedPoint& point : points) {
      pairs.emplace_back(point.id, point.x);
    }
    return pairs;
  };
  return py::make_tuple(request.folder.string(), list(outcome.points), list(outcome.waiting),
                        outcome.result.has_value());
}

template <class Number>
py::array_t<Number> copy_array(const std::vector<Number>& values) {
  return py::array_t<Number>(static_cast<py::ssize_t>(values.size()), values.data());
}

// Returns every recorded training evaluation, one list per quantity: the ragged points, objectives,
// constraint values, case errors and case numbers; then index, generation, charge, status and
// whether the point was clipped.
py::tuple read_history(const std::filesystem::path& folder) {
  std::vector<std::vector<double>> points, objectives, constraints, case_errors, case_numbers;
  std::vector<std::uint64_t> indices, generations, charges;
  std::vector<std::uint8_t> statuses, clipped;
  {
    const py::gil_scoped_release released;
    const JournalContent journal = read_journal(folder / "journal");
    for (const EvaluationRecord& record : journal.training) {
      points.push_back(record.x);
      objectives.push_back(record.evaluation.objectives);
      constraints.push_back(record.evaluation.constraint_values);
      case_errors.push_back(record.evaluation.case_errors);
      case_numbers.emplace_back(record.cases.numbers.begin(), record.cases.numbers.end());
      indices.push_back(record.index);
      generations.push_back(record.generation);
      charges.push_back(record.calc_charge());
      statuses.push_back(static_cast<std::uint8_t>(record.evaluation.status));
      clipped.push_back(record.clipped);
    }
  }
  return py::make_tuple(make_ragged(points), make_ragged(objectives), make_ragged(constraints),
                        make_ragged(case_errors), make_ragged(case_numbers), copy_array(indices),
                        copy_array(generations), copy_array(charges), copy_array(statuses),
                        copy_array(clipped));
}

// Returns the variables that matter as JSON. Without `simulations`, nothing is simulated.
std::string show_importance(const std::filesystem::path& folder,
                            std::optional<std::int64_t> simulations, unsigned jobs,
                            const py::object& listener) {
  Host host(listener);
  std::string text;
  host.run([&] {
    const LoadedProblem loaded = load_problem_of_run(folder);
    Importance importance = calc_importance(folder, loaded.problem->description());
    if (!simulations || add_simulated_importance(folder, *loaded.problem, *simulations, jobs,
                                                 host.stop(), host, importance)) {
      text = to_json(importance);
    }
  });
  return text;
}

}  // namespace

void add_runs(py::module_& module) {
  module.def("optimize", [](const ProblemHandle& problem, const py::object& optimizer,
                            std::vector<std::string> options, std::uint64_t seed,
                            std::optional<std::int64_t> budget, std::optional<std::string> schedule,
                            std::optional<std::string> racing, std::optional<std::string> out,
                            bool another, unsigned jobs, std::optional<double> time_limit_s,
                            const std::vector<std::string>& command, const py::object& listener) {
    return optimize(problem, optimizer,
                    {std::move(options), seed, budget, std::move(schedule), std::move(racing)},
                    {std::move(out), another, jobs, time_limit_s}, command, listener);
  });
  module.def("ask", [](const ProblemHandle& problem, const py::object& optimizer,
                       std::vector<std::string> options, std::uint64_t seed,
                       std::optional<std::int64_t> budget, std::optional<std::string> out,
                       const std::vector<std::string>& command, std::size_t count,
                       const py::object& listener) {
    return ask_for_points(problem, optimizer, {std::move(options), seed, budget, {}, {}},
                          {std::move(out), false, 1, {}}, command, count, listener);
  });
  module.def("tell",
             [](const ProblemHandle& problem, const std::string& folder, const std::string& line) {
               const Problem& own = *problem.loaded.problem;
               tell(folder, own, read_told(line, "tell()", own));
             });
  module.def("load_result", [](const std::string& folder) { return to_json(load_result(folder)); });
  module.def("importance", [](const std::string& folder, std::optional<std::int64_t> simulations,
                              unsigned jobs, const py::object& listener) {
    return show_importance(folder, simulations, jobs, listener);
  });
  module.def("read_history", [](const std::string& folder) { return read_history(folder); });
}

}  // namespace armwright::python
