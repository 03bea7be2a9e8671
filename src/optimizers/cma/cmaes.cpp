// The row of cmaes: its options. cma_search.cpp runs the search. cma_distribution.cpp computes the
// options' defaults; its CmaDistribution::update() adapts mean, step size and covariance.

#include <utility>

#include "base/error.hpp"
#include "optimizers/cma/cma_search.hpp"
#include "optimizers/interface/scalar_function.hpp"

namespace armwright {
namespace {

CmaRestarts to_restarts(const std::string& text) {
  return text == "none"   ? CmaRestarts::none
         : text == "ipop" ? CmaRestarts::ipop
                          : CmaRestarts::bipop;
}

class CmaEs : public Optimizer {
 public:
  explicit CmaEs(const Options& options)
      : settings_{.cma = {.population = static_cast<std::size_t>(options.get_integer("population")),
                          .mu = static_cast<std::size_t>(options.get_integer("mu")),
                          .active = options.get_bool("active"),
                          .orthogonal = options.get_bool("orthogonal"),
                          .c_1 = options.get_number("c_1"),
                          .c_mu = options.get_number("c_mu"),
                          .c_sigma = options.get_number("c_sigma"),
                          .d_sigma = options.get_number("d_sigma"),
                          .c_c = options.get_number("c_c")},
                  .batch_multiple = static_cast<std::size_t>(options.get_integer("batch_multiple")),
                  .sigma = options.get_number("sigma"),
                  .restart_sigma = options.get_number("restart_sigma"),
                  .restarts = to_restarts(options.get_text("restarts")),
                  .uncertainty_handling = options.get_bool("uncertainty_handling"),
                  .tolerances = {.function = options.get_number("tol_fun"),
                                 .step = options.get_number("tol_x")},
                  .surrogate = options.get_text("surrogate") == "quadratic",
                  .feasibility_first = options.get_bool("feasibility_first"),
                  .constraint_weight = options.get_number("constraint_weight")} {
    if (settings_.cma.population == 1) {
      throw Error(ErrorKind::usage,
                  "optimizer 'cmaes': option 'population' is 1; it must be 0 (chosen by the number "
                  "of variables) or at least 2");
    }
    if (settings_.surrogate && settings_.uncertainty_handling) {
      throw Error(
          ErrorKind::usage,
          "optimizer 'cmaes': option 'surrogate' is quadratic and 'uncertainty_handling' is "
          "true; the handling compares two values of the points of a generation, and the "
          "surrogate leaves most of them without one. Use surrogate=none, or "
          "uncertainty_handling=false");
    }
    if (settings_.surrogate && settings_.feasibility_first) {
      throw Error(ErrorKind::usage,
                  "optimizer 'cmaes': option 'surrogate' is quadratic and 'feasibility_first' is "
                  "true; its ranking jumps where a constraint is met, and a quadratic cannot. Use "
                  "surrogate=none, or feasibility_first=false, which adds the violation to the "
                  "objective with constraint_weight");
    }
  }

  void minimize(Evaluator& evaluator, std::uint64_t seed) override {
    search_with_cma(settings_, evaluator, seed);
  }

