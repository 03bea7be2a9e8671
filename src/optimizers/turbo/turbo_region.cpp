#include "optimizers/turbo/turbo_region.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "optimizers/turbo/box_descent.hpp"

namespace armwright {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kShortestSide = 1.0 / 128;
constexpr double kLongestSide = 1.6;
constexpr int kSuccesses = 3;
// A success is an improvement by this share of the best value's magnitude.
constexpr double kLeastImprovement = 1e-3;

// The hyperparameters are fitted on at most this many places, those nearest to the centre.
constexpr Index kMostFitted = 500;
constexpr int kFitSteps = 20;

// Two places at a smaller distance count as one.
constexpr double kSamePlace = 1e-9;

// Returns the values with mean 0 and variance 1. Equal values become 0.
VectorXd standardise(VectorXd values) {
  values.array() -= values.mean();
  const double deviation = std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
  return deviation > 0 ? VectorXd(values / deviation) : VectorXd::Zero(values.size());
}

std::vector<Index> sort_by(const VectorXd& keys) {
  std::vector<Index> order(static_cast<std::size_t>(keys.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::ranges::stable_sort(order, {}, [&](Index i) { return keys[i]; });
  return order;
}

}  // namespace

TurboRegion::TurboRegion(const TurboBox& box, const ProblemDescription& problem, double length)
    : box_(box),
      problem_(problem),
      n_(box.dimension()),
      length_(length),
      places_(n_, 0),
      objective_(box.feature_variables()),
      constraints_(problem.constraints.size(), GaussianProcess(box.feature_variables())),
      weights_(VectorXd::Ones(n_)) {}

bool TurboRegion::has_converged() const {
  return length_ < kShortestSide;
}

void TurboRegion::begin(const MatrixXd& places, std::span<const Score> scores) {
  add(places, scores);
}

void TurboRegion::add(const MatrixXd& places, std::span<const Score> scores) {
  places_.conservativeResize(n_, places_.cols() + places.cols());
  places_.rightCols(places.cols()) = places;
  scores_.insert(scores_.end(), scores.begin(), scores.end());
  for (const Score& score : scores) {
    fitness_.push_back(calc_fitness(problem_, score));
  }
}

std::size_t TurboRegion::find_best() const {
  return static_cast<std::size_t>(std::ranges::min_element(fitness_, is_fitter) - fitness_.begin());
}

bool TurboRegion::is_success(const Fitness& before, const Fitness& after) const {
  if (before.violation > 0) {
    return after.violation < before.violation;
  }
  return after.violation <= 0 &&
         after.objective < before.objective - kLeastImprovement * std::abs(before.objective);
}

void TurboRegion::add_batch(const MatrixXd& places, std::span<const Score> scores) {
  const Fitness before = fitness_[find_best()];
  add(places, scores);
  if (is_success(before, fitness_[find_best()])) {
    ++successes_;
    failures_ = 0;
  } else {
    ++failures_;
    successes_ = 0;
  }
  const double most_failures =
      std::ceil(std::max(4.0, static_cast<double>(n_)) / static_cast<double>(places.cols()));
  if (successes_ == kSuccesses) {
    length_ = std::min(2 * length_, kLongestSide);
    successes_ = 0;
  } else if (failures_ >= most_failures) {
    length_ /= 2;
    failures_ = 0;
  }
}

// An evaluation that did not end well counts as the worst of those that did, so that a penalty
// tells where the failures are and does not hide the shape of the rest.
VectorXd TurboRegion::make_objective_values() const {
  double worst = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < scores_.size(); ++k) {
    if (scores_[k].status == EvaluationStatus::ok) {
      worst = std::max(worst, fitness_[k].objective);
    }
  }
  VectorXd values(places_.cols());
  for (std::size_t k = 0; k < scores_.size(); ++k) {
    const double objective = fitness_[k].objective;
    const bool is_bad = scores_[k].status != EvaluationStatus::ok && std::isfinite(worst);
    values[static_cast<Index>(k)] = is_bad ? std::min(objective, worst) : objective;
  }
  return standardise(values);
}

// Returns sign(g) log(1 + |g| / s), which is steepest at the limit (Eriksson and Poloczek 2021, the
// bilog transformation). s is the median of |g|. A failed evaluation counts as the worst.
VectorXd TurboRegion::make_constraint_values(std::size_t constraint) const {
  std::vector<double> magnitudes;
  double worst = 0;
  for (const Score& score : scores_) {
    if (!score.constraint_values.empty()) {
      magnitudes.push_back(std::abs(score.constraint_values[constraint]));
      worst = std::max(worst, score.constraint_values[constraint]);
    }
  }
  const auto middle = magnitudes.begin() + std::ssize(magnitudes) / 2;
  std::ranges::nth_element(magnitudes, middle);
  const double scale = !magnitudes.empty() && *middle > 0 ? *middle : 1;
  VectorXd values(places_.cols());
  for (std::size_t k = 0; k < scores_.size(); ++k) {
    const std::vector<double>& all = scores_[k].constraint_values;
    const double g = all.empty() ? std::max(worst, scale) : all[constraint];
    values[static_cast<Index>(k)] = std::copysign(std::log1p(std::abs(g) / scale), g);
  }
  return values;
}

void TurboRegion::fit_processes() {
  const MatrixXd features = box_.calc_features(places_);
  const bool fits = places_.cols() >= next_fit_;
  std::vector<Index> nearest;
  if (fits) {
    const MatrixXd steps = weights_.cwiseInverse().asDiagonal() *
                           (places_.colwise() - places_.col(static_cast<Index>(find_best())));
    nearest = sort_by(steps.colwise().norm().transpose());
    nearest.resize(std::min(nearest.size(), static_cast<std::size_t>(kMostFitted)));
    next_fit_ = places_.cols() + std::max(places_.cols() / 20, Index{1});
  }
  const auto update = [&](GaussianProcess& process, const VectorXd& values) {
    if (fits) {
      process.fit(features(Eigen::all, nearest), values(nearest), kFitSteps);
    }
    process.condition(features, values);
  };
  update(objective_, make_objective_values());
  for (std::size_t i = 0; i < constraints_.size(); ++i) {
    update(constraints_[i], make_constraint_values(i));
  }
}

void TurboRegion::place_box() {
  centre_ = places_.col(static_cast<Index>(find_best()));
  weights_ = objective_.hyperparameters().head(n_);
  weights_ = (weights_.array() - weights_.mean()).exp();
  lower_.resize(n_);
  upper_.resize(n_);
  for (Index i = 0; i < n_; ++i) {
    const auto variable = static_cast<std::size_t>(i);
    const double half =
        0.5 * std::max(length_ * weights_[i], box_.calc_least_width(variable, centre_[i]));
    const bool is_category = box_.is_category(variable);
    lower_[i] = is_category ? 0 : std::max(centre_[i] - half, 0.0);
    upper_[i] = is_category ? 1 : std::min(centre_[i] + half, 1.0);
  }
}

MatrixXd TurboRegion::draw_candidates(RandomStream& random) const {
  // Enough for the local minima of a sample to be found from the best ones.
  const Index count = std::min<Index>(100 + 20 * n_, 500);
  const double moved = std::min(1.0, 20.0 / static_cast<double>(n_));
  constexpr double kMovedCategory = 0.5;  // its trust region is the whole box
  MatrixXd candidates(n_, count);
  VectorXd order(count);
  for (Index i = 0; i < n_; ++i) {
    std::generate(order.begin(), order.end(), [&] { return random.uniform(); });
    const std::vector<Index> cells = sort_by(order);
    for (Index k = 0; k < count; ++k) {
      const double share =
          (static_cast<double>(cells[static_cast<std::size_t>(k)]) + random.uniform()) /
          static_cast<double>(count);
      candidates(i, k) = lower_[i] + share * (upper_[i] - lower_[i]);
    }
  }
  for (Index k = 0; k < count; ++k) {
    const auto always = static_cast<Index>(random.below(static_cast<std::uint64_t>(n_)));
    for (Index i = 0; i < n_; ++i) {
      const double probability =
          box_.is_category(static_cast<std::size_t>(i)) ? kMovedCategory * moved : moved;
      if (i != always && probability < 1 && !random.bernoulli(probability)) {
        candidates(i, k) = centre_[i];
      }
    }
    box_.settle(candidates.col(k));
  }
  return candidates;
}

VectorXd TurboRegion::minimise(const Draw& draw, RandomStream& random) const {
  constexpr std::size_t kRefined = 3;
  constexpr int kRefineSteps = 50;
  // In standardised units. With the weight, the minimum violates a constraint by less than the
  // margin, unless the constraint's multiplier is above 2.
  constexpr double kMargin = 1e-3;
  constexpr double kWeight = 1e3;
  MatrixXd candidates = draw_candidates(random);
  candidates.col(0) = centre_;
  const MatrixXd features = box_.calc_features(candidates);
  const VectorXd values = draw.objective.calc_values(features);
  VectorXd violations = VectorXd::Zero(values.size());
  for (const ProcessFunction& constraint : draw.constraints) {
    violations += constraint.calc_values(features).cwiseMax(0);
  }
  std::vector<Fitness> fitness;
  for (Index k = 0; k < values.size(); ++k) {
    fitness.push_back({.violation = violations[k], .objective = values[k]});
  }
  std::vector<Index> order(fitness.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::ranges::stable_sort(order, is_fitter,
                           [&](Index k) { return fitness[static_cast<std::size_t>(k)]; });

  // The features of real variables are their shares, so those of the others stay.
  std::vector<Index> real_features;
  std::vector<Index> real_variables;
  for (std::size_t f = 0; f < box_.feature_variables().size(); ++f) {
    if (!box_.is_discrete(box_.feature_variables()[f])) {
      real_features.push_back(static_cast<Index>(f));
      real_variables.push_back(static_cast<Index>(box_.feature_variables()[f]));
    }
  }
  VectorXd best = candidates.col(order[0]);
  Fitness best_fitness = fitness[static_cast<std::size_t>(order[0])];
  if (real_features.empty()) {
    return best;
  }
  const Box trust{lower_(real_variables), upper_(real_variables)};
  std::vector<Index> starts = {0};  // the centre
  starts.insert(starts.end(), order.begin(), order.begin() + kRefined - 1);
  for (const Index start : starts) {
    VectorXd at = features.col(start);
    VectorXd slope;
    VectorXd x = at(real_features);
    descend_in_box(
        [&](const VectorXd& shares, VectorXd& gradient) {
          at(real_features) = shares;
          double value = draw.objective.calc_gradient(at, slope);
          gradient = slope(real_features);
          for (const ProcessFunction& constraint : draw.constraints) {
            const double excess = constraint.calc_gradient(at, slope) + kMargin;
            if (excess > 0) {
              value += kWeight * excess * excess;
              gradient += 2 * kWeight * excess * slope(real_features);
            }
          }
          return value;
        },
        trust, kRefineSteps, x);
    at(real_features) = x;
    Fitness found{.violation = 0, .objective = draw.objective.calc_gradient(at, slope)};
    for (const ProcessFunction& constraint : draw.constraints) {
      found.violation += std::max(constraint.calc_gradient(at, slope), 0.0);
    }
    if (is_fitter(found, best_fitness)) {
      best_fitness = found;
      best = candidates.col(start);
      best(real_variables) = x;
    }
  }
  return best;
}

bool TurboRegion::is_known(const MatrixXd& batch, Index place) const {
  const auto is_near = [&](const auto& other) {
    return (other - batch.col(place)).template lpNorm<Eigen::Infinity>() < kSamePlace;
  };
  for (Index k = 0; k < places_.cols(); ++k) {
    if (is_near(places_.col(k))) {
      return true;
    }
  }
  for (Index k = 0; k < place; ++k) {
    if (is_near(batch.col(k))) {
      return true;
    }
  }
  return false;
}

MatrixXd TurboRegion::choose(Index batch, RandomStream& random) {
  constexpr int kTries = 100;
  fit_processes();
  place_box();
  MatrixXd chosen(n_, batch);
  for (Index k = 0; k < batch; ++k) {
    Draw draw{.objective = objective_.draw_sample(random), .constraints = {}};
    for (const GaussianProcess& constraint : constraints_) {
      draw.constraints.push_back(constraint.draw_sample(random));
    }
    chosen.col(k) = minimise(draw, random);
    for (int tries = 0; tries < kTries && is_known(chosen, k); ++tries) {
      for (Index i = 0; i < n_; ++i) {
        chosen(i, k) = random.uniform(lower_[i], upper_[i]);
      }
      box_.settle(chosen.col(k));
    }
  }
  return chosen;
}

}  // namespace armwright
