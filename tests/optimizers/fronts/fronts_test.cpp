// mode and nsga3: their parts, and whole runs on functions with known fronts.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "base/expect_error.hpp"
#include "optimizers/fronts/front_order.hpp"
#include "optimizers/fronts/mode.hpp"
#include "optimizers/fronts/nsga3.hpp"
#include "optimizers/run_optimizer.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "problems/analytic/analytic.hpp"
#include "study/statistics/pareto.hpp"

namespace armwright {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;

FrontMember make_member(std::vector<double> objectives, double violation = 0) {
  return {.coordinates = {}, .objectives = std::move(objectives), .violation = violation};
}

TEST(FrontOrder, LessViolationBeatsBetterObjectives) {
  EXPECT_TRUE(dominates(make_member({9, 9}), make_member({1, 1}, 0.1)));
  EXPECT_TRUE(dominates(make_member({9, 9}, 0.1), make_member({1, 1}, 0.2)));
  EXPECT_TRUE(dominates(make_member({9, 9}, 1e300), make_member({1, 1}, INFINITY)));
  EXPECT_TRUE(dominates(make_member({1, 2}, 0.1), make_member({2, 2}, 0.1)));
  EXPECT_FALSE(dominates(make_member({1, 2}), make_member({1, 2})));
  EXPECT_FALSE(dominates(make_member({1, 2}), make_member({2, 1})));
  EXPECT_TRUE(equals_or_dominates(make_member({1, 2}), make_member({1, 2})));
}

TEST(FrontOrder, SortsAsTheDefinitionSays) {
  RandomStream random("test/front-order");
  std::vector<FrontMember> members;
  for (int i = 0; i < 150; ++i) {
    // Whole numbers, so that some members are equal.
    members.push_back(
        make_member({std::floor(random.uniform(0, 9)), std::floor(random.uniform(0, 9)),
                     std::floor(random.uniform(0, 9))},
                    std::floor(random.uniform(0, 2))));
  }
  // The definition: the next front is what no member that is left dominates.
  std::vector<std::size_t> left(members.size());
  std::iota(left.begin(), left.end(), std::size_t{0});
  for (const std::vector<std::size_t>& front : sort_into_fronts(members)) {
    std::vector<std::size_t> expected;
    std::ranges::copy_if(left, std::back_inserter(expected), [&](std::size_t i) {
      return std::ranges::none_of(left,
                                  [&](std::size_t j) { return dominates(members[j], members[i]); });
    });
    EXPECT_THAT(front, testing::UnorderedElementsAreArray(expected));
    std::erase_if(left, [&](std::size_t i) { return std::ranges::count(front, i) > 0; });
  }
  EXPECT_TRUE(left.empty());
}

TEST(FrontOrder, CrowdingAddsTheGapsAsSharesOfTheRange) {
  const std::vector<FrontMember> members = {make_member({0, 8}), make_member({4, 0}),
                                            make_member({1, 6}), make_member({3, 2})};
  const std::vector<std::size_t> front = {0, 1, 2, 3};
  const std::vector<double> crowding = calc_crowding(members, front);
  EXPECT_EQ(crowding[0], INFINITY);
  EXPECT_EQ(crowding[1], INFINITY);
  EXPECT_EQ(crowding[2], 3.0 / 4 + 6.0 / 8);
  EXPECT_EQ(crowding[3], 3.0 / 4 + 6.0 / 8);
}

const std::vector<DecisionVariable>& list_three_variables() {
  static const std::vector<DecisionVariable> variables = {
      {"a", "", 0, 1, 0.5}, {"b", "", -2, 5, 1}, {"c", "", 1, 1000, 30, Scale::logarithmic}};
  return variables;
}

std::vector<FrontMember> draw_members(const SearchSpace& space, std::size_t size,
                                      RandomStream& random) {
  std::vector<FrontMember> members;
  for (const std::vector<double>& coordinates : space.draw_population(size, 1, random)) {
    members.push_back({.coordinates = coordinates, .objectives = {}});
  }
  return members;
}

TEST(Mode, WithoutAWeightATrialHasCoordinatesOfThePopulationOnly) {
  const SearchSpace space(list_three_variables());
  RandomStream random("test/mode");
  const std::vector<FrontMember> members = draw_members(space, 6, random);
  bool mixes = false;
  for (std::size_t k = 0; k < 60; ++k) {
    const std::vector<double> trial =
        make_trial(members, k % 6, space, {.weight = 0, .crossover = 0.5}, random);
    std::set<std::size_t> origins;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto origin = std::ranges::find(
          members, trial[i], [&](const FrontMember& member) { return member.coordinates[i]; });
      ASSERT_NE(origin, members.end()) << "coordinate " << i << " of trial " << k << " is new";
      origins.insert(static_cast<std::size_t>(origin - members.begin()));
    }
    EXPECT_LE(origins.size(), 2U);  // the member itself, and one other
    mixes |= origins.size() == 2;
  }
  EXPECT_TRUE(mixes);
}

