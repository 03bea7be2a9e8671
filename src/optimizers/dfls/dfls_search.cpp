#include "optimizers/dfls/dfls_search.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "optimizers/dfls/residual_model.hpp"
#include "optimizers/dfls/trust_step.hpp"
#include "optimizers/interface/scalar_function.hpp"

namespace armwright {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// The constants of the trust region, with the values of the source, section 5.
constexpr double kPoor = 0.1;        // eta_1: a step with a smaller ratio has failed
constexpr double kGood = 0.7;        // eta_2
constexpr double kShrink = 0.5;      // gamma_dec
constexpr double kGrow = 2;          // gamma_inc, of the length of the step; the source has 4
constexpr double kSafety = 0.5;      // gamma_S
constexpr double kResolution = 0.1;  // alpha_1: by how much the resolution falls
constexpr double kRadius = 0.5;      // alpha_2: the radius then, as a share of the last resolution
constexpr double kFailed = 0.25;     // the radius after a failed evaluation, share of the step

// Of searches with power laws. Below the limit, roughness of simulations hides what is to be gained.
constexpr double kRoughLimit = 0.4;    // of the radius, as a share of the first one
constexpr double kRoughRestart = 0.8;  // the radius of each restart, as a share of the last one

// A larger sum of squares counts as a failed evaluation: its products would not be finite.
constexpr double kLargestUsableSum = 1e200;

// Thrown if the cases have grown and no point of the model works on them.
struct NothingLeft {};

// Returns true if every variable with room is logarithmic.
bool has_logarithms(const std::vector<DecisionVariable>& variables) {
  return std::ranges::all_of(variables, [](const DecisionVariable& variable) {
    return variable.scale == Scale::logarithmic || variable.lower == variable.upper;
  });
}

// Places are relative to the start, in units of the width of the box. Variables whose bounds are
// equal have no coordinate.
class Places {
 public:
  explicit Places(const SearchSpace& space) : space_(space) {
    for (std::size_t i = 0; i < space.dimension(); ++i) {
      if (space.upper()[i] > space.lower()[i]) {
        variables_.push_back(i);
      }
    }
    lower_.resize(dimension());
    upper_.resize(dimension());
    for (Index k = 0; k < dimension(); ++k) {
      const std::size_t i = variable(k);
      lower_[k] = (space.lower()[i] - space.start()[i]) / width(k);
      upper_[k] = (space.upper()[i] - space.start()[i]) / width(k);
    }
  }

  Index dimension() const { return std::ssize(variables_); }
  std::size_t variable(Index k) const { return variables_[static_cast<std::size_t>(k)]; }
  double width(Index k) const { return space_.upper()[variable(k)] - space_.lower()[variable(k)]; }

  // Returns the steps from a place that stay in the box.
  StepBox get_box(const VectorXd& place) const {
    return {(lower_ - place).cwiseMin(0.0), (upper_ - place).cwiseMax(0.0)};
  }
  std::vector<double> to_coordinates(const VectorXd& place) const {
    std::vector<double> coordinates = space_.start();
    for (Index k = 0; k < dimension(); ++k) {
      const std::size_t i = variable(k);
      coordinates[i] =
          std::clamp(coordinates[i] + place[k] * width(k), space_.lower()[i], space_.upper()[i]);
    }
    return coordinates;
  }

 private:
  const SearchSpace& space_;
  std::vector<std::size_t> variables_;
  VectorXd lower_;
  VectorXd upper_;
};

class DflsSearch {
 public:
  DflsSearch(const DflsSettings& settings, Evaluator& evaluator)
      : settings_(settings),
        function_(evaluator),
        places_(function_.space()),
        is_rough_(settings.power_laws && has_logarithms(evaluator.problem().variables)),
        limit_(is_rough_ ? std::max(settings.smallest_radius, kRoughLimit * settings.radius)
                         : settings.smallest_radius) {}

  // Returns why it ends.
  const char* run() {
    const VectorXd start = VectorXd::Zero(places_.dimension());
    radius_ = settings_.radius;
    if (!begin(start)) {
      return "the start failed, so there is nothing to descend from";
    }
    descend();
    double side = 1;
    for (int restart = 0; restart < settings_.restarts && !settings_.exact; ++restart) {
      const ResidualSample best = model_->centre();
      const std::uint64_t changes = function_.evaluator().case_changes();
      side = -side;
      radius_ = settings_.radius * std::pow(is_rough_ ? kRoughRestart : kShrink, restart + 1);
      if (radius_ < limit_ || best.square_sum == 0) {
        break;
      }
      build(list_axis_places(best.place, side), {best});
      descend();
      if (function_.evaluator().case_changes() == changes &&
          model_->centre().square_sum >= best.square_sum) {
        break;
      }
    }
    if (limit_ > settings_.smallest_radius) {
      radius_ = limit_;
      limit_ = settings_.smallest_radius;
      descend();
    }
    return "it has converged: its trust region is smaller than smallest_radius";
  }

