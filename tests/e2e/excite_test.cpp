// armwright excite: what it prints and writes, and that identify finds the plant in its recordings.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kPlant =
    "[joint.shoulder]\nviscous_n_m_s_per_rad = 4\ncoulomb_n_m = 6\narmature_kg_m2 = 0.5\n"
    "[joint.elbow]\nviscous_n_m_s_per_rad = 3\ncoulomb_n_m = 5\narmature_kg_m2 = 0.4\n";

class Excite : public testing::Test {
 protected:
  Outcome excite(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(),
                     {"excite", "--robot", "planar2", "--budget", "600", "--quiet"});
    return run_program(folder_.path(), arguments);
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  std::string read(const std::string& name) const { return read_text(folder_.path() / name); }
  TemporaryFolder folder_;
};

TEST_F(Excite, WritesAMotionThatIsWithinItsLimitsAndBetterThanItsStart) {
  const Outcome shown = excite({"--out", "motion"});
  EXPECT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_THAT(shown.out,
              AllOf(StartsWith("condition number of what the motion tells: "),
                    HasSubstr("Shares of the limits (allowed: 90 %, 80 %, 80 %), checked at 1001 "),
                    HasSubstr("What a recording at 100 Hz would tell, with noise of 1 % of each"),
                    HasSubstr("armwright identify LOG --robot planar2"),
                    HasSubstr("collisions were not checked")));
  const json report = json::parse(read("motion/excitation.json"));
  EXPECT_GT(report["log_det"], report["log_det_before"].get<double>() + 0.3);
  for (const json& joint : report["joints"]) {
    EXPECT_LE(joint["position_share"], 0.9);
    EXPECT_LE(joint["speed_share"], 0.8);
    EXPECT_LE(joint["effort_share"], 0.8);
  }
  const std::string csv = read("motion/motion.csv");
  EXPECT_THAT(csv, StartsWith("time_s,position_1_rad,position_2_rad,velocity_1_rad_per_s,"));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 2002);
  EXPECT_THAT(read("motion/trajectory.yaml"),
              AllOf(HasSubstr("joint_names:\n  - \"shoulder\"\n"),
                    HasSubstr("velocities: [0.000000000, 0.000000000]"),
                    HasSubstr("time_from_start: {sec: 19, nanosec: 900000000}")));
}

TEST_F(Excite, LowersTheConditionNumberIfThatIsTheCriterion) {
  const Outcome shown = excite({"--criterion", "condition", "--fit", "inertial", "--json"});
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  const json report = json::parse(shown.out);
  EXPECT_LT(report["condition"], report["condition_before"].get<double>() / 2);
}

TEST_F(Excite, SimulatesRecordingsInWhichIdentifyFindsThePlant) {
  std::ofstream(folder_.path() / "plant.toml") << kPlant;
  ASSERT_EQ(excite({"--out", "m", "--rate", "250", "--simulate", "plant.toml", "--noise-seed", "7"})
                .exit_code,
            0);
  const Outcome found = run_program(
      folder_.path(), {"identify", "m/simulated-7.csv", "--robot", "planar2", "--json", "--quiet"});
  ASSERT_EQ(found.exit_code, 0) << found.err;
  const std::map<std::string, double> truth = {{"shoulder.viscous", 4},    {"shoulder.coulomb", 6},
                                               {"shoulder.armature", 0.5}, {"elbow.viscous", 3},
                                               {"elbow.coulomb", 5},       {"elbow.armature", 0.4}};
  for (const json& parameter : json::parse(found.out)["parameters"]) {
    const auto at = truth.find(parameter["name"]);
    if (at != truth.end()) {
      // Four standard errors.
      EXPECT_NEAR(parameter["value"], at->second, 4 * parameter["standard_error"].get<double>())
          << at->first;
    }
  }
  // Another seed is another log; the same is the same.
  const std::string first = read("m/simulated-7.csv");
  excite({"--out", "m", "--rate", "250", "--simulate", "plant.toml", "--noise-seed", "8"});
  EXPECT_NE(read("m/simulated-8.csv"), first);
  excite({"--out", "m", "--rate", "250", "--simulate", "plant.toml", "--noise-seed", "7"});
  EXPECT_EQ(read("m/simulated-7.csv"), first);
}

TEST_F(Excite, RefusesWhatItCannotDo) {
  EXPECT_THAT(excite({"--rate", "5"}).err,
              HasSubstr("--rate is '5'; it must be a number from 10 to"));
  EXPECT_THAT(excite({"--fit", "payload"}).err,
              HasSubstr("state the mass that the robot will carry"));
  EXPECT_THAT(excite({"--harmonics", "99"}).err, HasSubstr("excitation.harmonics"));
}

}  // namespace
}  // namespace armwright
