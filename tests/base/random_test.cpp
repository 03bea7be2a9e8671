// Every test uses a fixed stream, so its result never changes. The comments at the statistical
// bounds state how rarely a good generator would miss them with a random stream.
#include "base/random.hpp"

#include <Random123/philox.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

namespace armwright {
namespace {

std::vector<std::uint64_t> take(RandomStream stream, std::size_t count) {
  std::vector<std::uint64_t> numbers(count);
  std::generate(numbers.begin(), numbers.end(), [&] { return stream.next_u64(); });
  return numbers;
}

// Random123 1.14, tests/kat_vectors, the lines "philox4x64 10".
TEST(Random, TheGeneratorGivesItsAuthorsKnownAnswers) {
  using Words = std::array<std::uint64_t, 4>;
  const auto run = [](Words counter, std::array<std::uint64_t, 2> key) {
    const auto block =
        r123::Philox4x64{}({{counter[0], counter[1], counter[2], counter[3]}}, {{key[0], key[1]}});
    return Words{block[0], block[1], block[2], block[3]};
  };
  constexpr std::uint64_t kOnes = ~std::uint64_t{0};
  EXPECT_EQ(run({}, {}), (Words{0x16554d9eca36314c, 0xdb20fe9d672d0fdc, 0xd7e772cee186176b,
                                0x7e68b68aec7ba23b}));
  EXPECT_EQ(
      run({kOnes, kOnes, kOnes, kOnes}, {kOnes, kOnes}),
      (Words{0x87b092c3013fe90b, 0x438c3c67be8d0224, 0x9cc7d7c69cd777b6, 0xa09caebf594f0ba0}));
  EXPECT_EQ(
      run({0x243f6a8885a308d3, 0x13198a2e03707344, 0xa4093822299f31d0, 0x082efa98ec4e6c89},
          {0x452821e638d01377, 0xbe5466cf34e90c6c}),
      (Words{0xa528f45403e61d95, 0x38c72dbd566e9788, 0xa5a1610e72fd18b5, 0x57bd43b5e52b7fe6}));
}

// From an independent implementation of Philox4x64-10 (Python integers; it gives the known answers
// above): key = the first 16 bytes of SHA-256(name), little-endian; counter = (block, 0, index, 0).
// If these values change, old runs cannot be repeated.
TEST(Random, AStreamNeverChanges) {
  EXPECT_EQ(
      take(RandomStream("train/1"), 6),
      (std::vector<std::uint64_t>{0x997fa9840283bcc8, 0x9b566b020b1bb2d2, 0x81551699f999bf77,
                                  0x84291fd13ab603b8, 0x697b4240bad3dfe7, 0x02e444da8123568f}));
  EXPECT_EQ(
      take(RandomStream("train/1", 7), 6),
      (std::vector<std::uint64_t>{0xdedcdec1d97f7d46, 0xad107a099d7d0179, 0xd89701e7951be2b1,
                                  0x2f8f89c6b2c29eab, 0x275a244cca61a4ab, 0x6c49315af10f1a9e}));
  EXPECT_EQ(take(RandomStream("optimizer/ga/seed=1"), 2),
            (std::vector<std::uint64_t>{0xbc7f73a03e941619, 0xc872a6e899980e34}));
}

TEST(Random, StreamsDependOnNameAndIndexAndNothingElse) {
  RandomStream disturbed("train/1");
  RandomStream other("train/2");
  std::vector<std::uint64_t> numbers;
  for (int i = 0; i < 100; ++i) {
    numbers.push_back(disturbed.next_u64());
    other.next_u64();  // use of one stream must not move another
  }
  EXPECT_EQ(take(RandomStream("train/1"), 100), numbers);
  EXPECT_NE(take(RandomStream("train/2"), 100), numbers);
  EXPECT_NE(take(RandomStream("train/1", 1), 100), numbers);
}

TEST(Random, SubstreamsDoNotOverlap) {
  std::set<std::uint64_t> seen;
  for (std::uint64_t index = 0; index < 100; ++index) {
    for (const std::uint64_t number : take(RandomStream("train/1", index), 100)) {
      EXPECT_TRUE(seen.insert(number).second);  // by chance: 1e8 / 2^65, less than 3e-12
    }
  }
}

TEST(Random, UniformStaysInItsHalfOpenInterval) {
  RandomStream stream("test/uniform");
  double sum = 0;
  constexpr int kCount = 100000;
  for (int i = 0; i < kCount; ++i) {
    const double number = stream.uniform();
    ASSERT_GE(number, 0);
    ASSERT_LT(number, 1);
    sum += number;
  }
  // The mean has a standard deviation of sqrt(1/12 / n). The bound is five of them: one stream in
  // 1.7 million would miss it.
  EXPECT_NEAR(sum / kCount, 0.5, 5 * std::sqrt(1.0 / 12 / kCount));
}

TEST(Random, UniformNeverRoundsUpToItsUpperEnd) {
  RandomStream stream("test/rounding");
  const double upper = std::nextafter(1.0, 2.0);  // only 1 itself lies in [1, upper)
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(stream.uniform(1.0, upper), 1.0);
  }
  EXPECT_EQ(stream.uniform(3.0, 3.0), 3.0);
}

TEST(Random, BelowIsUnbiased) {
  // For n = 3 * 2^62 a plain remainder has its largest error: the lowest third would be drawn twice
  // as often.
  constexpr std::uint64_t kN = std::uint64_t{3} << 62;
  constexpr int kCount = 30000;
  std::array<int, 3> thirds{};
  RandomStream stream("test/below");
  for (int i = 0; i < kCount; ++i) {
    const std::uint64_t number = stream.below(kN);
    ASSERT_LT(number, kN);
    ++thirds[number >> 62];
  }
  double chi_square = 0;
  for (const int count : thirds) {
    chi_square += (count - kCount / 3.0) * (count - kCount / 3.0) / (kCount / 3.0);
  }
  EXPECT_LT(chi_square, 27.6);  // two degrees of freedom: P = exp(-27.6 / 2), one in a million
}

TEST(Random, BelowReachesEveryNumberEquallyOften) {
  constexpr std::uint64_t kN = 7;
  constexpr int kCount = 70000;
  std::array<int, kN> counts{};
  RandomStream stream("test/seven");
  for (int i = 0; i < kCount; ++i) {
    ++counts.at(stream.below(kN));
  }
  double chi_square = 0;
  for (const int count : counts) {
    chi_square += (count - 1e4) * (count - 1e4) / 1e4;
  }
  EXPECT_LT(chi_square, 38.3);  // six degrees of freedom: the point one in a million exceeds
  EXPECT_EQ(RandomStream("test/one").below(1), 0U);
}

TEST(Random, BernoulliFollowsItsProbability) {
  RandomStream stream("test/bernoulli");
  constexpr int kCount = 100000;
  int hits = 0;
  for (int i = 0; i < kCount; ++i) {
    hits += stream.bernoulli(0.3) ? 1 : 0;
    ASSERT_FALSE(stream.bernoulli(0));
    ASSERT_TRUE(stream.bernoulli(1));
  }
  EXPECT_NEAR(hits, 0.3 * kCount, 5 * std::sqrt(kCount * 0.3 * 0.7));  // five standard deviations
}

TEST(Random, NormalHasTheMomentsOfTheStandardNormal) {
  RandomStream stream("test/normal");
  constexpr int kCount = 200000;
  std::array<double, 5> moments{};
  int beyond_two = 0;
  for (int i = 0; i < kCount; ++i) {
    const double number = stream.normal();
    beyond_two += std::abs(number) > 2 ? 1 : 0;
    for (std::size_t power = 1; power < moments.size(); ++power) {
      moments[power] += std::pow(number, static_cast<double>(power)) / kCount;
    }
  }
  // Var(X^k) = E X^2k - (E X^k)^2 is 1, 2, 15, 96 for k = 1..4; the bounds are five standard
  // deviations of the mean.
  EXPECT_NEAR(moments[1], 0, 5 * std::sqrt(1.0 / kCount));
  EXPECT_NEAR(moments[2], 1, 5 * std::sqrt(2.0 / kCount));
  EXPECT_NEAR(moments[3], 0, 5 * std::sqrt(15.0 / kCount));
  EXPECT_NEAR(moments[4], 3, 5 * std::sqrt(96.0 / kCount));
  const double tail = std::erfc(2 / std::sqrt(2.0));
  EXPECT_NEAR(beyond_two, tail * kCount, 5 * std::sqrt(kCount * tail * (1 - tail)));
}

}  // namespace
}  // namespace armwright
