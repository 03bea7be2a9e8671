#include <gmock/gmock.h>

#include <cmath>

#include "sim/engines/articulated/number_simulation.hpp"

namespace armwright {
namespace {

struct TestLevel;
using Slopes = lanes::Pack<double, 2, TestLevel>;
using Number = lanes::Dual<Slopes>;
using Lane = lanes::NumberLane<Number>;

// Numbers with derivatives (1, 0) or (0, 1): along two independent directions.
Lane make_x(double value) {
  return Lane(Number(value, Slopes(Slopes::Vector{1, 0})));
}
Lane make_y(double value) {
  return Lane(Number(value, Slopes(Slopes::Vector{0, 1})));
}

void expect_lane(const Lane& lane, double value, double by_x, double by_y) {
  // A few roundings of numbers about 1.
  EXPECT_NEAR(lane.value(), value, 1e-15 * std::max(1.0, std::abs(value)));
  EXPECT_NEAR(lane.v.slopes.v[0], by_x, 1e-15 * std::max(1.0, std::abs(by_x)));
  EXPECT_NEAR(lane.v.slopes.v[1], by_y, 1e-15 * std::max(1.0, std::abs(by_y)));
}

TEST(Dual, ArithmeticFollowsTheRulesOfDifferentiation) {
  const Lane x = make_x(1.7);
  const Lane y = make_y(-0.3);
  expect_lane(x + y, 1.4, 1, 1);
  expect_lane(x - y, 2.0, 1, -1);
  expect_lane(-y, 0.3, 0, -1);
  expect_lane(x * y, -0.51, -0.3, 1.7);
  expect_lane(x / y, 1.7 / -0.3, 1 / -0.3, -1.7 / 0.09);
  expect_lane(Lane(2) * x - Lane(5), -1.6, 2, 0);
  Lane sum = x;
  sum += y;
  sum -= Lane(1);
  expect_lane(sum, 0.4, 1, 1);
}

TEST(Dual, ComparisonsChooseByValueAndDerivativesAreTheChosenOnes) {
  const Lane x = make_x(1);
  const Lane y = make_y(2);
  expect_lane(min(x, y), 1, 1, 0);
  expect_lane(max(x, y), 2, 0, 1);
  expect_lane(min(x, make_y(1)), 1, 0, 1);  // the second of equal ones
  expect_lane(max(x, make_y(1)), 1, 0, 1);
  expect_lane(select(x < y, x, y), 1, 1, 0);
  expect_lane(select(x > y, x, y), 2, 0, 1);
  expect_lane(abs(make_x(-3)), 3, -1, 0);
  expect_lane(abs(make_x(3)), 3, 1, 0);
  EXPECT_EQ(find_less(x, y), 1U);
  EXPECT_EQ(find_less(y, x), 0U);
}

TEST(Dual, LeavingTurnsOutKeepsDerivatives) {
  constexpr double kTurn = 2 * M_PI;
  for (const double angle : {0.4, 3.1, -3.1, 3.3, -9.5}) {
    expect_lane(lanes::wrap(make_x(angle)), angle - kTurn * std::round(angle / kTurn), 1, 0);
  }
}

TEST(Dual, SineAndCosineAreEachOthersDerivatives) {
  for (const double angle : {0.3, 2.0, -2.5, 4.4, 100.0}) {
    Lane sine;
    Lane cosine;
    lanes::calc_sine_cosine(make_y(angle), sine, cosine);
    expect_lane(sine, std::sin(angle), 0, std::cos(angle));
    expect_lane(cosine, std::cos(angle), 0, -std::sin(angle));
  }
}

}  // namespace
}  // namespace armwright
