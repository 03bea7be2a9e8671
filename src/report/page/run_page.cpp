// Makes the page of a run.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/text.hpp"
#include "problems/user/user_problem.hpp"
#include "report/evidence/arm_evidence.hpp"
#include "report/evidence/distance_response.hpp"
#include "report/evidence/page_json.hpp"
#include "report/evidence/robot_scene.hpp"
#include "report/page/page_data.hpp"
#include "report/page/page_file.hpp"
#include "report/page/progress_meter.hpp"
#include "report/page/run_parts.hpp"
#include "study/run/run.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr std::size_t kMostIncumbents = 24;
constexpr int kMostIncumbentCases = 100;

int count_incumbent_cases(const RecordedRun& run) {
  return std::min(run.problem->sets.test_cases, kMostIncumbentCases);
}

// Returns Incumbents. Without a simulator (null) they have no values on the test set.
json make_incumbents(const RecordedRun& run, const std::vector<Incumbent>& shown,
                     bool by_generation, PageSimulator* simulator) {
  json incumbents = {
      {"index", json::array()},
      {"cases", json::array()},
      {"training", json::array()},
      {"test", json::array()},
      {"test_set", run.problem ? run.problem->sets.test : ""},
      {"test_cases", run.problem ? count_incumbent_cases(run) : 0},
      {"engine", run.tracking() != nullptr ? run.tracking()->config().engines.judging_name : ""}};
  CaseBlock block{.role = CaseRole::test, .set = incumbents["test_set"], .numbers = {}};
  block.numbers.resize(incumbents["test_cases"].get<std::size_t>());
  std::iota(block.numbers.begin(), block.numbers.end(), std::uint64_t{0});
  for (const Incumbent& incumbent : shown) {
    const EvaluationRecord record = run.journal.training.find(incumbent.evaluation).value();
    incumbents["index"].push_back(by_generation ? record.generation : incumbent.evaluation + 1);
    incumbents["cases"].push_back(incumbent.cases);
    incumbents["training"].push_back(finite_or_null(incumbent.objective));
    json& test = incumbents["test"].emplace_back(nullptr);
    if (simulator != nullptr) {
      const Evaluation evaluation = simulator->evaluate(*run.problem->problem, record.x, block);
      if (!evaluation.objectives.empty()) {
        test = finite_or_null(calc_scalar(run.describe(), evaluation.objectives));
      }
    }
  }
  return incumbents;
}

void add_notes(const RecordedRun& run, const History& history, const PageOptions& options,
               std::vector<std::string>& notes) {
  if (!run.result) {
    notes.push_back("The run has not ended, so it has no winner and no test of a winner yet.");
  } else if (!run.result->winner) {
    notes.push_back("No design that the run found has a number, so there is no winner.");
  }
  if (run.result && !run.result->failure.empty()) {
    notes.push_back(
        fmt::format("The optimizer failed before its end: {}.", sanitize(run.result->failure)));
  }
  if (run.result && run.journal.training.size() < run.result->counts.evaluations) {
    notes.push_back(fmt::format(
        "The journal holds {} of the {} evaluations of result.json. 'armwright doctor' on the "
        "folder says more.",
        run.journal.training.size(), run.result->counts.evaluations));
  }
  if (run.journal.torn_bytes > 0) {
    notes.push_back("The journal ends in the middle of a record, which was left out.");
  }
  if (history.left_out > 0) {
    notes.push_back(fmt::format("Of {} generations {} are shown, evenly spread, and the last.",
                                history.left_out + history.parts.size(), history.parts.size()));
  }
  if (!run.describe().constraints.empty()) {
    notes.push_back(
        "In training, best, mean and worst count only the designs that meet all constraints.");
  }
  if (run.is_identification()) {
    return;  // its page has no parts that need a simulation
  }
  if (!run.problem) {
    notes.push_back(
        "Without the problem the bounds of its variables are unknown, so their history is left "
        "out.");
  } else if (!options.simulate) {
    notes.push_back(
        "Nothing was simulated for this page: replays, tests of incumbents and of "
        "other designs, the distance response and the sweep are left out.");
  }
}

// Adds a note if the winner's errors, simulated now, differ from those that the run recorded.
void compare_with_record(const RecordedRun& run, const std::vector<ShownDesign>& designs,
                         std::vector<std::string>& notes) {
  const auto now = get_case_errors(designs.front().results);
  const auto& recorded = run.result->test.case_errors;
  for (std::size_t i = 0; i < std::min(now.size(), recorded.size()); ++i) {
    const bool same = now[i] == recorded[i] || (std::isnan(now[i]) && std::isnan(recorded[i]));
    if (!same) {
      notes.push_back(
          fmt::format("The simulations for this page differ from those that the run recorded, "
                      "first on test case {}: {} m recorded, {} m now.",
                      i, format_exact(recorded[i]), format_exact(now[i])));
      return;
    }
  }
}

