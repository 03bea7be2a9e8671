// The operators of the genetic algorithm: what they compute, and the distributions of what they
// draw. Seeds are fixed; the bounds are what a correct implementation exceeds once in a thousand
// seeds, or 4 standard deviations for a share.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "optimizers/builtin/ga.hpp"
#include "optimizers/kolmogorov_smirnov.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;

// Four standard deviations of a binomial share: a correct implementation is outside with
// probability 6e-5.
double calc_share_bound(double probability, int trials) {
  return 4 * std::sqrt(probability * (1 - probability) / trials);
}

std::vector<Fitness> make_population(std::span<const double> objectives) {
  std::vector<Fitness> population;
  for (const double objective : objectives) {
    population.push_back({0, objective});
  }
  return population;
}

DecisionVariable logarithmic(double lower, double start, double upper) {
  return {"v", "", lower, upper, start, Scale::logarithmic};
}

DecisionVariable linear(double lower, double upper) {
  return {"v", "", lower, upper, lower, Scale::linear};
}

DecisionVariable whole(double lower, double upper, Scale scale = Scale::linear) {
  return {"v", "", lower, upper, lower, scale, VariableType::integer};
}

DecisionVariable words(std::vector<std::string> choices) {
  const double last = static_cast<double>(choices.size()) - 1;
  return {"v", "", 0, last, 0, Scale::linear, VariableType::category, std::move(choices)};
}

Genome cross_real(const Genome& first, const Genome& second, const CrossoverSettings& settings,
                  RandomStream& random) {
  return cross(first, second, std::vector<DecisionVariable>(first.size()), settings, random);
}

TEST(GaFitness, RankingKeepsTheOrderOfEquals) {
  const std::vector<double> objectives = {3, 1, 2, 1, 0};
  EXPECT_THAT(rank(make_population(objectives)), ElementsAre(4, 1, 3, 2, 0));
}

TEST(GaSelection, EveryRankWinsAsOftenAsItShould) {
  // Two distinct individuals of N, the fitter wins with probability p. The one of rank r (1: the
  // fittest) is drawn with probability 2/N; its rival is worse with probability (N-r)/(N-1). So it
  // wins with probability 2/N (p (N-r) + (1-p) (r-1))/(N-1).
  constexpr int kSize = 35;
  constexpr double kProbability = 0.7;
  constexpr int kDraws = 350000;
  std::vector<double> objectives;
  for (int i = 0; i < kSize; ++i) {
    objectives.push_back((i * 13) % kSize);  // a permutation: the value is rank - 1
  }
  const std::vector<Fitness> population = make_population(objectives);
  RandomStream random("test/ga/selection");
  std::vector<int> wins(kSize);
  for (int draw = 0; draw < kDraws; ++draw) {
    ++wins[static_cast<std::size_t>(objectives[select(population, kProbability, random)])];
  }
  double chi_square = 0;
  double total = 0;
  for (int rank = 1; rank <= kSize; ++rank) {
    const double share = 2.0 / kSize *
                         (kProbability * (kSize - rank) + (1 - kProbability) * (rank - 1)) /
                         (kSize - 1);
    const double expected = kDraws * share;
    total += expected;
    chi_square += std::pow(wins[rank - 1] - expected, 2) / expected;
  }
  EXPECT_NEAR(total, kDraws, 1e-6);  // the closed form is a distribution
  constexpr double kBound = 65.25;   // 99.9 % quantile of chi-square with 34 degrees of freedom
  EXPECT_LT(chi_square, kBound);
}

TEST(GaSelection, TheTwoAreDistinct) {
  // With certainty that the fitter wins, the least fit could win only against itself; and of two,
  // the fitter wins always.
  const std::vector<double> objectives = {2, 5, 1};
  const std::vector<Fitness> three = make_population(objectives);
  const std::vector<Fitness> two = make_population(std::span(objectives).first(2));
  RandomStream random("test/ga/distinct");
  for (int draw = 0; draw < 1000; ++draw) {
    EXPECT_NE(select(three, 1, random), 1u);
    EXPECT_NE(select(three, 0, random), 2u);
    EXPECT_EQ(select(two, 1, random), 0u);
    EXPECT_EQ(select(two, 0, random), 1u);
  }
}

