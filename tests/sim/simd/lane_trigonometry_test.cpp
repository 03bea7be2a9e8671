#include "sim/simd/lane_trigonometry.hpp"

#include <gmock/gmock.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "base/random.hpp"
#include "sim/support.hpp"

namespace armwright {
namespace {

struct TestLevel;
using One = lanes::Single<double, TestLevel>;
// These need no instruction set of their own; the wider ones are compared by targets_test.cpp.
using Two = lanes::Pack<double, 2, TestLevel>;
using Four = lanes::Pair<Two>;

double calc_angle(double y, double x) {
  return calc_atan2(One(y), One(x)).v;
}

template <class V>
std::array<double, V::kLanes> read(V v) {
  std::array<double, V::kLanes> numbers;
  std::memcpy(numbers.data(), &v, sizeof v);
  return numbers;
}
template <class V>
V write(const double* numbers) {
  V v;
  std::memcpy(static_cast<void*>(&v), numbers, sizeof v);
  return v;
}

// The bounds that the header states.
void expect_accurate(double y, double x) {
  const long double expected = std::atan2(static_cast<long double>(y), static_cast<long double>(x));
  const double angle = calc_angle(y, x);
  const auto error = static_cast<double>(std::abs(angle - expected));
  ASSERT_LE(error, 4e-16) << y << ' ' << x;
  if (std::abs(expected) < kPi / 8) {
    ASSERT_LE(error, 4e-16 * static_cast<double>(std::abs(expected))) << y << ' ' << x;
  }
  ASSERT_EQ(std::signbit(angle), std::signbit(y)) << y << ' ' << x;
}

TEST(LaneAtan2, KeepsItsErrorBoundAllAround) {
  RandomStream random("test/lanes/atan2");
  for (int i = 0; i < 200'000; ++i) {
    const double angle = random.uniform(-kPi, kPi);
    const double radius = std::exp(random.uniform(-20, 20));
    expect_accurate(radius * std::sin(angle), radius * std::cos(angle));
  }
}

TEST(LaneAtan2, KeepsItsErrorBoundAtSmallAngles) {
  RandomStream random("test/lanes/small angles");
  for (int i = 0; i < 100'000; ++i) {
    expect_accurate(random.uniform(-1, 1) * std::exp(random.uniform(-600, 0)),
                    random.uniform(0.5, 2));
  }
}

// The seams of the reduction: the axes, the diagonals, an eighth of pi, each with its neighbours.
TEST(LaneAtan2, KeepsItsErrorBoundAtTheSeams) {
  for (const double seam : {0.0, 0.41421356237309503, 1.0, 2.4142135623730949}) {
    double ratio = seam;
    for (int i = 0; i < 20; ++i) {
      ratio = std::nextafter(ratio, 0);
    }
    for (int i = 0; i < 40; ++i, ratio = std::nextafter(ratio, 10)) {
      for (const double scale : {1e-150, 0.3, 1.0, 7.0, 1e150}) {
        for (const double x : {scale, -scale}) {
          for (const double y : {ratio * scale, -ratio * scale}) {
            expect_accurate(y, x);
            if (y != 0) {
              expect_accurate(x, y);
            }
          }
        }
      }
    }
  }
}

TEST(LaneAtan2, IsExactOnTheAxesAndZeroAtTheOrigin) {
  for (const double r : {std::numeric_limits<double>::denorm_min(), 1e-310, 1.0, 8e307}) {
    EXPECT_EQ(calc_angle(0, r), 0);
    EXPECT_EQ(calc_angle(0, -r), kPi);
    EXPECT_EQ(calc_angle(-0.0, -r), -kPi);
    for (const double zero : {0.0, -0.0}) {
      EXPECT_EQ(calc_angle(r, zero), kPi / 2);
      EXPECT_EQ(calc_angle(-r, zero), -kPi / 2);
    }
    EXPECT_EQ(calc_angle(r, r), kPi / 4);
    EXPECT_EQ(calc_angle(r, -r), 3 * kPi / 4);
  }
  for (const double y : {0.0, -0.0}) {
    for (const double x : {0.0, -0.0}) {
      EXPECT_EQ(calc_angle(y, x), 0);
      EXPECT_EQ(std::signbit(calc_angle(y, x)), std::signbit(y));
    }
  }
}

TEST(LaneAtan2, IsNoNumberForWhatIsNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(calc_angle(nan, 1)));
  EXPECT_TRUE(std::isnan(calc_angle(1, nan)));
}

template <class V>
void expect_same_bits_as_one(const std::vector<double>& ys, const std::vector<double>& xs) {
  for (std::size_t i = 0; i + V::kLanes <= ys.size(); ++i) {
    const V y = write<V>(&ys[i]);
    const V x = write<V>(&xs[i]);
    const auto angle = read(calc_atan2(y, x));
    const auto root = read(sqrt(flip_sign(y, y)));
    const auto flipped = read(flip_sign(y, x));
    for (std::size_t lane = 0; lane < V::kLanes; ++lane) {
      const double one_y = ys[i + lane];
      const double one_x = xs[i + lane];
      ASSERT_EQ(std::bit_cast<std::uint64_t>(angle[lane]),
                std::bit_cast<std::uint64_t>(calc_angle(one_y, one_x)))
          << one_y << ' ' << one_x;
      ASSERT_EQ(root[lane], std::sqrt(std::abs(one_y)));
      ASSERT_EQ(std::bit_cast<std::uint64_t>(flipped[lane]),
                std::bit_cast<std::uint64_t>(flip_sign(One(one_y), One(one_x)).v));
    }
  }
}

TEST(LaneTrigonometry, GivesTheSameBitsForAnyNumberOfLanes) {
  RandomStream random("test/lanes/same bits");
  std::vector<double> ys, xs;
  const auto draw = [&] {
    const double special = random.uniform(0, 8);
    return special < 1 ? 0.0 : special < 2 ? -0.0 : special < 3 ? 1.0 : random.uniform(-2, 2);
  };
  for (int i = 0; i < 20'000; ++i) {
    ys.push_back(draw());
    xs.push_back(draw());
  }
  expect_same_bits_as_one<Two>(ys, xs);
  expect_same_bits_as_one<Four>(ys, xs);
}

}  // namespace
}  // namespace armwright
