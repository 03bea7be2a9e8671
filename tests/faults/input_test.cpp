// Tests inputs that change during a run, cannot be used or are hostile. They are refused within a
// second, the message names the difference or the line, and no file is written.

#include <algorithm>

#include "base/remove_checksums.hpp"
#include "faults/support.hpp"

namespace armwright::faults {
namespace {

namespace fs = std::filesystem;

// Returns the content of every file below a folder, by name.
std::map<std::string, std::string> read_all(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file() && entry.path().filename() != "lock") {
      files[fs::relative(entry.path(), folder)] = read_text(entry.path());
    }
  }
  return files;
}

void replace_in(const fs::path& file, const std::string& before, const std::string& after) {
  std::string text = read_text(file);
  const std::size_t at = text.find(before);
  ASSERT_NE(at, std::string::npos) << before;
  ASSERT_EQ(before.size(), after.size()) << "one byte is to change, no more";
  write_text(file, text.replace(at, before.size(), after));
}

class Inputs : public testing::Test {
 protected:
  Outcome run(const Words& words, const Environment& environment = {}) {
    return run_program(folder_.path(), words, environment);
  }
  TemporaryFolder folder_;
};

// A problem that names a file of each kind.
class ChangedInputs : public Inputs {
 protected:
  void SetUp() override {
    fs::copy(ARMWRIGHT_CONFIGS "/robots/irb4600_40_255.urdf", folder_ / "arm.urdf");
    fs::copy(ARMWRIGHT_CONFIGS "/designs/table-a1.toml", folder_ / "start.toml");
    fs::copy(ARMWRIGHT_CONFIGS "/perturbations/masses-10.toml", folder_ / "plant.toml");
    fs::copy(get_plugin("good"), folder_ / "good.so");
    fs::copy(get_script("good.py"), folder_ / "good.py");
    write_text(folder_ / "problem.toml",
               kShortProblem +
                   "[robot]\nurdf = \"arm.urdf\"\n[variables]\nstart = \"start.toml\"\n"
                   "[perturbation]\npreset = \"plant.toml\"\n");
  }

  static Words make(const Words& more) {
    const bool has_budget = std::ranges::count(more, "--budget") > 0;
    const bool has_optimizer = std::ranges::count(more, "--optimizer") > 0;
    return Words{"optimize", "problem.toml", "--out", "run", "--quiet"} +
           (has_optimizer ? Words{} : Words{"--optimizer", "ga"}) +
           (has_budget ? Words{} : Words{"--budget", "70"}) + more;
  }

  // Changes the input of a finished run with `change`, and expects that the run is neither resumed
  // nor changed.
  void expect_refused(const Words& optimizer, const std::function<void()>& change,
                      const testing::Matcher<const std::string&>& message,
                      const Words& instead = {}) {
    fs::remove_all(folder_ / "run");
    ASSERT_TRUE(has_ended(run(make(optimizer))));
    fs::remove(folder_ / "run/result.json");  // so that the run can be resumed
    const auto before = read_all(folder_ / "run");
    change();
    const Outcome outcome = run(make(instead.empty() ? optimizer : instead));
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("error: run holds a run with another configuration"),
                                   message, HasSubstr("use --new or --out for another folder")));
    EXPECT_EQ(read_all(folder_ / "run"), before);
  }
};

TEST_F(ChangedInputs, AByteOfTheProblem) {
  expect_refused(
      {"--optimizer", "ga"},
      [&] { replace_in(folder_ / "problem.toml", "points = 4", "points = 5"); },
      HasSubstr("problem.workspace.points: recorded 4, now 5"));
}

TEST_F(ChangedInputs, AByteOfTheRobot) {
  expect_refused(
      {"--optimizer", "ga"}, [&] { replace_in(folder_ / "arm.urdf", "229.6", "229.7"); },
      HasSubstr("the input 'arm.urdf' has changed since the run began (SHA-256: recorded \""));
}

TEST_F(ChangedInputs, AByteOfTheDesign) {
  expect_refused(
      {"--optimizer", "ga"},
      [&] { replace_in(folder_ / "start.toml", "p_n_m_per_rad = 45000", "p_n_m_per_rad = 46000"); },
      AllOf(HasSubstr("start.toml"), HasSubstr("recorded")));
}

TEST_F(ChangedInputs, AByteOfThePerturbation) {
  expect_refused(
      {"--optimizer", "ga"},
      [&] { replace_in(folder_ / "plant.toml", "mass_relative = 0.1", "mass_relative = 0.2"); },
      AllOf(HasSubstr("perturbation"), HasSubstr("recorded")));
}

TEST_F(ChangedInputs, AByteOfALibrary) {
  expect_refused(
      {"--optimizer", "./good.so"},
      [&] {
        // It belongs to the table of sections, which nobody reads who loads a library.
        std::string bytes = read_text(folder_ / "good.so");
        bytes.back() ^= 1;
        write_text(folder_ / "good.so", bytes);
      },
      AllOf(HasSubstr("good.so' has changed since the run began"), HasSubstr("now \"")));
}