TEST(GaSelection, EqualsAreChosenAlikeOften) {
  const std::vector<double> objectives = {1, 1, 1, 1};
  const std::vector<Fitness> population = make_population(objectives);
  RandomStream random("test/ga/equals");
  constexpr int kDraws = 40000;
  std::vector<int> wins(4);
  for (int draw = 0; draw < kDraws; ++draw) {
    ++wins[select(population, 0.7, random)];
  }
  for (const int count : wins) {
    EXPECT_NEAR(count / double{kDraws}, 0.25, calc_share_bound(0.25, kDraws));
  }
}

TEST(GaCrossover, HandComputedGene) {
  EXPECT_EQ(calc_crossed_gene(4, 2, 0), 3);
  EXPECT_EQ(calc_crossed_gene(4, 2, 0.25), 3.5);
  EXPECT_EQ(calc_crossed_gene(2, 4, 0.25), 2.5);
  EXPECT_EQ(calc_crossed_gene(-200, -100, 0.125), -162.5);
  EXPECT_EQ(calc_crossed_gene(7, 7, 0.2), 7);
}

TEST(GaCrossover, HandComputedChild) {
  // The numbers that the child is made of, drawn in the documented order from the same stream.
  const Genome a = {4, 10, -8};
  const Genome b = {2, 30, -4};
  for (std::uint64_t index = 0; index < 20; ++index) {
    RandomStream numbers("test/ga/child", index);
    const bool a_is_base = numbers.uniform() < 0.5;
    const Genome& base = a_is_base ? a : b;
    const Genome& other = a_is_base ? b : a;
    Genome expected = base;
    for (std::size_t i = 0; i < 3; ++i) {
      if (numbers.uniform() < 0.75) {
        const double sigma = 0.25 * numbers.uniform();
        expected[i] = 0.5 * (base[i] + other[i]) + sigma * (base[i] - other[i]);
      }
    }
    RandomStream random("test/ga/child", index);
    EXPECT_EQ(cross_real(a, b, {.probability = 0.75, .extent = 0.25}, random), expected);
  }
}

TEST(GaCrossover, SharesAndSigmaAreAsDeclared) {
  constexpr int kGenes = 20;
  constexpr int kChildren = 2000;
  Genome a;
  Genome b;
  for (int i = 0; i < kGenes; ++i) {
    a.push_back(10 + i);
    b.push_back(-3 * i - 1);
  }
  RandomStream random("test/ga/crossover");
  int a_was_base = 0;
  std::vector<double> shares;  // sigma as a share of the extent
  for (int child_number = 0; child_number < kChildren; ++child_number) {
    const Genome child = cross_real(a, b, {.probability = 0.75, .extent = 0.25}, random);
    // Crossed or not, with sigma in [0, 0.25) every gene lies nearer to the base's.
    const bool a_is_base = std::abs(child[0] - a[0]) < std::abs(child[0] - b[0]);
    a_was_base += a_is_base ? 1 : 0;
    const Genome& base = a_is_base ? a : b;
    const Genome& other = a_is_base ? b : a;
    for (int i = 0; i < kGenes; ++i) {
      if (child[i] == base[i]) {
        continue;
      }
      const double sigma = (child[i] - 0.5 * (base[i] + other[i])) / (base[i] - other[i]);
      ASSERT_GE(sigma, -1e-15);  // rounding of a quotient near 0
      ASSERT_LT(sigma, 0.25 + 1e-15);
      shares.push_back(sigma / 0.25);
    }
  }
  EXPECT_NEAR(a_was_base / double{kChildren}, 0.5, calc_share_bound(0.5, kChildren));
  constexpr int kTrials = kGenes * kChildren;
  EXPECT_NEAR(static_cast<double>(shares.size()) / kTrials, 0.75, calc_share_bound(0.75, kTrials));
  EXPECT_LT(calc_kolmogorov_smirnov(shares), kKolmogorovSmirnovBound);
}

