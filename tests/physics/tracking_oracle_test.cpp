// Compares designs of the thesis on three test cases with the errors of an independent program for
// the same task, which also uses ODE (data/tracking-oracle.json).
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tracking_arms.hpp"

namespace armwright::physics_test {
namespace {

const std::map<std::string, ArmDesign> kDesigns{{"A.5", kTableA5}, {"A.10", kTableA10}};

// The programs do the same arithmetic in another order. Stable loops do not magnify rounding errors
// of 1e-16 m much over 4000 steps (measured: 5e-14 m). The file has 12 digits of errors up to 1e-2
// m.
constexpr double kTolerance_m = 1e-12;

TEST(TrackingOracle, EveryPointErrorAgrees) {
  std::ifstream file(ARMWRIGHT_TEST_DATA "/tracking-oracle.json");
  const nlohmann::json oracle = nlohmann::json::parse(file);
  int compared = 0;
  for (const auto& expected : oracle.at("results")) {
    const auto design = kDesigns.find(expected.at("design").get<std::string>());
    if (design == kDesigns.end()) {
      continue;
    }
    TrackingTask task;
    ASSERT_EQ(expected.at("signal"), "complex");
    task.distance_limit_m = expected.at("distance_limit_m");
    task.ik_bug = expected.at("ik_bug");
    task.load_kg = expected.at("load_kg");
    TestCase test_case;
    for (const auto& p : oracle.at("cases").at(expected.at("case").get<std::size_t>())) {
      test_case.points_m.emplace_back(p.at(0), p.at(1), p.at(2));
    }
    const TrackingSetup setup(load_irb4600(), task);
    const TargetTable targets = setup.make_targets(test_case);
    const TrackingResult result = simulate_one(setup, make_job(design->second, targets));
    SCOPED_TRACE(design->first + ", case " + expected.at("case").dump());
    EXPECT_EQ(result.status, SimulationStatus::ok) << result.reason;
    EXPECT_EQ(result.steps, expected.at("steps").get<int>());
    const auto errors_m = expected.at("point_error_m").get<std::vector<double>>();
    ASSERT_EQ(result.point_error_m.size(), errors_m.size());
    for (std::size_t k = 0; k < errors_m.size(); ++k) {
      EXPECT_NEAR(result.point_error_m[k], errors_m[k], kTolerance_m) << "point " << k + 1;
    }
    const double mean_m = expected.at("mean_error_m");
    EXPECT_NEAR(result.mean_error_m, mean_m, kTolerance_m);
    ++compared;
  }
  EXPECT_EQ(compared, 6);
}

}  // namespace
}  // namespace armwright::physics_test
