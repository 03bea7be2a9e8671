// Cases of a set "coevolved/ID": they depend only on set and genome, one key per quarter of the
// case.

#include <gtest/gtest.h>

#include "sim/tracking/test_case.hpp"

namespace armwright {
namespace {

constexpr std::uint64_t kGenome = 0x0123456789ABCDE;

TEST(BredCase, AGenomeIsFourKeys) {
  std::uint64_t copy = 0;
  for (int place = 0; place < kGenomeKeys; ++place) {
    EXPECT_LT(get_key(kGenome, place), kGenomeKeyValues);
    copy = set_key(copy, place, get_key(kGenome, place));
  }
  EXPECT_EQ(copy, kGenome);
  EXPECT_EQ(set_key(kGenome, 2, get_key(kGenome, 2)), kGenome);
  EXPECT_EQ(get_key(set_key(kGenome, 3, 7), 3), 7u);
}

TEST(BredCase, ItKeepsTheRulesOfGeneratedCases) {
  const WorkspaceSphere sphere;
  const TestCase made = make_test_case("coevolved/1", kGenome, sphere);
  ASSERT_EQ(made.points_m.size(), 26u);
  EXPECT_EQ(made.points_m[0], sphere.centre_m);
  for (int k = 1; k <= sphere.points; ++k) {
    const auto at = static_cast<std::size_t>(k);
    // Rounding of coordinates of about 2 m.
    EXPECT_NEAR((made.points_m[at] - made.points_m[at - 1]).norm(), sphere.calc_move_m(k), 1e-14);
    EXPECT_LE((made.points_m[at] - sphere.centre_m).norm(), sphere.radius_m * (1 + 1e-15));
  }
  EXPECT_EQ(make_test_case("coevolved/1", kGenome, sphere).points_m, made.points_m);
  EXPECT_NE(make_test_case("coevolved/2", kGenome, sphere).points_m, made.points_m);
}

TEST(BredCase, AKeyDecidesOnItsQuarter) {
  const WorkspaceSphere sphere{.points = 24};
  const TestCase made = make_test_case("coevolved/1", kGenome, sphere);
  for (int place = 0; place < kGenomeKeys; ++place) {
    const std::uint64_t key = get_key(kGenome, place) ^ 1;
    const TestCase other = make_test_case("coevolved/1", set_key(kGenome, place, key), sphere);
    for (int k = 1; k <= 6 * place; ++k) {  // points before the quarter stay
      const auto at = static_cast<std::size_t>(k);
      EXPECT_EQ(other.points_m[at], made.points_m[at]) << place << " " << k;
    }
    const auto first = static_cast<std::size_t>(6 * place + 1);
    EXPECT_NE(other.points_m[first], made.points_m[first]) << place;
  }
  // After the quarter the directions stay, except those that would lead outside.
  const TestCase other = make_test_case("coevolved/1", set_key(kGenome, 0, 5), sphere);
  int same = 0;
  for (std::size_t at = 13; at <= 24; ++at) {
    const Eigen::Vector3d move_m = made.points_m[at] - made.points_m[at - 1];
    const Eigen::Vector3d its_m = other.points_m[at] - other.points_m[at - 1];
    same += (move_m - its_m).norm() < 1e-14 ? 1 : 0;
  }
  EXPECT_GE(same, 6) << "of 12";
}

}  // namespace
}  // namespace armwright
