// The optimizer ceres:lm: Levenberg-Marquardt on the residuals of a problem.

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <span>

#include "optimizers/ceres/ceres_backend.hpp"
#include "optimizers/ceres/ceres_support.hpp"

namespace armwright {
namespace {

// A larger sum of squares counts as a failure: Ceres squares its slopes and prints a message for
// numbers that are not finite.
constexpr double kLargestSquareSum = 1e200;

double calc_square_sum(const std::vector<double>& values) {
  return std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
}

bool uses_logarithm(ResidualTransform transform, const ProblemDescription& problem) {
  if (transform != ResidualTransform::automatic) {
    return transform == ResidualTransform::logarithm;
  }
  return std::ranges::all_of(problem.variables, [](const DecisionVariable& variable) {
    return variable.scale == Scale::logarithmic;
  });
}

// The residuals in the form that Ceres gets. The first usable ones, those of the start, set the
// scale: the cost (half the sum of squares) is that of a mean, so that the damping means the same
// for every problem.
class ResidualsOf {
 public:
  ResidualsOf(bool logarithm, double floor) : logarithm_(logarithm), floor_share_(floor) {}

  // Returns an empty vector for a failed evaluation.
  std::vector<double> operator()(const Score& score) {
    std::vector<double> residuals = score.residuals;
    const double square_sum = calc_square_sum(residuals);
    if (residuals.empty() || !(square_sum < kLargestSquareSum)) {  // also where it is no number
      return {};
    }
    const auto count = static_cast<double>(residuals.size());
    if (scale_ == 0) {
      scale_ = std::max(std::sqrt(square_sum / count), std::numeric_limits<double>::min());
    }
    const double floor = floor_share_ * scale_;
    for (double& residual : residuals) {
      const double share = residual / (logarithm_ ? floor : scale_);
      residual = (logarithm_ ? std::log1p(share * share) : share) / std::sqrt(count);
    }
    return residuals;
  }

  // Returns the derivative of each value with respect to its residual. Call this after the values.
  std::vector<double> calc_slopes(const Score& score) const {
    std::vector<double> slopes = score.residuals;
    const auto root = std::sqrt(static_cast<double>(slopes.size()));
    const double unit = logarithm_ ? floor_share_ * scale_ : scale_;
    for (double& slope : slopes) {
      const double share = slope / unit;
      slope = (logarithm_ ? 2 * share / (1 + share * share) : 1) / (unit * root);
    }
    return slopes;
  }

 private:
  bool logarithm_;
  double floor_share_;
  double scale_ = 0;  // root mean square of the start's residuals
};

// Coordinates in which the box is 10 wide and `centre` is 0.
class CentredBox {
 public:
  CentredBox(const SearchSpace& space, std::vector<double> centre)
      : space_(space), centre_(std::move(centre)) {}

  double unit(std::size_t i) const {
    return (space_.upper()[i] - space_.lower()[i]) / kCeresBoxWidth;
  }
  double lower(std::size_t i) const { return to_own(i, space_.lower()[i]); }
  double upper(std::size_t i) const { return to_own(i, space_.upper()[i]); }

  std::vector<double> to_coordinates(const double* p) const {
    std::vector<double> coordinates;
    for (std::size_t i = 0; i < space_.dimension(); ++i) {
      coordinates.push_back(
          std::clamp(centre_[i] + p[i] * unit(i), space_.lower()[i], space_.upper()[i]));
    }
    return coordinates;
  }

 private:
  double to_own(std::size_t i, double coordinate) const {
    return unit(i) > 0 ? (coordinate - centre_[i]) / unit(i) : 0;
  }

  const SearchSpace& space_;
  std::vector<double> centre_;
};

// The steepest slope of a residual, in units of the scale of its values per tenth of the box.
constexpr double kSteepest = 10;

class ResidualCost : public CeresFunction {
 public:
  ResidualCost(DifferencedFunction& function, const CentredBox& box, HeldException& held,
               const Evaluator& evaluator, std::size_t residual_count)
      : function_(function),
        box_(box),
        held_(held),
        evaluator_(evaluator),
        residual_count_(residual_count) {}

  bool stopped() const override { return held_.any() || evaluator_.stopped(); }

  bool evaluate(const double* p, double* residuals, double* jacobian) override {
    const std::size_t dimension = function_.space().dimension();
    const bool is_known = held_.run([&] {
      const DifferencedFunction::Place& place =
          function_.evaluate_place(box_.to_coordinates(p), jacobian != nullptr);
      if (place.values.size() != residual_count_) {
        return false;
      }
      std::ranges::copy(place.values, residuals);
      for (std::size_t i = 0; jacobian != nullptr && i < dimension; ++i) {
        for (std::size_t k = 0; k < residual_count_; ++k) {
          jacobian[k * dimension + i] = place.derivatives[i][k] * box_.unit(i);
        }
      }
      for (std::size_t k = 0; jacobian != nullptr && function_.is_exact() && k < residual_count_;
           ++k) {
        limit_steepness({jacobian + k * dimension, dimension});
      }
      return true;
    });
    if (is_known || jacobian == nullptr) {
      return is_known;
    }
    // Ceres asks for a Jacobian only where the residuals are known, so the run has ended here.
    // Ceres would print a failure on stderr even with logging off; with slopes of zero it returns
    // without a message.
    std::fill_n(residuals, residual_count_, 0.0);
    std::fill_n(jacobian, residual_count_ * dimension, 0.0);
    return true;
  }

