// What an arm's maker takes home from a run: ROS 2's parameters, read again by a strict reader that
// knows nothing of ours; the URDF, by our own; the datasheet. tests/page/datasheet_test.mjs prints
// that.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/remove_checksums.hpp"
#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"
#include "problems/config/design_file.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/robot/urdf_writer.hpp"
#include "study/run/run.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

// What is markup, a comment or an indicator somewhere. The joint turns without end.
const std::string kJoint = "say \"hi\": #1 --> <b>& é中";
const std::string kJointXml = "say &quot;hi&quot;: #1 --&gt; &lt;b&gt;&amp; é中";

// The text with `from`, which is there, once replaced.
std::string replace(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

// A run on an arm of the user's own.
class Deliverables : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    const std::string configs = ARMWRIGHT_CONFIGS;
    std::string xml = read_text(configs + "/robots/irb4600_40_255.urdf");
    xml = replace(xml, "name=\"joint_1\" type=\"revolute\"",
                  "name=\"" + kJointXml + "\" type=\"continuous\"");
    const std::size_t limit = xml.find("<limit");
    xml.erase(limit, xml.find('\n', limit) - limit);
    std::ofstream(path("arm.urdf")) << xml;
    DesignFile start = load_design("table-a1");
    start.joint_names[0] = kJoint;
    std::ofstream(path("start.toml")) << to_toml(start);
    std::ofstream(path("p.toml"))
        << "kind = \"tracking\"\ntitle = \"</style><script>\"\n[robot]\nurdf = \"arm.urdf\"\n"
           "[variables]\nstart = \"start.toml\"\n[sets]\nvalidation_cases = 2\ntest_cases = 3\n";
    optimize("run", {"./p.toml", "--budget", "40"});
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static void optimize(const std::string& out, std::vector<std::string> words) {
    words.insert(words.begin(), "optimize");
    for (const char* word : {"--optimizer", "ga", "--engine", "articulated", "--simd", "sse2"}) {
      words.emplace_back(word);
    }
    words.insert(words.end(), {"--out", out});
    const Outcome outcome = run(words);
    ASSERT_TRUE(has_ended(outcome)) << outcome.err;
  }
  static Outcome run(const std::vector<std::string>& arguments) {
    return run_program(folder_->path(), arguments);
  }
  static std::filesystem::path path(const std::string& name) { return *folder_ / name; }
  static void export_as(const std::string& format, const std::string& out,
                        const std::string& of = "run") {
    const Outcome outcome = run({"export", of, "--format", format, "--out", out});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, AllOf(StartsWith("the winner of ga (seed 1) on p as " + format),
                                   HasSubstr(out + ": ")));
  }
  static void copy(const std::string& from, const std::string& to) {
    std::filesystem::create_directories(path(to).parent_path());
    std::filesystem::copy(path(from), path(to), std::filesystem::copy_options::recursive);
  }
  static void expect_refused(const std::vector<std::string>& arguments, int exit_code,
                             const testing::Matcher<std::string>& message) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, exit_code);
    EXPECT_THAT(outcome.out, IsEmpty());
    EXPECT_THAT(outcome.err, message);
  }

  inline static std::unique_ptr<TemporaryFolder> folder_;
};

TEST_F(Deliverables, Ros2sParametersAreTheWinnersToTheLastDigit) {
  export_as("ros2-control", "ros2");
  const std::string text = read_with("read_ros2_control.py", path("ros2"));
  const json all = json::parse(text, nullptr, false);
  ASSERT_TRUE(all.is_object()) << text;
  ASSERT_EQ(all.size(), 3u);
  const DesignFile winner = load_design(path("run/winner.toml").string());
  for (const auto& [distribution, file] : all.items()) {
    EXPECT_EQ(file.at("update_rate"), 100);
    EXPECT_EQ(file.at("joints"), json(winner.joint_names)) << distribution;
    for (std::size_t i = 0; i < winner.joint_names.size(); ++i) {
      const json& gains = file.at("gains").at(winner.joint_names[i]);
      const JointDrive& drive = winner.design.joints[i];
      EXPECT_EQ(gains.at("p"), drive.gains[0]);
      EXPECT_EQ(gains.at("i"), drive.gains[1]);
      EXPECT_EQ(gains.at("d"), drive.gains[2]);
      if (distribution != "humble") {
        EXPECT_EQ(gains.at("u_clamp_max"), drive.limits.max);
        EXPECT_EQ(gains.at("u_clamp_min"), drive.limits.min);
      } else {
        EXPECT_EQ(gains.at("angle_wraparound"), i == 0);
      }
      if (distribution == "kilted") {
        EXPECT_EQ(gains.at("i_clamp_max"), drive.limits.max);
        EXPECT_EQ(gains.at("i_clamp_min"), drive.limits.min);
      } else {
        EXPECT_EQ(gains.at("i_clamp"), std::max(-drive.limits.min, drive.limits.max));
      }
    }
  }
}

