#include "sim/tracking/test_case.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "sim/support.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;

// Coordinates are below 4 m in every sphere used here; a point is the sum of two rounded numbers of
// that size.
constexpr double kRounding_m = 8 * std::numeric_limits<double>::epsilon();

std::string message_of(ErrorKind kind, const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind);
    return error.what();
  }
  return "(no error)";
}

const std::vector<WorkspaceSphere>& spheres() {
  static const std::vector<WorkspaceSphere> all = {
      {},
      {{-0.31, 0.77, 2.05}, 0.37, 0.0123, 12},
      {{0.6, -0.4, 0.2}, 0.25, 0.33, 3},
      {{1.1, 0.3, 0.8}, 0.5, 0.9, 60},  // only long moves: few directions stay inside
  };
  return all;
}

double calc_chi_square(const std::vector<int>& counts, double expected) {
  double sum = 0;
  for (const int count : counts) {
    sum += (count - expected) * (count - expected) / expected;
  }
  return sum;
}

// Thesis, table 5.2, which gives metres with three decimals.
constexpr std::array<double, 25> kTable52_m = {
    0.800, 1.600, 1.376, 1.184, 1.018, 0.876, 0.753, 0.648, 0.557, 0.479, 0.412, 0.355, 0.305,
    0.262, 0.226, 0.194, 0.167, 0.144, 0.123, 0.106, 0.091, 0.079, 0.068, 0.058, 0.050};

TEST(TestCases, MoveByTheDistancesOfTheThesis) {
  for (std::uint64_t number = 0; number < 20; ++number) {
    const TestCase made = make_test_case("train/1", number, {});
    ASSERT_EQ(made.points_m.size(), 26u);
    EXPECT_EQ(made.points_m[0], Eigen::Vector3d(1.4, 0.0, 0.9));
    for (std::size_t k = 1; k <= 25; ++k) {
      EXPECT_NEAR((made.points_m[k] - made.points_m[k - 1]).norm(), kTable52_m[k - 1], 0.0005)
          << "case " << number << ", point " << k;
    }
  }
}

// The expected numbers were computed with 60 decimal digits; the power was rounded to double once
// and then multiplied by 2r. Of the 25 powers, the one nearest to a rounding boundary is 0.03 ulp
// away from it, so any long double with at least 64 bits of mantissa gives the same numbers.
TEST(TestCases, MovesAreTheSameBitsEverywhere) {
  const WorkspaceSphere sphere;
  EXPECT_EQ(sphere.calc_move_m(1), 0.8);
  EXPECT_EQ(sphere.calc_move_m(2), 1.6);
  EXPECT_EQ(sphere.calc_move_m(3), 0x1.604e0bda4d7c5p+0);
  EXPECT_EQ(sphere.calc_move_m(7), 0x1.81a425be1883fp-1);
  EXPECT_EQ(sphere.calc_move_m(14), 0x1.0c9c7ef4c2d49p-2);
  EXPECT_EQ(sphere.calc_move_m(23), 0x1.14d462151be04p-4);
  EXPECT_EQ(sphere.calc_move_m(24), 0x1.dc36877d20077p-5);
  EXPECT_EQ(sphere.calc_move_m(25), 0x1.999999999999ap-5);
}

TEST(TestCases, StayInTheirSphere) {
  for (const WorkspaceSphere& sphere : spheres()) {
    for (std::uint64_t number = 0; number < 50; ++number) {
      const auto points_m = make_test_case("validation/1", number, sphere).points_m;
      ASSERT_EQ(points_m.size(), static_cast<std::size_t>(sphere.points) + 1);
      EXPECT_EQ(points_m[0], sphere.centre_m);
      EXPECT_NEAR((points_m[1] - sphere.centre_m).norm(), sphere.radius_m, kRounding_m);
      EXPECT_NEAR((points_m[2] - sphere.centre_m).norm(), sphere.radius_m, kRounding_m);
      EXPECT_NEAR((points_m[1] + points_m[2] - 2 * sphere.centre_m).norm(), 0, kRounding_m);
      for (std::size_t k = 3; k < points_m.size(); ++k) {
        ASSERT_LE((points_m[k] - sphere.centre_m).norm(), sphere.radius_m + kRounding_m);
        ASSERT_NEAR((points_m[k] - points_m[k - 1]).norm(), sphere.calc_move_m(static_cast<int>(k)),
                    kRounding_m);
      }
    }
  }
}

TEST(TestCases, DependOnNameAndNumberOnly) {
  const TestSet set = TestSet::make_generated("train/3", {});
  EXPECT_EQ(set.name(), "train/3");
  EXPECT_EQ(set.size(), std::nullopt);
  std::vector<TestCase> forward(40);
  std::vector<TestCase> backward(40);
  for (std::size_t i = 0; i < 40; ++i) {
    forward[i] = set.make_case(i);
  }
  for (std::size_t i = 40; i-- > 0;) {
    backward[i] = make_test_case("train/3", i, {});
  }
  EXPECT_EQ(calc_content_hash(forward), calc_content_hash(backward));
  for (std::size_t i = 0; i < 40; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_NE(forward[i].points_m[1], forward[j].points_m[1]) << i << " " << j;
    }
    EXPECT_NE(forward[i].points_m[1], make_test_case("train/4", i, {}).points_m[1]) << i;
  }
  EXPECT_NO_THROW(set.make_case(std::numeric_limits<std::uint64_t>::max()));
}

