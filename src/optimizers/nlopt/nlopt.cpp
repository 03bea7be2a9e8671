// The rows of the NLopt algorithms: their options, and the optimizer that runs an algorithm.

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"
#include "optimizers/interface/differences.hpp"
#include "optimizers/interface/isolation.hpp"
#include "optimizers/interface/scalar_function.hpp"
#include "optimizers/nlopt/nlopt_algorithms.hpp"
#include "optimizers/nlopt/nlopt_backend.hpp"

namespace armwright {
namespace {

class Nlopt : public Optimizer {
 public:
  Nlopt(const NloptAlgorithm& algorithm, const Options& options) : algorithm_(algorithm) {
    const auto& values = options.values();
    const auto number = [&](const std::string& name) {
      return values.contains(name) ? options.get_number(name) : 0.0;
    };
    const auto integer = [&](const std::string& name) {
      return values.contains(name) ? options.get_integer(name) : 0;
    };
    isolated_ = algorithm.isolated;
    smallest_dimension_ = algorithm.smallest_dimension;
    settings_ = {.optimizer = "nlopt:" + algorithm.name,
                 .algorithm = algorithm.nlopt_name,
                 .takes_constraints = algorithm.takes_constraints,
                 .is_paced = algorithm.needs_pace,
                 .initial_step = number("initial_step"),
                 .xtol_rel = number("xtol_rel"),
                 .ftol_rel = number("ftol_rel"),
                 .population = integer("population"),
                 .restarts = integer("restarts"),
                 .tolerances_are_local = algorithm.kind == NloptKind::starting,
                 .constraint_weight = number("constraint_weight")};
    if (algorithm.takes_gradients) {
      settings_.differences = read_differences(options);
    }
    if (values.contains("local")) {
      const NloptAlgorithm& local = find_nlopt_algorithm(options.get_text("local"));
      settings_.local = local.nlopt_name;
      isolated_ = isolated_ || local.isolated;
      smallest_dimension_ = std::max(smallest_dimension_, local.smallest_dimension);
    }
  }

  void minimize(Evaluator& evaluator, std::uint64_t seed) override {
    check_dimension(evaluator.problem());
    const auto body = [&](Evaluator& asked) { minimize_with_nlopt(settings_, asked, seed); };
    if (isolated_) {
      minimize_isolated(settings_.optimizer, body, evaluator, ProcessLimits{});
    } else {
      body(evaluator);
    }
  }

 private:
  void check_dimension(const ProblemDescription& problem) const {
    const int dimension = static_cast<int>(problem.variables.size());
    if (dimension < smallest_dimension_) {
      throw Error(ErrorKind::usage,
                  fmt::format("optimizer '{}': the problem has {} decision variables; with these "
                              "options it must have at least {}",
                              settings_.optimizer, dimension, smallest_dimension_));
    }
    if (algorithm_.largest_dimension > 0 && dimension > algorithm_.largest_dimension) {
      throw Error(ErrorKind::usage,
                  fmt::format("optimizer '{}': the problem has {} decision variables; it can have "
                              "{} at most",
                              settings_.optimizer, dimension, algorithm_.largest_dimension));
    }
  }

