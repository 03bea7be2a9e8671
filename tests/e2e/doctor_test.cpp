// armwright doctor as its users meet it: what it says of damage, that a repaired copy goes on to
// the same result, and what it says of the machine.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/resource.h>

#include <chrono>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

std::vector<std::string> make_run(const std::string& out, const std::string& optimizer = "ga",
                                  const std::string& budget = "700") {
  return {"optimize",    "q1-complex",
          "--engine",    "articulated",
          "--set",       "sets.test_cases=10",
          "--set",       "sets.validation_cases=4",
          "--optimizer", optimizer,
          "--budget",    budget,
          "--out",       out,
          "--quiet"};
}

void change(const std::filesystem::path& file, const std::function<void(std::string&)>& how) {
  std::string bytes = read_text(file);
  how(bytes);
  std::ofstream(file, std::ios::binary) << bytes;
}

void damage_journal(const std::filesystem::path& run) {
  change(run / "journal", [](std::string& bytes) {
    for (const std::size_t percent : {10, 50, 80}) {
      char& byte = bytes[bytes.size() * percent / 100];
      byte = static_cast<char>(byte ^ 0x11);
    }
  });
}

// As if its lines had no end.
std::string unwrap(const std::string& text) {
  std::string flat;
  for (const char c : text) {
    const bool is_blank = c == ' ' || c == '\n';
    if (!is_blank || (!flat.empty() && flat.back() != ' ')) {
      flat += is_blank ? ' ' : c;
    }
  }
  return flat;
}

class Doctor : public testing::Test {
 protected:
  Outcome run(const std::vector<std::string>& arguments, const Environment& environment = {}) {
    return run_program(folder_.path(), arguments, environment);
  }
  Outcome doctor(const std::vector<std::string>& more, const Environment& environment = {}) {
    std::vector<std::string> arguments = {"doctor"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments, environment);
  }
  TemporaryFolder folder_;
};

TEST_F(Doctor, ARepairedRunGoesOnToTheSameResult) {
  for (const std::string optimizer : {"ga", "cmaes"}) {
    ASSERT_EQ(run(make_run("whole-" + optimizer, optimizer)).exit_code, 0);
    const std::string hurt = "hurt-" + optimizer;
    ASSERT_EQ(run(make_run(hurt, optimizer)).exit_code, 0);
    const Outcome intact = doctor({hurt});
    EXPECT_EQ(intact.exit_code, 0) << intact.out;
    EXPECT_THAT(intact.out, HasSubstr("All stored files are intact."));
    damage_journal(folder_ / hurt);
    const std::string bytes = read_text(folder_ / hurt / "journal");

    const Outcome found = doctor({hurt});
    EXPECT_EQ(found.exit_code, 4);
    EXPECT_THAT(found.out, HasSubstr("DAMAGED  journal"));
    EXPECT_THAT(unwrap(found.out), HasSubstr("its checksum is wrong"));
    EXPECT_THAT(unwrap(found.out), HasSubstr("lost: 3 of 700 evaluations"));
    EXPECT_THAT(found.out, HasSubstr("armwright doctor " + hurt + " --repair\n"));
    EXPECT_THAT(found.out, HasSubstr("--quiet --out " + hurt + ".repaired\n"));

    const Outcome repaired = doctor({hurt, "--repair"});
    EXPECT_EQ(repaired.exit_code, 0) << repaired.err;
    EXPECT_THAT(unwrap(repaired.out), HasSubstr("697 evaluations kept, 3 to be made again"));
    EXPECT_EQ(read_text(folder_ / hurt / "journal"), bytes);
    EXPECT_EQ(read_text(folder_ / (hurt + ".repaired") / "journal.damaged"), bytes);
    const Outcome again = doctor({hurt, "--repair"});
    EXPECT_EQ(again.exit_code, 2);
    EXPECT_THAT(again.err, HasSubstr("is there already"));

    const Outcome resumed = run(make_run(hurt + ".repaired", optimizer));
    EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
    for (const char* file :
         {"result.json", "winner.toml", "convergence.csv", "winner-trajectory.csv"}) {
      EXPECT_EQ(read_text(folder_ / (hurt + ".repaired") / file),
                read_text(folder_ / ("whole-" + optimizer) / file));
    }
    EXPECT_EQ(doctor({hurt + ".repaired"}).exit_code, 0);
  }
}