 private:
  CmaSearchSettings settings_;
};

// Smaller than for other optimizers: steps shrink too early where the penalty bends sharply
// (docs/constrained.md).
OptionSpec make_weight_option() {
  OptionSpec option = make_constraint_weight_option();
  option.fallback = 10.0;
  return option;
}

std::vector<OptionSpec> make_option_specs() {
  const auto rate = [](std::string name, std::string description, double upper) {
    return OptionSpec{.name = std::move(name),
                      .description = std::move(description) + "; 0: the tutorial's value",
                      .fallback = 0.0,
                      .lower = 0,
                      .upper = upper};
  };
  return {
      {.name = "population",
       .description = "points of a generation; 0: 4 + floor(3 ln n) for n variables",
       .fallback = std::int64_t{0},
       .lower = 0,
       .upper = 100000},
      {.name = "batch_multiple",
       .description = "populations are rounded up to a multiple of this, say the number of threads",
       .fallback = std::int64_t{1},
       .lower = 1,
       .upper = 10000},
      {.name = "sigma",
       .description = "initial standard deviation, as a share of the box's width",
       .fallback = 0.05,
       .lower = 1e-6,
       .upper = 1},
      {.name = "active",
       .description = "the worst points take part in the update, with negative weights",
       .fallback = true},
      {.name = "orthogonal",
       .description = "the steps of a generation are drawn at right angles to each other, as many "
                      "at a time as there are variables",
       .fallback = true},
      {.name = "mu",
       .description = "points of positive weight; 0: half the population",
       .fallback = std::int64_t{0},
       .lower = 0,
       .upper = 100000},
      rate("c_1", "learning rate of the rank-one update", 1),
      rate("c_mu", "learning rate of the rank-mu update", 1),
      rate("c_sigma", "learning rate of the step size's path", 1),
      rate("d_sigma", "damping of the step size", 1000),
      rate("c_c", "learning rate of the covariance's path", 1),
      {.name = "restarts",
       .description =
           "what follows a run that has converged: nothing, larger populations (ipop), or "
           "larger and smaller ones in turn (bipop)",
       .fallback = std::string("ipop"),
       .choices = {"none", "ipop", "bipop"}},
      {.name = "restart_sigma",
       .description = "as sigma, for the restarts, which begin anywhere in the box",
       .fallback = 0.2,
       .lower = 1e-6,
       .upper = 1},
      {.name = "uncertainty_handling",
       .description = "evaluates some points again on new cases, and enlarges sigma where their "
                      "ranks change too much",
       .fallback = false},
      {.name = "tol_fun",
       .description = "a run has converged where its values differ by less than this",
       .fallback = 1e-12,
       .lower = 0,
       .upper = 1e12},
      {.name = "tol_x",
       .description = "a run has converged where its steps are less than this share of the first",
       .fallback = 1e-12,
       .lower = 0,
       .upper = 1},
      make_weight_option(),
      {.name = "feasibility_first",
       .description = "of two points the one that violates the constraints less ranks before the "
                      "other, and only then the objective counts; constraint_weight has then no "
                      "influence",
       .fallback = false},
      {.name = "surrogate",
       .description =
           "quadratic: a model of all values ranks the points of a generation, and only as many "
           "are "
           "evaluated as it takes until the model orders the last points as the objective does; "
           "evaluates batches of few points, at least batch_multiple",
       .fallback = std::string("none"),
       .choices = {"none", "quadratic"},
       .is_new = true},
  };
}

}  // namespace

std::vector<OptimizerRow> make_cmaes_rows() {
  return {{
      .name = "cmaes",
      .summary = "CMA-ES: adapts a normal distribution; active update, restarts, margin",
      .source =
          "Hansen 2016, The CMA Evolution Strategy: A Tutorial (arXiv:1604.00772); Auger and "
          "Hansen 2005, A restart CMA evolution strategy with increasing population size; "
          "Hansen 2009, Benchmarking a BI-population CMA-ES on the BBOB-2009 function testbed; "
          "Hansen et al. 2009, A method for handling uncertainty in evolutionary optimization; "
          "Hamano et al. 2022, CMA-ES with margin: lower-bounding marginal probability for "
          "mixed-integer black-box optimization; Hansen 2019, A global surrogate assisted CMA-ES",
      .capabilities = {.bounds = true,
                       .batch = true,
                       .noisy = true,
                       .stochastic = true,
                       .generations = true,
                       .integer = true},
      .options = make_option_specs(),
      .make = [](const Options& options) -> std::unique_ptr<Optimizer> {
        return std::make_unique<CmaEs>(options);
      },
      .tuned_on = {"bbob-f1", "bbob-f2", "bbob-f3", "bbob-f8", "bbob-f10", "bbob-f15", "rastrigin",
                   "q2-torque", "q2-error"},
      .tuning = "active and orthogonal have the best mean rank on functions of BBOB; restarts was "
                "first chosen on rastrigin, and on bbob-f3 and bbob-f15 bipop cannot be told apart "
                "from ipop; constraint_weight was chosen on q2-torque and q2-error",
  }};
}

}  // namespace armwright
