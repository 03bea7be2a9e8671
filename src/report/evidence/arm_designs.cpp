#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"
#include "base/text.hpp"
#include "problems/config/config_files.hpp"
#include "report/evidence/arm_evidence.hpp"

namespace armwright {
namespace {

// A design's file as `armwright evaluate` finds it: a shipped name stays a name.
std::string find_design_word(const RecordedRun& run, const std::string& name) {
  const auto path = resolve_config("designs", name, run.beside);
  return path.stem() == name ? name : path.string();
}

// What is published of a design holds for the problem as it is shipped: another engine is another
// way to compute it, any other setting another problem.
bool is_as_published(const RecordedRun& run) {
  for (std::size_t i = 3; i < run.problem_words.size(); i += 2) {
    const std::string& setting = run.problem_words[i];
    const bool chooses_engine = std::ranges::any_of(
        std::initializer_list<const char*>{"engine", "judging_engine", "precision", "simd"},
        [&](const char* key) { return setting.starts_with(fmt::format("physics.{}=", key)); });
    if (!chooses_engine) {
      return false;
    }
  }
  return true;
}

void add_published(const RecordedRun& run, const DesignFile& file, ShownDesign& design) {
  if (!is_as_published(run)) {
    return;
  }
  for (const PublishedResult& result : file.published) {
    if (result.problem == run.problem_name && result.overrides.empty()) {
      design.published_mean_m = result.error_m;
      design.published_torque_n_m = result.total_torque_n_m;
      design.where = result.where;
      return;
    }
  }
}

// Nothing but a note if its file is missing or made for another arm.
std::optional<ShownDesign> load_shown(const RecordedRun& run, const std::string& name,
                                      const std::string& id, std::vector<std::string>& notes) {
  try {
    ShownDesign design;
    design.word = find_design_word(run, name);
    const DesignFile file = load_design(design.word);
    run.tracking()->check_design(file.design);
    design.named = {id, file.source.empty() ? file.name : file.source, file.design};
    add_published(run, file, design);
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
    winner.word = run.result && std::filesystem::exists(file) ? file.string() : "";
  }
  const auto& variables = run.configuration.at("problem").at("variables");
  const auto start = variables.at("start").get<std::string>();
  if (start == kProposedStart) {
    ShownDesign& base = designs.emplace_back();
    base.named = {"base", "proposed controllers", tracking.config().start};
    base.word = kStartDesign;
  } else if (auto base = load_shown(run, start, "base", notes)) {
    base->named.name = "base controllers";
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
