// Compares the tracking simulation with an independent implementation of the same task, which has
// its own inverse kinematics, controllers and timeline around ODE 0.16.2. Our side uses the public
// interface only: problem, overrides, design and a file of test cases.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "problems/config/design_file.hpp"
#include "problems/config/problem_loader.hpp"
#include "problems/load_tracking.hpp"
#include "sim/tracking/reference_signal.hpp"

namespace armwright {
namespace {

struct OracleDesign {
  std::string label;    // in the oracle's file
  std::string name;     // of the shipped design
  std::string problem;  // the problem that the design was made for
  // Both sides compute in double precision from numbers of twelve digits. The closed loop amplifies
  // differences of the last bits; the largest measured one is 1e-9. The step signal (A.9) excites
  // the arm at the edge of its stability, where other compilers or libraries may differ more.
  double tolerance = 1e-6;
};

void PrintTo(const OracleDesign& design, std::ostream* out) {
  *out << design.label;
}

class TrackingOracle : public testing::TestWithParam<OracleDesign> {
 protected:
  static const nlohmann::json& get_oracle() {
    static const nlohmann::json oracle = nlohmann::json::parse(std::ifstream(kOracle));
    return oracle;
  }

  static std::vector<nlohmann::json> find_results(const std::string& label) {
    std::vector<nlohmann::json> found;
    for (const nlohmann::json& result : get_oracle().at("results")) {
      if (result.at("design") == label) {
        found.push_back(result);
      }
    }
    return found;
  }
};

TEST_P(TrackingOracle, ShippedProblemGivesTheSameErrorAtEveryPoint) {
  const TestSet cases = TestSet::load(kOracle);
  ASSERT_EQ(cases.size(), 3U);
  const DesignFile file = load_design(GetParam().name);
  const LoadedProblem loaded = load_problem(GetParam().problem, file.published.front().overrides);
  const ArmDesign& design = file.design;
  const auto expected = find_results(GetParam().label);
  ASSERT_EQ(expected.size(), 3U);
  for (const nlohmann::json& result : expected) {
    const TrackingTask& task = loaded.tracking()->config().task;
    ASSERT_EQ(signal_names()[static_cast<std::size_t>(task.signal)], result.at("signal"));
    ASSERT_EQ(task.distance_limit_m, result.at("distance_limit_m").get<double>());
    ASSERT_EQ(task.ik_bug, result.at("ik_bug").get<bool>());
    ASSERT_EQ(task.load_kg, result.at("load_kg").get<double>());

    const TrackingResult measured =
        loaded.tracking()->track(design, cases, result.at("case").get<std::uint64_t>());
    ASSERT_EQ(measured.status, SimulationStatus::ok) << measured.reason;
    EXPECT_EQ(measured.steps, result.at("steps").get<int>());
    const auto points = result.at("point_error_m").get<std::vector<double>>();
    ASSERT_EQ(measured.point_error_m.size(), points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_NEAR(measured.point_error_m[i], points[i], GetParam().tolerance * points[i])
          << "case " << result.at("case") << ", point " << i + 1;
    }
    const double mean = result.at("mean_error_m").get<double>();
    EXPECT_NEAR(measured.mean_error_m, mean, GetParam().tolerance * mean);
  }
}

TEST_P(TrackingOracle, OverridesMakeTheSameTaskOfAnotherProblem) {
  const auto expected = find_results(GetParam().label).at(0);
  // Only the robot and the workspace of the other problem fit; the overrides set all the rest.
  const std::string other = GetParam().problem == "q1-step" ? "q3-load" : "q1-step";
  const std::vector<std::string> overrides = {
      fmt::format("task.signal={}", expected.at("signal").get<std::string>()),
      fmt::format("task.distance_limit_m={}", expected.at("distance_limit_m").get<double>()),
      fmt::format("task.ik_bug={}", expected.at("ik_bug").get<bool>()),
      fmt::format("task.load_kg={}", expected.at("load_kg").get<double>()), "physics.engine=ode"};
  const DesignFile file = load_design(GetParam().name);
  const ArmDesign& design = file.design;
  const auto made = load_tracking(other, overrides);
  const auto shipped = load_tracking(GetParam().problem, file.published.front().overrides);
  const TestSet cases = TestSet::load(kOracle);
  EXPECT_EQ(made->track(design, cases, 0).point_error_m,
            shipped->track(design, cases, 0).point_error_m);
}

INSTANTIATE_TEST_SUITE_P(Designs, TrackingOracle,
                         testing::Values(OracleDesign{"A.5", "table-a5", "q1-complex"},
                                         OracleDesign{"A.6", "table-a6", "q1-triangular"},
                                         OracleDesign{"A.7", "table-a7", "q1-trapezoid"},
                                         OracleDesign{"A.8", "table-a8", "q1-ramp"},
                                         OracleDesign{"A.9", "table-a9", "q1-step", 1e-3},
                                         OracleDesign{"A.10", "table-a10", "q2-e6"},
                                         OracleDesign{"A.11", "table-a11", "q3-load"}),
                         [](const auto& parameters) {
                           return "TableA" + parameters.param.label.substr(2);
                         });

}  // namespace
}  // namespace armwright