TEST_F(Deliverables, Ros2sParametersAreReadStrictly) {
  export_as("ros2-control", "strict");
  const auto file = path("strict/controllers-jazzy.yaml");
  const std::string good = read_text(file);
  const auto refusal_of = [&](const std::string& from, const std::string& to) {
    std::ofstream(file) << replace(good, from, to);
    return read_with("read_ros2_control.py", path("strict"));
  };
  EXPECT_THAT(refusal_of("        p: ", "        d: 1.0\n        p: "), HasSubstr("twice"));
  EXPECT_THAT(refusal_of("ff_velocity_scale: 0.0", "ff_velocity_scale: 0"), HasSubstr("no float"));
  EXPECT_THAT(refusal_of("i_clamp:", "normalize_error:"), HasSubstr("unknown 'normalize_error'"));
  EXPECT_THAT(refusal_of("\"conditional_integration\"", "\"clamping\""),
              HasSubstr("against the rule one_of"));
  EXPECT_THAT(refusal_of("- \"velocity\"", "- \"effort\""), HasSubstr("the rule subset_of"));
  EXPECT_THAT(refusal_of("\"joint_2\":", "\"joint_5\":"), HasSubstr("no joint_2"));
  EXPECT_THAT(refusal_of("update_rate: 100", "update_rate: 100.5"), HasSubstr("update_rate"));
}

// Drives that take velocities or positions: the export is right for every distribution, and can be
// the start of another run.
TEST_F(Deliverables, DrivesAreExportedAndImportedAgain) {
  for (const std::string interface : {"velocity", "position"}) {
    SCOPED_TRACE(interface);
    std::string xml = read_text(path("arm.urdf"));
    xml = replace(xml, "type=\"continuous\">",
                  "type=\"continuous\"><limit effort=\"1e5\" velocity=\"3\"/>");
    std::ofstream(path("limited.urdf")) << xml;
    const std::vector<std::string> settings = {
        "--set", "robot.urdf=limited.urdf", "--set", "control.interface=" + interface,
        "--set", "physics.substeps=20",     "--set", "variables.optimize=[\"gains\"]"};
    std::vector<std::string> words = {"./p.toml", "--budget", "80"};
    words.insert(words.end(), settings.begin(), settings.end());
    optimize(interface, words);
    export_as("ros2-control", interface + "-ros2", interface);
    const json all =
        json::parse(read_with("read_ros2_control.py", path(interface + "-ros2")), nullptr, false);
    ASSERT_TRUE(all.is_object());
    EXPECT_EQ(all.contains("humble"), interface == "velocity");
    const DesignFile winner = load_design(path(interface + "/winner.toml").string());
    EXPECT_EQ(winner.design.controller, "pid_" + interface);
    for (const auto& [distribution, file] : all.items()) {
      EXPECT_EQ(file.at("interface"), interface);
      const json& gains = file.at("gains").at("joint_2");
      EXPECT_EQ(gains.at("p"), winner.design.joints[1].gains[0]);
      EXPECT_EQ(gains.at("i"), winner.design.joints[1].gains[1]);
      EXPECT_EQ(gains.at("d"), winner.design.joints[1].gains[2]);
      if (interface == "velocity") {
        EXPECT_EQ(gains.at("ff_velocity_scale"), winner.design.joints[1].gains[3]);
      }
      // The export as a start is as good as the winner. Its effort limits are those of the URDF,
      // which the winner's drives reach now and then.
      std::vector<std::string> evaluate = {
          "evaluate",
          "start",
          "--problem",
          "./p.toml",
          "--json",
          "--set",
          "variables.start=" + interface + "-ros2/controllers-" + distribution + ".yaml"};
      evaluate.insert(evaluate.end(), settings.begin(), settings.end());
      for (const char* word : {"--engine", "articulated", "--simd", "sse2"}) {
        evaluate.emplace_back(word);
      }
      const Outcome start = run(evaluate);
      ASSERT_EQ(start.exit_code, 0) << start.err;
      const RunResult result = load_result(path(interface));
      const double mean_m = result.test_summary.mean.value();
      EXPECT_NEAR(json::parse(start.out).at("summary").at("mean_error_m").get<double>(), mean_m,
                  0.02 * mean_m);
    }
    // A file with other gains is not taken for an export of this robot.
    std::vector<std::string> foreign = {
        "evaluate", "start", "--problem",
        "q2-e6",    "--set", "variables.start=" + interface + "-ros2/controllers-kilted.yaml"};
    foreign.insert(foreign.end(), settings.begin() + 2, settings.end());
    expect_refused(foreign, 4,
                   AllOf(HasSubstr("controllers-kilted.yaml:"),
                         HasSubstr("but the robot's are joint_1, joint_2")));
  }
}

