// What [control] says of drives with an inner loop: the interface, its controllers, and what cannot
// be simulated.
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "base/expect_error.hpp"
#include "problems/config/problem_loader.hpp"
#include "problems/problem_folder.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

LoadedProblem load_plain(const std::vector<std::string>& settings = {}) {
  return load_problem("q2-e6", settings);
}

LoadedProblem load_driven(std::vector<std::string> settings) {
  settings.insert(settings.begin(), {"control.interface=velocity", "physics.substeps=20"});
  return load_plain(settings);
}

TEST(Drives, AreAbsentUnlessTheInterfaceNamesThem) {
  const LoadedProblem plain = load_plain();
  EXPECT_FALSE(plain.tracking()->config().task.drives.has_loops());
  EXPECT_EQ(plain.resolved_json, load_plain({"control.interface=effort"}).resolved_json);
  EXPECT_THAT(plain.resolved_json, AllOf(Not(HasSubstr("interface")), Not(HasSubstr("bandwidth"))));
}

TEST(Drives, HaveControllersThatStartFromTheirLag) {
  const LoadedProblem loaded = load_driven({"control.delay_s=0.002"});
  const TrackingConfig& config = loaded.tracking()->config();
  const ArmDrives& drives = config.task.drives;
  EXPECT_EQ(config.start.controller, "pid_velocity");
  EXPECT_NEAR(drives.bandwidth_rad_per_s, 188.5, 0.1);
  // Start values from the lag of the drive, of the command and of half a period.
  EXPECT_NEAR(config.start.joints[2].gains[0], 1 / (4 * (0.002 + 1 / 188.5 + 0.005)), 0.01);
  EXPECT_EQ(config.start.joints[2].gains[3], 1);
  EXPECT_EQ(config.start.joints[2].limits.max, 20000);  // of the motor, as before
  EXPECT_THAT(loaded.resolved_json,
              AllOf(HasSubstr(R"("interface":"velocity")"), HasSubstr(R"("bandwidth_hz":30)"),
                    HasSubstr(R"("delay_s":0.002)")));
  // The record is the same problem.
  EXPECT_EQ(load_recorded_problem(loaded.resolved_json, loaded.name, "").resolved_json,
            loaded.resolved_json);
}

TEST(Drives, TakeControllersOfTheirInterface) {
  EXPECT_THAT(usage_error_of([] { load_driven({"control.controller=pid"}); }),
              AllOf(HasSubstr("control.controller is pid; controller 'pid' needs "
                              "control.interface = \"effort\", and it is \"velocity\", whose "
                              "controllers are pid_velocity")));
  EXPECT_THAT(
      usage_error_of([] { load_plain({"control.controller=pid_position"}); }),
      HasSubstr("controller 'pid_position' needs control.interface = \"position\", and it is "
                "\"effort\""));
  EXPECT_THAT(usage_error_of([] { load_plain({"control.interface=torque"}); }),
              HasSubstr("effort, velocity, position"));
  const LoadedProblem driven = load_driven({});
  EXPECT_THAT(usage_error_of([&] {
                driven.tracking()->check_design(load_plain().tracking()->config().start);
              }),
              HasSubstr("controller 'pid' needs control.interface = \"effort\""));
}

TEST(Drives, OwnTheirSettings) {
  for (const char* setting : {"control.bandwidth_hz=20", "control.delay_s=0",
                              "control.resolution_m=1e-6", "control.resolution_rad=1e-6"}) {
    EXPECT_THAT(usage_error_of([&] { load_plain({setting}); }),
                HasSubstr("it belongs to drives with an inner loop; set control.interface to "))
        << setting;
  }
}

// The message says how many steps are needed: with so many the problem loads, with fewer not.
TEST(Drives, AreRefusedIfTheStepsCannotResolveThem) {
  const auto load = [](int substeps) {
    return load_plain(
        {"control.interface=position", "physics.substeps=" + std::to_string(substeps)});
  };
  const std::string message = usage_error_of([&] { load(1); });
  EXPECT_THAT(message,
              HasSubstr("control.interface is position; the drives' bandwidth of 30 Hz is 1.88 "
                        "rad per physics step of 0.01 s; at most 0.5 can be simulated: set "
                        "physics.substeps to 4 or more, or control.bandwidth_hz to 7.88 or "
                        "less"));
  const std::string before = "set physics.substeps to ";
  const int needed = std::stoi(message.substr(message.find(before) + before.size()));
  EXPECT_GT(needed, 2);
  load(needed);
  EXPECT_THAT(usage_error_of([&] { load(needed - 1); }),
              HasSubstr(before + std::to_string(needed) + " or more"));
}

TEST(Drives, OfFiniteResolutionHaveNoJacobian) {
  const std::string engine = "physics.engine=articulated";
  EXPECT_TRUE(load_driven({engine}).problem->description().has_jacobian);
  const LoadedProblem coarse = load_driven({engine, "control.resolution_rad=1e-6"});
  EXPECT_FALSE(coarse.problem->description().has_jacobian);
  EXPECT_THAT(coarse.problem->description().jacobian_advice, HasSubstr("control.resolution_rad"));
}

TEST(Drives, StartFromGainsOfRos2Control) {
  const ProblemFolder folder;
  std::string joints;
  for (const char* joint : {"joint_1", "joint_2", "joint_3", "joint_4"}) {
    joints +=
        std::string("      ") + joint + ": {p: 12.0, i: 1.0, d: 0.1, ff_velocity_scale: 1.0}\n";
  }
  folder.write("c.yaml",
               "c:\n  ros__parameters:\n    command_interfaces: [velocity]\n    gains:\n" + joints);
  const std::string start = "variables.start=" + folder.path("c.yaml");
  const LoadedProblem loaded = load_driven({start, R"(variables.optimize=["gains"])"});
  EXPECT_EQ(loaded.tracking()->config().start.joints[3].gains,
            (std::vector<double>{12, 1, 0.1, 1}));
  EXPECT_EQ(loaded.problem->description().variables[0].start, 12);
  EXPECT_THAT(loaded.input_hashes, testing::Contains(testing::Key(HasSubstr("c.yaml"))));
  try {
    load_plain({start});
    ADD_FAILURE() << "not refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_data);
    EXPECT_THAT(error.what(), HasSubstr("c.yaml:3: controller 'c' commands 'velocity', but "
                                        "control.interface is 'effort'"));
  }
  EXPECT_THAT(usage_error_of([] { load_driven({"variables.start=none.yaml"}); }),
              HasSubstr("there is no file 'none.yaml'"));
}

}  // namespace
}  // namespace armwright
