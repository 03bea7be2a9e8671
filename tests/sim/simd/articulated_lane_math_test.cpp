// Sine, cosine, wrapping and the smaller and larger of numbers in lanes, against the C library's
// long double. The tests are compiled for the machine's basic instruction set: one lane and
// SSE2's.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <type_traits>
#include <vector>

#include "base/random.hpp"
#include "sim/simd/lane_math.hpp"

namespace armwright {
namespace {

struct TestLevel;

constexpr long double kLongPi = std::numbers::pi_v<long double>;

template <class V>
struct Lanes : testing::Test {
  using Number = typename V::Scalar;
  static constexpr bool kDouble = std::is_same_v<Number, double>;
  static constexpr Number kFarthest =
      kDouble ? Number{1e6} : Number{1e4};  // of the range that is promised

  // Every lane has another number, so a result in the wrong lane is found.
  static V load(const std::vector<Number>& numbers) {
    alignas(64) Number lanes[V::kLanes];
    for (int i = 0; i < V::kLanes; ++i) {
      lanes[i] = numbers[static_cast<std::size_t>(i)];
    }
    return *reinterpret_cast<const V*>(lanes);
  }
  static std::vector<Number> store(const V& pack) {
    const Number* lanes = reinterpret_cast<const Number*>(&pack);
    return std::vector<Number>(lanes, lanes + V::kLanes);
  }

  // Over the whole range, near its ends, near zero, and around multiples of pi / 4, where the
  // quadrant changes and where sine or cosine are smallest.
  static std::vector<Number> make_angles() {
    RandomStream random("test/sim/lanes", kDouble ? 1 : 2);
    std::vector<Number> angles{0, -Number{0}, kFarthest, -kFarthest,
                               std::numeric_limits<Number>::min()};
    for (int i = 0; i < 20000; ++i) {
      angles.push_back(static_cast<Number>(random.uniform(-kFarthest, kFarthest)));
      angles.push_back(static_cast<Number>(random.uniform(-7, 7)));
      angles.push_back(static_cast<Number>(std::pow(10, random.uniform(-12, 0))));
      const auto most = static_cast<double>(kFarthest) / (std::numbers::pi / 4) - 1;
      const double eighth = std::floor(random.uniform(-most, most));
      const auto near = static_cast<Number>(static_cast<long double>(eighth) * (kLongPi / 4));
      angles.push_back(near);
      angles.push_back(std::nextafter(near, kFarthest));
      angles.push_back(std::nextafter(near, -kFarthest));
    }
    angles.resize(angles.size() / V::kLanes * V::kLanes);
    return angles;
  }

