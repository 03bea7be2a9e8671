#include "optimizers/ceres_module/ceres_module.hpp"

#include <ceres/ceres.h>

#include <limits>

namespace armwright {
namespace {

class StopCallback : public ceres::IterationCallback {
 public:
  explicit StopCallback(const CeresFunction& function) : function_(function) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& /*summary*/) override {
    return function_.stopped() ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
  }

 private:
  const CeresFunction& function_;
};

class ResidualCost : public ceres::CostFunction {
 public:
  ResidualCost(CeresFunction& function, std::size_t residual_count, std::size_t dimension)
      : function_(function) {
    set_num_residuals(static_cast<int>(residual_count));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(dimension));
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    return function_.evaluate(parameters[0], residuals,
                              jacobians == nullptr ? nullptr : jacobians[0]);
  }

 private:
  CeresFunction& function_;
};

class MeritFunction : public ceres::FirstOrderFunction {
 public:
  MeritFunction(CeresFunction& function, std::size_t dimension)
      : function_(function), dimension_(static_cast<int>(dimension)) {}

  int NumParameters() const override { return dimension_; }
  bool Evaluate(const double* parameters, double* cost, double* gradient) const override {
    return function_.evaluate(parameters, cost, gradient);
  }

 private:
  CeresFunction& function_;
  int dimension_;
};

class Solver : public CeresSolver {
 public:
  void minimize_squares(CeresFunction& function, std::vector<double>& p,
                        const CeresLeastSquares& settings) const override {
    ResidualCost cost(function, settings.residual_count, p.size());
    ceres::Problem::Options ownership;
    ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(ownership);
    problem.AddResidualBlock(&cost, nullptr, p.data());
    for (std::size_t i = 0; i < p.size(); ++i) {
      problem.SetParameterLowerBound(p.data(), static_cast<int>(i), settings.lower[i]);
      problem.SetParameterUpperBound(p.data(), static_cast<int>(i), settings.upper[i]);
    }
    StopCallback callback(function);
    ceres::Solver::Options options;
    options.minimizer_type = ceres::TRUST_REGION;
    options.trust_region_strategy_type = ceres::LEVENBERG_MARQUARDT;
    options.linear_solver_type = ceres::DENSE_QR;
    options.num_threads = 1;
    options.logging_type = ceres::SILENT;
    options.minimizer_progress_to_stdout = false;
    options.max_num_iterations = std::numeric_limits<int>::max();
    options.max_solver_time_in_seconds = std::numeric_limits<double>::max();
    // Steps are cut at the bounds. A line search along the bounds would cost evaluations.
    options.max_num_line_search_step_size_iterations = 0;
    options.jacobi_scaling = settings.jacobi_scaling;
    options.min_lm_diagonal = settings.min_damping;
    options.initial_trust_region_radius = settings.initial_radius;
    options.function_tolerance = settings.function_tolerance;
    options.parameter_tolerance = settings.parameter_tolerance;
    options.callbacks.push_back(&callback);
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
  }

  std::string search_lines(CeresFunction& function, std::vector<double>& p,
                           const CeresLineSearch& settings) const override {
    StopCallback callback(function);
    ceres::GradientProblemSolver::Options options;
    options.line_search_direction_type = ceres::BFGS;
    options.line_search_type = ceres::WOLFE;
    options.logging_type = ceres::SILENT;
    options.minimizer_progress_to_stdout = false;
    options.max_num_iterations = std::numeric_limits<int>::max();
    options.max_solver_time_in_seconds = std::numeric_limits<double>::max();
    options.function_tolerance = settings.function_tolerance;
    options.parameter_tolerance = settings.parameter_tolerance;
    options.callbacks.push_back(&callback);
    // The problem owns the function.
    const ceres::GradientProblem problem(new MeritFunction(function, p.size()));
    ceres::GradientProblemSolver::Summary summary;
    ceres::Solve(options, problem, p.data(), &summary);
    return summary.message;
  }
};

}  // namespace
}  // namespace armwright

extern "C" {

[[gnu::visibility("default")]] extern const char armwright_module_id[];
const char armwright_module_id[] = ARMWRIGHT_MODULE_ID;

[[gnu::visibility("default")]] armwright::GetCeresSolver armwright_get_ceres_solver;
const armwright::CeresSolver* armwright_get_ceres_solver() {
  static const armwright::Solver solver;
  return &solver;
}
}