TEST(Mode, TrialsStayWithinTheBounds) {
  const SearchSpace space(list_three_variables());
  RandomStream random("test/mode");
  const std::vector<FrontMember> members = draw_members(space, 6, random);
  for (std::size_t k = 0; k < 200; ++k) {
    const std::vector<double> trial =
        make_trial(members, k % 6, space, {.weight = 2, .crossover = 1}, random);
    for (std::size_t i = 0; i < 3; ++i) {
      ASSERT_GE(trial[i], space.lower()[i]);
      ASSERT_LE(trial[i], space.upper()[i]);
    }
  }
}

std::vector<std::vector<double>> list_objectives(std::span<const FrontMember> members) {
  std::vector<std::vector<double>> objectives;
  for (const FrontMember& member : members) {
    objectives.push_back(member.objectives);
  }
  return objectives;
}

TEST(Mode, BothStayUnlessOneDominates) {
  const std::vector<FrontMember> members = {make_member({0, 9}), make_member({5, 5}),
                                            make_member({9, 0}), make_member({2, 2}, 1)};
  const std::vector<FrontMember> trials = {make_member({1, 7}), make_member({4, 4}),
                                           make_member({9, 1}), make_member({9, 9}, 0.5)};
  // Six are left: 9,1 and the violated 2,2 have lost against their partners, as has 5,5. In the cut
  // to four, the violated trial goes first.
  EXPECT_THAT(list_objectives(select_survivors(members, trials, 4)),
              testing::UnorderedElementsAre(ElementsAre(0, 9), ElementsAre(1, 7), ElementsAre(4, 4),
                                            ElementsAre(9, 0)));
}

TEST(ReferenceDirections, AreAllMultiplesThatAddUpToOne) {
  EXPECT_THAT(make_directions(2, 2),
              ElementsAre(ElementsAre(0, 1), ElementsAre(0.5, 0.5), ElementsAre(1, 0)));
  EXPECT_EQ(make_directions(3, 12).size(), 91U);  // the source's table I
  EXPECT_EQ(make_directions(5, 6).size(), 210U);
  EXPECT_EQ(count_directions(5, 6, 1000), 210);
  EXPECT_EQ(count_directions(5, 6, 100), 101);
}

TEST(ReferenceDirections, ThePlaneThroughTheExtremesGivesTheRanges) {
  // Points of the plane f1 / 2 + f2 / 4 + f3 / 8 = 1, moved by the ideal point (1, 1, 1), which three
  // points reach.
  const std::vector<std::vector<double>> points = {{3, 1, 1}, {1, 5, 1}, {1, 1, 9}, {2, 2, 3}};
  FrontScale scale;
  scale.update(points, points.size());
  EXPECT_THAT(scale.ideal(), ElementsAre(1, 1, 1));
  EXPECT_THAT(scale.ranges(),
              ElementsAre(DoubleNear(2, 1e-14), DoubleNear(4, 1e-14), DoubleNear(8, 1e-14)));
  EXPECT_THAT(scale.normalise(points[3]), ElementsAre(0.5, 0.25, 0.25));
}

TEST(ReferenceDirections, AFrontOfOnePointHasARange) {
  FrontScale scale;
  scale.update(std::vector<std::vector<double>>{{3, 1}}, 1);
  EXPECT_THAT(scale.ranges(), ElementsAre(1, 1));
}

TEST(Nsga3, KeepsOneMemberPerDirection) {
  // Five directions of two objectives, and twelve members on the line f1 + f2 = 1, crowded at one
  // end. The nearest member of every direction survives.
  std::vector<FrontMember> members;
  for (const double x : {0.0, 0.01, 0.02, 0.03, 0.24, 0.26, 0.27, 0.5, 0.52, 0.74, 0.78, 1.0}) {
    members.push_back(make_member({x, 1 - x}));
  }
  FrontScale scale;
  RandomStream random("test/nsga3");
  const std::vector<FrontMember> kept =
      select_along_directions(members, 5, make_directions(2, 4), scale, random);
  std::vector<double> first;
  for (const FrontMember& member : kept) {
    first.push_back(member.objectives[0]);
  }
  std::ranges::sort(first);
  ASSERT_EQ(first.size(), 5U);
  EXPECT_EQ(first[0], 0);
  EXPECT_THAT(first[1], DoubleNear(0.25, 0.011));
  EXPECT_EQ(first[2], 0.5);
  EXPECT_EQ(first[3], 0.74);
  EXPECT_EQ(first[4], 1);
}