  const NloptAlgorithm& algorithm_;
  NloptSettings settings_;
  bool isolated_ = false;
  int smallest_dimension_ = 1;
};

std::vector<OptionSpec> make_options(const NloptAlgorithm& algorithm) {
  const bool takes_steps = (algorithm.kind == NloptKind::local && !algorithm.takes_gradients) ||
                           algorithm.kind == NloptKind::starting ||
                           algorithm.kind == NloptKind::wrapping;
  const bool descends = algorithm.kind == NloptKind::local || algorithm.kind == NloptKind::wrapping;
  std::vector<OptionSpec> options;
  if (algorithm.kind == NloptKind::starting) {
    options.push_back(
        {.name = "local",
         .description =
             "local optimizer of each search; bobyqa, newuoa_bound and praxis need at least "
             "2 variables; praxis uses random numbers",
         .fallback = std::string("bobyqa"),
         .choices = {"bobyqa", "cobyla", "neldermead", "newuoa_bound", "praxis", "sbplx"}});
  }
  if (algorithm.kind == NloptKind::wrapping) {
    const bool passes_constraints_on = algorithm.name == "auglag_eq";
    std::vector<std::string> choices = {"cobyla"};
    if (!passes_constraints_on) {
      choices = {"bobyqa", "cobyla", "neldermead", "newuoa_bound", "praxis", "sbplx"};
    }
    options.push_back(
        {.name = "local",
         .description = passes_constraints_on
                            ? "inner local optimizer, which handles the inequality constraints"
                            : "inner local optimizer; bobyqa, newuoa_bound and praxis need at "
                              "least 2 variables; praxis uses random numbers",
         .fallback = choices.front(),
         .choices = choices});
  }
  if (algorithm.takes_gradients) {
    options.push_back(make_differences_option("central"));
    options.push_back({.name = "step",
                       .description = "of the differences, share of the box; simulated objectives "
                                      "are rough and need 0.001 or more",
                       .fallback = 1e-6,
                       .lower = 1e-12,
                       .upper = 0.25});
  }
  if (takes_steps) {
    options.push_back(
        {.name = "initial_step",
         .description = "first step in every coordinate, as a share of the box; 0: NLopt derives "
                        "it from start and bounds",
         .fallback = 0.05,
         .lower = 0,
         .upper = 0.49});  // BOBYQA wants two steps within the box
  }
  if (algorithm.kind != NloptKind::covering) {
    const double xtol_rel = descends ? 1e-8 : takes_steps ? 1e-4 : 0.0;
    options.push_back({.name = "xtol_rel",
                       .description = "a search ends when its steps are this small, relative to "
                                      "the coordinates; 0: never",
                       .fallback = xtol_rel,
                       .lower = 0,
                       .upper = 1});
    options.push_back({.name = "ftol_rel",
                       .description = "a search ends when its gains are this small, relative to "
                                      "the objective; 0: never",
                       .fallback = 0.0,
                       .lower = 0,
                       .upper = 1});
  }
  if (algorithm.kind == NloptKind::drawing || algorithm.kind == NloptKind::starting) {
    options.push_back({.name = "population",
                       .description = algorithm.kind == NloptKind::drawing
                                          ? "number of individuals; 0: NLopt chooses it"
                                          : "number of points drawn at a time; 0: NLopt chooses it",
                       .fallback = std::int64_t{0},
                       .lower = 0,
                       .upper = 100000});
  }
  if (descends) {
    options.push_back({.name = "restarts",
                       .description = algorithm.takes_gradients
                                          ? "largest number of restarts at the best point seen; a "
                                            "restart without an improvement is the last"
                                          : "largest number of restarts at the best point seen, "
                                            "each with half the step; a restart without an "
                                            "improvement is the last",
                       .fallback = algorithm.restarts,
                       .lower = 0,
                       .upper = 1000});
  }
  if (!algorithm.takes_constraints) {
    options.push_back(make_constraint_weight_option());
  }
  return options;
}

// Returns when the algorithm runs in a child process: "always"; "" for never; or the choices of
// the option `local` for which it does, as in "with local=cobyla or local=newuoa_bound".
std::string explain_isolation(const NloptAlgorithm& algorithm,
                              std::span<const OptionSpec> options) {
  const auto local = std::ranges::find(options, "local", &OptionSpec::name);
  if (algorithm.isolated || local == options.end()) {
    return algorithm.isolated ? "always" : "";
  }
  std::vector<std::string> isolated;
  for (const std::string& choice : local->choices) {
    if (find_nlopt_algorithm(choice).isolated) {
      isolated.push_back("local=" + choice);
    }
  }
  const bool always = isolated.size() == local->choices.size();
  return always ? "always" : "with " + join(isolated, " or ");
}

OptimizerRow make_row(const NloptAlgorithm& algorithm) {
  const bool descends = algorithm.kind == NloptKind::local || algorithm.kind == NloptKind::wrapping;
  const std::vector<OptionSpec> specs = make_options(algorithm);
  return {
      .name = "nlopt:" + algorithm.name,
      .summary = algorithm.summary,
      .source = algorithm.source,
      .capabilities = {.bounds = !algorithm.leaves_box,
                       .constraints = algorithm.takes_constraints,
                       .batch = algorithm.takes_gradients,
                       .stochastic = algorithm.is_stochastic,
                       .local = descends},
      .options = specs,
      .make = [&algorithm](const Options& options) -> std::unique_ptr<Optimizer> {
        return std::make_unique<Nlopt>(algorithm, options);
      },
      .requirements = {.variables = algorithm.smallest_dimension},
      .backend = "NLopt (CMake option ARMWRIGHT_WITH_NLOPT)",
      .isolated = explain_isolation(algorithm, specs),
      .unfit = algorithm.unfit,
      .unavailable = algorithm.unfit.empty() ? explain_missing_nlopt() : algorithm.unfit,
  };
}

}  // namespace

std::vector<OptimizerRow> make_nlopt_rows() {
  std::vector<OptimizerRow> rows;
  std::ranges::transform(nlopt_algorithms(), std::back_inserter(rows), make_row);
  return rows;
}

}  // namespace armwright
