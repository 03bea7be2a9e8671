// What runs of identifications leave: the plant, its intervals, and what is said about them.
#include "study/identification/fit_analysis.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/decompositions.hpp"
#include "base/expect_error.hpp"
#include "problems/config/plant_file.hpp"
#include "problems/config/problem_loader.hpp"
#include "problems/tracking/tracking_problem.hpp"
#include "study/identification/fit_report.hpp"
#include "study/run_support.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::Contains;
using testing::HasSubstr;
using testing::MatchesRegex;

constexpr double kFlange_kg = 217.78;  // 200 kg and the flange's 17.78

class Identifications : public testing::Test {
 protected:
  // Runs the shipped identification of the KR300 and returns its report.
  json identify(const std::string& fitted, const std::string& held_back,
                const std::vector<std::string>& more = {}) {
    const std::string folder = ARMWRIGHT_CONFIGS "/logs/kr300/trajectory-";
    std::vector<std::string> settings = {
        "identification.logs=[\"" + folder + fitted + ".csv\"]",
        "identification.validate=[\"" + folder + held_back + ".csv\"]"};
    settings.insert(settings.end(), more.begin(), more.end());
    RunRequest request;
    request.plan.problem = load_problem("identify", settings);
    request.plan.optimizer = load_optimizer("ceres:lm");
    request.plan.options =
        Options::parse("ceres:lm", request.plan.optimizer.options,
                       std::vector<std::string>{"derivatives=exact", "transform=none"});
    request.plan.budget = 1000;
    request.plan.schedule = choose_schedule(request.plan.problem, request.plan.optimizer);
    request.folder = folder_.path() / fitted;
    StopSignal stop;
    SilentObserver observer;
    const auto result = execute_run(request, stop, observer);
    EXPECT_TRUE(result && result->winner);
    return json::parse(read_file(request.folder / kIdentificationFile, 1U << 26));
  }
  std::filesystem::path plant(const std::string& fitted) const {
    return folder_.path() / fitted / kPlantFile;
  }
  RobotModel load_robot() const { return load_urdf(ARMWRIGHT_CONFIGS "/robots/kr300.urdf"); }

  TemporaryFolder folder_;
};

double get_value(const json& report, const std::string& name) {
  for (const json& parameter : report.at("parameters")) {
    if (parameter.at("name") == name) {
      return parameter.at("value");
    }
  }
  ADD_FAILURE() << "no parameter " << name;
  return 0;
}

TEST_F(Identifications, OfTheKr300ExplainAnotherMotionTwiceAsWellAsTheDataSheet) {
  for (const auto& [fitted, held_back] : {std::pair{"A", "B"}, {"B", "A"}}) {
    const json report = identify(fitted, held_back);
    const json& judged = report.at("held_back");
    EXPECT_LE(judged.at("error_after").get<double>(), 0.6 * judged.at("error_before").get<double>())
        << "fitted on " << fitted;
    EXPECT_NEAR(get_value(report, "payload.mass") + 17.78, kFlange_kg, 0.03 * kFlange_kg)
        << "fitted on " << fitted;
  }
}

TEST_F(Identifications, GiveAPlantFileThatIsTheFittedRobot) {
  const json report = identify("A", "B");
  RobotModel robot = load_robot();
  const auto fitted = load_plant(plant("A"), robot);
  ASSERT_TRUE(fitted);
  ASSERT_EQ(fitted->parameters.size(), report.at("parameters").size());
  for (std::size_t i = 0; i < fitted->parameters.size(); ++i) {
    const double value = report.at("parameters")[i].at("value");
    EXPECT_EQ(fitted->values[i], value);
    EXPECT_NEAR(get_parameter(robot, fitted->parameters[i]), value, 1e-12 * std::abs(value))
        << fitted->parameters[i].name;
    const double error = report.at("parameters")[i].at("standard_error");
    const auto at = static_cast<Eigen::Index>(i);
    const bool is_known = report.at("parameters")[i].at("determined");
    EXPECT_NEAR(fitted->covariance(at, at), is_known ? error * error : 0, 1e-9 * error * error);
  }
  ASSERT_EQ(fitted->logs.size(), 1u);
  EXPECT_THAT(fitted->logs[0], HasSubstr("trajectory-A.csv "));
  // The counterbalance, up to the straight lines between its points.
  RobotModel before = load_robot();
  load_plant(ARMWRIGHT_CONFIGS "/robots/kr300.plant.toml", before);
  const Counterbalance& was = before.joints[1].plant.counterbalance;
  const Counterbalance& is = robot.joints[1].plant.counterbalance;
  ASSERT_EQ(is.efforts.size(), was.efforts.size());
  const double largest = *std::ranges::max_element(was.efforts);
  for (std::size_t k = 0; k < is.efforts.size(); ++k) {
    EXPECT_NEAR(is.efforts[k], is.scale * was.efforts[k], 1e-4 * largest);
  }
}

