// Everybody's robot: from a URDF to tuned controllers with one command and nothing else.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"
#include "sim/generated_arm.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// What keeps the tests short: few cases, few simulations.
const std::vector<std::string> kSmall = {
    "--set", "sets.validation_cases=4", "--set",  "sets.test_cases=6", "--set", "schedule.cases=4",
    "--set", "physics.substeps=4",      "--quiet"};

class Robots : public testing::Test {
 protected:
  Outcome run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), kSmall.begin(), kSmall.end());
    return run_program(folder_.path(), arguments);
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / name) << text;
  }

  // Tuned in one go, its error on unseen paths is far below that of what was proposed.
  void expect_tuned(const std::vector<std::string>& robot) const {
    std::vector<std::string> tune = {"optimize"};
    std::vector<std::string> start = {"evaluate", "start", "--json"};
    tune.insert(tune.end(), robot.begin(), robot.end());
    start.insert(start.end(), robot.begin(), robot.end());
    tune.insert(tune.end(), {"--budget", "1500", "--json", "--out", "tuned/" + robot.back()});
    const Outcome before = run(start);
    ASSERT_EQ(before.exit_code, 0) << before.err;
    const Outcome after = run(tune);
    ASSERT_EQ(after.exit_code, 0) << after.err;
    const json proposed = json::parse(before.out).at("summary");
    const json tuned = json::parse(after.out).at("winner").at("test_summary");
    EXPECT_EQ(proposed.at("without_number"), 0);
    EXPECT_EQ(tuned.at("failures"), 0) << robot.back();
    EXPECT_LT(5 * tuned.at("mean").get<double>(), proposed.at("mean_error_m").get<double>())
        << robot.back();
  }

  TemporaryFolder folder_;
};

class GeneratedRobots : public Robots, public testing::WithParamInterface<int> {};

TEST_P(GeneratedRobots, GoFromUrdfToTunedControllersWithOneCommand) {
  const std::string name = "arm_" + std::to_string(GetParam()) + ".urdf";
  write(name, make_arm_urdf(GetParam()));
  expect_tuned({"--robot", name});
}

INSTANTIATE_TEST_SUITE_P(E2e, GeneratedRobots, testing::Range(0, kGeneratedArms));

class ShippedRobots : public Robots, public testing::WithParamInterface<const char*> {};

TEST_P(ShippedRobots, GoFromUrdfToTunedControllersWithOneCommand) {
  std::vector<std::string> words = {"--robot", GetParam()};
  if (std::string(GetParam()) == "arm7_gripper") {
    words.insert(words.begin(), {"--tip", "tool"});
  }
  expect_tuned(words);
}

INSTANTIATE_TEST_SUITE_P(E2e, ShippedRobots,
                         testing::Values("irb4600_40_255", "irb4600_six", "planar2", "arm7",
                                         "arm7_gripper"));

// The tutorial, command by command as it stands there, with fewer cases and simulations. Its robot
// is the shipped one with a gripper under another name.
TEST_F(Robots, TheTutorialWorks) {
  const std::filesystem::path docs =
      std::filesystem::path(ARMWRIGHT_SCRIPTS).parent_path() / "docs";
  std::istringstream lines(read_text(docs / "bring-your-robot.md"));
  std::filesystem::copy_file(std::filesystem::path(ARMWRIGHT_CONFIGS) / "robots/arm7_gripper.urdf",
                             folder_.path() / "my_arm.urdf");
  std::string block;  // a file that the text shows, up to the next line that is not indented
  std::string file;
  int commands = 0;
  for (std::string line; std::getline(lines, line);) {
    if (!file.empty()) {
      if (line.starts_with("    ") || line.empty()) {
        block += (line.empty() ? line : line.substr(4)) + "\n";
        continue;
      }
      write(file, block);
      file.clear();
      block.clear();
    }
    if (const std::size_t at = line.find("Write `"); at != std::string::npos) {
      file = line.substr(at + 7, line.find('`', at + 7) - at - 7);
      std::getline(lines, line);  // the empty one before the block
      continue;
    }
    if (!line.starts_with("    armwright ")) {
      continue;
    }
    std::istringstream words(line.substr(0, line.find(" #")));
    std::vector<std::string> command;
    for (std::string word; words >> word;) {
      command.push_back(word);
    }
    command.erase(command.begin());
    SCOPED_TRACE(line);
    ++commands;
    const bool simulates = command.front() == "optimize" || command.front() == "evaluate";
    if (command.front() == "optimize") {
      command.insert(command.end(), {"--budget", "40"});
    } else if (command.front() == "verify") {
      command.insert(command.end(), {"--cases", "1"});
    }
    const Outcome outcome = simulates ? run(command) : run_program(folder_.path(), command);
    // Few simulations need not keep what is required.
    EXPECT_THAT(outcome.exit_code, testing::AnyOf(0, 3)) << outcome.err;
  }
  EXPECT_GT(commands, 8);
}

}  // namespace
}  // namespace armwright