TEST_F(ChangedInputs, AByteOfAProgram) {
  expect_refused(
      {"--optimizer", "exec:python3 good.py"},
      [&] { replace_in(folder_ / "good.py", "1013904223", "1013904224"); },
      AllOf(HasSubstr("good.py' has changed since the run began"), HasSubstr("now \"")));
}

TEST_F(ChangedInputs, SeedOptionBudgetAndOptimizer) {
  const auto nothing = [] {};
  expect_refused({"--seed", "1"}, nothing, HasSubstr("run.seed: recorded 1, now 2"),
                 {"--seed", "2"});
  expect_refused({"--opt", "population=10"}, nothing,
                 HasSubstr("run.options.population: recorded 10, now 11"),
                 {"--opt", "population=11"});
  expect_refused({"--optimizer", "ga"}, nothing, HasSubstr("run.budget: recorded 70, now 69"),
                 {"--optimizer", "ga", "--budget", "69"});
  expect_refused({"--optimizer", "ga"}, nothing,
                 HasSubstr("run.optimizer: recorded \"ga\", now \"cmaes\""),
                 {"--optimizer", "cmaes"});
}

// Another build may compute the same. The differences are reported, and the journal decides.
TEST_F(ChangedInputs, AnotherBuildIsWarnedOf) {
  ASSERT_TRUE(has_ended(run(make({}))));
  const std::string result = read_text(folder_ / "run/result.json");
  fs::remove(folder_ / "run/result.json");
  remove_checksums(folder_ / "run");
  std::string manifest = read_text(folder_ / "run/manifest.json");
  const std::size_t at = manifest.find("\"version\": \"");
  ASSERT_NE(at, std::string::npos);
  write_text(folder_ / "run/manifest.json", manifest.insert(at + 12, "9"));
  const Outcome outcome = run(make({}));
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.err,
              AllOf(HasSubstr("warning: version was '9"), HasSubstr("when the run began"),
                    HasSubstr("if the results differ, resuming stops with an error")));
  EXPECT_EQ(read_text(folder_ / "run/result.json"), result);
}

TEST_F(ChangedInputs, AByteOfAStudysProblem) {
  const Words command = {"compare",      "--problems", "./problem.toml", "--optimizers", "ga",
                         "--replicates", "2",          "--budget",       "70",           "--out",
                         "study",        "--quiet"};
  ASSERT_EQ(run(command).exit_code, 0);
  const auto before = read_all(folder_ / "study");
  replace_in(folder_ / "arm.urdf", "229.6", "229.7");
  const Outcome outcome = run(command);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("study holds a study whose cells could not be compared"),
                                 HasSubstr("recorded")));
  EXPECT_EQ(read_all(folder_ / "study"), before);
}

struct BadInput {
  const char* name;
  std::string file;
  std::string text;
  std::string message;
};

void PrintTo(const BadInput& bad, std::ostream* out) {
  *out << bad.name;
}

class BadInputs : public Inputs, public testing::WithParamInterface<BadInput> {};

std::string make_problem(const std::string& more) {
  return kShortProblem + "variables.start = \"table-a1\"\n" + more;
}
const std::string kArm = "robot.urdf = \"irb4600_40_255\"\n";
std::string make_robot(const std::string& more) {
  return "<?xml version=\"1.0\"?>\n<robot name=\"r\">\n" + more;
}
std::string nest(const std::string& opening, const std::string& middle, const std::string& closing,
                 int depth) {
  std::string text;
  for (int i = 0; i < depth; ++i) {
    text += opening;
  }
  text += middle;
  for (int i = 0; i < depth; ++i) {
    text += closing;
  }
  return text;
}

TEST_P(BadInputs, AreRefusedWithTheLineInASecond) {
  const BadInput& bad = GetParam();
  write_text(folder_ / "problem.toml", make_problem("[robot]\nurdf = \"arm.urdf\"\n"));
  fs::copy(ARMWRIGHT_CONFIGS "/robots/irb4600_40_255.urdf", folder_ / "arm.urdf");
  write_text(folder_ / bad.file, bad.text);
  Words command = {"optimize", "problem.toml", "--optimizer", "ga",
                   "--budget", "10",           "--out",       "run"};
  if (bad.file == "study.toml") {
    command = {"compare", "study.toml", "--out", "run"};
  } else if (bad.file == "design.toml") {
    command = {"evaluate", "design.toml", "--cases", "1", "--problem", "q1-complex"};
  } else if (bad.file == "cases.json" || bad.file == "cases.csv") {
    command = {"evaluate", "table-a5", "--problem", "q1-complex", "--test-cases", bad.file};
  }
  Outcome outcome;
  const double cpu_s = measure_children_s([&] { outcome = run(command); });
  EXPECT_THAT(outcome.exit_code, AnyOf(2, 4)) << outcome.err;
  EXPECT_THAT(outcome.err,
              AllOf(StartsWith("armwright: error: "), HasSubstr(bad.file), HasSubstr(bad.message)));
  EXPECT_LT(cpu_s, 1.0);
  EXPECT_LT(outcome.err.size(), 4000u);
  EXPECT_FALSE(fs::exists(folder_ / "run"));
}