TEST_F(Doctor, ARepairedComparisonGoesOnToTheSameTables) {
  const auto compare = [](const std::string& out) {
    return std::vector<std::string>{"compare", "--preset", "smoke", "--out", out, "--quiet"};
  };
  ASSERT_EQ(run(compare("whole")).exit_code, 0);
  ASSERT_EQ(run(compare("hurt")).exit_code, 0);
  damage_journal(folder_ / "hurt/cells/sphere/cmaes/r03");
  damage_journal(folder_ / "hurt/cells/rosenbrock/ga/r01");
  const Outcome found = doctor({"hurt"});
  EXPECT_EQ(found.exit_code, 4) << found.out;
  EXPECT_THAT(found.out, HasSubstr("cells/sphere/cmaes/r03/journal"));
  EXPECT_THAT(found.out, HasSubstr("cells/rosenbrock/ga/r01/journal"));
  EXPECT_THAT(found.out, HasSubstr("runs damaged"));
  ASSERT_EQ(doctor({"hurt", "--repair", "--out", "mended"}).exit_code, 0);
  const json survey = json::parse(doctor({"mended", "--json"}).out);
  EXPECT_FALSE(survey["damaged"].get<bool>());
  EXPECT_EQ(survey["cells"]["planned"].get<int>() - survey["cells"]["finished"].get<int>(), 2);
  const Outcome resumed = run({"compare", "mended/study.toml", "--out", "mended", "--quiet"});
  EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_EQ(read_text(folder_ / "mended/result.json"), read_text(folder_ / "whole/result.json"));
  EXPECT_EQ(read_text(folder_ / "mended/verdict.txt"), read_text(folder_ / "whole/verdict.txt"));
  EXPECT_EQ(doctor({"mended"}).exit_code, 0);
}

TEST_F(Doctor, EveryKindOfDamageIsNamed) {
  ASSERT_EQ(run(make_run("run", "ga", "140")).exit_code, 0);
  const auto expect = [&](const std::string& file, const std::string& what,
                          const std::function<void(std::string&)>& how) {
    const std::string before = read_text(folder_ / "run" / file);
    change(folder_ / "run" / file, how);
    const Outcome outcome = doctor({"run", "--json"});
    EXPECT_EQ(outcome.exit_code, 4) << file;
    const json run = json::parse(outcome.out)["runs"][0];
    bool is_named = false;
    for (const json& finding : run["findings"]) {
      is_named |= finding["kind"] != "note" && finding["file"] == file &&
                  finding["what"].get<std::string>().find(what) != std::string::npos;
    }
    EXPECT_TRUE(is_named) << run["findings"].dump(1);
    std::ofstream(folder_ / "run" / file, std::ios::binary) << before;
  };
  const auto cut = [](std::string& text) { text.resize(text.size() / 2); };
  expect("manifest.json", "not one that armwright wrote", cut);
  expect("journal", "its end is missing", cut);
  expect("journal", "does not begin with", [](std::string& text) { text[2] = 'X'; });
  expect("journal", "no intact record", [](std::string& text) { text.assign(5000, '\0'); });
  expect("result.json", "not a result that armwright wrote", cut);
  expect("winner.toml", "winner.toml", [](std::string& text) { text += "[[["; });
  expect("convergence.csv", "is cut short", cut);
  expect("winner-trajectory.csv", "fields",
         [](std::string& text) { text.insert(text.size() / 2, ","); });
  expect("results.sqlite", "SQLite", cut);
  expect("results.sqlite", "SQLite", [](std::string& text) { text.assign("no database"); });
  EXPECT_EQ(doctor({"run"}).exit_code, 0);
}

