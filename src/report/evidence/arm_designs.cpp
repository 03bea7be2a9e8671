// Chooses the designs that a page shows of a run.

#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"
#include "base/folder.hpp"
#include "base/text.hpp"
#include "problems/config/config_files.hpp"
#include "report/evidence/arm_evidence.hpp"

namespace armwright {
namespace {

// Returns the design's file for `armwright evaluate`, or the name of a shipped design.
std::string find_design_argument(const RecordedRun& run, const std::string& name) {
  const auto path = resolve_config("designs", name, run.input_folder);
  return path.stem() == name ? name : path.string();
}

// Returns whether published numbers apply to the run's problem. They hold for the problem as it is
// shipped, with the settings that belong to them. Another engine computes the same problem; every
// other setting makes another problem.
bool is_as_published(const RecordedRun& run) {
  for (std::size_t i = 3; i < run.problem_arguments.size(); i += 2) {
    const std::string& setting = run.problem_arguments[i];
    const bool chooses_engine = std::ranges::any_of(
        std::initializer_list<const char*>{"engine", "judging_engine", "precision", "simd"},
        [&](const char* key) { return setting.starts_with(fmt::format("physics.{}=", key)); });
    if (!chooses_engine && std::ranges::count(run.problem->published.set, setting) == 0) {
      return false;
    }
  }
  return true;
}

void add_published(const RecordedRun& run, const std::string& name, ShownDesign& design) {
  const PublishedWinner& published = run.problem->published;
  if (name == published.design && is_as_published(run)) {
    design.published_mean_m = published.error_m;
    design.published_torque_n_m = published.total_torque_n_m;
    design.where = published.where;
  }
}

// Returns the name of the start or of the published design on all pages.
std::string name_design(const std::string& id) {
  return id == "base" ? kBaseControllers : id;
}

// If the file is missing or made for another arm, returns nothing and adds a note.
std::optional<ShownDesign> load_shown(const RecordedRun& run, const std::string& name,
                                      const std::string& id, std::vector<std::string>& notes) {
  try {
    ShownDesign design;
    design.argument = find_design_argument(run, name);
    const DesignFile file = load_design(design.argument);
    run.tracking()->check_design(file.design);
    design.named = {id, name_design(id), file.design};
    design.source = file.source;
    add_published(run, name, design);
    return design;
  } catch (const Error& error) {
    notes.push_back(fmt::format("The design {} cannot be shown beside the others: {}.",
                                sanitize(name), sanitize(error.what())));
    return std::nullopt;
  }
}

}  // namespace

std::vector<ShownDesign> list_designs(const RecordedRun& run, std::vector<std::string>& notes) {
  std::vector<ShownDesign> designs;
  const TrackingProblem& tracking = *run.tracking();
  const std::vector<double> best = run.find_best();
  if (!best.empty()) {
    ShownDesign& winner = designs.emplace_back();
    winner.named = {"winner", run.result ? "winner" : "best so far", tracking.make_design(best)};
    const auto file = run.folder / "winner.toml";
    winner.argument = run.result && path_exists(file) ? file.string() : "";
  }
  const auto& variables = run.configuration.at("problem").at("variables");
  const auto start = variables.at("start").get<std::string>();
  if (start == kProposedStart) {
    ShownDesign& base = designs.emplace_back();
    base.named = {"base", kProposedControllers, tracking.config().start};
    base.argument = kStartDesign;
  } else if (auto base = load_shown(run, start, "base", notes)) {
    designs.push_back(std::move(*base));
  }
  const std::string& published = run.problem->published.design;
  if (!published.empty() && published != start) {
    if (auto design = load_shown(run, published, "published", notes)) {
      designs.push_back(std::move(*design));
    }
  }
  return designs;
}

void simulate_designs(const RecordedRun& run, PageSimulator& simulator,
                      std::vector<ShownDesign>& designs) {
  const CaseSets& sets = run.problem->sets;
  for (ShownDesign& design : designs) {
    design.results =
        simulator.evaluate(*run.tracking(), design.named.design, run.tracking()->get_set(sets.test),
                           0, static_cast<std::uint64_t>(sets.test_cases));
  }
}

}  // namespace armwright