TEST(Nsga3, OfViolatedMembersTheLeastViolatedOnesSurvive) {
  std::vector<FrontMember> members;
  for (int i = 0; i < 8; ++i) {
    members.push_back(make_member({i + 0.0, -i + 0.0}, i < 2 ? 0 : 10 - i));
  }
  FrontScale scale;
  RandomStream random("test/nsga3");
  std::vector<double> violations;
  for (const FrontMember& member :
       select_along_directions(members, 4, make_directions(2, 3), scale, random)) {
    violations.push_back(member.violation);
  }
  EXPECT_THAT(violations, ElementsAre(0, 0, 3, 4));
}

TEST(Nsga3, ChildrenStayWithinTheBoundsAndKeepTheMiddleOnAverage) {
  const SearchSpace space(list_three_variables());
  RandomStream random("test/nsga3");
  const std::vector<FrontMember> members = draw_members(space, 2, random);
  const GeneticSettings settings = {.crossover = 1, .crossover_index = 2, .mutation_index = 20};
  double sum = 0;
  constexpr int kPairs = 2000;
  for (int k = 0; k < kPairs; ++k) {
    for (const auto& child : breed_pair(members[0], members[1], space, settings, random)) {
      for (std::size_t i = 0; i < 3; ++i) {
        ASSERT_GE(child[i], space.lower()[i]);
        ASSERT_LE(child[i], space.upper()[i]);
      }
      sum += child[0];
    }
  }
  const double middle = 0.5 * (members[0].coordinates[0] + members[1].coordinates[0]);
  // The bounds make the spread of the two children unequal by less than this.
  EXPECT_NEAR(sum / (2 * kPairs), middle, 0.05);
}

// Returns the objectives of all feasible evaluations.
std::vector<std::vector<double>> list_archive(const MemoryEvaluator& evaluator) {
  std::vector<std::vector<double>> archive;
  for (const MemoryEvaluator::Entry& entry : evaluator.trace()) {
    if (std::ranges::all_of(entry.score.constraint_values, [](double g) { return g <= 0; })) {
      archive.push_back(entry.score.objectives);
    }
  }
  return archive;
}

constexpr double kZdt1Volume = 0.1 + 2.0 / 3 + 0.11;

double calc_zdt1_volume(const std::string& optimizer, std::uint64_t seed,
                        const std::vector<std::string>& options) {
  const std::vector<double> reference = {1.1, 1.1};
  return calc_hypervolume(list_archive(run_optimizer(optimizer, *make_analytic("zdt1"),
                                                     {.budget = 25000}, seed, options)),
                          reference);
}

// The front of all evaluations counts. Of 15 seeds, docs/fronts.md has the median and the worst.
TEST(Mode, FindsTheFrontOfZdt1) {
  const double volume = calc_zdt1_volume("mode", 1, {});
  EXPECT_GT(volume, kZdt1Volume - 1e-3);
  EXPECT_LT(volume, kZdt1Volume);
}

TEST(Nsga3, CoversTheSphereOfDtlz2) {
  const auto problem = make_analytic("dtlz2");
  const MemoryEvaluator evaluator = run_optimizer("nsga3", *problem, {.budget = 92 * 250}, 1, {});
  // The front of the last 20 generations.
  std::vector<std::vector<double>> archive = list_archive(evaluator);
  archive.erase(archive.begin(), archive.end() - 92 * 20);
  double distance = 0;
  std::vector<std::vector<double>> front;
  for (const std::size_t i : find_non_dominated(archive)) {
    front.push_back(archive[i]);
    distance += std::hypot(archive[i][0], archive[i][1], archive[i][2]) - 1;
  }
  EXPECT_LT(distance / static_cast<double>(front.size()), 0.01);  // measured: 0.0022
  // Where the reference directions meet the sphere, neighbours are about 0.1 apart.
  for (const std::vector<double>& direction : make_directions(3, 12)) {
    const double length = std::hypot(direction[0], direction[1], direction[2]);
    double nearest = INFINITY;
    for (const std::vector<double>& f : front) {
      nearest =
          std::min(nearest, std::hypot(f[0] - direction[0] / length, f[1] - direction[1] / length,
                                       f[2] - direction[2] / length));
    }
    EXPECT_LT(nearest, 0.05) << "direction " << direction[0] << " " << direction[1];  // 0.021
  }
}

TEST(Fronts, AreRefusedForOneObjective) {
  for (const char* name : {"mode", "nsga3"}) {
    EXPECT_EQ(find_optimizer(name).requirements.objectives, 2) << name;
  }
}

TEST(Nsga3, RefusesTooManyDirections) {
  const OptimizerRow& row = find_optimizer("nsga3");
  const auto optimizer =
      row.make(Options::parse("nsga3", row.options, std::vector<std::string>{"divisions=200"}));
  EXPECT_THAT(
      usage_error_of([&] { optimizer->check_problem(make_analytic("dtlz2")->description()); }),
      HasSubstr("more than 10000 reference directions; choose fewer divisions"));
}

}  // namespace
}  // namespace armwright
