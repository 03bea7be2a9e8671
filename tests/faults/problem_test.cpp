// Tests runs on problems of users under SIGKILL: a resumed run ends with the same bytes, and the
// programs of the problem end with the run.
#include "base/random.hpp"
#include "faults/support.hpp"

namespace armwright::faults {
namespace {

using Fault = FailingFiles::Fault;

class KilledProblem : public testing::TestWithParam<const char*> {};

Words make_squares(const std::string& optimizer, const std::string& out, int jobs) {
  return {"optimize",    "exec:python3 " + get_script("problem.py") + " slow-squares",
          "--optimizer", optimizer,
          "--budget",    "600",
          "--out",       out,
          "--jobs",      std::to_string(jobs),
          "--quiet"};
}

TEST_P(KilledProblem, EndsWithTheSameBytesAfterTenKills) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "runs");
  const Outcome whole = run_program(folder.path(), make_squares(GetParam(), "whole", 2));
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  FailingFiles files(folder / "runs", "write");
  RandomStream random(std::string("test/killed-problem/") + GetParam(), 1);
  int kills = 0;
  for (int life = 0; life < 10; ++life) {
    const auto at = static_cast<std::uint64_t>(random.uniform(2, 9));
    Environment environment = files.make_environment(Fault::kill, at, 0);
    environment.variables.emplace_back("FAULTS_MARK", "problem");
    const Outcome killed = run_program(
        folder.path(), make_squares(GetParam(), "runs/killed", 1 + life % 2), environment);
    kills += killed.exit_code == -SIGKILL ? 1 : 0;
    ASSERT_TRUE(wait_until([] { return list_processes("problem").empty(); }))
        << "programs outlive the run";
  }
  EXPECT_EQ(kills, 10);
  const Outcome last = run_program(folder.path(), make_squares(GetParam(), "runs/killed", 2));
  ASSERT_EQ(last.exit_code, 0) << last.err;
  expect_same_run(folder / "whole", folder / "runs/killed");
}

INSTANTIATE_TEST_SUITE_P(Optimizers, KilledProblem,
                         testing::Values("ga", "cmaes", "pagmo:de", "nlopt:cobyla", "ceres:lm",
                                         "random"),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::erase(name, ':');
                           return name;
                         });

}  // namespace
}  // namespace armwright::faults