TEST(GaCrossover, GenesAreCrossedIndependentlyOfEachOther) {
  const Genome a = {1, 1};
  const Genome b = {2, 2};
  RandomStream random("test/ga/independence");
  constexpr int kChildren = 20000;
  int both = 0;
  for (int child_number = 0; child_number < kChildren; ++child_number) {
    const Genome child = cross_real(a, b, {.probability = 0.75, .extent = 0.25}, random);
    const auto is_copied = [](double gene) { return gene == 1 || gene == 2; };
    both += !is_copied(child[0]) && !is_copied(child[1]) ? 1 : 0;
  }
  EXPECT_NEAR(both / double{kChildren}, 0.5625, calc_share_bound(0.5625, kChildren));
}

TEST(GaMutation, HandComputedGene) {
  // exp(ln 2) is not exactly 2 in doubles: 4 ulps.
  const DecisionVariable gain = logarithmic(0.1, 10, 1000);
  EXPECT_DOUBLE_EQ(calc_mutated_gene(gain, 10, 2, 1), 20);
  EXPECT_DOUBLE_EQ(calc_mutated_gene(gain, 10, 2, -1), 5);
  EXPECT_DOUBLE_EQ(calc_mutated_gene(gain, 10, 4, 0.5), 20);
  EXPECT_EQ(calc_mutated_gene(gain, 10, 2, 0), 10);
  const DecisionVariable torque = logarithmic(-2000, -20, -0.2);
  EXPECT_DOUBLE_EQ(calc_mutated_gene(torque, -20, 2, 1), -40);  // the sign is kept
  // ln 10 / ln 100 = 1/2 of half the box, which is 4 wide to either side.
  EXPECT_DOUBLE_EQ(calc_mutated_gene(linear(-3, 5), 1, 10, 1), 3);
  EXPECT_DOUBLE_EQ(calc_mutated_gene(linear(-3, 5), 1, 10, -0.5), 0);
  EXPECT_DOUBLE_EQ(calc_mutated_gene(linear(-3, 5), 0, 10, 1), 2);  // zero is no trap
}

// Mutates genomes of twenty genes of value 10, gives how far along its range each mutated gene
// moved, in [0, 1].
std::vector<double> collect_mutations(const MutationSettings& settings, int genomes) {
  const std::vector<DecisionVariable> variables(20, logarithmic(0.1, 10, 1000));
  RandomStream random("test/ga/mutation");
  std::vector<double> positions;
  for (int i = 0; i < genomes; ++i) {
    Genome genome(variables.size(), 10);
    mutate(genome, variables, settings, random);
    for (const double gene : genome) {
      if (gene != 10) {
        positions.push_back(0.5 + 0.5 * std::log(gene / 10) / std::log(settings.factor));
      }
    }
  }
  return positions;
}

TEST(GaMutation, ShareAndFactorAreAsDeclared) {
  constexpr int kGenomes = 20000;
  constexpr int kTrials = 20 * kGenomes;
  const std::vector<double> positions =
      collect_mutations({.probability = 0.05, .factor = 2}, kGenomes);
  EXPECT_NEAR(static_cast<double>(positions.size()) / kTrials, 0.05,
              calc_share_bound(0.05, kTrials));
  EXPECT_LT(calc_kolmogorov_smirnov(positions), kKolmogorovSmirnovBound);
}

TEST(GaMutation, LinearVariablesMoveUniformly) {
  const std::vector<DecisionVariable> variables(20, linear(-3, 5));
  RandomStream random("test/ga/linear");
  std::vector<double> positions;
  for (int i = 0; i < 1000; ++i) {
    Genome genome(variables.size(), 0);
    mutate(genome, variables, {.probability = 1, .factor = 10}, random);
    for (const double gene : genome) {
      positions.push_back(0.5 + 0.5 * gene / 2);
    }
  }
  EXPECT_LT(calc_kolmogorov_smirnov(positions), kKolmogorovSmirnovBound);
}

