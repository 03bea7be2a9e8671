#include "study/survey/index_set.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "base/random.hpp"

namespace armwright {
namespace {

TEST(IndexSet, KnowsWhatIsMissingWhateverTheOrder) {
  RandomStream random("test/index-set", 1);
  for (int round = 0; round < 50; ++round) {
    IndexSet set;
    std::set<std::uint64_t> plain;
    for (int i = 0; i < 60; ++i) {
      const auto index = static_cast<std::uint64_t>(random.uniform(0, 40));
      EXPECT_EQ(set.insert(index), plain.insert(index).second);
    }
    EXPECT_EQ(set.size(), plain.size());
    EXPECT_EQ(set.end(), *plain.rbegin() + 1);
    std::set<std::uint64_t> missing;
    for (const IndexRange& range : set.list_missing(45)) {
      for (std::uint64_t i = range.first; i <= range.last; ++i) {
        EXPECT_TRUE(missing.insert(i).second);
      }
    }
    for (std::uint64_t i = 0; i < 45; ++i) {
      EXPECT_EQ(set.has(i), plain.contains(i)) << i;
      EXPECT_EQ(missing.contains(i), !plain.contains(i)) << i;
    }
    EXPECT_EQ(count(set.list_missing(45)), missing.size());
  }
}

TEST(IndexSet, OfNoneEverythingIsMissing) {
  const IndexSet set;
  EXPECT_EQ(set.end(), 0u);
  EXPECT_TRUE(set.list_missing(0).empty());
  EXPECT_EQ(describe(set.list_missing(3)), "0 to 2");
}

TEST(IndexSet, NamesAFewPlaces) {
  EXPECT_EQ(describe({{3, 3}, {7, 9}}), "3, 7 to 9");
  EXPECT_EQ(describe({{0, 0}, {2, 2}, {4, 4}}, 2), "0, 2 and 1 more place");
  EXPECT_EQ(describe({{0, 0}, {2, 2}, {4, 4}, {6, 6}}, 2), "0, 2 and 2 more places");
}

}  // namespace
}  // namespace armwright
