// Tests designs and arms that make every engine diverge, produce NaN or, in ODE, abort. The
// evaluation fails with a reason, the run continues, and no file has a NaN or an infinity.
#include <cmath>

#include "faults/support.hpp"

namespace armwright::faults {
namespace {

struct Provocation {
  const char* name;
  Words settings;    // of the problem
  std::string gain;  // of every joint's proportional part; "": as in the published design
  std::string effort_n_m;
};

void PrintTo(const Provocation& provocation, std::ostream* out) {
  *out << provocation.name;
}

std::string make_design(const Provocation& provocation) {
  std::string text = "name = \"wild\"\ncontroller = \"pid\"\n";
  for (const char* joint : {"joint_1", "joint_2", "joint_3", "joint_4"}) {
    text += std::string("[[joint]]\nname = \"") + joint +
            "\"\np_n_m_per_rad = " + provocation.gain + "\ni_n_m_per_rad_s = " + provocation.gain +
            "\nd_n_m_s_per_rad = " + provocation.gain + "\neffort_min_n_m = -" +
            provocation.effort_n_m + "\neffort_max_n_m = " + provocation.effort_n_m + "\n";
  }
  return text;
}

class Physics : public testing::TestWithParam<std::tuple<const char*, Provocation>> {
 protected:
  static bool is_built(const std::string& engine) {
    const TemporaryFolder folder;
    return run_program(folder.path(), {"evaluate", "table-a5", "--problem", "q1-complex", "--cases",
                                       "1", "--engine", engine, "--quiet"})
               .exit_code == 0;
  }
};

TEST_P(Physics, FailsAsAValueWithAReason) {
  const auto& [engine, provocation] = GetParam();
  if (!is_built(engine)) {
    GTEST_SKIP() << "this build has no engine " << engine;
  }
  const TemporaryFolder folder;
  Words common = {"--engine", engine, "--set", "workspace.points=4"};
  for (const std::string& setting : provocation.settings) {
    common = common + Words{"--set", setting};
  }
  Words start;
  if (!provocation.gain.empty()) {
    write_text(folder / "wild.toml", make_design(provocation));
    start = {"--set", "variables.start=wild.toml"};
    const Outcome evaluated =
        run_program(folder.path(), Words{"evaluate", "wild.toml", "--problem", "q1-complex",
                                         "--cases", "3", "--json", "--quiet"} +
                                       common);
    EXPECT_THAT(evaluated.exit_code, AnyOf(0, 3)) << evaluated.err;
    write_text(folder / "evaluated.json", evaluated.out);
    expect_finite_numbers(folder / "evaluated.json");
    if (evaluated.exit_code == 3) {
      EXPECT_THAT(evaluated.out, AnyOf(HasSubstr("diverged"), HasSubstr("failed")));
    }
  }
  const Outcome outcome =
      run_program(folder.path(), Words{"optimize", "q1-complex", "--optimizer", "ga", "--budget",
                                       "70", "--set", "sets.test_cases=3", "--set",
                                       "sets.validation_cases=2", "--out", "run", "--quiet"} +
                                     common + start);
  ASSERT_THAT(outcome.exit_code, AnyOf(0, 3)) << outcome.err;
  const JournalContent journal = read_journal(folder / "run/journal");
  EXPECT_EQ(journal.training.size(), 70u);
  EXPECT_TRUE(journal.ended);
  const auto expect_numbers = [](const auto& records) {
    for (const EvaluationRecord& record : records) {
      const Evaluation& evaluation = record.evaluation;
      for (const double objective : evaluation.objectives) {
        EXPECT_TRUE(std::isfinite(objective)) << record.index;
      }
      for (const double metric : evaluation.metrics) {
        EXPECT_TRUE(std::isfinite(metric)) << record.index;
      }
      if (evaluation.status != EvaluationStatus::ok) {
        EXPECT_FALSE(evaluation.reason.empty()) << record.index;
      }
    }
  };
  expect_numbers(journal.training);
  expect_numbers(journal.judgements);
  for (const auto& entry : std::filesystem::directory_iterator(folder / "run")) {
    const auto extension = entry.path().extension();
    if (extension == ".json" || extension == ".csv" || extension == ".toml") {
      expect_finite_numbers(entry.path());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Engines, Physics,
    testing::Combine(
        testing::Values("ode", "articulated", "mujoco"),
        testing::Values(
            Provocation{"StiffGains", {}, "1e12", "1e9"},
            Provocation{"HugeTorque", {}, "1e160", "1e160"},
            Provocation{"NearTheLargestNumbers", {}, "1e300", "1e300"},
            Provocation{"TinyMasses", {"robot.mass_scale=0.01"}, "", ""},
            Provocation{
                "WildGravity", {"physics.gravity_m_per_s2=1000", "control.period_s=0.1"}, "", ""},
            Provocation{"AtTheLimits", {"workspace.centre_m=[2.2,0,1.2]"}, "", ""})),
    [](const auto& test) {
      return std::string(std::get<0>(test.param)) + std::get<1>(test.param).name;
    });

}  // namespace
}  // namespace armwright::faults