  // f(the lanes' angles, the angles one by one) for all angles.
  template <class F>
  static void for_packs(const F& f) {
    const std::vector<Number> angles = make_angles();
    for (std::size_t i = 0; i < angles.size(); i += V::kLanes) {
      const std::vector<Number> some(angles.begin() + static_cast<std::ptrdiff_t>(i),
                                     angles.begin() + static_cast<std::ptrdiff_t>(i) + V::kLanes);
      f(load(some), some);
    }
  }
};

using LaneTypes =
    testing::Types<lanes::Single<double, TestLevel>, lanes::Single<float, TestLevel>,
                   lanes::Pack<double, 2, TestLevel>, lanes::Pack<float, 4, TestLevel>,
                   lanes::Pair<lanes::Pack<double, 2, TestLevel>>>;
TYPED_TEST_SUITE(Lanes, LaneTypes);

TYPED_TEST(Lanes, SineAndCosineAreWithinTheBoundThatIsPromised) {
  using T = typename TypeParam::Scalar;
  const double bound = TestFixture::kDouble ? 2.2e-16 : 9e-8;
  double worst = 0;
  T worst_at = 0;
  TestFixture::for_packs([&](TypeParam angles, const std::vector<T>& each) {
    TypeParam sine, cosine;
    lanes::calc_sine_cosine(angles, sine, cosine);
    const std::vector<T> sines = TestFixture::store(sine), cosines = TestFixture::store(cosine);
    for (std::size_t i = 0; i < each.size(); ++i) {
      const long double x = each[i];
      const auto error = static_cast<double>(
          std::max(std::abs(sines[i] - std::sin(x)), std::abs(cosines[i] - std::cos(x))));
      if (!(error <= worst)) {
        worst = error;
        worst_at = each[i];
      }
    }
  });
  EXPECT_LE(worst, bound) << "at " << worst_at;
  EXPECT_GT(worst, bound / 10);  // rounding alone is that large
}

// Small angles keep their digits: the sine of x is x, in relative terms.
TYPED_TEST(Lanes, SinesOfSmallAnglesAreAsPreciseAsThese) {
  using T = typename TypeParam::Scalar;
  TestFixture::for_packs([&](TypeParam angles, const std::vector<T>& each) {
    TypeParam sine, cosine;
    lanes::calc_sine_cosine(angles, sine, cosine);
    const std::vector<T> sines = TestFixture::store(sine);
    for (std::size_t i = 0; i < each.size(); ++i) {
      if (std::abs(each[i]) < T{0.5}) {
        const long double exact = std::sin(static_cast<long double>(each[i]));
        ASSERT_LE(std::abs(sines[i] - exact),
                  std::abs(exact) * 2 * std::numeric_limits<T>::epsilon())
            << each[i];
      }
    }
  });
}

TYPED_TEST(Lanes, EveryLaneIsOnItsOwn) {
  using T = typename TypeParam::Scalar;
  TestFixture::for_packs([&](TypeParam angles, const std::vector<T>& each) {
    TypeParam sine, cosine;
    lanes::calc_sine_cosine(angles, sine, cosine);
    for (std::size_t i = 0; i < each.size(); ++i) {
      TypeParam alone_sine, alone_cosine;
      lanes::calc_sine_cosine(TypeParam(each[i]), alone_sine, alone_cosine);
      ASSERT_EQ(TestFixture::store(sine)[i], TestFixture::store(alone_sine)[0]) << each[i];
      ASSERT_EQ(TestFixture::store(cosine)[i], TestFixture::store(alone_cosine)[0]) << each[i];
    }
  });
}

// The multiple of the rounded 2 pi costs half a unit in the last place of itself; a number that is
// next to an odd multiple of pi may go either way.
TYPED_TEST(Lanes, WrappingTakesTheNearestTurnAway) {
  using T = typename TypeParam::Scalar;
  constexpr T kEpsilon = std::numeric_limits<T>::epsilon();
  TestFixture::for_packs([&](TypeParam angles, const std::vector<T>& each) {
    const std::vector<T> wrapped = TestFixture::store(lanes::wrap(angles));
    for (std::size_t i = 0; i < each.size(); ++i) {
      const long double x = each[i];
      const long double tolerance = 2 * kEpsilon * (std::abs(x) + kLongPi);
      ASSERT_LE(std::abs(wrapped[i]), kLongPi + tolerance) << each[i];
      ASSERT_LE(std::abs(std::remainder(wrapped[i] - x, 2 * kLongPi)), tolerance) << each[i];
      if (std::abs(x) < kLongPi - 1e-6L) {
        ASSERT_EQ(wrapped[i], each[i]);
      }
    }
  });
}

TYPED_TEST(Lanes, BeyondTheRangeTheyStayFinite) {
  using T = typename TypeParam::Scalar;
  for (const T angle : {T{1e7}, T{-1e8}, T{1e9}}) {
    TypeParam sine, cosine;
    lanes::calc_sine_cosine(TypeParam(angle), sine, cosine);
    for (const TypeParam& pack : {sine, cosine}) {
      EXPECT_TRUE(std::isfinite(TestFixture::store(pack)[0])) << angle;
    }
  }
}

// Clamping relies on this: min and max return the second argument if one is NaN.
TYPED_TEST(Lanes, SmallerAndLargerOfWhatDoesNotCompareIsTheSecond) {
  using T = typename TypeParam::Scalar;
  const T nan = std::numeric_limits<T>::quiet_NaN();
  const auto first = [](const TypeParam& pack) { return TestFixture::store(pack)[0]; };
  EXPECT_EQ(first(min(TypeParam(T{1}), TypeParam(T{2}))), T{1});
  EXPECT_EQ(first(max(TypeParam(T{1}), TypeParam(T{2}))), T{2});
  EXPECT_EQ(first(min(TypeParam(nan), TypeParam(T{2}))), T{2});
  EXPECT_EQ(first(max(TypeParam(nan), TypeParam(T{2}))), T{2});
  EXPECT_TRUE(std::isnan(first(min(TypeParam(T{1}), TypeParam(nan)))));
  EXPECT_TRUE(std::isnan(first(max(TypeParam(T{1}), TypeParam(nan)))));
}

TYPED_TEST(Lanes, FindLessHasABitForEveryLane) {
  using T = typename TypeParam::Scalar;
  const std::uint32_t all = (std::uint32_t{1} << TypeParam::kLanes) - 1;
  for (std::uint32_t wanted = 0; wanted <= all; ++wanted) {
    std::vector<T> numbers;
    for (int lane = 0; lane < TypeParam::kLanes; ++lane) {
      const T others = lane % 2 == 0 ? T{3} : std::numeric_limits<T>::quiet_NaN();
      numbers.push_back((wanted >> lane & 1) != 0 ? T{-1} : others);
    }
    EXPECT_EQ(find_less(TestFixture::load(numbers), TypeParam(T{3})), wanted);
  }
}

}  // namespace
}  // namespace armwright
