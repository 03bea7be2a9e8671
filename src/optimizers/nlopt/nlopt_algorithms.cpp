#include "optimizers/nlopt/nlopt_algorithms.hpp"

#include <algorithm>

namespace armwright {
namespace {

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

}  // namespace

const std::vector<NloptAlgorithm>& nlopt_algorithms() {
  static const std::vector<NloptAlgorithm> table = {
      {.name = "cobyla",
       .nlopt_name = "LN_COBYLA",
       .summary = "COBYLA: linear models of objective and constraints in a trust region",
       .source = "Powell 1994, A direct search optimization method that models the objective and "
                 "constraint functions by linear interpolation",
       .takes_constraints = true,
       .isolated = true},
      {.name = "slsqp",
       .nlopt_name = "LD_SLSQP",
       .summary = "SLSQP: quadratic programs with constraints, gradients by differences",
       .source = "Kraft 1994, Algorithm 733: TOMP-Fortran modules for optimal control calculations",
       .takes_constraints = true,
       .takes_gradients = true},
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
       // NLopt finds every step within the bounds by a run of MMA. It takes 2.2 ms of its own time
       // per evaluation with 12 variables and 4.2 ms with 24; newuoa takes 0.01 and bobyqa 0.05 ms.
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
       .kind = NloptKind::dividing,
       .summary = "DIRECT: divides the box where it may still hold the best",
       .source = kJones},
      {.name = "direct_l",
       .nlopt_name = "GN_DIRECT_L",
       .kind = NloptKind::dividing,
       .summary = "DIRECT with a bias towards the best found",
       .source = kGablonsky},
      {.name = "direct_l_rand",
       .nlopt_name = "GN_DIRECT_L_RAND",
       .kind = NloptKind::dividing,
       .summary = "DIRECT-L that draws lots for the side to divide",
       .source = kGablonsky,
       .is_stochastic = true},
      {.name = "direct_noscal",
       .nlopt_name = "GN_DIRECT_NOSCAL",
       .kind = NloptKind::dividing,
       .summary = "DIRECT on the unscaled box; in NLopt 2.7.1 the same as direct_l_noscal",
       .source = kJones},
      {.name = "direct_l_noscal",
       .nlopt_name = "GN_DIRECT_L_NOSCAL",
       .kind = NloptKind::dividing,
       .summary = "DIRECT-L on the box as it is, not scaled to a cube",
       .source = kGablonsky},
      {.name = "direct_l_rand_noscal",  // draws no lots, whatever its name says: measured
       .nlopt_name = "GN_DIRECT_L_RAND_NOSCAL",
       .kind = NloptKind::dividing,
       .summary = "DIRECT-L with lots, unscaled; in NLopt 2.7.1 the same as direct_l_noscal",
       .source = kGablonsky},
      {.name = "orig_direct",
       .nlopt_name = "GN_ORIG_DIRECT",
       .kind = NloptKind::dividing,
       .summary = "DIRECT in Gablonsky's program; takes constraints",
       .source = kJones,
       .takes_constraints = true,
       .needs_pace = true},
      {.name = "orig_direct_l",
       .nlopt_name = "GN_ORIG_DIRECT_L",
       .kind = NloptKind::dividing,
       .summary = "DIRECT-L in Gablonsky's program; takes constraints",
       .source = kGablonsky,
       .takes_constraints = true,
       .needs_pace = true},
      {.name = "crs2_lm",
       .nlopt_name = "GN_CRS2_LM",
       .kind = NloptKind::drawing,
       .summary = "CRS2: controlled random search with local mutation",
       .source = "Kaelo and Ali 2006, Some variants of the controlled random search algorithm for "
                 "global optimization",
       .is_stochastic = true},
      {.name = "mlsl",
       .nlopt_name = "G_MLSL",
       .kind = NloptKind::starting,
       .summary = "MLSL: local searches from random points, one a basin",
       .source = kMlsl,
       .is_stochastic = true},
      {.name = "mlsl_lds",
       .nlopt_name = "G_MLSL_LDS",
       .kind = NloptKind::starting,
       .summary = "MLSL: local searches from points of a Sobol sequence, one a basin",
       .source = kMlsl},
      {.name = "isres",
       .nlopt_name = "GN_ISRES",
       .kind = NloptKind::drawing,
       .summary = "ISRES: evolution strategy that ranks objective and constraints by lot",
       .source = "Runarsson and Yao 2005, Search biases in constrained evolutionary optimization",
       .takes_constraints = true,
       .is_stochastic = true},
      {.name = "esch",
       .nlopt_name = "GN_ESCH",
       .kind = NloptKind::drawing,
       .summary = "ESCH: evolution with crossover and Cauchy mutation",
       .source = "da Silva Santos, Goncalves and Hernandez-Figueroa 2010, Designing novel photonic "
                 "devices by bio-inspired computing",
       .is_stochastic = true},
      {.name = "ags",
       .nlopt_name = "GN_AGS",
       .kind = NloptKind::covering,
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
       .kind = NloptKind::wrapping,
       .summary = "Augmented Lagrangian: multipliers bring constraints to a local search",
       .source = kAuglag,
       .takes_constraints = true},
      {.name = "auglag_eq",
       .nlopt_name = "AUGLAG_EQ",
       .kind = NloptKind::wrapping,
       .summary = "Augmented Lagrangian for equalities, of which problems here have none",
       .source = kAuglag,
       .takes_constraints = true},
  };
  return table;
}

const NloptAlgorithm& find_nlopt_algorithm(const std::string& name) {
  return *std::ranges::find(nlopt_algorithms(), name, &NloptAlgorithm::name);
}

}  // namespace armwright