// If the generator changed, an old name would stand for other test cases, and results would no
// longer be comparable. The expected numbers come from a second implementation (Philox, the
// directions, the hash) in Python.
TEST(TestCases, AreTheOnesOfAllEarlierResults) {
  const auto points_m = make_test_case("train/1", 0, {}).points_m;
  EXPECT_EQ(points_m[1],
            Eigen::Vector3d(0x1.b47030597737p+0, 0x1.4eaa1d0519af8p-2, 0x1.904309808bc16p+0));
  EXPECT_EQ(points_m[2],
            Eigen::Vector3d(0x1.185c9c735595cp+0, -0x1.4eaa1d0519af8p-2, 0x1.e44e1a62085bcp-3));
  EXPECT_EQ(points_m[3],
            Eigen::Vector3d(0x1.1fb120a74290ap+0, -0x1.e6357f2f356a8p-3, 0x1.9c05adf51b3d6p+0));
  EXPECT_EQ(points_m[25],
            Eigen::Vector3d(0x1.82eab8e5e8695p+0, -0x1.dff4e450ea2f2p-2, 0x1.a17d551711fccp-2));
  std::vector<TestCase> cases;
  for (std::uint64_t number = 0; number < 500; ++number) {
    cases.push_back(make_test_case("test/2", number, {}));
  }
  EXPECT_EQ(calc_content_hash(cases),
            "51e23dc098b30ce0feb553e9a3457f97cf49b8dfd623b4a4e904dbef2acbc7e4");
}

// Directions of 20 000 moves against uniformity: chi-square with its 99.9 % quantile for the
// octants (7 degrees of freedom, 24.32) and for 20 equal slices along each axis (Archimedes: equal
// area; 19, 43.82); the components' means (variance 1/3) and mean products (variance of x^2 4/45,
// of xy 1/15) within 4 standard errors. The seeds are fixed, so the test cannot fail by chance.
void expect_uniform(const std::vector<Eigen::Vector3d>& directions) {
  const auto n = static_cast<double>(directions.size());
  std::vector<int> octants(8);
  std::array<std::vector<int>, 3> slices;
  slices.fill(std::vector<int>(20));
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d product = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& d : directions) {
    ASSERT_NEAR(d.norm(), 1, 1e-12);
    ++octants[(d.x() > 0 ? 4u : 0u) + (d.y() > 0 ? 2u : 0u) + (d.z() > 0 ? 1u : 0u)];
    for (int axis = 0; axis < 3; ++axis) {
      const auto slice = static_cast<std::size_t>(std::clamp((d[axis] + 1) * 10, 0.0, 19.0));
      ++slices[static_cast<std::size_t>(axis)][slice];
    }
    mean += d / n;
    product += d * d.transpose() / n;
  }
  EXPECT_LT(calc_chi_square(octants, n / 8), 24.32);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_LT(calc_chi_square(slices[static_cast<std::size_t>(axis)], n / 20), 43.82) << axis;
    EXPECT_NEAR(mean[axis], 0, 4 * std::sqrt(1.0 / 3 / n)) << axis;
    for (int other = 0; other < 3; ++other) {
      EXPECT_NEAR(product(axis, other), axis == other ? 1.0 / 3 : 0.0,
                  4 * std::sqrt((axis == other ? 4.0 / 45 : 1.0 / 15) / n))
          << axis << " " << other;
    }
  }
}

TEST(TestCases, TheFirstMoveHasAnyDirection) {
  std::vector<Eigen::Vector3d> directions;
  const WorkspaceSphere sphere{{0, 0, 0}, 1.0, 0.5, 3};
  for (std::uint64_t number = 0; number < 20000; ++number) {
    directions.push_back(make_test_case("uniform", number, sphere).points_m[1]);
  }
  expect_uniform(directions);
}

// A move that starts deeper in the sphere than its length is never redrawn.
TEST(TestCases, ALaterMoveHasAnyDirection) {
  std::vector<Eigen::Vector3d> directions;
  for (std::uint64_t number = 0; directions.size() < 20000; ++number) {
    const auto points_m = make_test_case("test/2", number, {}).points_m;
    if ((points_m[24] - points_m[0]).norm() < 0.7499) {
      directions.push_back((points_m[25] - points_m[24]) / (points_m[25] - points_m[24]).norm());
    }
  }
  expect_uniform(directions);
}