 private:
  // Descends until the resolution is at its limit and the model has nothing to improve.
  void descend() {
    resolution_ = radius_;
    while (true) {
      const ResidualSample& centre = model_->centre();
      const VectorXd step = model_->find_step(places_.get_box(centre.place), radius_);
      const double predicted = centre.square_sum - model_->predict(step).squaredNorm();
      if (step.norm() < kSafety * resolution_ || !(predicted > 0)) {
        radius_ = std::max(kShrink * radius_, resolution_);
        if (!improve() && !grow() && !refine()) {
          return;
        }
        continue;
      }
      const double before = centre.square_sum;
      std::optional<ResidualSample> sample = evaluate(centre.place + step);
      if (!sample) {
        if (!retreat(step.norm())) {
          return;
        }
        continue;
      }
      const double ratio = (before - sample->square_sum) / predicted;
      adapt_radius(ratio, step.norm());
      learn(std::move(*sample));
      if (ratio < kPoor && !improve() && radius_ <= resolution_ && !grow() && !refine()) {
        return;
      }
    }
  }

  void adapt_radius(double ratio, double length) {
    if (ratio >= kGood) {
      radius_ = std::max(radius_, kGrow * length);
      radius_ = std::min(radius_, std::sqrt(static_cast<double>(places_.dimension())));
    } else if (ratio >= kPoor) {
      radius_ = std::max({kShrink * radius_, length, resolution_});
    } else {
      radius_ = std::max(std::min(kShrink * radius_, length), resolution_);
    }
  }

  // Lowers the resolution. Returns false if it is at its limit.
  bool refine() {
    if (resolution_ <= limit_) {
      return false;
    }
    radius_ = std::max(kRadius * resolution_, limit_);
    resolution_ = std::max(kResolution * resolution_, limit_);
    return true;
  }

  // Says that the model has nothing to improve at this resolution, so that the run may add training
  // cases. Returns true if it has: then the model is one of the best point on these cases.
  bool grow() {
    Evaluator& evaluator = function_.evaluator();
    const std::size_t cases = evaluator.cases();
    if (!evaluator.grow_cases()) {
      return false;
    }
    const ResidualModel old = *std::exchange(model_, std::nullopt);
    for (const ResidualSample& known : old.list_samples()) {
      std::optional<ResidualSample> sample = evaluate(known.place);
      if (!sample) {
        continue;
      }
      const VectorXd place = sample->place;
      model_ = ResidualModel::extend(old, *sample, cases, evaluator.cases());
      if (!model_) {
        return build(list_axis_places(place, 1), {std::move(*sample)});
      }
      is_derived_ = false;
      return true;
    }
    throw NothingLeft();
  }

  // Makes the radius a share of a step whose evaluation failed. Returns false if that is less than
  // the limit.
  bool retreat(double length) {
    radius_ = kFailed * length;
    resolution_ = std::min(resolution_, radius_);
    return radius_ >= limit_;
  }

  // Adds an evaluated step to the model.
  void learn(ResidualSample sample) {
    if (!settings_.exact) {
      model_->include(std::move(sample), radius_);
    } else if (sample.square_sum < model_->centre().square_sum) {
      make_model({model_->centre(), std::move(sample)}, model_->calc_jacobian());
      is_derived_ = false;
    }
  }

  // Improves the model by an evaluation. Returns false if there is nothing to improve.
  bool improve() {
    if (settings_.exact) {
      return !is_derived_ && derive(VectorXd(model_->centre().place));
    }
    if (!model_->is_full()) {
      return add_direction();
    }
    const ResidualModel::Distance furthest = model_->find_furthest();
    if (furthest.length <= std::max(2 * radius_, 10 * resolution_)) {
      return false;
    }
    const double reach = std::max(std::min(0.1 * furthest.length, radius_), resolution_);
    const ResidualSample& centre = model_->centre();
    const VectorXd step = find_extreme_step(model_->calc_lagrange_gradient(furthest.index),
                                            places_.get_box(centre.place), reach);
    if (!(step.norm() > 0)) {  // the point tells nothing that the others do not tell
      model_->remove(furthest.index);
      return improve();
    }
    if (std::optional<ResidualSample> sample = evaluate(centre.place + step)) {
      model_->replace(furthest.index, std::move(*sample));
      return true;
    }
    return retreat(step.norm());
  }

  // Evaluates a point along a direction that the model lacks.
  bool add_direction() {
    const ResidualSample& centre = model_->centre();
    const VectorXd step =
        find_extreme_step(model_->find_missing_direction(), places_.get_box(centre.place), radius_);
    if (std::optional<ResidualSample> sample = evaluate(centre.place + step)) {
      model_->include(std::move(*sample), radius_);
      return true;
    }
    return retreat(step.norm());
  }

