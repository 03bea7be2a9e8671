// The optimizer cmaes on functions of BBOB in 10 dimensions, beside a stored run of pycma from the
// same starts on the same instances (benchmarks/pycma_plugin.py made it).
#include <gmock/gmock.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "sample_or_all.hpp"
#include "study/compare/study_support.hpp"

namespace armwright {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr const char* kAllProblems = "['bbob-f1', 'bbob-f2', 'bbob-f8', 'bbob-f10']";
constexpr const char* kPlan =
    "\nreplicates = 15\nbudget = 12000\n"
    "start_spread = 0.8\nbaselines = false\ncheckpoints = 2\n"
    "[[optimizer]]\nname = 'cmaes'\nlabel = 'default'\noptions = ['restarts=none']\n"
    "[[optimizer]]\nname = 'cmaes'\nlabel = 'published'\n"
    "options = ['restarts=none', 'orthogonal=false']\n";

// Returns the number of evaluations to 1e-8, infinity if the run did not get there.
double count_to_target(const CellOutcome& cell) {
  const auto hit =
      std::ranges::find_if(cell.trace, [](const CurvePoint& point) { return point.value <= 1e-8; });
  return hit == cell.trace.end() ? kInfinity : static_cast<double>(hit->budget);
}

// Returns the value that this share of the others does not exceed.
double find_quantile(std::vector<double> values, double share) {
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

TEST_F(StudyTest, CmaesNeedsAsManyEvaluationsAsPycma) {
  const auto stored = nlohmann::json::parse(
      read_file(std::filesystem::path(ARMWRIGHT_TEST_DATA) / "bbob" / "pycma.json", 1 << 20));
  const StudyPlan plan = load_plan(
      temporary_, std::string("problems = ") + sample_or_all("['bbob-f8']", kAllProblems) + kPlan);
  ASSERT_EQ(run_all(plan, "study", 2), 0U);
  const StudyResult result = analyze_study(plan, temporary_ / "study");
  for (const StudyProblem& problem : plan.problems) {
    SCOPED_TRACE(problem.label);
    const auto& recorded = stored.at("problems").at(problem.label);
    std::vector<double> pycma;
    for (const auto& evaluations : recorded.at("evaluations")) {
      pycma.push_back(evaluations.is_null() ? kInfinity : evaluations.get<double>());
    }
    std::map<std::string, std::vector<double>> own;  // by the optimizer's label
    for (const CellOutcome& cell : result.cells) {
      if (cell.problem == problem.label) {
        own[cell.optimizer].push_back(count_to_target(cell));
        const auto start =
            recorded.at("start_values").at(static_cast<std::size_t>(cell.replicate - 1));
        EXPECT_NEAR(cell.start_value / start.get<double>(), 1, 1e-9);
      }
    }
    ASSERT_EQ(pycma.size(), 15U);
    // Without orthogonal steps, which pycma lacks, the median is within the middle 80 % of pycma's
    // runs. Orthogonal steps save evaluations.
    const double published = find_quantile(own.at("published"), 0.5);
    EXPECT_GE(published, find_quantile(pycma, 0.1));
    EXPECT_LE(published, find_quantile(pycma, 0.9));
    EXPECT_LE(find_quantile(own.at("default"), 0.5), published);
    for (const auto& [label, evaluations] : own) {
      EXPECT_LE(std::ranges::count(evaluations, kInfinity), 2) << label;
    }
  }
}

}  // namespace
}  // namespace armwright
