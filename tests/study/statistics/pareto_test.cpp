#include "study/statistics/pareto.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "base/random.hpp"
#include "study/statistics/support.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using Points = std::vector<std::vector<double>>;

TEST(NonDominated, KeepsWhatNothingIsBetterThan) {
  const Points points = {{1, 6}, {6, 1}, {7, 7}, {1, 6}, {1, 7}, {kInf, 0}, {kInf, 3}};
  EXPECT_THAT(find_non_dominated(points), ElementsAre(0, 1, 3, 5));
  EXPECT_THAT(find_non_dominated(Points{{kInf, kInf}, {kInf, kInf}}), ElementsAre(0, 1));
  EXPECT_THAT(find_non_dominated(Points{{3}, {1}, {2}}), ElementsAre(1));
  EXPECT_THAT(find_non_dominated(Points{{1, 2, 3}, {3, 1, 2}, {3, 2, 3}}), ElementsAre(0, 1));
  EXPECT_THAT(find_non_dominated({}), IsEmpty());
}

TEST(Hypervolume, IsTheAreaUnderTheReferencePoint) {
  constexpr std::array kReference = {11.0, 11.0};
  EXPECT_EQ(calc_hypervolume(Points{{1, 1}}, kReference), 100);
  EXPECT_EQ(calc_hypervolume(Points{{1, 6}, {6, 1}, {7, 7}, {20, 0}}, kReference), 75);
  EXPECT_EQ(calc_hypervolume(Points{{11, 0}, {kInf, 0}, {0, 12}}, kReference), 0);
  EXPECT_EQ(calc_hypervolume({}, kReference), 0);
}

TEST(Hypervolume, IsTheVolumeOfUnitedBoxes) {
  constexpr std::array kReference = {4.0, 4.0, 4.0};
  EXPECT_EQ(calc_hypervolume(Points{{1, 2, 3}}, kReference), 6);
  // Boxes of 3 x 1 x 1 along each axis, the cube of 1 common to all.
  EXPECT_EQ(calc_hypervolume(Points{{1, 3, 3}, {3, 1, 3}, {3, 3, 1}}, kReference), 7);
  EXPECT_EQ(calc_hypervolume(Points{{1, 2, 3}}, std::array{2.0, 4.0, 8.0}), 10);
  EXPECT_EQ(calc_hypervolume(Points{{3, 5}, {1, 9}}, std::array{4.0, 8.0}), 3);
  EXPECT_EQ(calc_hypervolume(Points{{3}, {-1}, {7}}, std::array{4.0}), 5);
}

TEST(IgdPlus, CountsOnlyWhatIsWorseThanTheReference) {
  constexpr std::array kUnit = {1.0, 1.0};
  const Points front = {{0, 4}, {2, 2}, {4, 0}};
  EXPECT_EQ(calc_igd_plus(front, front, kUnit), 0);
  EXPECT_EQ(calc_igd_plus(Points{{-1, -1}}, front, kUnit), 0);
  // From (3, 3): 3 to the first and the last, sqrt(2) to the middle.
  EXPECT_NEAR(calc_igd_plus(Points{{3, 3}}, front, kUnit), (3 + std::sqrt(2) + 3) / 3, 1e-15);
  // (1, 9) is as good as (2, 2) in the first objective, and 7 worse in the second.
  EXPECT_NEAR(calc_igd_plus(Points{{3, 3}, {1, 9}}, Points{{2, 2}}, kUnit), std::sqrt(2), 1e-15);
  EXPECT_NEAR(calc_igd_plus(Points{{1, 9}}, Points{{2, 2}}, kUnit), 7, 1e-15);
  // In units of the extent, and in three objectives.
  EXPECT_NEAR(calc_igd_plus(Points{{1, 9}}, Points{{2, 2}}, std::array{1.0, 14.0}), 0.5, 1e-15);
  EXPECT_NEAR(calc_igd_plus(Points{{1, 2, 3}}, Points{{0, 0, 5}}, std::array{1.0, 1.0, 1.0}),
              std::sqrt(5), 1e-15);
  EXPECT_EQ(calc_igd_plus({}, front, kUnit), kInf);
  EXPECT_EQ(calc_igd_plus(Points{{kInf, 0}}, front, kUnit), kInf);
  EXPECT_THROW(calc_igd_plus(front, {}, kUnit), std::invalid_argument);
  EXPECT_THROW(calc_igd_plus(front, front, std::array{1.0}), std::invalid_argument);
  EXPECT_THROW(calc_igd_plus(front, front, std::array{1.0, 0.0}), std::invalid_argument);
}

