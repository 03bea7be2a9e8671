// The optimizer ceres:bfgs: line searches along quasi-Newton directions.

#include <algorithm>
#include <cmath>

#include "optimizers/ceres/ceres_backend.hpp"
#include "optimizers/ceres/ceres_support.hpp"

namespace armwright {
namespace {

// Coordinates that map into the box, for methods that do not handle bounds.
class FoldedBox {
 public:
  // At a bound the map is flat, and a search could never leave it. So a start on a bound is moved
  // inside by `margin`, a share of the box.
  FoldedBox(const SearchSpace& space, double margin) : space_(space) {
    for (std::size_t i = 0; i < space.dimension(); ++i) {
      const double inset = margin * width(i);
      centre_.push_back(
          std::clamp(space.start()[i], space.lower()[i] + inset, space.upper()[i] - inset));
      const double share = width(i) > 0 ? (centre_[i] - space.lower()[i]) / width(i) : 0.5;
      angle_.push_back(std::asin(std::clamp(2 * share - 1, -1.0, 1.0)));
    }
  }

  std::vector<double> to_coordinates(const double* p) const {
    std::vector<double> coordinates;
    for (std::size_t i = 0; i < centre_.size(); ++i) {
      const double swing = std::sin(angle_[i] + kRate * p[i]) - std::sin(angle_[i]);
      coordinates.push_back(
          std::clamp(centre_[i] + width(i) / 2 * swing, space_.lower()[i], space_.upper()[i]));
    }
    return coordinates;
  }

  double slope(std::size_t i, double p) const {
    return width(i) / 2 * kRate * std::cos(angle_[i] + kRate * p);
  }

 private:
  static constexpr double kRate =
      2 / kCeresBoxWidth;  // in the middle of the box the scale is 10 a box

  double width(std::size_t i) const { return space_.upper()[i] - space_.lower()[i]; }

  const SearchSpace& space_;
  std::vector<double> centre_;
  std::vector<double> angle_;
};

class MeritFunction : public CeresFunction {
 public:
  MeritFunction(DifferencedFunction& function, const FoldedBox& box, double unit,
                HeldException& held, const Evaluator& evaluator)
      : function_(function), box_(box), unit_(unit), held_(held), evaluator_(evaluator) {}

  bool stopped() const override { return held_.any() || evaluator_.stopped(); }

  bool evaluate(const double* parameters, double* cost, double* gradient) override {
    return held_.run([&] {
      std::vector<double> p(parameters, parameters + function_.space().dimension());
      std::ranges::transform(p, p.begin(), [this](double value) { return value * unit_; });
      const DifferencedFunction::Place& place =
          function_.evaluate_place(box_.to_coordinates(p.data()), gradient != nullptr);
      if (place.values.empty()) {
        return false;
      }
      *cost = place.values.front();
      for (std::size_t i = 0; gradient != nullptr && i < p.size(); ++i) {
        gradient[i] = place.derivatives[i].front() * box_.slope(i, p[i]) * unit_;
      }
      return true;
    });
  }

 private:
  DifferencedFunction& function_;
  const FoldedBox& box_;
  double unit_;
  HeldException& held_;
  const Evaluator& evaluator_;
};

class Bfgs : public Optimizer {
 public:
  explicit Bfgs(const BfgsSettings& settings)
      : settings_(settings), solver_(load_ceres("optimizer 'ceres:bfgs'")) {}

  void minimize(Evaluator& evaluator, std::uint64_t /*seed*/) override {
    const auto merit_of = [&](const Score& score) {
      const double merit = calc_merit(evaluator.problem(), score, settings_.constraint_weight);
      const bool is_usable = score.status == EvaluationStatus::ok && std::isfinite(merit);
      return is_usable ? std::vector<double>{merit} : std::vector<double>{};
    };
    DifferencedFunction function(evaluator, merit_of, settings_.differences);
    const FoldedBox box(function.space(), settings_.differences.step);
    HeldException held;
    // The first step of Ceres is 1 in the largest component of its coordinates.
    MeritFunction merit(function, box, settings_.initial_step * kCeresBoxWidth, held, evaluator);
    std::vector<double> p(function.space().dimension(), 0.0);
    const std::string message =
        solver_.search_lines(merit, p,
                             {.function_tolerance = settings_.function_tolerance,
                              .parameter_tolerance = settings_.parameter_tolerance});
    held.rethrow_unless_stopped();
    evaluator.explain_end("Ceres: " + message);
  }

 private:
  BfgsSettings settings_;
  const CeresSolver& solver_;
};

}  // namespace

std::unique_ptr<Optimizer> make_bfgs(const BfgsSettings& settings) {
  return std::make_unique<Bfgs>(settings);
}

}  // namespace armwright