INSTANTIATE_TEST_SUITE_P(
    Files, BadInputs,
    testing::Values(
        BadInput{"Toml", "problem.toml", "kind = \"tracking\"\n[task\nx = 1\n", "problem.toml:2"},
        BadInput{"TomlKey", "problem.toml", make_problem(kArm + "[task]\nsped_m_per_s = 1\n"),
                 "problem.toml:9: unknown key task.sped_m_per_s; did you mean"},
        BadInput{"TomlRange", "problem.toml", make_problem(kArm + "[task]\nspeed_m_per_s = -1\n"),
                 "problem.toml:9: task.speed_m_per_s is -1"},
        BadInput{"TomlNan", "problem.toml", make_problem(kArm + "[task]\nspeed_m_per_s = nan\n"),
                 "problem.toml:9: task.speed_m_per_s is nan"},
        BadInput{"TomlNested", "problem.toml", "x = " + nest("[", "1", "]", 100'000),
                 "problem.toml"},
        BadInput{"TomlUtf8", "problem.toml", make_problem("title = \"\xff\xfe\"\n"),
                 "problem.toml"},
        BadInput{"TomlNul", "problem.toml", make_problem(std::string("title = \"a\0b\"\n", 14)),
                 "problem.toml:7"},
        BadInput{"TomlItself", "problem.toml", "extends = \"./problem.toml\"\n", "problem.toml"},
        BadInput{"UrdfEmpty", "arm.urdf", "", "arm.urdf"},
        BadInput{"UrdfTorn", "arm.urdf", make_robot("<link name=\"a\">\n"), "arm.urdf"},
        BadInput{"UrdfNoJoints", "arm.urdf", make_robot("<link name=\"a\"/>\n</robot>\n"),
                 "arm.urdf"},
        BadInput{"UrdfNested", "arm.urdf", make_robot(nest("<a>", "", "</a>", 100'000)),
                 "arm.urdf"},
        BadInput{"UrdfEntities", "arm.urdf",
                 "<!DOCTYPE r [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;&a;\">]>\n"
                 "<robot name=\"&b;\"/>",
                 "arm.urdf"},
        BadInput{"Design", "design.toml", "name = \"d\"\n[[joint]]\nname = 3\n", "design.toml:3"},
        BadInput{"Study", "study.toml", "problems = [\"sphere\"]\noptimisers = [\"ga\"]\n",
                 "study.toml:2"},
        BadInput{"CasesJson", "cases.json", "{\"cases\": [[[1.4, 0, 0.9], [1e999, 0, 0]]]}",
                 "cases.json"},
        BadInput{"CasesNested", "cases.json", nest("[", "", "]", 100'000), "cases.json"},
        BadInput{"CasesCsv", "cases.csv", "case,point,x_m,y_m,z_m\n0,0,1.4,nan,0.9\n",
                 "cases.csv"}),
    [](const auto& test) { return test.param.name; });

// Meshes are only drawn: with a broken one the replay has no picture of it, and the report works.
TEST_F(Inputs, ABrokenMeshCostsOnlyItsPicture) {
  std::string urdf = read_text(ARMWRIGHT_CONFIGS "/robots/irb4600_40_255.urdf");
  const std::string sphere = "<geometry><box size=\"0.62 0.56 0.04\"/></geometry>";
  ASSERT_NE(urdf.find(sphere), std::string::npos);
  urdf.replace(urdf.find(sphere), sphere.size(),
               "<geometry><mesh filename=\"broken.stl\"/></geometry>");
  write_text(folder_ / "arm.urdf", urdf);
  write_text(folder_ / "broken.stl", "solid s\nfacet normal nan 0 1e999\nouter loop\n");
  write_text(folder_ / "problem.toml", make_problem("[robot]\nurdf = \"arm.urdf\"\n"));
  ASSERT_EQ(run({"optimize", "problem.toml", "--optimizer", "ga", "--budget", "35", "--out", "run",
                 "--quiet"})
                .exit_code,
            0);
  const Outcome report = run({"report", "run", "--out", "run.html"});
  EXPECT_EQ(report.exit_code, 0) << report.err;
  EXPECT_THAT(report.err + read_text(folder_ / "run.html"), HasSubstr("broken.stl"));
}

}  // namespace
}  // namespace armwright::faults