TEST_F(Deliverables, TheUrdfIsTheSameRobotWithTheWinnersLimits) {
  export_as("urdf", "urdf");
  const RobotModel before = load_urdf(path("arm.urdf"));
  const RobotModel after = load_urdf(path("urdf/arm.urdf"));
  const DesignFile winner = load_design(path("run/winner.toml").string());
  ASSERT_EQ(after.joint_count(), before.joint_count());
  for (std::size_t i = 0; i < after.joint_count(); ++i) {
    EXPECT_EQ(after.joints[i].name, before.joints[i].name);
    EXPECT_EQ(after.joints[i].effort_limit, calc_largest_effort(winner.design.joints[i]));
    EXPECT_EQ(after.joints[i].lower, before.joints[i].lower);
    EXPECT_EQ(after.joints[i].origin.matrix(), before.joints[i].origin.matrix());
    EXPECT_EQ(after.links[i].inertial.inertia_kg_m2, before.links[i].inertial.inertia_kg_m2);
    EXPECT_EQ(after.links[i].visuals.size(), before.links[i].visuals.size());
  }
  EXPECT_EQ(after.joints[0].speed_limit, kNoVelocityLimit_rad_per_s);
  EXPECT_EQ(after.joints[1].speed_limit, before.joints[1].speed_limit);
}

TEST_F(Deliverables, TheDatasheetHasTheResultAndNoMarkupOfOthers) {
  export_as("datasheet", "sheet");
  export_as("datasheet", "again");
  const std::string html = read_text(path("sheet/datasheet.html"));
  EXPECT_EQ(html, read_text(path("again/datasheet.html")));
  EXPECT_THAT(html, AllOf(Not(HasSubstr("<script")), Not(HasSubstr("<b>")),
                          HasSubstr("&lt;/style&gt;&lt;script&gt;"),
                          HasSubstr("say &quot;hi&quot;: #1 --&gt; &lt;b&gt;&amp; é中"),
                          Not(HasSubstr("http:")), Not(HasSubstr("src="))));
  const RunResult result = load_result(path("run"));
  char mean_mm[32];
  std::snprintf(mean_mm, sizeof mean_mm, ">%.4g<", 1e3 * result.test_summary.mean.value());
  EXPECT_THAT(html, AllOf(HasSubstr(mean_mm), HasSubstr("test: test/2"), HasSubstr("p [N m/rad]"),
                          HasSubstr("no end"), HasSubstr("arm.urdf: SHA-256 "),
                          HasSubstr("tip error in the first test case")));
  // Without the recorded motion there is one figure less.
  copy("run", "bare");
  std::filesystem::remove(path("bare/winner-trajectory.csv"));
  export_as("datasheet", "bare-sheet", "bare");
  EXPECT_THAT(read_text(path("bare-sheet/datasheet.html")),
              AllOf(HasSubstr("have an error below"), Not(HasSubstr("tip error"))));
}

TEST_F(Deliverables, OtherControllersHaveADatasheetAndAUrdfAlone) {
  optimize("gravity", {"./p.toml", "--budget", "35", "--set", "control.controller=pid_gravity"});
  expect_refused({"export", "gravity", "--format", "ros2-control"}, 2,
                 AllOf(HasSubstr("'pid_gravity'"), HasSubstr("control.controller=pid")));
  EXPECT_FALSE(std::filesystem::exists(path("gravity/export-ros2-control")));
  export_as("urdf", "gravity-urdf", "gravity");
  export_as("datasheet", "gravity-sheet", "gravity");
  EXPECT_THAT(read_text(path("gravity-sheet/datasheet.html")), HasSubstr("share [1]"));
}

