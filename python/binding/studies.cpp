// Studies: makes or continues them as `armwright compare` does, and reads them.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/text.hpp"
#include "host.hpp"
#include "optimizers/plugins/recorded_optimizer.hpp"
#include "parts.hpp"
#include "study/analysis/final_check.hpp"
#include "study/analysis/study_tables.hpp"
#include "study/compare/plugin_consent.hpp"
#include "study/compare/study_folder.hpp"
#include "study/compare/study_plan.hpp"
#include "study/compare/study_runner.hpp"
#include "study/matrix/cell_attempt.hpp"
#include "study/run/run_observer.hpp"
#include "user_problems.hpp"

namespace armwright::python {
namespace {

using nlohmann::json;

bool is_of_python(const StudyPlan& plan, const Cell& cell) {
  return is_host_name(plan.optimizers[cell.optimizer].row.name) ||
         is_host_name(plan.problems[cell.problem].loaded.program);
}

// Reports a cell's progress as progress of the whole study.
class CellObserver final : public RunObserver {
 public:
  CellObserver(RunObserver& study, Progress done) : study_(study), done_(done) {}
  void on_progress(const Progress& progress) override {
    if (progress.phase == CaseRole::training) {
      Progress all = done_;
      all.done += progress.done;
      all.replayed += progress.replayed;
      study_.on_progress(all);
    }
  }
  void on_message(const std::string& message) override { study_.on_message(message); }

 private:
  RunObserver& study_;
  Progress done_;
};

// Runs the cells whose optimizer or problem is a Python class, one after the other in this process, because
// forked processes must not run Python.
void run_python_cells(const StudyPlan& plan, const std::filesystem::path& folder, unsigned jobs,
                      StopSignal& stop, RunObserver& observer) {
  const auto cells = list_cells(plan);
  Progress progress;
  progress.total = cells.size() * static_cast<std::uint64_t>(plan.budget);
  for (const Cell& cell : cells) {
    if (!is_of_python(plan, cell)) {
      continue;
    }
    if (!load_cell(plan, cell, folder)) {
      if (stop.requested()) {
        return;
      }
      CellObserver its(observer, progress);
      run_cell(plan, cell, {.folder = folder / make_cell_path(plan, cell), .jobs = jobs}, stop,
               its);
    }
    progress.done += static_cast<std::uint64_t>(plan.budget);
  }
}

json list_outcomes(const StudyResult& result) {
  json cells = json::array();
  for (const CellOutcome& cell : result.cells) {
    cells.push_back(json::parse(to_json(cell)));
  }
  return cells;
}

// Returns the content of result.json, every cell, and the parts of the plan that these do not have.
std::string describe(const StudyPlan& plan, const StudyResult& result) {
  json problems = json::array(), optimizers = json::array(), missing = json::array();
  for (std::size_t p = 0; p < plan.problems.size(); ++p) {
    problems.push_back({{"label", plan.problems[p].label},
                        {"name", plan.problems[p].name},
                        {"settings", plan.problems[p].settings},
                        {"schedule", describe_schedule(plan.problems[p])},
                        {"checkpoints", list_checkpoints(plan, p)}});
  }
  for (const StudyOptimizer& optimizer : plan.optimizers) {
    optimizers.push_back(
        {{"label", optimizer.label}, {"name", optimizer.name}, {"baseline", optimizer.baseline}});
  }
  for (const Cell& cell : result.missing) {
    missing.push_back(make_cell_path(plan, cell).string());
  }
  return json{{"result", json::parse(to_json(plan, result))},
              {"cells", list_outcomes(result)},
              {"missing", missing},
              {"plan",
               {{"name", plan.name},
                {"title", plan.title},
                {"seed", plan.seed},
                {"replicates", plan.replicates},
                {"budget", plan.budget},
                {"problems", problems},
                {"optimizers", optimizers}}}}
      .dump();
}

// Returns the study's folder and its results. The results are None if the time limit ended the call
// first.
py::tuple compare(StudyRequest request, const py::list& optimizers, const py::list& own_problems,
                  const Place& place, const py::object& listener) {
  Host host(listener);
  for (const py::handle problem : own_problems) {
    request.hosts.push_back(
        make_program(problem.cast<const ProblemHandle&>().python, host, place.jobs));
  }
  for (const py::handle optimizer : optimizers) {
    if (py::isinstance<py::str>(optimizer)) {
      request.optimizers.push_back(optimizer.cast<std::string>());
    } else {
      request.rows.push_back(load_row(py::reinterpret_borrow<py::object>(optimizer), host));
      request.optimizers.push_back(request.rows.back().name);
    }
  }
  StudyPlan plan = make_study_plan(request);
  const auto path = place.choose(escape_name(plan.name));
  adopt_recorded(path, plan);
  const StudyFolder folder(path, plan);
  remember_study(path, plan.problems);
  for (const std::string& addition : folder.additions()) {
    host.on_message("new in the plan: " + addition);
  }
  host.limit_time(place.time_limit_s);
  adopt_attempts(plan, path, host);
  host.run([&] { run_python_cells(plan, path, place.jobs, host.stop(), host); });
  std::optional<StudyResult> result;
  host.run_aside([&] {
    if (!run_cells(plan, path, place.jobs, host.stop(), host)) {
      return;
    }
    StudyResult found = analyze_study(plan, path);
    if (add_final_checks(plan, path, place.jobs, host.stop(), host, found)) {
      write_study_tables(plan, found, path);
      result = std::move(found);
    }
  });
  return py::make_tuple(path.string(),
                        result ? py::object(py::str(describe(plan, *result))) : py::none());
}

std::string load_study(const std::filesystem::path& folder) {
  const StudyPlan plan = load_study_plan(folder);
  StudyResult result = analyze_study(plan, folder);
  load_final_checks(plan, folder, result);
  return describe(plan, result);
}

}  // namespace

void add_studies(py::module_& module) {
  module.def(
      "compare",
      [](const std::string& file, std::vector<std::string> problems, const py::list& optimizers,
         const py::list& own_problems, std::vector<std::string> settings,
         std::optional<std::int64_t> replicates, std::optional<std::int64_t> budget,
         const std::optional<std::string>& schedule, std::optional<std::uint64_t> seed,
         bool baselines, bool trust, std::optional<std::string> out, bool another, unsigned jobs,
         std::optional<double> time_limit_s, const py::object& listener) {
        StudyRequest request;
        request.file = file;
        request.problems = std::move(problems);
        request.settings = std::move(settings);
        constexpr std::int64_t kMostReplicates = 10'000;
        if (replicates) {
          request.replicates =
              static_cast<int>(check_number("replicates", *replicates, 1, kMostReplicates));
        }
        if (budget) {
          request.budget = check_number("budget", *budget, 1, kMostBudget);
        }
        if (schedule) {
          request.schedule = read_study_schedule(*schedule);
          if (!request.schedule) {
            throw Error(ErrorKind::usage,
                        fmt::format("schedule is '{}'; it must be {}", sanitize(*schedule),
                                    describe_study_schedules()));
          }
        }
        request.seed = seed;
        request.baselines = baselines;
        request.ask = [trust](const std::string&) { return trust; };
        return compare(std::move(request), optimizers, own_problems,
                       {std::move(out), another, jobs, time_limit_s}, listener);
      });
  module.def("escape_name", [](const std::string& label) { return escape_name(label); });
  module.def("load_study", [](const std::string& folder) {
    const py::gil_scoped_release released;
    return load_study(folder);
  });
}

}  // namespace armwright::python
