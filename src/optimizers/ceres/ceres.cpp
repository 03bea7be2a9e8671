// The rows of the Ceres solvers: their options and what they need.

#include "optimizers/ceres/ceres_backend.hpp"
#include "optimizers/interface/differences.hpp"
#include "process/module_loader.hpp"

namespace armwright {
namespace {

constexpr const char* kBackend = "Ceres Solver (CMake option ARMWRIGHT_WITH_CERES)";

std::vector<OptionSpec> make_tolerance_options() {
  return {{.name = "function_tolerance",
           .description = "converged when a step changes the cost by less than this share of it",
           .fallback = 1e-6,
           .lower = 0,
           .upper = 1},
          {.name = "parameter_tolerance",
           .description = "converged when a step is shorter than this share of the way gone so far",
           .fallback = 1e-8,
           .lower = 0,
           .upper = 1}};
}

std::unique_ptr<Optimizer> make_lm(const Options& options) {
  const std::string& transform = options.get_text("transform");
  return make_levenberg_marquardt(
      {.exact = options.get_text("derivatives") == "exact",
       .transform = transform == "log"    ? ResidualTransform::logarithm
                    : transform == "none" ? ResidualTransform::none
                                          : ResidualTransform::automatic,
       .floor = options.get_number("floor"),
       .differences = read_differences(options),
       .smallest_step = options.get_number("smallest_step"),
       .jacobi_scaling = options.get_bool("jacobi_scaling"),
       .min_damping = options.get_number("min_lm_diagonal"),
       .initial_radius = options.get_number("initial_trust_region_radius"),
       .function_tolerance = options.get_number("function_tolerance"),
       .parameter_tolerance = options.get_number("parameter_tolerance")});
}

std::unique_ptr<Optimizer> make_bfgs_optimizer(const Options& options) {
  return make_bfgs({.differences = read_differences(options),
                    .initial_step = options.get_number("initial_step"),
                    .function_tolerance = options.get_number("function_tolerance"),
                    .parameter_tolerance = options.get_number("parameter_tolerance"),
                    .constraint_weight = options.get_number("constraint_weight")});
}

template <typename... Lists>
std::vector<OptionSpec> join_options(std::vector<OptionSpec> options, const Lists&... lists) {
  (options.insert(options.end(), lists.begin(), lists.end()), ...);
  return options;
}

OptimizerRow make_lm_row() {
  const std::vector<OptionSpec> own = {
      {.name = "transform",
       .description =
           "what becomes of the residuals: log (ln of 1 plus their squares over the "
           "floor's), none (as they are), or auto: log where every variable is logarithmic",
       .fallback = std::string("auto"),
       .choices = {"auto", "log", "none"}},
      {.name = "floor",
       .description = "of the logarithm, which levels out for residuals below this share of the "
                      "start's root mean square; without the logarithm no influence",
       .fallback = 0.1,
       .lower = 1e-12,
       .upper = 1},
      {.name = "derivatives",
       .description = "differences of evaluations, or exact: computed along with the simulation, "
                      "where the problem offers that (--engine articulated); such an evaluation "
                      "costs 1 + n/4 (rounded up) for n variables",
       .fallback = std::string("differences"),
       .choices = {"differences", "exact"}},
      make_differences_option("forward"),
      {.name = "step",
       .description = "of the differences at first, share of the box; 0: 0.07 with the logarithm, "
                      "wide as simulations are rough, and 0.005 without; with exact derivatives "
                      "no influence, as differences and smallest_step",
       .fallback = 0.0,
       .lower = 0,
       .upper = 0.25},
      {.name = "smallest_step",
       .description =
           "each time that it has converged, it starts again from the best point with half "
           "the step of the differences, down to this share of the box",
       .fallback = 5e-4,
       .lower = 1e-12,
       .upper = 0.25},
      {.name = "jacobi_scaling",
       .description = "scale every variable by its column of the Jacobian: variables without "
                      "influence then take huge steps",
       .fallback = false},
      {.name = "min_lm_diagonal",
       .description = "least damping of a variable, beside the mean square of its column of the "
                      "Jacobian in a box 10 wide: those without influence stay where they are",
       .fallback = 0.5,
       .lower = 1e-12,
       .upper = 1e12},
      {.name = "initial_trust_region_radius",
       .description = "the damping is divided by it; it grows with every good step",
       .fallback = 1.0,
       .lower = 1e-12,
       .upper = 1e12},
  };
  return {
      .name = "ceres:lm",
      .summary = "Levenberg-Marquardt on residuals, derivatives by differences or exact",
      .source =
          "Levenberg 1944, A method for the solution of certain non-linear problems in least "
          "squares; Marquardt 1963, An algorithm for least-squares estimation of nonlinear "
          "parameters; Agarwal, Mierle and others, Ceres Solver",
      .capabilities = {.bounds = true, .batch = true, .residuals = true, .local = true},
      .options = join_options(own, make_tolerance_options()),
      .make = make_lm,
      .requirements = {.residuals = true},
      .backend = kBackend,
      .tuned_on = {"q1-complex", "irb4600_six", "planar2", "arm7"},
      .tuning =
          "transform, floor, step, min_lm_diagonal and function_tolerance were first chosen "
          "on q1-complex; on the other arms no value was significantly better",
      .unavailable = explain_missing(kCeresModule),
  };
}

OptimizerRow make_bfgs_row() {
  const std::vector<OptionSpec> own = {
      {.name = "initial_step",
       .description = "longest first step of a variable, as a share of the box",
       .fallback = 0.05,
       .lower = 1e-9,
       .upper = 1},
      make_differences_option("central"),
      {.name = "step",
       .description = "of the differences, share of the box",
       .fallback = 0.001,
       .lower = 1e-12,
       .upper = 0.25},
      make_constraint_weight_option(),
  };
  return {
      .name = "ceres:bfgs",
      .summary = "BFGS with Wolfe line searches, gradients by differences",
      .source =
          "Nocedal and Wright 2006, Numerical Optimization, sections 6.1 and 3.5; Agarwal, "
          "Mierle and others, Ceres Solver",
      .capabilities = {.bounds = true, .batch = true, .local = true},
      .options = join_options(own, make_tolerance_options()),
      .make = make_bfgs_optimizer,
      .backend = kBackend,
      .unavailable = explain_missing(kCeresModule),
  };
}

}  // namespace

std::vector<OptimizerRow> make_ceres_rows() {
  return {make_lm_row(), make_bfgs_row()};
}

}  // namespace armwright
