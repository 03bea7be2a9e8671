// Tests names, texts and paths from outside: none of them runs as a script or a formula, or changes
// a terminal, and every folder name that the system allows works. Numbers have a decimal point in
// every language.
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "faults/support.hpp"

namespace armwright::faults {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class Names : public testing::Test {
 protected:
  Outcome run(const Words& words, const Environment& environment = {}) {
    return run_program(folder_.path(), words, environment);
  }
  void copy_robot(const std::string& name, const std::string& robot) {
    std::string urdf = read_text(ARMWRIGHT_CONFIGS "/robots/irb4600_40_255.urdf");
    const std::string before = "<robot name=\"irb4600_40_255\">";
    urdf.replace(urdf.find(before), before.size(), "<robot name=\"" + robot + "\">");
    write_text(folder_ / name, urdf);
  }
  // Expects that neither output has control characters for a terminal.
  static void expect_harmless(const Outcome& outcome) {
    for (const std::string* text : {&outcome.out, &outcome.err}) {
      EXPECT_THAT(*text, AllOf(Not(HasSubstr("\x1b")), Not(HasSubstr("\x07")),
                               Not(HasSubstr("\u202e")), Not(HasSubstr("\r"))));
      EXPECT_EQ(text->find('\0'), std::string::npos);
    }
    EXPECT_THAT(outcome.err, Not(HasSubstr("a bug in armwright")));
    EXPECT_LT(outcome.err.size(), 20'000u);
  }
  TemporaryFolder folder_;
};

const std::string kProblem =
    kShortProblem + "robot.urdf = \"arm.urdf\"\nvariables.start = \"table-a1\"\n";

// An XML name may contain text that is markup in HTML. Control characters are refused.
TEST_F(Names, OfARobotAreTextInThePage) {
  write_text(folder_ / "problem.toml", kProblem);
  copy_robot("arm.urdf", "&lt;/script&gt;&lt;script&gt;document.title='PWNED'&lt;/script&gt;");
  const Outcome made =
      run({"optimize", "problem.toml", "--optimizer", "ga", "--budget", "35", "--out", "run"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const Outcome report = run({"report", "run", "--out", "run.html"});
  ASSERT_EQ(report.exit_code, 0) << report.err;
  EXPECT_THAT(read_text(folder_ / "run.html"), AllOf(Not(HasSubstr("<script>document.title")),
                                                     HasSubstr("Content-Security-Policy")));
  for (const std::string& name :
       {std::string("a\x1b[2Jb"), std::string("a\nb\u202ec"), std::string("a\xff\xfe"),
        std::string("a\0b", 3), std::string("a&#27;[31m"), std::string("a&#8238;b")}) {
    copy_robot("arm.urdf", name);
    const Outcome outcome =
        run({"optimize", "problem.toml", "--optimizer", "ga", "--budget", "35", "--out", "other"});
    expect_harmless(outcome);
    EXPECT_THAT(outcome.exit_code, AnyOf(0, 2, 4)) << outcome.err;
    fs::remove_all(folder_ / "other");
  }
}

TEST_F(Names, OfAProblemsTextsAreHarmlessEverywhere) {
  copy_robot("arm.urdf", "arm");
  for (const std::string& title :
       {std::string("</script><script>alert(1)</script>"), std::string("=cmd|'/C calc'!A0"),
        std::string("\\u001b[2J\\u0007"), std::string("\\u202egnp.exe"), std::string("a\\nb"),
        std::string(4096, 'x')}) {
    SCOPED_TRACE(title.substr(0, 30));
    write_text(folder_ / "problem.toml", "title = \"" + title + "\"\n" + kProblem);
    const Outcome made =
        run({"optimize", "problem.toml", "--optimizer", "ga", "--budget", "35", "--out", "run"});
    expect_harmless(made);
    if (made.exit_code == 0) {
      const Outcome report = run({"report", "run", "--out", "run.html"});
      EXPECT_EQ(report.exit_code, 0) << report.err;
      expect_harmless(report);
      EXPECT_THAT(read_text(folder_ / "run.html"), Not(HasSubstr("<script>alert(1)")));
      expect_harmless(run({"show", "run"}));
    }
    expect_harmless(run({"list", "problems", "./problem.toml"}));
    fs::remove_all(folder_ / "run");
  }
}

// Text that a spreadsheet would run as a formula gets an apostrophe in front; numbers stay numbers.
TEST_F(Names, OfAStudyAreNoFormulasInItsTables) {
  const Words labels = {"=cmd|' /C calc'!A0", "+1+1",     "-2+3", "@SUM(A1)",
                        "</script><b>",       "'quoted'", "a,b",  std::string(150, 'n')};
  std::string study = "problems = [\"sphere\"]\nreplicates = 2\nbudget = 40\nbaselines = false\n";
  for (const std::string& label : labels) {
    study += "[[optimizer]]\nname = \"random\"\nlabel = " + json(label).dump() + "\n";
  }
  write_text(folder_ / "study.toml", study);
  const Outcome outcome = run({"compare", "study.toml", "--out", "study", "--quiet"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  expect_harmless(outcome);
  ASSERT_EQ(run({"export", "study", "--format", "csv", "--out", "csv"}).exit_code, 0);
  int tables = 0;
  for (const char* below : {"study", "csv"}) {
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / below)) {
      if (entry.path().extension() != ".csv") {
        continue;
      }
      ++tables;
      const std::string text = read_text(entry.path());
      for (const char* formula : {"=cmd", "+1+1", "-2+3", "@SUM"}) {
        for (const char* before : {"\n", ",", "\"", "\r"}) {
          EXPECT_THAT(text, Not(HasSubstr(std::string(before) + formula))) << entry.path();
        }
      }
    }
  }
  EXPECT_GT(tables, 5);
  EXPECT_THAT(read_text(folder_ / "study/tables/cells.csv"), HasSubstr(",'=cmd|' /C calc'!A0,"));
  EXPECT_THAT(read_text(folder_ / "study/tables/cells.csv"), HasSubstr(",'-2+3,1,"));
  const Outcome report = run({"report", "study", "--out", "study.html"});
  ASSERT_EQ(report.exit_code, 0) << report.err;
  EXPECT_THAT(read_text(folder_ / "study.html"), Not(HasSubstr("</script><b>")));
  for (const std::string& label :
       {std::string("\\u001b[2J"), std::string("a\\u202eb"), std::string("a\\u0000b"),
        std::string("a\\nb"), std::string("\\u009b2J"), std::string(4096, 'n')}) {
    write_text(folder_ / "bad.toml",
               "problems = [\"sphere\"]\nbudget = 40\n[[optimizer]]\nname = \"random\"\n"
               "label = \"" +
                   label + "\"\n");
    const Outcome refused = run({"compare", "bad.toml", "--out", "bad"});
    expect_harmless(refused);
    EXPECT_EQ(refused.exit_code, 2) << refused.err;
    EXPECT_THAT(refused.err, AnyOf(HasSubstr(" label '"), HasSubstr("bad.toml")));
  }
}

TEST_F(Names, InTheCommandLineAreShownHarmlessly) {
  for (const std::string& name :
       {std::string("\x1b[2J"), std::string("a\nb"), std::string("\xff\xfe"), std::string("\u202e"),
        std::string(4096, 'n'), std::string("=cmd|x"), std::string("\xc2\x9b") + "2J"}) {
    SCOPED_TRACE(name.substr(0, 10));
    for (const Words& command :
         {Words{name}, Words{"list", "problems", name}, Words{"list", "optimizers", name},
          Words{"optimize", name}, Words{"optimize", "sphere", "--optimizer", name},
          Words{"optimize", "sphere", "--optimizer", "exec:" + name},
          Words{"optimize", "sphere", "--optimizer", "ga", "--opt", name},
          Words{"optimize", "sphere", "--optimizer", "ga", "--set", name},
          Words{"optimize", "sphere", "--optimizer", "ga", "--seed", name}, Words{"compare", name},
          Words{"evaluate", name}, Words{"show", name}, Words{"report", name},
          Words{"export", name, "--format", "csv"}, Words{"--" + name}}) {
      const Outcome outcome = run(command);
      expect_harmless(outcome);
      EXPECT_THAT(outcome.exit_code, AnyOf(2, 4, 74)) << command.front() << ": " << outcome.err;
    }
  }
}

// The output of a plugin goes into a file unchanged, and to the terminal without control codes.
TEST_F(Names, OfAPluginAndWhatItPrintsAreHarmlessOnTheTerminal) {
  write_text(folder_ / "evil.py",
             "import json, sys\n"
             "sys.stdin.readline()\n"
             "sys.stderr.buffer.write(b'\\x1b]0;PWNED\\x07\\x1b[2J\\xff\\n'); sys.stderr.flush()\n"
             "print(json.dumps({'type': 'description', 'protocol': 1, 'name': sys.argv[1], "
             "'summary': '\\x1b[2J', 'source': '', 'capabilities': [], 'options': []}), "
             "flush=True)\n"
             "sys.stdin.readline()\n"
             "sys.exit(3)\n");
  for (const std::string name : {"evil", "=evil", "<b>evil", "e\u202evil"}) {
    const Outcome outcome = run({"optimize", "sphere", "--budget", "5", "--out", "run",
                                 "--optimizer", "exec:python3 evil.py '" + name + "'"});
    expect_harmless(outcome);
    EXPECT_THAT(outcome.exit_code, AnyOf(2, 3, 4)) << outcome.err;
    fs::remove_all(folder_ / "run");
  }
  expect_harmless(run({"list", "optimizers", "exec:python3 evil.py evil"}));
}

// Any folder name works. If the system refuses a name, the message says so.
TEST_F(Names, OfFoldersMayBeAnything) {
  std::string deep = "deep";
  while (deep.size() + folder_.path().native().size() < 460) {
    deep += "/dddddddd";
  }
  ASSERT_EQ(run(make_run("whole")).exit_code, 0);
  for (const std::string& name :
       {std::string("with space"), std::string("new\nline"), std::string("bad\xff\xfe"),
        std::string("\x1b[31mred"), std::string("-dash"), std::string("quote'\"`$(x)"),
        std::string("\u202eback"), deep}) {
    SCOPED_TRACE(name.substr(0, 20));
    const std::string out = "./" + name;
    const Outcome outcome = run(make_run(out));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    expect_harmless(outcome);
    expect_same_run(folder_ / "whole", folder_ / name);
    fs::remove(folder_ / name / "result.json");
    EXPECT_EQ(run(make_run(out)).exit_code, 0);  // resumed
    for (const Words& command : {Words{"show", out}, Words{"report", out, "--out", "page.html"},
                                 Words{"export", out, "--format", "csv", "--out", "table"}}) {
      const Outcome reader = run(command);
      EXPECT_EQ(reader.exit_code, 0) << reader.err;
      expect_harmless(reader);
    }
    fs::remove_all(folder_ / "table");
  }
  for (const std::string& name : {std::string(300, 'n'), std::string(5000, 'n')}) {
    const Outcome outcome = run(make_run(name));
    EXPECT_THAT(outcome.exit_code, AnyOf(2, 74));
    EXPECT_THAT(outcome.err,
                AnyOf(HasSubstr("File name too long"), HasSubstr("is too long a path")));
  }
}

// SQLite cannot open a file with a path of more than 512 bytes. The run must not fail at its end.
TEST_F(Names, OfFoldersTooDeepForTheDatabaseAreRefusedBeforeTheRun) {
  std::string deep = "deep";
  while (deep.size() < 3000) {
    deep += "/" + std::string(200, 'd');
  }
  const Outcome outcome = run(make_run(deep));
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("is too long a path"));
  EXPECT_FALSE(fs::exists(folder_ / "deep"));
}

// Tests every file that is read, with a name or a content that is not UTF-8.
TEST_F(Names, AndTextsThatAreNoUtf8) {
  const std::string odd = "b\xff\xfe d\n";
  fs::create_directory(folder_ / odd);
  fs::copy(ARMWRIGHT_CONFIGS "/robots/irb4600_40_255.urdf", folder_ / odd / "arm.urdf");
  write_text(folder_ / odd / "problem.toml", kProblem);
  const Outcome outcome = run(
      {"optimize", odd + "/problem.toml", "--optimizer", "ga", "--budget", "35", "--out", "run"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  expect_harmless(outcome);
  // The name of the robot's file goes into the manifest.
  fs::copy(folder_ / odd / "arm.urdf", folder_ / odd / "a\xff.urdf");
  fs::copy(folder_ / odd / "arm.urdf", folder_ / "a\xff.urdf");
  const Outcome robot = run({"optimize", "q1-complex", "--optimizer", "ga", "--set",
                             "robot.urdf=a\xff.urdf", "--budget", "35", "--out", "other"});
  EXPECT_THAT(robot.exit_code, AnyOf(0, 2, 4)) << robot.err;
  expect_harmless(robot);
  // The name of a plugin.
  fs::copy(get_plugin("good"), folder_ / odd / "good\xff.so");
  fs::copy(get_script("good.py"), folder_ / "g\xff.py");
  for (const std::string& plugin :
       {"./" + odd + "/good\xff.so", std::string("exec:python3 g\xff.py")}) {
    const Outcome plugged =
        run({"optimize", "sphere", "--budget", "20", "--out", "plugged", "--optimizer", plugin});
    EXPECT_EQ(plugged.exit_code, 2) << plugged.err;
    EXPECT_THAT(plugged.err, HasSubstr("is not printable UTF-8"));
    expect_harmless(plugged);
    fs::remove_all(folder_ / "plugged");
  }
  write_text(folder_ / "design.toml", "name = \"\xff\"\n");
  write_text(folder_ / "cases.csv", "case,point,x_m,y_m,z_m\n0,0,1.4,\xff,0.9\n");
  for (const Words& command :
       {Words{"evaluate", "design.toml", "--problem", "q1-complex"},
        Words{"evaluate", "table-a5", "--problem", "q1-complex", "--test-cases", "cases.csv"},
        Words{"testset", "import", "cases.csv"}}) {
    const Outcome refused = run(command);
    EXPECT_THAT(refused.exit_code, AnyOf(2, 4)) << refused.err;
    expect_harmless(refused);
  }
}

// Creates a locale that writes numbers with a comma, because the system may not have one.
TEST_F(Names, NumbersHaveAPointInEveryLanguage) {
  const std::string make =
      "localedef -i de_DE -f UTF-8 '" + (folder_ / "de_DE.UTF-8").string() + "' > /dev/null 2>&1";
  if (std::system(make.c_str()) != 0 || !fs::exists(folder_ / "de_DE.UTF-8/LC_NUMERIC")) {
    GTEST_SKIP() << "localedef cannot make de_DE.UTF-8 here; the package locales is missing";
  }
  Environment german;
  german.variables = {{"LC_ALL", "de_DE.UTF-8"}, {"LOCPATH", folder_.path()}};
  Environment check = german;
  check.launcher = {"sh", "-c", "env printf '%.1f\\n' 1,5", "sh"};
  ASSERT_EQ(run({}, check).out, "1,5\n") << "the locale does not work";

  ASSERT_EQ(run(make_run("english")).exit_code, 0);
  const Outcome made = run(make_run("german"), german);
  ASSERT_EQ(made.exit_code, 0) << made.err;
  expect_same_run(folder_ / "english", folder_ / "german");
  for (const Words& command :
       {Words{"evaluate", "table-a10", "--cases", "2", "--json", "--quiet"},
        Words{"evaluate", "table-a10", "--cases", "2", "--quiet", "--engine", "mujoco", "--csv",
              "-"},
        Words{"optimize", "sphere", "--optimizer", "exec:python3 " + get_script("good.py"),
              "--budget", "20", "--json", "--quiet"},
        Words{"optimize", "rosenbrock", "--optimizer", "pagmo:de", "--budget", "200", "--json",
              "--quiet"},
        Words{"sweep", "q4-speed", "--values", "0.5,1.5", "--cases", "1", "--json", "--quiet"},
        Words{"compare", "--problems", "sphere", "--optimizers", "cmaes", "--replicates", "2",
              "--budget", "50", "--json", "--quiet"},
        Words{"plot", "german", "--figure", "convergence", "--out", "-"},
        Words{"list", "problems", "q1-complex"}}) {
    SCOPED_TRACE(command[0] + " " + command[1]);
    const Outcome here = run(command);
    fs::remove_all(folder_ / "results");
    const Outcome there = run(command, german);
    fs::remove_all(folder_ / "results");
    EXPECT_EQ(here.exit_code, there.exit_code) << there.err;
    EXPECT_EQ(here.out, there.out);
  }
}

}  // namespace
}  // namespace armwright::faults