TEST_F(Identifications, SayWhatAMotionCannotTell) {
  const json report =
      identify("A", "B", {"identification.fit=[\"friction\", \"armature\", \"inertial\"]"});
  EXPECT_THAT(report.at("undetermined").get<std::vector<std::string>>(),
              Contains(HasSubstr("cannot be told from this motion")));
  RobotModel robot = load_robot();
  load_plant(plant("A"), robot);
  for (const Link& link : robot.links) {
    EXPECT_GT(link.inertial.mass_kg, 0);
    const Eigen::Vector3d moments =
        link.inertial.inertia_kg_m2.selfadjointView<Eigen::Lower>().eigenvalues();
    EXPECT_GT(moments[0], 0) << link.name;
    EXPECT_LE(moments[2], moments[0] + moments[1]) << link.name;
  }
}

TEST_F(Identifications, MakeProblemsWhoseCasesHaveOtherPlants) {
  identify("A", "B");
  const std::vector<std::string> settings = {"robot.urdf=\"kr300\"",
                                             "robot.plant=\"" + plant("A").string() + "\""};
  const LoadedProblem drawn = load_problem("robot", settings);
  const Perturbation& p = drawn.tracking()->config().perturbation;
  EXPECT_EQ(p.fitted, Perturbation::Fitted::draws);
  ASSERT_TRUE(p.fitted_plant);
  const Plant one = draw_plant(p, 6, 0.001, "train/1", 0),
              two = draw_plant(p, 6, 0.001, "train/1", 1);
  EXPECT_NE(one.fitted_values, two.fitted_values);
  EXPECT_EQ(one.fitted_values, draw_plant(p, 6, 0.001, "train/1", 0).fitted_values);
  EXPECT_THAT(describe_plants(p, CaseRole::test),
              MatchesRegex("drawn from the fit of trajectory-A.csv \\([0-9]+ parameters\\)"));
  const RobotModel& nominal = drawn.tracking()->config().robot;
  EXPECT_NE(one.make_arm(nominal).links.back().inertial.mass_kg,
            nominal.links.back().inertial.mass_kg)
      << "the payload is fitted";

  std::vector<std::string> none = settings;
  none.emplace_back("perturbation.fitted=none");
  EXPECT_FALSE(load_problem("robot", none).tracking()->config().perturbation.changes_anything());
  EXPECT_THAT(error_of(ErrorKind::usage,
                       [] {
                         load_problem("robot",
                                      std::vector<std::string>{"robot.urdf=\"kr300\"",
                                                               "perturbation.fitted=draws"});
                       }),
              HasSubstr("the robot's plant must have [identification], as armwright identify "
                        "writes it"));
}

TEST_F(Identifications, OfRunsThatAreReadAgainNeedNoOtherRun) {
  const json first = identify("A", "B");
  std::filesystem::remove(folder_.path() / "A" / kIdentificationFile);
  EXPECT_EQ(identify("A", "B"), first);
}

TEST(FitDoubts, ComeFirst) {
  FitAnalysis analysis;
  analysis.parameters.push_back({.name = "joint_1.viscous", .unit = "", .is_at_bound = true});
  analysis.fitted.logs = {"a.csv"};
  analysis.fitted.before = 0.5;
  analysis.fitted.after = 0.5;
  EXPECT_THAT(list_doubts(analysis, false),
              testing::ElementsAre(
                  HasSubstr("the optimizer was still moving when its budget ended"),
                  HasSubstr("a parameter is at the end of the range that is searched: "
                            "joint_1.viscous"),
                  HasSubstr("the fitted plant explains a.csv no better than the robot did")));
}

}  // namespace
}  // namespace armwright
