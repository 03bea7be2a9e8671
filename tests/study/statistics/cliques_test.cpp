#include <gmock/gmock.h>

#include <algorithm>
#include <stdexcept>

#include "base/random.hpp"
#include "study/statistics/ranking.hpp"

namespace armwright {
namespace {

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;
using Sets = std::vector<std::vector<std::size_t>>;

TEST(Cliques, AreTheLargestSetsWithoutATellableOne) {
  EXPECT_EQ(find_cliques(3, Pairs{}, 9), (Sets{{0, 1, 2}}));
  EXPECT_EQ(find_cliques(3, Pairs{{2, 0}}, 9), (Sets{{0, 1}, {1, 2}}));  // not transitive
  EXPECT_EQ(find_cliques(4, Pairs{{0, 1}, {0, 2}, {0, 3}}, 9), (Sets{{1, 2, 3}}));
  EXPECT_EQ(find_cliques(2, Pairs{{0, 1}}, 9), Sets{});
  EXPECT_EQ(find_cliques(1, Pairs{}, 9), Sets{});
  EXPECT_EQ(find_cliques(0, Pairs{}, 9), Sets{});
}

// Tries all subsets one by one.
TEST(Cliques, AreThoseOfBruteForce) {
  constexpr std::size_t kCount = 9;
  RandomStream random("test/cliques");
  for (int round = 0; round < 50; ++round) {
    const double share = random.uniform();
    Pairs apart;
    for (std::size_t i = 0; i < kCount; ++i) {
      for (std::size_t j = i + 1; j < kCount; ++j) {
        if (random.uniform() < share) {
          apart.emplace_back(i, j);
        }
      }
    }
    const auto is_clique = [&](unsigned set) {
      return std::ranges::none_of(apart, [&](const auto& pair) {
        return (set >> pair.first & 1U) != 0 && (set >> pair.second & 1U) != 0;
      });
    };
    Sets expected;
    for (unsigned set = 0; set < 1U << kCount; ++set) {
      bool is_largest = is_clique(set) && std::popcount(set) > 1;
      for (std::size_t i = 0; i < kCount && is_largest; ++i) {
        const unsigned larger = set | 1U << i;
        is_largest = larger == set || !is_clique(larger);
      }
      if (is_largest) {
        auto& members = expected.emplace_back();
        for (std::size_t i = 0; i < kCount; ++i) {
          if ((set >> i & 1U) != 0) {
            members.push_back(i);
          }
        }
      }
    }
    std::ranges::sort(expected);
    EXPECT_EQ(find_cliques(kCount, apart, 1000), expected);
  }
}

TEST(Cliques, OfTooManyThereIsNothing) {
  Pairs apart;  // one of each pair may be in a set: 2^12 sets
  for (std::size_t i = 0; i < 12; ++i) {
    apart.emplace_back(2 * i, 2 * i + 1);
  }
  EXPECT_EQ(find_cliques(24, apart, 4095), std::nullopt);
  EXPECT_EQ(find_cliques(24, apart, 4096)->size(), 4096u);
}

TEST(Cliques, RefuseAPairThatIsNone) {
  EXPECT_THROW(find_cliques(3, Pairs{{1, 1}}, 9), std::invalid_argument);
  EXPECT_THROW(find_cliques(3, Pairs{{1, 3}}, 9), std::invalid_argument);
}

}  // namespace
}  // namespace armwright
