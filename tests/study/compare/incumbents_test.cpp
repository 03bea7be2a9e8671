#include "study/compare/incumbents.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace armwright {
namespace {

std::vector<Incumbent> make_incumbents(std::int64_t count) {
  std::vector<Incumbent> incumbents;
  for (std::int64_t i = 1; i <= count; ++i) {
    incumbents.push_back({.cases = 5 * i, .evaluation = static_cast<std::uint64_t>(i - 1)});
  }
  return incumbents;
}

std::vector<std::int64_t> list_cases(const std::vector<Incumbent>& incumbents) {
  std::vector<std::int64_t> cases;
  for (const Incumbent& one : incumbents) {
    cases.push_back(one.cases);
  }
  return cases;
}

TEST(ThinIncumbents, KeepsAllUpToTheLimit) {
  const auto all = make_incumbents(100);
  EXPECT_EQ(list_cases(thin_incumbents(all, 100, {})), list_cases(all));
  EXPECT_TRUE(thin_incumbents({}, 100, {}).empty());
}

TEST(ThinIncumbents, KeepsThoseInForceAtEvenLogarithms) {
  const auto all = make_incumbents(10'000);
  const auto thinned = list_cases(thin_incumbents(all, 100, {}));
  EXPECT_LE(thinned.size(), 100u);
  EXPECT_EQ(thinned.front(), 5);
  EXPECT_EQ(thinned.back(), 50'000);
  const double step = std::pow(10'000, 1 / 99.0);
  for (std::size_t i = 1; i < thinned.size(); ++i) {
    // One step further lies the next one, up to the distance of two incumbents.
    EXPECT_LE(static_cast<double>(thinned[i]), static_cast<double>(thinned[i - 1] + 5) * step + 5);
  }
}

TEST(ThinIncumbents, KeepsThoseOfTheCheckpoints) {
  const auto thinned = list_cases(
      thin_incumbents(make_incumbents(10'000), 3, std::vector<std::int64_t>{3, 1234, 9999}));
  EXPECT_THAT(thinned, testing::ElementsAre(5, 500, 1230, 9995, 50'000));
}

}  // namespace
}  // namespace armwright