TEST(TestCases, AnImpossibleSphereIsRefused) {
  const auto refusal = [](const WorkspaceSphere& sphere) {
    const std::string message =
        message_of(ErrorKind::usage, [&] { make_test_case("train/1", 0, sphere); });
    EXPECT_EQ(message, message_of(ErrorKind::usage, [&] { TestSet::make_generated("a", sphere); }));
    return message;
  };
  EXPECT_EQ(refusal({{1, kNan, 2}, 0.8, 0.05, 25}),
            "workspace sphere: the centre is (1, nan, 2) m; it must be finite");
  EXPECT_EQ(refusal({{1, 0, 2}, 0, 0.05, 25}),
            "workspace sphere: the radius is 0 m; it must be finite and > 0");
  EXPECT_EQ(refusal({{1, 0, 2}, kInfinity, 0.05, 25}),
            "workspace sphere: the radius is inf m; it must be finite and > 0");
  EXPECT_EQ(refusal({{1, 0, 2}, 0.8, 0.05, 2}),
            "workspace sphere: the number of points is 2; it must be from 3 to 1000");
  EXPECT_EQ(refusal({{1, 0, 2}, 0.8, 0.05, 1001}),
            "workspace sphere: the number of points is 1001; it must be from 3 to 1000");
  for (const double bad : {0.0, -0.05, 1e-9, 1.6, 2.0, kNan, kInfinity}) {
    EXPECT_THAT(
        refusal({{1, 0, 2}, 0.8, bad, 3}),
        HasSubstr("it must be from 2.8e-06 to 1.5984 m for a radius of 0.8 m and 3 points"));
  }
  EXPECT_THAT(refusal({{1, 0, 2}, 0.8, 1.6, 3}),
              HasSubstr("workspace sphere: the shortest move is 1.6 m; "));
}

// With the largest moves allowed, only a thousandth of the directions stays inside, and the
// generator finds one.
TEST(TestCases, TheLongestMovesAllowedCanBeMade) {
  const WorkspaceSphere sphere{{0, 0, 0}, 1.0, 2 * std::pow(0.999, 98) * (1 - 1e-12), 100};
  EXPECT_EQ(make_test_case("train/1", 0, sphere).points_m.size(), 101u);
}

TEST(TestSets, GivenCasesAreNamedAfterTheirContent) {
  const std::vector<TestCase> cases = {make_test_case("a", 0, {}), make_test_case("a", 1, {})};
  const TestSet set = TestSet::make_from_cases(cases);
  EXPECT_EQ(set.name(), "file:" + calc_content_hash(cases).substr(0, 16));
  EXPECT_EQ(set.size(), 2u);
  EXPECT_EQ(set.make_case(1).points_m, cases[1].points_m);
  EXPECT_EQ(message_of(ErrorKind::usage, [&] { set.make_case(2); }),
            "test set " + set.name() + " has 2 cases, counted from 0; there is no case 2");
}

TEST(TestSets, UnusableCasesAreRefused) {
  const auto refusal = [](std::vector<TestCase> cases) {
    return message_of(ErrorKind::bad_data, [&] { TestSet::make_from_cases(std::move(cases)); });
  };
  const Eigen::Vector3d a(1.4, 0.1, 0.9);
  const Eigen::Vector3d b(1.4, 0.1, 0.8);
  EXPECT_EQ(refusal({}), "test cases: there is none; a set must hold at least one");
  EXPECT_EQ(refusal({{{a, b}}, {{}}}),
            "test cases: case 1, point 0 is missing; a case must have at least 2 points: the start "
            "and where to go");
  EXPECT_EQ(refusal({{{a, b, b, a}}}),
            "test cases: case 0, point 2 is where the point before is; each point must differ from "
            "the one before it");
  EXPECT_EQ(refusal({{{a, b, {0, kNan, 0}}}}),
            "test cases: case 0, point 2 has the coordinate nan m; it must lie within +-100 m (are "
            "the coordinates in metres?)");
}

// SHA-256 over little-endian words: number of cases, then for each its number of points and their
// coordinates' bits. Expected: Python's hashlib over struct.pack('<QQ6dQ9d', 2, 2, ..., 3, ...).
TEST(TestSets, ContentHashIsDefinedByTheBits) {
  const std::vector<TestCase> cases = {{{{1.5, -0.25, 0.1}, {1.25, 0.0, 3.0}}},
                                       {{{0.3, 0.2, 0.1}, {0.3, 0.2, 0.7}, {0.3, -0.0, 0.7}}}};
  EXPECT_EQ(calc_content_hash(cases),
            "f08daa81428729d9b00574a161b8c0fc8a62bfca0eabe16be3c962b33777e6da");
  std::vector<TestCase> changed = cases;
  changed[1].points_m[2].y() = 0.0;  // another bit pattern, though equal
  EXPECT_NE(calc_content_hash(changed), calc_content_hash(cases));
  const std::vector<TestCase> regrouped = {
      {{cases[0].points_m[0], cases[0].points_m[1], cases[1].points_m[0]}},
      {{cases[1].points_m[1], cases[1].points_m[2]}}};
  EXPECT_NE(calc_content_hash(regrouped), calc_content_hash(cases));
}

}  // namespace
}  // namespace armwright