 private:
  // The slopes of a motion that is about to become unstable are almost unbounded and predict
  // nothing at the distance of a step. They are shortened and keep their direction (gradient
  // clipping; Pascanu, Mikolov and Bengio 2013, On the difficulty of training recurrent neural
  // networks).
  void limit_steepness(std::span<double> row) const {
    const double steepest = kSteepest / std::sqrt(static_cast<double>(residual_count_));
    const double largest =
        std::abs(*std::ranges::max_element(row, {}, [](double slope) { return std::abs(slope); }));
    if (largest > steepest) {
      for (double& slope : row) {
        slope *= steepest / largest;
      }
    }
  }

  DifferencedFunction& function_;
  const CentredBox& box_;
  HeldException& held_;
  const Evaluator& evaluator_;
  std::size_t residual_count_;
};

// The widest differences, as a share of the box. Simulated objectives are rough, others are smooth.
constexpr double kRoughStep = 0.07;
constexpr double kSmoothStep = 0.005;

class LevenbergMarquardt : public Optimizer {
 public:
  explicit LevenbergMarquardt(const LevenbergSettings& settings)
      : settings_(settings), solver_(load_ceres("optimizer 'ceres:lm'")) {}

  void check_problem(const ProblemDescription& problem) const override {
    if (settings_.exact) {
      require_jacobian(problem, "ceres:lm", "derivatives is exact", "derivatives=differences");
    }
  }

  void minimize(Evaluator& evaluator, std::uint64_t /*seed*/) override {
    check_problem(evaluator.problem());
    const bool logarithm = uses_logarithm(settings_.transform, evaluator.problem());
    HeldException held;
    if (settings_.exact) {
      minimize_exactly(evaluator, held, logarithm);
      held.rethrow_unless_stopped();
      evaluator.explain_end("it has converged, and another descent gained nothing");
      return;
    }
    DifferenceSettings differences = settings_.differences;
    if (differences.step == 0) {
      differences.step = logarithm ? kRoughStep : kSmoothStep;
    }
    std::optional<DifferencedFunction::Best> best;
    const double smallest_step = std::min(settings_.smallest_step, differences.step);
    for (bool is_going = true; is_going && differences.step >= smallest_step;
         differences.step /= 2) {
      is_going = held.run([&] {
        ResidualsOf residuals_of(logarithm, settings_.floor);
        DifferencedFunction function(evaluator, std::ref(residuals_of), differences);
        if (best) {
          function.learn(*best);
        }
        const std::vector<double> centre = best ? best->coordinates : function.space().start();
        const std::size_t residual_count = function.evaluate_place(centre, false).values.size();
        if (residual_count == 0) {  // a start that fails offers nothing to descend from
          return false;
        }
        solve(evaluator, function, held, centre, residual_count);
        best = function.best();
        return true;
      });
    }
    held.rethrow_unless_stopped();
    evaluator.explain_end(best ? "it has converged, and the steps of the differences are smaller "
                                 "than smallest_step"
                               : "the start failed, so there is nothing to descend from");
  }

 private:
  void minimize_exactly(Evaluator& evaluator, HeldException& held, bool logarithm) const {
    std::optional<DifferencedFunction::Best> best;
    const auto calc = [&](const DifferencedFunction::Best& one) {
      return calc_scalar(evaluator.problem(), one.score.objectives);
    };
    for (bool is_going = true; is_going;) {
      is_going = held.run([&] {
        ResidualsOf residuals_of(logarithm, settings_.floor);
        DifferencedFunction function(evaluator, std::ref(residuals_of), [&](const Score& score) {
          return residuals_of.calc_slopes(score);
        });
        if (best) {
          function.learn(*best);
        }
        const std::vector<double> centre = best ? best->coordinates : function.space().start();
        const std::size_t residual_count = function.evaluate_place(centre, false).values.size();
        if (residual_count == 0) {
          return false;
        }
        solve(evaluator, function, held, centre, residual_count);
        const bool has_gained = !best || calc(*function.best()) < calc(*best);
        best = function.best();
        return has_gained;
      });
    }
  }

  void solve(const Evaluator& evaluator, DifferencedFunction& function, HeldException& held,
             const std::vector<double>& centre, std::size_t residual_count) const {
    const CentredBox box(function.space(), centre);
    std::vector<double> p(centre.size(), 0.0);
    ResidualCost cost(function, box, held, evaluator, residual_count);
    CeresLeastSquares problem{.residual_count = residual_count,
                              .jacobi_scaling = settings_.jacobi_scaling,
                              .min_damping = settings_.min_damping,
                              .initial_radius = settings_.initial_radius,
                              .function_tolerance = settings_.function_tolerance,
                              .parameter_tolerance = settings_.parameter_tolerance};
    for (std::size_t i = 0; i < p.size(); ++i) {
      problem.lower.push_back(box.lower(i));
      problem.upper.push_back(box.upper(i));
    }
    solver_.minimize_squares(cost, p, problem);
  }

  LevenbergSettings settings_;
  const CeresSolver& solver_;
};

}  // namespace

std::unique_ptr<Optimizer> make_levenberg_marquardt(const LevenbergSettings& settings) {
  return std::make_unique<LevenbergMarquardt>(settings);
}

}  // namespace armwright