TEST_F(Doctor, ALostManifestIsNotRepaired) {
  ASSERT_EQ(run(make_run("run", "ga", "70")).exit_code, 0);
  std::filesystem::remove(folder_ / "run/manifest.json");
  const Outcome found = doctor({"run"});
  EXPECT_EQ(found.exit_code, 4);
  EXPECT_THAT(found.out, HasSubstr("LOST"));
  EXPECT_THAT(unwrap(found.out), HasSubstr("q1-complex --optimizer ga --seed 1"));
  const Outcome refused = doctor({"run", "--repair"});
  EXPECT_EQ(refused.exit_code, 4);
  EXPECT_THAT(refused.err, HasSubstr("no repair brings it back"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run.repaired"));
}

TEST_F(Doctor, ARunInProgressIsReadAndNotRepaired) {
  Program program(folder_.path(), make_run("run", "ga", "400000"));
  const auto journal = folder_ / "run/journal";
  while (program.is_running() &&
         !(std::filesystem::exists(journal) && std::filesystem::file_size(journal) > 20000)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  for (int i = 0; i < 20; ++i) {
    const Outcome outcome = doctor({"run"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.out;
    ASSERT_THAT(outcome.out, HasSubstr("being written now by process"));
    ASSERT_THAT(outcome.out, Not(HasSubstr("To resume")));
  }
  const Outcome refused = doctor({"run", "--repair"});
  EXPECT_EQ(refused.exit_code, 5);
  EXPECT_THAT(refused.err, HasSubstr("is being written by process"));
  ASSERT_TRUE(program.is_running());
  program.send(SIGKILL);
  program.wait();
  const Outcome killed = doctor({"run"});
  EXPECT_EQ(killed.exit_code, 0) << killed.out;
  EXPECT_THAT(killed.out, HasSubstr("To resume:\n  armwright optimize"));
}

TEST_F(Doctor, AFullDiskOrAKillDuringRepairHarmsNothing) {
  ASSERT_EQ(run(make_run("run", "ga", "7000")).exit_code, 0);
  damage_journal(folder_ / "run");
  const std::string bytes = read_text(folder_ / "run/journal");
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit low{bytes.size() / 2, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &low);  // the program inherits it
  const Outcome full = doctor({"run", "--repair"});
  ::setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(full.exit_code, 74) << full.err;
  EXPECT_THAT(full.err, HasSubstr("File too large"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run.repaired"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run.repaired.partial-1"));
  for (int wait_ms = 0; wait_ms < 40; wait_ms += 4) {
    Program program(folder_.path(), {"doctor", "run", "--repair"});
    std::this_thread::sleep_for(std::chrono::milliseconds(wait_ms));
    program.send(SIGKILL);
    program.wait();
    if (std::filesystem::exists(folder_ / "run.repaired")) {
      EXPECT_EQ(doctor({"run.repaired"}).exit_code, 0);
      std::filesystem::remove_all(folder_ / "run.repaired");
    }
    EXPECT_EQ(read_text(folder_ / "run/journal"), bytes);
  }
  EXPECT_EQ(doctor({"run", "--repair"}).exit_code, 0);
  EXPECT_EQ(doctor({"run.repaired"}).exit_code, 0);
}

TEST_F(Doctor, NamesOfFilesDoNoHarm) {
  const std::string name = "a b\x1b[31m\n'$(x)";
  ASSERT_EQ(run(make_run(name, "ga", "70")).exit_code, 0);
  damage_journal(folder_ / name);
  std::ofstream(folder_ / name / "evil\x1b]0;x\x07\xff.new") << "x";
  const Outcome outcome = doctor({name});
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_THAT(outcome.out, Not(HasSubstr("\x1b")));
  EXPECT_THAT(outcome.out, HasSubstr("evil?]0;x??.new"));
  EXPECT_TRUE(json::accept(doctor({name, "--json"}).out));
  EXPECT_EQ(doctor({name, "--repair", "--out", "copy"}).exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "copy" / "evil\x1b]0;x\x07\xff.new"));
}

TEST_F(Doctor, OtherFoldersAndWrongUseAreRefused) {
  std::filesystem::create_directories(folder_ / "empty");
  std::ofstream(folder_ / "file") << "x";
  const auto expect = [&](const std::vector<std::string>& words, const std::string& what) {
    const Outcome outcome = doctor(words);
    EXPECT_EQ(outcome.exit_code, 2) << what;
    EXPECT_THAT(outcome.err, HasSubstr(what));
  };
  expect({"empty"}, "is not the folder of a run");
  expect({"empty", "--repair"}, "is not the folder of a run");
  expect({"nowhere"}, "there is no folder 'nowhere'");
  expect({"nowhere", "--repair"}, "there is no folder 'nowhere'");
  expect({"file"}, "is not a folder");
  expect({"--repair"}, "--repair needs a FOLDER");
  expect({"empty", "--out", "x"}, "--out names the copy that --repair makes");
}

TEST_F(Doctor, AnIntactFolderIsNotCopied) {
  ASSERT_EQ(run(make_run("run", "ga", "70")).exit_code, 0);
  const Outcome outcome = doctor({"run", "--repair"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.out, HasSubstr("no copy was made"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run.repaired"));
}

TEST_F(Doctor, NamesDamagedTimesWhichHarmNothing) {
  ASSERT_EQ(run(make_run("run", "ga", "70")).exit_code, 0);
  std::ofstream(folder_ / "run/times.json") << "{";
  const Outcome outcome = doctor({"run"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("times.json"), HasSubstr("no time taken")));
}

TEST_F(Doctor, TellsWhatTheMachineHas) {
  const Outcome outcome = doctor({});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out;
  for (const char* what : {"articulated", "NLopt", "pagmo", "can be loaded", "written, synced",
                           "free space", "processors", "open files", "locale"}) {
    EXPECT_THAT(unwrap(outcome.out), HasSubstr(what));
  }
  const json checks = json::parse(doctor({"--json"}).out);
  EXPECT_TRUE(checks["usable"].get<bool>());
  EXPECT_GT(checks["checks"].size(), 25u);
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
    EXPECT_THAT(entry.path().filename().string(), testing::StartsWith(".streams-"));
  }
}

TEST_F(Doctor, SaysWhatIsMissingAndHowToGetIt) {
  const Outcome programs = doctor({}, {.variables = {{"PATH", "/nowhere"}}, .out_file = ""});
  EXPECT_EQ(programs.exit_code, 0) << programs.out;
  EXPECT_THAT(unwrap(programs.out), HasSubstr("apt install cmake"));
  const Outcome configuration =
      doctor({}, {.variables = {{"ARMWRIGHT_CONFIGS", "/nowhere"}}, .out_file = ""});
  EXPECT_EQ(configuration.exit_code, 3);
  EXPECT_THAT(configuration.out, HasSubstr("BAD  folder"));
  EXPECT_THAT(configuration.out, HasSubstr("1 thing must be fixed"));
  // A folder where nothing can be written, whoever asks.
  std::filesystem::create_directory_symlink("/proc", folder_ / "results");
  const Outcome results = doctor({"--json"});
  EXPECT_EQ(results.exit_code, 3);
  EXPECT_THAT(results.out, HasSubstr("a file cannot be made"));
}

}  // namespace
}  // namespace armwright