// A set whose points another one dominates is never nearer to the reference.
TEST(IgdPlus, NeverPrefersADominatedSet) {
  RandomStream random("igd-plus");
  constexpr std::array kExtent = {1.0, 2.0, 0.5};
  const auto draw = [&](std::size_t count) {
    Points points(count, std::vector<double>(3));
    for (std::vector<double>& point : points) {
      std::ranges::generate(point, [&] { return random.uniform(); });
    }
    return points;
  };
  for (int round = 0; round < 50; ++round) {
    const Points reference = draw(7), better = draw(5);
    Points worse = better;
    for (std::vector<double>& point : worse) {
      point[random.below(3)] += random.uniform();
    }
    EXPECT_GE(calc_igd_plus(worse, reference, kExtent), calc_igd_plus(better, reference, kExtent));
  }
}

TEST(Hypervolume, DependsOnNoOrderOfPointsOrObjectives) {
  RandomStream random("hypervolume-order");
  Points points(12, std::vector<double>(4));
  for (std::vector<double>& point : points) {
    std::ranges::generate(point, [&] { return static_cast<double>(random.below(8)); });
  }
  constexpr std::array kReference = {7.0, 7.0, 7.0, 7.0};
  const double volume = calc_hypervolume(points, kReference);  // of whole numbers: exact
  EXPECT_GT(volume, 0);
  for (int turn = 0; turn < 4; ++turn) {
    std::ranges::rotate(points, points.begin() + 5);
    for (std::vector<double>& point : points) {
      std::ranges::rotate(point, point.begin() + 1);
    }
    EXPECT_EQ(calc_hypervolume(points, kReference), volume);
  }
}

TEST(Attainment, IsWhatSoManyRunsReach) {
  const std::vector<Points> fronts = {{{1, 3}, {2, 1}}, {{0, 4}, {3, 2}}, {{2, 2}, {9, 9}}};
  EXPECT_THAT(calc_attainment_surface(fronts, 0.1),
              ElementsAre(ElementsAre(0, 4), ElementsAre(1, 3), ElementsAre(2, 1)));
  EXPECT_THAT(calc_attainment_surface(fronts, 0.5),
              ElementsAre(ElementsAre(1, 4), ElementsAre(2, 2)));
  EXPECT_THAT(calc_attainment_surface(fronts, 1),
              ElementsAre(ElementsAre(2, 4), ElementsAre(3, 2)));
}

TEST(Attainment, NeedsTheShareOfRunsAndNotOneMore) {
  // 7 of 100 runs are the share 0.07, though 0.07 x 100 rounds to more than 7.
  std::vector<Points> fronts(100);
  for (int i = 0; i < 7; ++i) {
    fronts[i] = {{1, 1}};
  }
  EXPECT_THAT(calc_attainment_surface(fronts, 0.07), ElementsAre(ElementsAre(1, 1)));
  EXPECT_THAT(calc_attainment_surface(fronts, 0.071), IsEmpty());
}

TEST(Attainment, OfRunsWithoutPointsCountsThem) {
  const std::vector<Points> fronts = {{{1, 1}}, {}, {{kInf, 0}, {0, kInf}}};
  EXPECT_THAT(calc_attainment_surface(fronts, 0.3), ElementsAre(ElementsAre(1, 1)));
  EXPECT_THAT(calc_attainment_surface(fronts, 0.4), IsEmpty());
  EXPECT_THAT(calc_attainment_surface({}, 0.5), IsEmpty());
}

TEST(Pareto, RefusesWhatIsNoFront) {
  constexpr std::array kReference = {1.0, 1.0};
  EXPECT_THAT([] { find_non_dominated(Points{{1, 2}, {1}}); }, refuses("one row has 2"));
  EXPECT_THAT([] { find_non_dominated(Points{{1, kNan}}); }, refuses("nan"));
  EXPECT_THAT([&] { calc_hypervolume(Points{{1}}, kReference); }, refuses("another dimension"));
  EXPECT_THAT([] { calc_hypervolume({}, std::array{kInf}); }, refuses("must be finite"));
  EXPECT_THAT([] { calc_hypervolume({}, {}); }, refuses("must be finite"));
  EXPECT_THAT([] { calc_attainment_surface({}, 0); }, refuses("level"));
  EXPECT_THAT(
      [] {
        calc_attainment_surface(std::vector<Points>{{{1, 2, 3}}}, 0.5);
      },
      refuses("two objectives"));
  EXPECT_THAT(
      [] {
        calc_attainment_surface(std::vector<Points>{{{1, kNan}}}, 0.5);
      },
      refuses("nan"));
}

}  // namespace
}  // namespace armwright
