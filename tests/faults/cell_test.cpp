// Tests cells of a comparison that are run one by one, as on a cluster, and are killed or fail at
// any moment. The next attempt ends with the same bytes, and a published cell is always complete.
#include "faults/support.hpp"

namespace armwright::faults {
namespace {

using Fault = FailingFiles::Fault;

class Cells : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directory(folder_ / "runs");
    write_text(folder_ / "plan.toml",
               "problems = [\"sphere\"]\noptimizers = [\"random\"]\nreplicates = 1\nbudget = 20\n"
               "baselines = false\n");
    const Outcome made =
        run({"compare", "plan.toml", "--executor", "script", "--out", "study", "--quiet"});
    ASSERT_EQ(made.exit_code, 0) << made.err;
    std::filesystem::copy(folder_ / "study", folder_ / "whole",
                          std::filesystem::copy_options::recursive);
    ASSERT_EQ(run({"cell", "whole", "0"}).exit_code, 0);
  }
  Outcome run(const Words& words, const Environment& environment = {}) {
    return run_program(folder_.path(), words, environment);
  }
  std::string make_study(const std::string& name) {
    std::filesystem::copy(folder_ / "study", folder_ / "runs" / name,
                          std::filesystem::copy_options::recursive);
    return "runs/" + name;
  }
  // A published cell is complete, and the next attempt ends like an undisturbed one.
  void expect_mended(const std::string& study) {
    const auto place = folder_ / study / kCell;
    if (std::filesystem::exists(place)) {
      EXPECT_EQ(read_text(place / "cell.json"), read_text(folder_ / "whole" / kCell / "cell.json"));
    }
    const Outcome next = run({"cell", study, "0"});
    ASSERT_EQ(next.exit_code, 0) << next.err;
    for (const char* file : {"cell.json", "result.json", "winner.toml"}) {
      EXPECT_EQ(read_text(place / file), read_text(folder_ / "whole" / kCell / file));
    }
    EXPECT_EQ(run({"status", study}).exit_code, 0);
  }
  static constexpr const char* kCell = "cells/sphere/random/r01";
  TemporaryFolder folder_;
};

TEST_F(Cells, KilledAtEveryWriteAndEveryRenameGoOnInTheNextAttempt) {
  for (const char* call : {"write", "rename"}) {
    FailingFiles files(folder_ / "runs", call);
    std::uint64_t at = 1;
    for (;; at += sample_or_all(2, 1)) {
      SCOPED_TRACE(call + std::to_string(at));
      const std::string study = make_study(call + std::to_string(at));
      const Outcome killed = run({"cell", study, "0"}, files.make_environment(Fault::kill, at, 0));
      if (killed.exit_code == 0) {
        break;
      }
      ASSERT_EQ(killed.exit_code, -SIGKILL) << killed.err;
      expect_mended(study);
    }
    EXPECT_GE(at, 6U) << call;
  }
}

TEST_F(Cells, OnADiskThatFailsTellItAndGoOnLater) {
  for (const char* call : {"write", "rename"}) {
    FailingFiles files(folder_ / "runs", call);
    for (std::uint64_t at = 1;; at += sample_or_all(2, 1)) {
      SCOPED_TRACE(call + std::to_string(at));
      const std::string study = make_study(call + std::to_string(at));
      const Outcome failed =
          run({"cell", study, "0"}, files.make_environment(Fault::for_ever, at, ENOSPC));
      if (files.count() < at) {
        EXPECT_EQ(failed.exit_code, 0);
        break;
      }
      EXPECT_EQ(failed.exit_code, 74) << failed.err;
      EXPECT_THAT(failed.err, HasSubstr("No space left on device"));
      expect_mended(study);
    }
  }
}

}  // namespace
}  // namespace armwright::faults
