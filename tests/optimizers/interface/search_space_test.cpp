#include "optimizers/interface/search_space.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

namespace armwright {
namespace {

using testing::ElementsAre;

const std::vector<DecisionVariable> kSpace = {
    {"linear", "", -3, 5, 0.1, Scale::linear},
    {"gain", "", 0.3, 7000, 11, Scale::logarithmic},
    {"negative", "", -2.1e6, -190, -2e4, Scale::logarithmic},
};

TEST(SearchSpace, CoordinatesAreTheValueOrTheLogarithmOfItsMagnitude) {
  const SearchSpace space(kSpace);
  EXPECT_EQ(space.dimension(), 3u);
  EXPECT_THAT(space.lower(), ElementsAre(-3, std::log(0.3), std::log(190)));
  EXPECT_THAT(space.upper(), ElementsAre(5, std::log(7000), std::log(2.1e6)));
  EXPECT_THAT(space.start(), ElementsAre(0.1, std::log(11), std::log(2e4)));
  EXPECT_THAT(space.to_coordinates(std::vector<double>{4, 2, -1e5}),
              ElementsAre(4, std::log(2.0), std::log(1e5)));
}

// exp(log(x)) is not x: these come out to the bit all the same.
TEST(SearchSpace, StartAndBoundsComeBackExactly) {
  const SearchSpace space(kSpace);
  EXPECT_THAT(space.to_point(space.start()), ElementsAre(0.1, 11, -2e4));
  const std::vector<double> lower = space.to_point(space.lower());
  const std::vector<double> upper = space.to_point(space.upper());
  for (std::size_t i = 0; i < kSpace.size(); ++i) {
    for (const std::vector<double>& x : {lower, upper}) {
      EXPECT_GE(x[i], kSpace[i].lower);
      EXPECT_LE(x[i], kSpace[i].upper);
    }
  }
  EXPECT_NEAR(upper[2] / -2.1e6, 1, 1e-14);  // the larger magnitude
}

TEST(SearchSpace, ThereAndBackIsTheSamePoint) {
  const SearchSpace space(kSpace);
  const std::vector<double> x = {-2.7, 0.47, -333};
  const std::vector<double> back = space.to_point(space.to_coordinates(x));
  EXPECT_EQ(back[0], x[0]);
  EXPECT_NEAR(back[1] / x[1], 1, 1e-14);
  EXPECT_NEAR(back[2] / x[2], 1, 1e-14);
}

TEST(SearchSpace, WhatLiesOutsideComesOutOutside) {
  const SearchSpace space(kSpace);
  const std::vector<double> above =
      space.to_point(std::vector<double>{5.5, std::log(7001.0), std::log(2.2e6)});
  EXPECT_EQ(above[0], 5.5);
  EXPECT_GT(above[1], 7000);
  EXPECT_LT(above[2], -2.1e6);
  const std::vector<double> below =
      space.to_point(std::vector<double>{-4, std::log(0.29), std::log(189.0)});
  EXPECT_EQ(below[0], -4);
  EXPECT_LT(below[1], 0.3);
  EXPECT_GT(below[2], -190);
}

TEST(SearchSpace, ANumberThatIsNoneStaysOne) {
  const SearchSpace space(kSpace);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double value : space.to_point(std::vector<double>(3, nan))) {
    EXPECT_TRUE(std::isnan(value));
  }
}

TEST(SearchSpace, AStartOutsideTheBoundsBecomesTheNearestInside) {
  const SearchSpace space(std::vector<DecisionVariable>{{"x", "", 0, 1, 2, Scale::linear}});
  EXPECT_THAT(space.start(), ElementsAre(1));
}

TEST(SearchSpace, DrawsOneNumberACoordinateBetweenTheGivenOnes) {
  const SearchSpace space(kSpace);
  RandomStream random("test/draw");
  RandomStream same("test/draw");
  const std::vector<double> lower = {-1, 0.5, 6};
  const std::vector<double> upper = {2, 1, 7};
  for (int k = 0; k < 100; ++k) {
    const std::vector<double> drawn = space.draw_between(lower, upper, random);
    ASSERT_EQ(drawn.size(), 3u);
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      EXPECT_EQ(drawn[i], same.uniform(lower[i], upper[i]));
      EXPECT_GE(drawn[i], lower[i]);
      EXPECT_LE(drawn[i], upper[i]);
    }
  }
}

TEST(SearchSpace, WhatIsDrawnLiesInTheBox) {
  const SearchSpace space(kSpace);
  RandomStream random("test/draw");
  const std::vector<double> lower = {-9, -9, 0};  // far beyond the bounds
  const std::vector<double> upper = {-8, 20, 40};
  for (int k = 0; k < 100; ++k) {
    const std::vector<double> drawn = space.draw_between(lower, upper, random);
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      EXPECT_GE(drawn[i], space.lower()[i]);
      EXPECT_LE(drawn[i], space.upper()[i]);
    }
  }
}

}  // namespace
}  // namespace armwright
