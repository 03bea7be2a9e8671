#include "cli/terminal/typed_flags.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace armwright {
namespace {

TEST(TypedFlags, AnErrorNamesThePlaceOnceAndAsTheUserTypedIt) {
  const std::vector<std::string> words = {"armwright", "optimize", "q1-complex", "--tip", "tol"};
  EXPECT_EQ(name_typed_flags("--set robot.tip=\"tol\": robot.tip is \"tol\"; arm.urdf: unknown "
                             "link 'tol'; did you mean 'tool'?",
                             words),
            "--tip tol: arm.urdf: unknown link 'tol'; did you mean 'tool'?");
}

TEST(TypedFlags, AFlagWithoutUseForTheProblemSaysSo) {
  const std::vector<std::string> words = {"armwright", "optimize", "sphere", "--simd=avx2"};
  const std::string fault = "--set physics.simd=avx2: unknown key physics. Valid here: name, title";
  EXPECT_EQ(name_typed_flags(fault, words),
            "--simd avx2: this problem has no setting physics.simd");
  EXPECT_EQ(name_typed_flags("problem sphere: " + fault, words),
            "problem sphere: --simd avx2: this problem has no setting physics.simd");
}

TEST(TypedFlags, BothEnginesMayComeFromOneFlag) {
  const std::string fault = "--set physics.judging_engine=ode: must not be";
  EXPECT_EQ(name_typed_flags(fault, std::vector<std::string>{"evaluate", "--engine", "ode"}),
            "--engine ode: must not be");
  EXPECT_EQ(name_typed_flags(fault, std::vector<std::string>{"optimize", "--engine", "mujoco",
                                                             "--judging-engine", "ode"}),
            "--judging-engine ode: must not be");
}

TEST(TypedFlags, OtherMessagesStay) {
  const std::vector<std::string> set = {"armwright", "optimize", "--set", "physics.simd=avx2"};
  const std::vector<std::string> flag = {"armwright", "optimize", "--simd", "avx2"};
  for (const std::string message :
       {"--set physics.simd=avx2: unknown key physics", "no such file", ""}) {
    EXPECT_EQ(name_typed_flags(message, set), message);
  }
  // A command line that a message shows is no place.
  const std::string shown = "begun with:\n  armwright optimize --set physics.simd=avx2 x: y";
  EXPECT_EQ(name_typed_flags(shown, flag), shown);
  EXPECT_EQ(name_typed_flags("--set task.x=1: task.x is 1; must", flag),
            "--set task.x=1: task.x is 1; must");
}

}  // namespace
}  // namespace armwright