  // Returns one place per axis, one radius away on the given side, or on the other one where the
  // box is too narrow.
  std::vector<VectorXd> list_axis_places(const VectorXd& centre, double side) const {
    const StepBox box = places_.get_box(centre);
    std::vector<VectorXd> places;
    for (Index k = 0; k < places_.dimension(); ++k) {
      const double above = std::min(radius_, box.upper[k]);
      const double below = std::min(radius_, -box.lower[k]);
      const bool is_above = side > 0 ? above >= below : above > below;
      places.push_back(centre);
      places.back()[k] += is_above ? above : -below;
    }
    return places;
  }

  // Makes the first model. Returns false if the start has failed.
  bool begin(const VectorXd& start) {
    if (settings_.exact) {
      return derive(start);
    }
    std::vector<VectorXd> places = list_axis_places(start, 1);
    places.insert(places.begin(), start);
    return build(places, {});
  }

  void make_model(std::vector<ResidualSample> samples, MatrixXd jacobian) {
    model_.emplace(std::move(samples), std::move(jacobian), is_rough_);
  }

  // Makes a model of places, which are one batch, and of a known point. Points that fail are left
  // out. Returns false if none is left.
  bool build(const std::vector<VectorXd>& places, std::vector<ResidualSample> samples) {
    for (std::optional<ResidualSample>& sample : evaluate(places)) {
      if (sample) {
        samples.push_back(std::move(*sample));
      }
    }
    if (samples.empty()) {
      return false;
    }
    MatrixXd jacobian =
        model_ ? model_->calc_jacobian()
               : MatrixXd(MatrixXd::Zero(samples.front().residuals.size(), places_.dimension()));
    make_model(std::move(samples), std::move(jacobian));
    return true;
  }

  // Makes a model of the exact derivatives at a place. Returns false if the evaluation fails.
  bool derive(const VectorXd& place) {
    const std::vector<double> coordinates = places_.to_coordinates(place);
    const Score score = function_.evaluate_with_jacobian(coordinates);
    std::optional<ResidualSample> sample = make_sample(place, score);
    const std::size_t variables = coordinates.size();
    if (!sample || score.jacobian.size() != score.residuals.size() * variables) {
      return false;
    }
    const std::vector<double> slopes = function_.space().calc_point_slopes(coordinates);
    MatrixXd jacobian(sample->residuals.size(), places_.dimension());
    for (Index row = 0; row < jacobian.rows(); ++row) {
      for (Index k = 0; k < jacobian.cols(); ++k) {
        const std::size_t i = places_.variable(k);
        const double slope = score.jacobian[static_cast<std::size_t>(row) * variables + i] *
                             slopes[i] * places_.width(k);
        jacobian(row, k) = std::isfinite(slope) ? slope : 0;
      }
    }
    make_model({std::move(*sample)}, std::move(jacobian));
    is_derived_ = true;
    return true;
  }

  std::vector<std::optional<ResidualSample>> evaluate(const std::vector<VectorXd>& places) {
    std::vector<std::vector<double>> batch;
    for (const VectorXd& place : places) {
      batch.push_back(places_.to_coordinates(place));
    }
    const std::vector<Score> scores = function_.evaluate_batch(batch);
    std::vector<std::optional<ResidualSample>> samples;
    for (std::size_t i = 0; i < places.size(); ++i) {
      samples.push_back(make_sample(places[i], scores[i]));
    }
    return samples;
  }
  std::optional<ResidualSample> evaluate(const VectorXd& place) {
    return std::move(evaluate(std::vector{place}).front());
  }

  // Returns nothing for a failed evaluation.
  std::optional<ResidualSample> make_sample(const VectorXd& place, const Score& score) const {
    const VectorXd residuals =
        Eigen::Map<const VectorXd>(score.residuals.data(), std::ssize(score.residuals));
    const double square_sum = residuals.squaredNorm();
    const bool fits = !model_ || residuals.size() == model_->centre().residuals.size();
    if (residuals.size() == 0 || !fits || !(square_sum < kLargestUsableSum)) {
      return std::nullopt;
    }
    return ResidualSample{place, residuals, square_sum};
  }

  const DflsSettings& settings_;
  ScalarFunction function_;
  Places places_;
  bool is_rough_;  // power laws, and descents that end early
  double limit_;   // of the radius
  std::optional<ResidualModel> model_;
  double radius_ = 0;
  double resolution_ = 0;
  bool is_derived_ = false;  // the model has the exact derivatives at its centre
};

}  // namespace

void search_with_dfls(const DflsSettings& settings, Evaluator& evaluator) {
  try {
    evaluator.explain_end(DflsSearch(settings, evaluator).run());
  } catch (const NothingLeft&) {
    evaluator.explain_end("no point of its model works on the training cases that were added");
  } catch (const EvaluatorStopped&) {  // the run is over, which is no error
  }
}

}  // namespace armwright
