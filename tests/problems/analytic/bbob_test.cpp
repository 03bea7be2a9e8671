// The functions of BBOB against values of the reference code.
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "base/expect_error.hpp"
#include "problems/analytic/analytic.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;
using testing::Pair;

const CaseBlock kBbobCase{CaseRole::training, "train/1", {0}};

struct ReferenceValues {
  int function = 0;
  int dimension = 0;
  int instance = 0;
  double f_opt = 0;
  std::vector<double> values;  // one per point
};

std::vector<ReferenceValues> read_reference_values() {
  std::ifstream file(std::string(ARMWRIGHT_TEST_DATA) + "/bbob/values.txt");
  std::vector<ReferenceValues> all;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with('#')) {
      continue;
    }
    ReferenceValues& row = all.emplace_back();
    std::istringstream numbers(line);
    numbers >> row.function >> row.dimension >> row.instance >> row.f_opt;
    for (double value = 0; numbers >> value;) {
      row.values.push_back(value);
    }
  }
  return all;
}

// Returns point k as the header of the file describes it.
std::vector<double> make_point(int k, const std::vector<double>& x_opt) {
  std::vector<double> x;
  for (int j = 0; j < static_cast<int>(x_opt.size()); ++j) {
    const double c = (37 * k + 101 * j + 13 * k * j + 7) % 1009 / 1009.0 * 10 - 5;
    x.push_back(k < 16 ? c : x_opt[static_cast<std::size_t>(j)] + std::pow(10, 15 - k) * c);
  }
  return x;
}

std::unique_ptr<Problem> make_bbob(int function, int dimension, int instance, bool adds_f_opt) {
  return make_analytic({.name = "bbob-f" + std::to_string(function),
                        .dimension = dimension,
                        .instance = instance,
                        .adds_f_opt = adds_f_opt});
}

// Both programs evaluate the same formulas with other orders of their operations. The largest
// condition of these formulas is that of T_osz behind a rotation: the rounding of a sum of 40 terms,
// 1e-14, is multiplied by at most 10. 1e-9 is the accuracy that users are promised.
TEST(Bbob, ValuesAreThoseOfTheReferenceCode) {
  std::map<int, int> counts;
  for (const ReferenceValues& row : read_reference_values()) {
    SCOPED_TRACE("f" + std::to_string(row.function) + ", dimension " +
                 std::to_string(row.dimension) + ", instance " + std::to_string(row.instance));
    const auto problem = make_bbob(row.function, row.dimension, row.instance, true);
    const auto without = make_bbob(row.function, row.dimension, row.instance, false);
    EXPECT_EQ(problem->description().optimum, row.f_opt);
    EXPECT_EQ(without->description().optimum, 0);
    const std::vector<double>& x_opt = problem->description().known_optimum;
    for (int k = 0; k < static_cast<int>(row.values.size()); ++k) {
      const std::vector<double> x = make_point(k, x_opt);
      const double expected = row.values[static_cast<std::size_t>(k)];
      const double tolerance = 1e-9 * std::max(1.0, std::abs(expected));
      EXPECT_NEAR(problem->evaluate(x, kBbobCase).objectives.at(0), expected, tolerance) << k;
      EXPECT_NEAR(without->evaluate(x, kBbobCase).objectives.at(0), expected - row.f_opt, tolerance)
          << k;
      ++counts[row.function];
    }
  }
  EXPECT_THAT(counts, ElementsAre(Pair(1, 400), Pair(2, 400), Pair(3, 400), Pair(8, 400),
                                  Pair(10, 400), Pair(15, 400)));
}

TEST(Bbob, TheMinimumIsFOptAtXOptWithinTheBox) {
  for (const int function : {1, 2, 3, 8, 10, 15}) {
    for (const int instance : {1, 4, 100, kMostInstances}) {
      const auto problem = make_bbob(function, 5, instance, true);
      const ProblemDescription& description = problem->description();
      EXPECT_EQ(problem->evaluate(description.known_optimum, kBbobCase).objectives.at(0),
                description.optimum);
      EXPECT_THAT(description.known_optimum,
                  testing::Each(testing::AllOf(testing::Ge(-4), testing::Le(4))));
      EXPECT_EQ(description.resolution, 1e-8);
    }
  }
}

TEST(Bbob, ResidualsNeedAMinimumOfZero) {
  const auto with = make_bbob(15, 3, 2, true);
  EXPECT_FALSE(with->description().has_residuals);
  EXPECT_EQ(with->description().residuals_advice, "set function.add_f_opt to false");
  const auto without = make_bbob(15, 3, 2, false);
  const Evaluation evaluation = without->evaluate(std::vector<double>{1, -2, 3}, kBbobCase);
  double sum = 0;
  for (const double residual : evaluation.residuals) {
    sum += residual * residual;
  }
  EXPECT_NEAR(sum, evaluation.objectives.at(0), 1e-13 * sum);  // a few roundings of 6 terms
}

TEST(Bbob, DimensionsAndInstancesAreChecked) {
  EXPECT_EQ(usage_error_of([] { make_bbob(1, 41, 1, true); }),
            "analytic function 'bbob-f1': dimension is 41; it must be between 2 and 40");
  EXPECT_EQ(usage_error_of([] { make_bbob(10, 5, 0, true); }),
            "analytic function 'bbob-f10': instance is 0; it must be between 1 and 200000");
  EXPECT_EQ(usage_error_of([] { make_bbob(10, 5, kMostInstances + 1, true); }),
            "analytic function 'bbob-f10': instance is 200001; it must be between 1 and 200000");
}

}  // namespace
}  // namespace armwright
