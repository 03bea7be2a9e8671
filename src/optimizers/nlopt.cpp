#include "optimizers/nlopt.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"
#include "optimizers/isolation.hpp"
#include "optimizers/nlopt_backend.hpp"
#include "optimizers/scalar_function.hpp"

namespace armwright {
namespace {

// How an algorithm searches, which decides on its options.
enum class Kind {
  local,     // from the start, with a step; ends by itself
  dividing,  // DIRECT: cuts the box up
  drawing,   // populations of random points
  starting,  // MLSL: starts a local optimizer again and again
  wrapping,  // AUGLAG: a local optimizer under multipliers
  covering   // AGS: a space-filling curve
};

// What NLopt 2.7.1 is known for beyond its documentation.
struct Algorithm {
  std::string name;        // behind "nlopt:"
  std::string nlopt_name;  // without its prefix
  Kind kind = Kind::local;
  std::string summary;
  std::string source;
  bool takes_constraints = false;
  bool is_stochastic = false;
  bool leaves_box = false;
  // It can go round in circles without asking for a point, and then nothing inside this process
  // stops it.
  bool isolated = false;
  std::int64_t restarts = 20;  // of those that end by themselves
  bool needs_pace = false;     // is told the number of evaluations, for its storage only
  int smallest_dimension = 1;
  int largest_dimension = 0;  // 0: any
  std::string unfit = {};     // why it is not offered, although the library has it
};

constexpr const char* kJones =
    "Jones, Perttunen and Stuckman 1993, Lipschitzian optimization without the Lipschitz constant";
constexpr const char* kGablonsky =
    "Gablonsky and Kelley 2001, A locally-biased form of the DIRECT algorithm";
constexpr const char* kMlsl =
    "Rinnooy Kan and Timmer 1987, Stochastic global optimization methods; Kucherenko and Sytsko "
    "2005, Application of deterministic low-discrepancy sequences in global optimization";
constexpr const char* kAuglag =
    "Conn, Gould and Toint 1991, A globally convergent augmented Lagrangian algorithm for "
    "optimization with general constraints and simple bounds; Birgin and Martinez 2008, Improving "
    "ultimate convergence of an augmented Lagrangian method";

const std::vector<Algorithm>& algorithms() {
  static const std::vector<Algorithm> table = {
      {.name = "cobyla",
       .nlopt_name = "LN_COBYLA",
       .summary = "COBYLA: linear models of objective and constraints in a trust region",
       .source = "Powell 1994, A direct search optimization method that models the objective and "
                 "constraint functions by linear interpolation",
       .takes_constraints = true,
       .isolated = true},
      {.name = "bobyqa",
       .nlopt_name = "LN_BOBYQA",
       .summary = "BOBYQA: quadratic models in a trust region within the box",
       .source = "Powell 2009, The BOBYQA algorithm for bound constrained optimization without "
                 "derivatives",
       .smallest_dimension = 2},
      {.name = "newuoa",
       .nlopt_name = "LN_NEWUOA",
       .summary = "NEWUOA: quadratic models in a trust region that knows no bounds",
       .source = "Powell 2006, The NEWUOA software for unconstrained optimization without "
                 "derivatives",
       .leaves_box = true,
       .smallest_dimension = 2},
      {.name = "newuoa_bound",
       .nlopt_name = "LN_NEWUOA_BOUND",
       // NLopt finds every step within the bounds by a run of MMA: 2.2 ms of its own time an
       // evaluation at 12 variables, 4.2 ms at 24, where newuoa and bobyqa take 0.01 and 0.05 ms.
       .summary = "NEWUOA with bounds in its steps, at 100 times the time of bobyqa",
       .source = "Powell 2006, The NEWUOA software for unconstrained optimization without "
                 "derivatives; Johnson 2007, The NLopt nonlinear-optimization package (bounds)",
       .isolated = true,
       .restarts = 0,  // begun at a minimum it goes round in circles
       .smallest_dimension = 2},
      {.name = "praxis",
       .nlopt_name = "LN_PRAXIS",
       .summary = "PRAXIS: line searches along principal axes",
       .source = "Brent 1973, Algorithms for minimization without derivatives",
       .is_stochastic = true,
       .smallest_dimension = 2},
      {.name = "neldermead",
       .nlopt_name = "LN_NELDERMEAD",
       .summary = "Nelder-Mead simplex within the box; may collapse onto its boundary",
       .source = "Nelder and Mead 1965, A simplex method for function minimization; Box 1965, A "
                 "new method of constrained optimization and a comparison with other methods"},
      {.name = "sbplx",
       .nlopt_name = "LN_SBPLX",
       .summary = "Subplex: Nelder-Mead on a sequence of subspaces",
       .source = "Rowan 1990, Functional stability analysis of numerical algorithms"},
      {.name = "direct",
       .nlopt_name = "GN_DIRECT",
       .kind = Kind::dividing,
       .summary = "DIRECT: divides the box where it may still hold the best",
       .source = kJones},
      {.name = "direct_l",
       .nlopt_name = "GN_DIRECT_L",
       .kind = Kind::dividing,
       .summary = "DIRECT with a bias towards the best found",
       .source = kGablonsky},
      {.name = "direct_l_rand",
       .nlopt_name = "GN_DIRECT_L_RAND",
       .kind = Kind::dividing,
       .summary = "DIRECT-L that draws lots for the side to divide",
       .source = kGablonsky,
       .is_stochastic = true},
      {.name = "direct_noscal",
       .nlopt_name = "GN_DIRECT_NOSCAL",
       .kind = Kind::dividing,
       .summary = "DIRECT on the unscaled box; in NLopt 2.7.1 the same as direct_l_noscal",
       .source = kJones},
      {.name = "direct_l_noscal",
       .nlopt_name = "GN_DIRECT_L_NOSCAL",
       .kind = Kind::dividing,
       .summary = "DIRECT-L on the box as it is, not scaled to a cube",
       .source = kGablonsky},
      {.name = "direct_l_rand_noscal",  // draws no lots, whatever its name says: measured
       .nlopt_name = "GN_DIRECT_L_RAND_NOSCAL",
       .kind = Kind::dividing,
       .summary = "DIRECT-L with lots, unscaled; in NLopt 2.7.1 the same as direct_l_noscal",
       .source = kGablonsky},
      {.name = "orig_direct",
       .nlopt_name = "GN_ORIG_DIRECT",
       .kind = Kind::dividing,
       .summary = "DIRECT in Gablonsky's program; takes constraints",
       .source = kJones,
       .takes_constraints = true,
       .needs_pace = true},
      {.name = "orig_direct_l",
       .nlopt_name = "GN_ORIG_DIRECT_L",
       .kind = Kind::dividing,
       .summary = "DIRECT-L in Gablonsky's program; takes constraints",
       .source = kGablonsky,
       .takes_constraints = true,
       .needs_pace = true},
      {.name = "crs2_lm",
       .nlopt_name = "GN_CRS2_LM",
       .kind = Kind::drawing,
       .summary = "CRS2: controlled random search with local mutation",
       .source = "Kaelo and Ali 2006, Some variants of the controlled random search algorithm for "
                 "global optimization",
       .is_stochastic = true},
      {.name = "mlsl",
       .nlopt_name = "G_MLSL",
       .kind = Kind::starting,
       .summary = "MLSL: local searches from random points, one a basin",
       .source = kMlsl,
       .is_stochastic = true},
      {.name = "mlsl_lds",
       .nlopt_name = "G_MLSL_LDS",
       .kind = Kind::starting,
       .summary = "MLSL: local searches from points of a Sobol sequence, one a basin",
       .source = kMlsl},
      {.name = "isres",
       .nlopt_name = "GN_ISRES",
       .kind = Kind::drawing,
       .summary = "ISRES: evolution strategy that ranks objective and constraints by lot",
       .source = "Runarsson and Yao 2005, Search biases in constrained evolutionary optimization",
       .takes_constraints = true,
       .is_stochastic = true},
      {.name = "esch",
       .nlopt_name = "GN_ESCH",
       .kind = Kind::drawing,
       .summary = "ESCH: evolution with crossover and Cauchy mutation",
       .source = "da Silva Santos, Goncalves and Hernandez-Figueroa 2010, Designing novel photonic "
                 "devices by bio-inspired computing",
       .is_stochastic = true},
      {.name = "ags",
       .nlopt_name = "GN_AGS",
       .kind = Kind::covering,
       .summary = "AGS: searches along a space-filling curve; up to 10 variables, better 5",
       .source = "Sergeyev and Markin 1995, An algorithm for solving global optimization problems "
                 "with nonlinear constraints",
       .takes_constraints = true,
       .largest_dimension = 10,
       .unfit =
           "it takes 10 variables at most, where the arm has 20, and with 5 or 10 variables it "
           "did worse than random search on the sphere and the ellipsoid (5000 evaluations)"},
      {.name = "auglag",
       .nlopt_name = "AUGLAG",
       .kind = Kind::wrapping,
       .summary = "Augmented Lagrangian: multipliers bring constraints to a local search",
       .source = kAuglag,
       .takes_constraints = true},
      {.name = "auglag_eq",
       .nlopt_name = "AUGLAG_EQ",
       .kind = Kind::wrapping,
       .summary = "Augmented Lagrangian for equalities, of which problems here have none",
       .source = kAuglag,
       .takes_constraints = true},
  };
  return table;
}

const Algorithm& find_algorithm(const std::string& name) {
  return *std::ranges::find(algorithms(), name, &Algorithm::name);
}

class Nlopt : public Optimizer {
 public:
  Nlopt(const Algorithm& algorithm, const Options& options) : algorithm_(algorithm) {
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
                 .tolerances_are_local = algorithm.kind == Kind::starting,
                 .constraint_weight = number("constraint_weight")};
    if (values.contains("local")) {
      const Algorithm& local = find_algorithm(options.get_text("local"));
      settings_.local = local.nlopt_name;
      isolated_ = isolated_ || local.isolated;
      smallest_dimension_ = std::max(smallest_dimension_, local.smallest_dimension);
    }
  }