// With sigma in [0, 0.25) the gene lies in [3.25, 4) of 2 and 5 as the base 2 decides, or in
// [3.5, 4.25) as the base 5 does: it is 3 or 4.
TEST(GaCrossover, AnIntegerIsRoundedBetweenItsParents) {
  const std::vector<DecisionVariable> variables = {whole(-9, 9)};
  RandomStream random("test/ga/integer");
  std::map<double, int> counts;
  for (int child = 0; child < 1000; ++child) {
    ++counts[cross({2}, {5}, variables, {.probability = 1, .extent = 0.25}, random)[0]];
  }
  EXPECT_THAT(counts, ElementsAre(testing::Key(3), testing::Key(4)));
}

TEST(GaCrossover, ACategoryIsTheWordOfEitherParentWithTheSameProbability) {
  const std::vector<DecisionVariable> variables = {words({"a", "b", "c", "d"})};
  RandomStream random("test/ga/category");
  constexpr int kChildren = 20000;
  int first = 0;
  for (int child = 0; child < kChildren; ++child) {
    const double gene = cross({0}, {3}, variables, {.probability = 1, .extent = 0.25}, random)[0];
    ASSERT_TRUE(gene == 0 || gene == 3) << gene;
    first += gene == 0 ? 1 : 0;
  }
  EXPECT_NEAR(first / double{kChildren}, 0.5, calc_share_bound(0.5, kChildren));
}

TEST(GaMutation, AnIntegerMovesByAtLeastOneAndStaysWholeAndInside) {
  // A factor of 2 moves a gene of 0..3 by 0.23 at most, so rounding alone would freeze it.
  EXPECT_EQ(calc_mutated_gene(whole(0, 3), 1, 2, 0.01), 2);
  EXPECT_EQ(calc_mutated_gene(whole(0, 3), 1, 2, -0.01), 0);
  EXPECT_EQ(calc_mutated_gene(whole(0, 3), 3, 2, 0.9), 2);  // at a bound it turns round
  EXPECT_EQ(calc_mutated_gene(whole(0, 3), 0, 2, -0.9), 1);
  EXPECT_EQ(calc_mutated_gene(whole(2, 2), 2, 2, 0.5), 2);  // there is no other value
  // A factor of 100 moves by up to half the box: 0.5 * 50 = 25.
  EXPECT_EQ(calc_mutated_gene(whole(0, 100), 40, 100, 0.5), 65);
  EXPECT_EQ(calc_mutated_gene(whole(0, 100), 90, 100, 0.5), 100);
}

TEST(GaMutation, ALogarithmicIntegerIsMultipliedAndRounded) {
  EXPECT_EQ(calc_mutated_gene(whole(1, 1000, Scale::logarithmic), 100, 2, 1), 200);
  EXPECT_EQ(calc_mutated_gene(whole(1, 1000, Scale::logarithmic), 3, 1.1, 0.5), 4);
  EXPECT_EQ(calc_mutated_gene(whole(1, 1000, Scale::logarithmic), 1, 1.1, -0.5), 2);
  EXPECT_EQ(calc_mutated_gene(whole(-1000, -1, Scale::logarithmic), -3, 1.1, 0.5), -4);
  EXPECT_EQ(calc_mutated_gene(whole(-1000, -1, Scale::logarithmic), -3, 1.1, -0.5), -2);
}

TEST(GaMutation, ACategoryBecomesEachOtherWordWithTheSameProbability) {
  const DecisionVariable variable = words({"a", "b", "c", "d"});
  RandomStream random("test/ga/words");
  constexpr int kDraws = 30000;
  std::map<double, int> counts;
  for (int draw = 0; draw < kDraws; ++draw) {
    ++counts[calc_mutated_gene(variable, 1, 2, random.uniform(-1, 1))];
  }
  ASSERT_THAT(counts, ElementsAre(testing::Key(0), testing::Key(2), testing::Key(3)));
  for (const auto& [word, count] : counts) {
    EXPECT_NEAR(count / double{kDraws}, 1.0 / 3, calc_share_bound(1.0 / 3, kDraws)) << word;
  }
  EXPECT_EQ(calc_mutated_gene(words({"only"}), 0, 2, 0.3), 0);
}

}  // namespace
}  // namespace armwright