// Adds the parts that only an arm has. All simulations except those of the incumbents happen here.
void add_arm(const RecordedRun& run, const PageOptions& options, PageSimulator* simulator,
             json& page, std::vector<std::string>& notes) {
  auto designs = list_designs(run, notes);
  const TrackingProblem& problem = *run.tracking();
  // An unfinished run has no winner to test. Its page shows the incumbent's motions.
  const bool has_winner = run.result && run.result->winner;
  if (simulator != nullptr) {
    const auto requests = choose_replays(run, designs, options.cases);
    std::vector<NamedDesign> named;
    for (const ShownDesign& design : designs) {
      named.push_back(design.named);
    }
    simulator->expect(requests.size() * named.size());
    if (has_winner) {
      simulator->expect(designs.size() * static_cast<std::uint64_t>(run.problem->sets.test_cases) +
                        count_sweep_cases(run, designs) + kHealthCases);
      simulate_designs(run, *simulator, designs);
      compare_with_record(run, designs, notes);
    }
    const auto groups = divide_by_motion(problem, named);
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const std::size_t robot =
          add_robot(make_shown_arm(problem, groups[g].front()), problem.config().task,
                    run.find_urdf().parent_path(), page["robots"], notes);
      page["replays"].push_back(make_replay_set(*simulator, problem,
                                                make_group_text({"run", "Motions"}, groups, g),
                                                robot, groups[g], requests));
    }
  }
  page["test"] = make_test_errors(run, designs);
  page["arm"] = make_arm_evidence(run, designs, has_winner ? simulator : nullptr, notes);
}

json make_page(const RecordedRun& run, const PageOptions& options, PageSimulator& simulator) {
  const std::string optimizer = run.configuration.at("run").at("optimizer").get<std::string>();
  const ProblemDescription description = run.describe();
  const History history = divide_history(run.journal.training);
  // A page never starts a program of the user.
  const bool can_simulate = run.problem && find_user_description(*run.problem->problem) == nullptr;
  PageSimulator* used = options.simulate && can_simulate ? &simulator : nullptr;
  const auto incumbents =
      thin_out(find_incumbents(description, run.journal.training, run.schedule), kMostIncumbents);
  if (used != nullptr) {
    used->expect(incumbents.size() * static_cast<std::uint64_t>(count_incumbent_cases(run)));
  }
  std::vector<std::string> notes = run.notes;
  add_notes(run, history, options, notes);
  const Quantity quantity = get_scalar_quantity(description.objectives);
  json progress = nullptr;
  if (!run.result) {
    progress = {{"done", history.parts.empty() ? 0 : history.parts.back().cases},
                {"total", run.budget},
                {"unit", "cases"}};
  }
  json page = {
      {"format", kPageFormat},
      {"kind", "run"},
      {"title", fmt::format("{} on {}", shorten_optimizer(optimizer), run.problem_name)},
      {"subtitle", run.problem ? run.problem->title : ""},
      {"program", make_program()},
      {"folder", run.folder.string()},
      {"command", run.make_begin_command()},
      {"finished", run.result.has_value()},
      {"progress", std::move(progress)},
      {"watched", options.meter == nullptr ? json(nullptr) : options.meter->observe_run(run)},
      {"facts", make_run_facts(run)},
      {"headline", make_headline(run, history)},
      {"robots", json::array()},
      {"replays", json::array()},
      {"problem", run.problem_name},
      {"optimizer", optimizer},
      {"quantity", run.make_quantity(quantity)},
      {"logarithmic", quantity.name.starts_with("ln(")},
      {"variables", make_variables(run, history)},
      {"front", make_front(run)},
      {"requirements", make_requirements(run)},
      {"limits", make_limits(run)},
      {"metrics", make_metrics(run)},
      {"failure_reasons", make_failure_reasons(run)},
      {"importance", make_importance(run)},
      {"record", nullptr},
      {"record_limits", nullptr},
      {"files", json::array()},
      {"identification", nullptr},
      {"arm", nullptr}};
  if (run.tracking() != nullptr) {
    add_arm(run, options, used, page, notes);
  } else {
    page["test"] = make_test_errors(run, {});
    add_winner_record(run, page, notes);
    add_planned_motion(run, page, notes);
    add_identification(run, page, notes);
  }
  page["training"] =
      make_training(run, history, make_incumbents(run, incumbents, history.by_generation, used));
  page["notes"] = notes;
  return page;
}

}  // namespace

std::optional<std::string> make_run_page(const std::filesystem::path& folder,
                                         const PageOptions& options, StopSignal& stop,
                                         RunObserver& observer) {
  const RecordedRun run = read_recorded_run(folder);
  PageSimulator simulator(options.jobs, stop, observer);
  try {
    return dump_page(make_page(run, options, simulator));
  } catch (const WorkStopped&) {
    return std::nullopt;
  }
}

}  // namespace armwright
