#include "optimizers/dfls/residual_model.hpp"

#include <gtest/gtest.h>

#include "base/random.hpp"

namespace armwright {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct LinearResiduals {
  MatrixXd slopes;
  VectorXd shift;

  ResidualSample sample(const VectorXd& place) const {
    const VectorXd residuals = slopes * place + shift;
    return {place, residuals, residuals.squaredNorm()};
  }
};

MatrixXd draw_matrix(RandomStream& random, Index rows, Index columns) {
  MatrixXd matrix(rows, columns);
  for (Index i = 0; i < rows; ++i) {
    for (Index k = 0; k < columns; ++k) {
      matrix(i, k) = random.normal();
    }
  }
  return matrix;
}

class ResidualModelOfALinearFunction : public testing::Test {
 protected:
  // n = 4 variables, 6 residuals
  std::vector<ResidualSample> draw_samples(std::size_t count) {
    std::vector<ResidualSample> samples;
    for (std::size_t i = 0; i < count; ++i) {
      samples.push_back(function_.sample(draw_matrix(random_, 4, 1)));
    }
    return samples;
  }

  RandomStream random_{"test/residual-model", 1};
  LinearResiduals function_{draw_matrix(random_, 6, 4), draw_matrix(random_, 6, 1)};
};

TEST_F(ResidualModelOfALinearFunction, IsExactWithOnePointMoreThanVariables) {
  const ResidualModel model(draw_samples(5), MatrixXd::Zero(6, 4));
  EXPECT_TRUE(model.is_full());
  EXPECT_LT((model.jacobian() - function_.slopes).norm(), 1e-12 * function_.slopes.norm());
  for (const ResidualSample& one : draw_samples(20)) {
    EXPECT_GE(model.centre().square_sum + 1e-9, 0);
    const VectorXd predicted =
        model.centre().residuals + model.jacobian() * (one.place - model.centre().place);
    EXPECT_LT((predicted - one.residuals).norm(), 1e-10);
  }
}

TEST_F(ResidualModelOfALinearFunction, AgreesWithFewPointsAndKeepsTheRest) {
  const MatrixXd before = draw_matrix(random_, 6, 4);
  const std::vector<ResidualSample> samples = draw_samples(3);
  const ResidualModel model(samples, before);
  EXPECT_FALSE(model.is_full());
  for (const ResidualSample& one : samples) {
    const VectorXd predicted =
        model.centre().residuals + model.jacobian() * (one.place - model.centre().place);
    EXPECT_LT((predicted - one.residuals).norm(), 1e-12);
  }
  const VectorXd missing = model.find_missing_direction();
  EXPECT_NEAR(missing.norm(), 1, 1e-12);
  for (const ResidualSample& one : samples) {
    EXPECT_NEAR(missing.dot(one.place - model.centre().place), 0, 1e-12);
  }
  EXPECT_LT((model.jacobian() * missing - before * missing).norm(), 1e-12);
}

TEST_F(ResidualModelOfALinearFunction, ABetterPointBecomesTheCentreAndTheBestNeverLeaves) {
  ResidualModel model(draw_samples(5), MatrixXd::Zero(6, 4));
  for (ResidualSample& one : draw_samples(200)) {
    const double best = std::min(model.centre().square_sum, one.square_sum);
    model.include(std::move(one), 0.5);
    EXPECT_EQ(model.centre().square_sum, best);
    EXPECT_TRUE(model.is_full());
    EXPECT_LT((model.jacobian() - function_.slopes).norm(), 1e-6);
  }
}

TEST_F(ResidualModelOfALinearFunction, LagrangeGradientsAreOneAtTheirPointAndZeroAtTheOthers) {
  const std::vector<ResidualSample> samples = draw_samples(5);
  const ResidualModel model(samples, MatrixXd::Zero(6, 4));
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (samples[k].place == model.centre().place) {
      continue;
    }
    const VectorXd gradient = model.calc_lagrange_gradient(k);
    for (std::size_t other = 0; other < samples.size(); ++other) {
      EXPECT_NEAR(gradient.dot(samples[other].place - model.centre().place), other == k ? 1 : 0,
                  1e-11);
    }
  }
}

TEST_F(ResidualModelOfALinearFunction, DistantPointsLeaveFirst) {
  std::vector<ResidualSample> samples{function_.sample(VectorXd::Zero(4))};
  for (Index i = 0; i < 4; ++i) {
    samples.push_back(function_.sample(VectorXd::Unit(4, i) * (i == 2 ? 100 : 0.1)));
  }
  // The centre must be the origin, whatever the sums are.
  for (std::size_t i = 1; i < samples.size(); ++i) {
    samples[i].square_sum = samples[0].square_sum + 1;
  }
  ResidualModel model(samples, MatrixXd::Zero(6, 4));
  EXPECT_EQ(model.find_furthest().index, 3U);
  EXPECT_EQ(model.find_furthest().length, 100);
  ResidualSample near = function_.sample(VectorXd::Constant(4, 0.05));
  near.square_sum = samples[0].square_sum + 1;
  model.include(near, 0.1);
  EXPECT_LT(model.find_furthest().length, 0.2);
}

}  // namespace
}  // namespace armwright
