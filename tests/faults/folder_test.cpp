// Tests folders that vanish, move, become files or cannot be written, before and during a run. The
// exit code is 74, the message names the folder or file, and other files are unchanged.
#include <sys/mount.h>
#include <unistd.h>

#include <cerrno>

#include "faults/support.hpp"

namespace armwright::faults {
namespace {

namespace fs = std::filesystem;
using Fault = FailingFiles::Fault;

Words make_endless_run(const std::string& out) {
  return {"optimize", "q1-complex", "--optimizer", "ga",    "--engine", "ode",    "--budget",
          "10000000", "--jobs",     "1",           "--out", out,        "--quiet"};
}

class Folders : public testing::Test {
 protected:
  Outcome run(const Words& words, const Environment& environment = {}) {
    return run_program(folder_.path(), words, environment);
  }
  // Lets a run begin, changes its folder and waits for its end.
  Outcome disturb(const std::function<void()>& action) {
    Program program(folder_.path(), make_endless_run("run"));
    EXPECT_TRUE(wait_until([&] { return get_size(folder_ / "run/journal") > 1000; }));
    action();
    EXPECT_TRUE(wait_until([&] { return !program.is_running(); })) << "it writes on, but where?";
    return program.wait();
  }
  TemporaryFolder folder_;
};

TEST_F(Folders, RemovedDuringARun) {
  const Outcome outcome = disturb([&] { fs::remove_all(folder_ / "run"); });
  EXPECT_EQ(outcome.exit_code, 74);
  EXPECT_THAT(outcome.err, HasSubstr("error: run/journal: was deleted while the run was writing"));
}

TEST_F(Folders, MadeAFileDuringARun) {
  const Outcome outcome = disturb([&] {
    fs::remove_all(folder_ / "run");
    write_text(folder_ / "run", "precious");
  });
  EXPECT_EQ(outcome.exit_code, 74);
  EXPECT_THAT(outcome.err, HasSubstr("error: run/journal: was deleted"));
  EXPECT_EQ(read_text(folder_ / "run"), "precious");
}

// The open journal moves with the folder. The derived files cannot be written at the end, and the
// run can be completed at its new place.
TEST_F(Folders, RenamedDuringARun) {
  ASSERT_EQ(run(make_run("whole", "3500")).exit_code, 0);
  Program program(folder_.path(), make_run("run", "3500"));
  ASSERT_TRUE(wait_until([&] { return get_size(folder_ / "run/journal") > 100; }));
  fs::rename(folder_ / "run", folder_ / "elsewhere");
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 74);
  EXPECT_THAT(outcome.err, HasSubstr("error: run/"));
  EXPECT_EQ(run(make_run("elsewhere", "3500")).exit_code, 0);
  expect_same_run(folder_ / "whole", folder_ / "elsewhere");
}

TEST_F(Folders, RemovedDuringAComparison) {
  Program program(folder_.path(), {"compare", "--problems", "q1-complex", "--optimizers",
                                   "ga,cmaes", "--replicates", "2", "--budget", "100000",
                                   "--engine", "ode", "--jobs", "2", "--out", "study", "--quiet"});
  ASSERT_TRUE(wait_until(
      [&] { return get_size(folder_ / "study/cells/q1-complex/ga/r01/journal") > 100; }));
  fs::remove_all(folder_ / "study");
  ASSERT_TRUE(wait_until([&] { return !program.is_running(); }));
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 74);
  EXPECT_THAT(outcome.err, HasSubstr("error: study/"));
}

TEST_F(Folders, ReadOnlyForTheUserBeforeAndDuringARun) {
  open_to_all(folder_.path());
  fs::create_directory(folder_ / "locked");
  fs::permissions(folder_ / "locked", fs::perms::owner_read | fs::perms::owner_exec |
                                          fs::perms::others_read | fs::perms::others_exec);
  Environment user;
  user.launcher = become_ordinary_user();
  const Outcome before = run(make_run("locked/run"), user);
  EXPECT_EQ(before.exit_code, 74);
  EXPECT_THAT(before.err, HasSubstr("error: locked/run: cannot create this folder: Permission "
                                    "denied"));
  // The folder becomes read-only during the run. The open journal is still written to its end; the
  // derived files must wait.
  ASSERT_EQ(run(make_run("whole", "3500"), user).exit_code, 0);
  Program program(folder_.path(), make_run("run", "3500"), user);
  ASSERT_TRUE(wait_until([&] { return get_size(folder_ / "run/journal") > 100; }));
  fs::permissions(folder_ / "run", fs::perms::owner_read | fs::perms::owner_exec |
                                       fs::perms::others_read | fs::perms::others_exec);
  const Outcome during = program.wait();
  EXPECT_EQ(during.exit_code, 74);
  EXPECT_THAT(during.err, AllOf(HasSubstr("error: run/"), HasSubstr("Permission denied")));
  fs::permissions(folder_ / "run", fs::perms::all);
  EXPECT_EQ(run(make_run("run", "3500"), user).exit_code, 0);
  expect_same_run(folder_ / "whole", folder_ / "run");
}

