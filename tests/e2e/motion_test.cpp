// Motions through the program: plan one, export it, read it back, follow it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

constexpr double kDegree_rad = std::numbers::pi / 180;

class Motion : public testing::Test {
 protected:
  Outcome run(std::vector<std::string> arguments) const {
    return run_program(folder_.path(), arguments);
  }
  // Runs an optimization into `out` and returns its front.
  std::string find_front(const std::string& problem, const std::string& out,
                         const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"optimize", problem, "--budget", "600",
                                          "--out",    out,     "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome ran = run(arguments);
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    return read_text(folder_.path() / out / "front.csv");
  }
  TemporaryFolder folder_;
};

TEST_F(Motion, IsPlannedExportedReadStrictlyAndFollowed) {
  const Outcome planned =
      run({"optimize", "gasparetto", "--budget", "400", "--out", "plan", "--quiet"});
  ASSERT_EQ(planned.exit_code, 0) << planned.err;
  const json result = json::parse(read_text(folder_.path() / "plan" / "result.json"));
  const json read =
      json::parse(read_with("read_joint_trajectory.py", folder_.path() / "plan" / "winner-files"));
  EXPECT_EQ(read["joints"].size(), 6u);
  EXPECT_EQ(read["points"], 51);  // motion.samples
  EXPECT_NEAR(read["first"][0], -10 * kDegree_rad, 1e-9);
  EXPECT_NEAR(read["last"][3], 10 * kDegree_rad, 1e-9);
  for (const std::string file : {"trajectory.yaml", "motion.csv"}) {
    const Outcome followed = run({"evaluate", "start", "--robot", "irb4600_six.urdf", "--motion",
                                  "plan/winner-files/" + file});
    EXPECT_EQ(followed.exit_code, 0) << followed.err;
    EXPECT_THAT(followed.out, AllOf(HasSubstr("How the joints follow the motion"),
                                    HasSubstr("Without effort limits the error would be")));
  }
  const Outcome judged = run({"evaluate", "plan/winner.toml", "--problem", "gasparetto"});
  EXPECT_EQ(judged.exit_code, 0) << judged.err;
  EXPECT_THAT(judged.out, HasSubstr("the arm could move along the same path in"));
}

TEST_F(Motion, AFrontIsTheSameBitByBitWithAnObstacleOutOfReach) {
  const std::string clear = "motion.self_clearance=true";
  const std::string none = find_front(
      "saravanan-puma", "none", {"--optimizer", "mode", "--set", "obstacle=[]", "--set", clear});
  const std::string far =
      find_front("saravanan-puma", "far",
                 {"--optimizer", "mode", "--set", clear, "--set",
                  "obstacle=[{name=\"far\", kind=\"box\", centre_m=[9,9,9], edges_m=[1,1,1]}]"});
  EXPECT_EQ(none, far);
  EXPECT_GT(std::count(none.begin(), none.end(), '\n'), 3);
}

TEST_F(Motion, OfALineIsTimedByItsEffortsAndWeighedAgainstThem) {
  const std::string front = find_front("chaiyaratana-line", "line", {"--jobs", "2"});
  EXPECT_EQ(front, find_front("chaiyaratana-line", "again", {"--jobs", "1"}));
  EXPECT_THAT(front, HasSubstr("waist.effort_share"));
  const json read =
      json::parse(read_with("read_joint_trajectory.py", folder_.path() / "line" / "winner-files"));
  EXPECT_GT(read["duration_s"], 0.414);
  EXPECT_LT(read["duration_s"], 0.8);
}

TEST_F(Motion, AFileThatIsNoMotionIsRefusedWithItsLine) {
  std::ofstream(folder_.path() / "bad.csv") << "time_s,position_1_rad\n0,1\n";
  const Outcome refused =
      run({"evaluate", "start", "--robot", "irb4600_six.urdf", "--motion", "bad.csv"});
  EXPECT_NE(refused.exit_code, 0);
  EXPECT_THAT(refused.err,
              HasSubstr("bad.csv:1: a motion of this robot needs the columns time_s and "
                        "position_1_rad to position_6_rad"));
}

}  // namespace
}  // namespace armwright
