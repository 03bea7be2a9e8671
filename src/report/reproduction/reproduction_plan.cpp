#include "report/reproduction/reproduction_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>

#include "base/error.hpp"
#include "base/text.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "problems/config/config_files.hpp"
#include "study/run/design_evaluation.hpp"

namespace armwright {
namespace {

std::vector<std::string> choose_designs(const std::vector<std::string>& tables) {
  std::vector<std::string> designs;
  for (const std::string& name : list_configs("designs")) {
    if (!load_design(name).published.empty()) {
      designs.push_back(name);
    }
  }
  std::ranges::sort(designs, {}, get_natural_key);
  if (tables.empty()) {
    return designs;
  }
  std::vector<std::string> valid;
  std::ranges::transform(designs, std::back_inserter(valid), get_table_name);
  std::vector<bool> wanted(designs.size());
  for (const std::string& table : tables) {
    const auto named = std::ranges::find(valid, table);
    const auto found = std::ranges::find(designs, table);
    if (named == valid.end() && found == designs.end()) {
      throw Error(ErrorKind::usage, describe_unknown("table", table, valid));
    }
    wanted[static_cast<std::size_t>(named != valid.end() ? named - valid.begin()
                                                         : found - designs.begin())] = true;
  }
  std::vector<std::string> chosen;
  for (std::size_t i = 0; i < designs.size(); ++i) {
    if (wanted[i]) {
      chosen.push_back(designs[i]);
    }
  }
  return chosen;
}

class Planner {
 public:
  explicit Planner(const ReproductionRequest& request) { plan_.request = request; }

  ReproductionPlan make() {
    const std::vector<std::string> designs = choose_designs(plan_.request.tables);
    for (const std::string& name : designs) {
      add_published(load_design(name));
    }
    if (plan_.request.whole) {
      const ReproductionConfig config = load_reproduction_config(plan_.request.config);
      if (plan_.request.tables.empty()) {
        add_unpublished(config);
        add_runs(config);
        check_reasons(config);
      }
      add_sweep(config.sweep, designs);
    }
    return std::move(plan_);
  }

 private:
  void add(ReproductionPart part, const ArmDesign& design) {
    PlannedPart planned;
    std::vector<std::string> overrides = part.overrides;
    std::ranges::copy(plan_.request.overrides, std::back_inserter(overrides));
    planned.problem = load_problem(part.problem, overrides);
    const TrackingProblem& tracking = require_tracking(planned.problem);
    if (!part.design.empty()) {
      tracking.check_design(design);
    }
    planned.cases =
        plan_.request.cases.value_or(static_cast<std::uint64_t>(planned.problem.sets.test_cases));
    if (!labels_.insert(part.label).second) {
      throw Error(ErrorKind::usage,
                  fmt::format("two results to reproduce have the label '{}'; labels in "
                              "configs/designs and configs/reproductions must differ",
                              sanitize(part.label)));
    }
    planned.part = std::move(part);
    planned.design = design;
    plan_.parts.push_back(std::move(planned));
  }

  void add_published(const DesignFile& file) {
    for (const PublishedResult& published : file.published) {
      ReproductionPart part;
      part.label = published.label;
      part.design = file.name;
      part.problem = published.problem;
      part.overrides = published.overrides;
      part.published_error_m = published.error_m;
      part.published_torque_n_m = published.total_torque_n_m;
      part.where = published.where;
      add(std::move(part), file.design);
    }
  }

  void add_unpublished(const ReproductionConfig& config) {
    for (const ReproductionPart& part : config.unpublished) {
      add(part, load_design(part.design).design);
    }
  }

  void add_runs(const ReproductionConfig& config) {
    for (ReproductionPart part : config.runs) {
      plan_.runs.push_back(make_run(config, part.problem));
      const PublishedWinner& published = plan_.runs.back().problem.published;
      part.run = plan_.runs.back().problem.name;
      part.published_error_m = published.error_m;
      part.published_torque_n_m = published.total_torque_n_m;
      part.where = published.where;
      add(part, {});
      for (const ReproductionPart& again : config.reevaluations) {
        if (again.run == part.run) {
          part.label = again.label;
          part.overrides = again.overrides;
          part.published_torque_n_m.reset();  // the same design; its first row has the torque
          part.where = again.where;
          add(part, {});
        }
      }
    }
  }

  // Throws Error{usage} if a reason belongs to no result.
  void check_reasons(const ReproductionConfig& config) const {
    const std::vector<std::string> valid(labels_.begin(), labels_.end());
    for (const auto& [label, reason] : config.reasons) {
      if (!labels_.contains(label)) {
        throw Error(ErrorKind::usage,
                    fmt::format("{}: difference.parts: {}", sanitize(plan_.request.config),
                                describe_unknown("result", label, valid)));
      }
    }
  }

  static RunPlan make_run(const ReproductionConfig& config, const std::string& name) {
    RunPlan run;
    run.seed = config.seed;
    std::vector<std::string> overrides = config.overrides;
    overrides.push_back("physics.engine=" + config.engine);
    overrides.push_back("physics.judging_engine=" + config.engine);
    run.problem = load_problem(name, overrides);
    run.optimizer = load_optimizer(config.optimizer);
    run.options = Options::parse(run.optimizer.name, run.optimizer.options, {});
    run.budget = run.problem.budget;
    run.schedule = choose_schedule(run.problem, run.optimizer);
    run.racing = run.problem.racing;
    check_plan(run);
    return run;
  }

  void add_sweep(const std::string& name, const std::vector<std::string>& designs) {
    const LoadedProblem problem = load_problem(name);
    if (!problem.sweep) {
      throw Error(ErrorKind::usage,
                  fmt::format("problem '{}' is to be swept, but has no [sweep]", sanitize(name)));
    }
    if (std::ranges::find(designs, problem.sweep->design) == designs.end()) {
      return;  // not among the chosen tables
    }
    const DesignFile file = load_design(problem.sweep->design);
    for (const double value : problem.sweep->values) {
      ReproductionPart part;
      part.kind = ReproductionPart::Kind::sweep;
      part.label = fmt::format("{} {}", name, format_exact(value));
      part.design = file.name;
      part.problem = name;
      part.overrides = file.published.front().overrides;
      part.overrides.push_back(problem.sweep->parameter + "=" + format_exact(value));
      part.value = value;
      add(std::move(part), file.design);
    }
  }

  ReproductionPlan plan_;
  std::set<std::string> labels_;
};

}  // namespace

std::pair<std::string, long long> get_natural_key(const std::string& name) {
  const std::size_t digits = name.find_last_not_of("0123456789") + 1;
  return {name.substr(0, digits), parse_integer(name.substr(digits)).value_or(-1)};
}

std::string get_table_name(const std::string& design) {
  constexpr std::string_view kPrefix = "table-a";
  return design.starts_with(kPrefix) ? "A." + design.substr(kPrefix.size()) : design;
}

ReproductionPlan plan_reproduction(const ReproductionRequest& request) {
  return Planner(request).make();
}

}  // namespace armwright
