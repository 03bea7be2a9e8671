// identification.json of made-up motions of the arm planar2.
#include "study/identification/fit_report.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace armwright {
namespace {

using nlohmann::json;
using testing::ElementsAre;

constexpr double kPeriod_s = 0.0125;  // as cutoff_hz = 8 leaves it

IdentificationConfig::Log make_log(const std::string& name, Eigen::Index rows) {
  LogSamples samples;
  samples.period_s = kPeriod_s;
  samples.times_s.resize(rows);
  for (Eigen::MatrixXd* matrix :
       {&samples.positions, &samples.rates, &samples.accelerations, &samples.efforts}) {
    matrix->resize(rows, 2);
  }
  for (Eigen::Index k = 0; k < rows; ++k) {
    const double t = static_cast<double>(k) * kPeriod_s;
    samples.times_s[k] = t;
    for (Eigen::Index i = 0; i < 2; ++i) {
      const double w = 1.5 + static_cast<double>(i);
      samples.positions(k, i) = std::sin(w * t);
      samples.rates(k, i) = w * std::cos(w * t);
      samples.accelerations(k, i) = -w * w * std::sin(w * t);
      samples.efforts(k, i) = 10 * std::cos(w * t) + (k % 2 == 0 ? 0.1 : -0.1);
    }
  }
  return {name, samples};
}

IdentificationProblem make_problem(Eigen::Index fitted_rows, Eigen::Index held_back_rows) {
  IdentificationConfig config;
  config.name = "made up";
  config.robot = load_urdf(ARMWRIGHT_CONFIGS "/robots/planar2.urdf");
  config.plain = config.robot;
  config.gravity_m_per_s2 = 9.80665;
  config.groups = {FitGroup::friction};
  config.fitted = {make_log("a.csv", fitted_rows)};
  config.held_back = {make_log("b.csv", held_back_rows)};
  config.cutoff_hz = 8;
  return IdentificationProblem(config);
}

json make_report(const IdentificationProblem& problem, const std::vector<std::string>& doubts) {
  std::vector<double> x;
  for (const DecisionVariable& variable : problem.description().variables) {
    x.push_back(variable.start);
  }
  return json::parse(to_json(problem, x, analyse_fit(problem, x), doubts));
}

TEST(FitReport, AMotionHasAtMostAThousandSamplesButAtLeast25PerSecond) {
  const auto problem = make_problem(1500, 8000);  // 18.75 s and 100 s
  const json motions = make_report(problem, {})["motions"];
  ASSERT_EQ(motions.size(), 2u);
  EXPECT_EQ(motions[0]["times_s"].size(), 750u);
  EXPECT_DOUBLE_EQ(motions[0]["times_s"][1], 2 * kPeriod_s);
  EXPECT_EQ(motions[1]["times_s"].size(), 2667u);  // of 1000, there were 10 per second
  EXPECT_DOUBLE_EQ(motions[1]["times_s"][1], 3 * kPeriod_s);
  for (const json& motion : motions) {
    for (const char* key : {"positions", "recorded", "model_before", "model_after"}) {
      ASSERT_EQ(motion[key].size(), 2u) << key;
      EXPECT_EQ(motion[key][1].size(), motion["times_s"].size()) << key;
    }
    const double t = motion["times_s"][70];
    EXPECT_NEAR(motion["positions"][0][70], std::sin(1.5 * t), 1e-12);
  }
}

TEST(FitReport, KeepsTheDoubtsAndTheLogsApart) {
  const json report = make_report(make_problem(400, 400), {"a doubt", "another one"});
  EXPECT_THAT(report["doubts"].get<std::vector<std::string>>(),
              ElementsAre("a doubt", "another one"));
  EXPECT_EQ(report["fitted"]["logs"], json({"a.csv"}));
  EXPECT_EQ(report["held_back"]["logs"], json({"b.csv"}));
  EXPECT_EQ(report["robot"], "planar2");
}

TEST(FitReport, DoubtsNameWhatIsAtAnEndAndAFitThatIsNoBetter) {
  FitAnalysis analysis;
  FittedParameter parameter;
  parameter.name = "joint_1.armature";
  analysis.parameters = {parameter};
  analysis.fitted.logs = {"a.csv"};
  analysis.fitted.before = 0.5;
  analysis.fitted.after = 0.1;
  EXPECT_THAT(list_doubts(analysis, true), testing::IsEmpty());
  analysis.parameters[0].is_at_bound = true;
  analysis.fitted.after = 0.5;
  EXPECT_THAT(list_doubts(analysis, false),
              ElementsAre(testing::HasSubstr("budget"), testing::HasSubstr("joint_1.armature"),
                          testing::HasSubstr("a.csv no better")));
}

}  // namespace
}  // namespace armwright