  void minimize(Evaluator& evaluator, std::uint64_t seed) override {
    check_dimension(evaluator.problem());
    const auto body = [&](Evaluator& asked) { minimize_with_nlopt(settings_, asked, seed); };
    if (isolated_) {
      minimize_isolated(settings_.optimizer, body, evaluator, IsolationLimits{});
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

  const Algorithm& algorithm_;
  NloptSettings settings_;
  bool isolated_ = false;
  int smallest_dimension_ = 1;
};

std::vector<OptionSpec> make_options(const Algorithm& algorithm) {
  const bool takes_steps = algorithm.kind == Kind::local || algorithm.kind == Kind::starting ||
                           algorithm.kind == Kind::wrapping;
  const bool descends = algorithm.kind == Kind::local || algorithm.kind == Kind::wrapping;
  std::vector<OptionSpec> options;
  if (algorithm.kind == Kind::starting) {
    options.push_back(
        {.name = "local",
         .description =
             "the local optimizer that is started; bobyqa, newuoa_bound and praxis want 2 "
             "variables at least; praxis draws by chance",
         .fallback = std::string("bobyqa"),
         .choices = {"bobyqa", "cobyla", "neldermead", "newuoa_bound", "praxis", "sbplx"}});
  }
  if (algorithm.kind == Kind::wrapping) {
    const bool passes_constraints_on = algorithm.name == "auglag_eq";
    std::vector<std::string> choices = {"cobyla"};
    if (!passes_constraints_on) {
      choices = {"bobyqa", "cobyla", "neldermead", "newuoa_bound", "praxis", "sbplx"};
    }
    options.push_back(
        {.name = "local",
         .description = passes_constraints_on
                            ? "the local optimizer inside, which takes the inequalities"
                            : "the local optimizer inside; bobyqa, newuoa_bound and praxis want "
                              "2 variables at least; praxis draws by chance",
         .fallback = choices.front(),
         .choices = choices});
  }
  if (takes_steps) {
    options.push_back({.name = "initial_step",
                       .description =
                           "first step in every coordinate, as a share of the box; 0: what NLopt "
                           "derives from start and bounds",
                       .fallback = 0.05,
                       .lower = 0,
                       .upper = 0.49});  // BOBYQA wants two steps within the box
  }
  if (algorithm.kind != Kind::covering) {
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
  if (algorithm.kind == Kind::drawing || algorithm.kind == Kind::starting) {
    options.push_back(
        {.name = "population",
         .description = algorithm.kind == Kind::drawing
                            ? "individuals; 0: as many as NLopt finds right"
                            : "points drawn at a time; 0: as many as NLopt finds right",
         .fallback = std::int64_t{0},
         .lower = 0,
         .upper = 100000});
  }
  if (descends) {
    options.push_back({.name = "restarts",
                       .description = "times to begin again at the best point seen, each with half "
                                      "the step, as long as the last one improved it",
                       .fallback = algorithm.restarts,
                       .lower = 0,
                       .upper = 1000});
  }
  if (!algorithm.takes_constraints) {
    options.push_back(make_constraint_weight_option());
  }
  return options;
}

// Which of the options lead into a child process.
std::string explain_isolation(const Algorithm& algorithm, std::span<const OptionSpec> options) {
  const auto local = std::ranges::find(options, "local", &OptionSpec::name);
  if (algorithm.isolated || local == options.end()) {
    return algorithm.isolated ? "always" : "";
  }
  std::vector<std::string> isolated;
  for (const std::string& choice : local->choices) {
    if (find_algorithm(choice).isolated) {
      isolated.push_back("local=" + choice);
    }
  }
  const bool always = isolated.size() == local->choices.size();
  return always ? "always" : "with " + join(isolated, " or ");
}

OptimizerRow make_row(const Algorithm& algorithm) {
  const bool descends = algorithm.kind == Kind::local || algorithm.kind == Kind::wrapping;
  const std::vector<OptionSpec> specs = make_options(algorithm);
  return {
      .name = "nlopt:" + algorithm.name,
      .summary = algorithm.summary,
      .source = algorithm.source,
      .capabilities = {.bounds = !algorithm.leaves_box,
                       .constraints = algorithm.takes_constraints,
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
  std::ranges::transform(algorithms(), std::back_inserter(rows), make_row);
  return rows;
}

}  // namespace armwright