TEST_F(Folders, OnAReadOnlyFileSystem) {
  fs::create_directory(folder_ / "disk");
  if (::mount("none", (folder_ / "disk").c_str(), "tmpfs", 0, "size=8m") != 0) {
    GTEST_SKIP() << "mounting a file system is not permitted here";
  }
  const auto remount = [&](unsigned long flags) {
    return ::mount("none", (folder_ / "disk").c_str(), "tmpfs", MS_REMOUNT | flags, "size=8m");
  };
  const Outcome first = run(make_run("disk/run"));
  EXPECT_EQ(first.exit_code, 0);
  EXPECT_EQ(remount(MS_RDONLY), 0);
  const Outcome fresh = run(make_run("disk/another"));
  EXPECT_EQ(fresh.exit_code, 74);
  EXPECT_THAT(fresh.err, HasSubstr("error: disk/another: cannot create this folder: Read-only"));
  const Outcome finished = run(make_run("disk/run"));
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_EQ(finished.out, first.out);
  // The commands that show, export and draw only need to read.
  EXPECT_EQ(run({"show", "disk/run"}).exit_code, 0);
  EXPECT_EQ(run({"export", "disk/run", "--format", "csv", "--out", "table"}).exit_code, 0);
  EXPECT_EQ(run({"report", "disk/run", "--out", "run.html"}).exit_code, 0);
  EXPECT_EQ(remount(0), 0);
  ::umount2((folder_ / "disk").c_str(), MNT_DETACH);
}

TEST_F(Folders, ReadOnlyInputsAreInputs) {
  open_to_all(folder_.path());
  fs::create_directory(folder_ / "inputs");
  write_text(folder_ / "inputs/problem.toml",
             kShortProblem + "[robot]\nurdf = \"arm.urdf\"\n[variables]\nstart = \"table-a1\"\n");
  fs::copy(ARMWRIGHT_CONFIGS "/robots/irb4600_40_255.urdf", folder_ / "inputs/arm.urdf");
  for (const char* path : {"inputs/problem.toml", "inputs/arm.urdf", "inputs"}) {
    fs::permissions(folder_ / path,
                    fs::perms::owner_write | fs::perms::group_write | fs::perms::others_write,
                    fs::perm_options::remove);
  }
  Environment user;
  user.launcher = become_ordinary_user();
  const Outcome outcome = run({"optimize", "inputs/problem.toml", "--optimizer", "ga", "--budget",
                               "35", "--out", "run", "--quiet"},
                              user);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  fs::permissions(folder_ / "inputs/arm.urdf", fs::perms::none);
  const Outcome unreadable = run(
      {"optimize", "inputs/problem.toml", "--optimizer", "ga", "--budget", "35", "--out", "other"},
      user);
  EXPECT_EQ(unreadable.exit_code, 74);
  EXPECT_THAT(unreadable.err, AllOf(HasSubstr("arm.urdf"), HasSubstr("Permission denied")));
  fs::permissions(folder_ / "inputs", fs::perms::all);
}

// Some network file systems cannot sync: the error of fsync is then ignored.
TEST_F(Folders, WithoutSync) {
  fs::create_directory(folder_ / "runs");
  ASSERT_EQ(run(make_run("runs/whole")).exit_code, 0);
  for (const char* call : {"fsync", "fdatasync"}) {
    FailingFiles files(folder_ / "runs", call);
    const std::string out = std::string("runs/") + call;
    const Outcome outcome = run(make_run(out), files.make_environment(Fault::for_ever, 1, EINVAL));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_GT(files.count(), 0u);
    expect_same_run(folder_ / "runs/whole", folder_ / out);
  }
}

}  // namespace
}  // namespace armwright::faults
