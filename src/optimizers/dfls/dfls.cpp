// The row of dfls: its options. dfls_search.cpp runs the search.

#include "optimizers/dfls/dfls_search.hpp"
#include "optimizers/interface/scalar_function.hpp"

namespace armwright {
namespace {

class Dfls : public Optimizer {
 public:
  explicit Dfls(const Options& options)
      : settings_{.radius = options.get_number("radius"),
                  .smallest_radius = options.get_number("smallest_radius"),
                  .restarts = static_cast<int>(options.get_integer("restarts")),
                  .exact = options.get_bool("jacobian"),
                  .power_laws = options.get_bool("power_laws")} {}

  void check_problem(const ProblemDescription& problem) const override {
    if (settings_.exact) {
      require_jacobian(problem, "dfls", "jacobian is true", "jacobian=false");
    }
  }

  void minimize(Evaluator& evaluator, std::uint64_t /*seed*/) override {
    check_problem(evaluator.problem());
    search_with_dfls(settings_, evaluator);
  }

 private:
  DflsSettings settings_;
};

}  // namespace

std::vector<OptimizerRow> make_dfls_rows() {
  return {{
      .name = "dfls",
      .summary = "Least squares by linear models of residuals in a trust region",
      .source =
          "Cartis, Fiala, Marteau and Roberts 2019, Improving the flexibility and robustness of "
          "model-based derivative-free optimization solvers; Zhang, Conn and Scheinberg 2010, A "
          "derivative-free algorithm for least-squares minimization; Powell 2009, The BOBYQA "
          "algorithm for bound constrained optimization without derivatives",
      .capabilities =
          {.bounds = true, .batch = true, .residuals = true, .local = true, .growing = true},
      .options =
          {{.name = "radius",
            .description = "of the first trust region, share of the box: how far from the start "
                           "the first points are, one per variable",
            .fallback = 0.1,
            .lower = 1e-12,
            .upper = 0.5},
           {.name = "smallest_radius",
            .description = "it has converged when the trust region is smaller, share of the box",
            .fallback = 1e-7,
            .lower = 1e-18,
            .upper = 0.5},
           {.name = "restarts",
            .description =
                "how often at most it descends again after it has converged, from the best point, "
                "with half the radius each time; the first descent that gains nothing is the last; "
                "with exact derivatives there is none",
            .fallback = std::int64_t{10},
            .lower = 0,
            .upper = 1000},
           {.name = "jacobian",
            .description =
                "use exact derivatives, computed along with the simulation, where the problem "
                "offers that (--engine articulated); such an evaluation costs 1 + n/4 (rounded up) "
                "for n variables",
            .fallback = false},
           {.name = "power_laws",
            .description =
                "where every variable is logarithmic, model residuals that do not change their "
                "sign as products of powers of the variables, and restart earlier and farther away",
            .fallback = true}},
      .make = [](const Options& options) -> std::unique_ptr<Optimizer> {
        return std::make_unique<Dfls>(options);
      },
      .requirements = {.residuals = true},
  }};
}

}  // namespace armwright