TEST_F(Deliverables, SayWhatToGiveInstead) {
  copy("run", "study/cells/p/ga/r01");
  std::ofstream(path("study/cells/p/ga/r01/cell.json"))
      << json{{"problem", "p"}, {"label", "ga"}, {"optimizer", "ga"}, {"replicate", 1}};
  copy("run", "unfinished");
  std::filesystem::remove(path("unfinished/result.json"));
  copy("run", "full/export-urdf");
  copy("run", "none");
  json result = json::parse(read_text(path("none/result.json")));
  result["winner"] = nullptr;
  remove_checksums(path("none"));
  std::ofstream(path("none/result.json")) << result;
  ASSERT_EQ(run({"optimize", "sphere", "--optimizer", "ga", "--budget", "40", "--out", "function"})
                .exit_code,
            0);
  for (const std::string format : {"ros2-control", "urdf", "datasheet"}) {
    expect_refused({"export", "study", "--format", format}, 2,
                   AllOf(HasSubstr("is a study"), HasSubstr("study/cells/p/ga/r01")));
    expect_refused({"export", "unfinished", "--format", format}, 2,
                   HasSubstr("has not come to its end; start it again"));
    expect_refused({"export", "function", "--format", format}, 2,
                   AllOf(HasSubstr("sphere, which has no arm"), HasSubstr("csv, ioh, coco")));
    expect_refused({"export", "none", "--format", format}, 2,
                   AllOf(HasSubstr("found no design"), HasSubstr("larger budget")));
    expect_refused({"export", "nowhere", "--format", format}, 2,
                   HasSubstr("is not the folder of a run"));
    expect_refused({"export", "run", "--format", format, "--out", "full"}, 2,
                   AllOf(HasSubstr("full: exists already"), HasSubstr("--out")));
  }
  const Outcome cell = run({"export", "study/cells/p/ga/r01", "--format", "urdf", "--out", "cell"});
  EXPECT_EQ(cell.exit_code, 0) << cell.err;
}

TEST_F(Deliverables, AreNotMadeOfAnotherRobotThanTheRuns) {
  const std::string xml = read_text(path("arm.urdf"));
  std::ofstream(path("arm.urdf")) << replace(xml, "mass value=\"112.9\"", "mass value=\"113\"");
  for (const std::string format : {"ros2-control", "urdf", "datasheet"}) {
    expect_refused({"export", "run", "--format", format, "--out", "other"}, 4,
                   AllOf(HasSubstr("have changed since the run: arm.urdf"),
                         HasSubstr("Restore the files"), Not(HasSubstr("page"))));
  }
  EXPECT_FALSE(std::filesystem::exists(path("other")));
  std::ofstream(path("arm.urdf")) << xml;
}

TEST_F(Deliverables, StretchedLinksAreNoUrdf) {
  optimize("stretched", {"co-design", "--budget", "35", "--set", "sets.validation_cases=1", "--set",
                         "sets.test_cases=1", "--set", "task.load_kg=5"});
  expect_refused({"export", "stretched", "--format", "urdf", "--force"}, 2,
                 AllOf(HasSubstr("other links than the robot's URDF"), HasSubstr("length x")));
  const Outcome outcome = run({"export", "stretched", "--format", "ros2-control", "--force"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(read_text(path("stretched/export-ros2-control/controllers-humble.yaml")),
              AllOf(HasSubstr("links are other ones"), HasSubstr("a load of 5 kg"),
                    HasSubstr("motors' masses, 100 N m/kg")));
}

// A co-design of tubes: the winner's file has them, is judged again, and is no URDF.
TEST_F(Deliverables, TubesAreDesignedJudgedAndNoUrdf) {
  const std::vector<std::string> tubes = {
      "--set", "tubes.diameter_m=[0.35,0.3,0.25,0.2]",
      "--set", "tubes.wall_m=[0.02]",
      "--set", "tubes.density_kg_per_m3=7850",
      "--set", "tubes.youngs_modulus_pa=2.1e11",
      "--set", "tubes.diameter_bounds_m=[0.15,0.45]",
      "--set", "tubes.wall_bounds_m=[0.008,0.04]",
      "--set", "tubes.deflection_limit_m=0.002",
      "--set", R"(variables.optimize=["tube_diameter","tube_wall"])",
      "--set", "sets.validation_cases=1",
      "--set", "sets.test_cases=1"};
  std::vector<std::string> arguments = {"co-design", "--budget", "70"};
  arguments.insert(arguments.end(), tubes.begin(), tubes.end());
  optimize("tubes", arguments);
  EXPECT_THAT(read_text(path("tubes/winner.toml")),
              AllOf(HasSubstr("tube_diameter_m = 0."), HasSubstr("tube_wall_m = 0.")));
  EXPECT_THAT(read_text(path("tubes/result.json")), HasSubstr("\"deflection\""));
  expect_refused({"export", "tubes", "--format", "urdf"}, 2, HasSubstr("links are tubes"));
  std::vector<std::string> judge = {"evaluate",  "tubes/winner.toml", "--problem",
                                    "co-design", "--cases",           "1"};
  judge.insert(judge.end(), tubes.begin(), tubes.end());
  const Outcome judged = run(judge);
  EXPECT_EQ(judged.exit_code, 0) << judged.err;
  // The problem without tubes does not know their material.
  expect_refused({"evaluate", "tubes/winner.toml", "--problem", "co-design", "--cases", "1"}, 2,
                 HasSubstr("add [tubes] to it"));
}

}  // namespace
}  // namespace armwright
