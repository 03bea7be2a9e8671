// Stored files that somebody has changed, as users meet them: readers refuse them by name, and
// doctor finds them. Folders of version 1.0 have no checksums; there doctor computes again what can
// be computed from the judged records.
#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "base/remove_checksums.hpp"
#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"
#include "study/journal/journal.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kCells[] = {"sphere/ga/r01", "sphere/ga/r02", "rosenbrock/cmaes/r03",
                                  "rosenbrock/random/r04"};

class Checksums : public testing::Test {
 protected:
  Outcome run(const std::vector<std::string>& words) { return run_program(folder_.path(), words); }

  void make_study() {
    const Outcome outcome = run({"compare", "--preset", "smoke", "--out", "study", "--quiet"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  void make_run() {
    const Outcome outcome =
        run({"optimize", "q1-complex", "--optimizer", "ga", "--engine", "articulated", "--budget",
             "70", "--set", "sets.test_cases=3", "--set", "sets.validation_cases=2", "--set",
             "task.load_kg=5", "--out", "run", "--quiet"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  void replace(const std::string& file, const std::string& from, const std::string& to) {
    std::string text = read_text(folder_ / file);
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << file << " has no " << from;
    std::ofstream(folder_ / file, std::ios::binary) << text.replace(at, from.size(), to);
  }
  // Makes the results of four cells worse, as in the report of this fault.
  void change_values() {
    for (const char* cell : kCells) {
      const std::string file = std::string("study/cells/") + cell + "/cell.json";
      replace(file, "\n \"value\": ", "\n \"value\": 8");
    }
  }
  // Returns what doctor says about a file of a run, without notes.
  std::string find_damage(const std::string& folder, const std::string& file) {
    const Outcome outcome = run({"doctor", folder, "--json"});
    EXPECT_EQ(outcome.exit_code, 4) << outcome.out;
    std::string found;
    const json survey = json::parse(outcome.out);
    for (const json& one : survey["runs"]) {
      for (const json& finding : one["findings"]) {
        if (finding["kind"] != "note" && finding["file"] == file) {
          found += finding["what"].get<std::string>() + "\n";
        }
      }
    }
    return found;
  }
  // Writes the journal of the run anew, with each judgement as often as `count_copies` says.
  void rewrite_journal(const std::function<int(const EvaluationRecord&)>& count_copies) {
    const auto file = folder_ / "run/journal";
    const JournalContent content = read_journal(file);
    std::filesystem::remove(file);
    JournalContent nothing;
    Journal journal(file, nothing);
    for (const EvaluationRecord& record : content.training) {
      journal.append(record);
    }
    for (const EvaluationRecord& record : content.judgements) {
      for (int copies = count_copies(record); copies > 0; --copies) {
        journal.append(record);
      }
    }
    journal.append(content.end);
    journal.close();
  }

  TemporaryFolder folder_;
};

TEST_F(Checksums, AreThoseThatSha256sumChecks) {
  make_study();
  for (const char* folder : {"study", "study/cells/sphere/ga/r01"}) {
    const std::string command =
        "cd '" + (folder_ / folder).string() + "' && sha256sum --quiet -c SHA256SUMS";
    EXPECT_EQ(std::system(command.c_str()), 0);
  }
  const std::string lines = read_text(folder_ / "study/SHA256SUMS");
  for (const char* name : {"study.toml", "problems/sphere.json", "cells/sphere/ga/r01/SHA256SUMS",
                           "result.json", "verdict.txt", "tables/cells.csv"}) {
    EXPECT_THAT(lines, HasSubstr(std::string("  ") + name + "\n"));
  }
  const Outcome intact = run({"doctor", "study"});
  EXPECT_EQ(intact.exit_code, 0);
  EXPECT_THAT(intact.out, AllOf(HasSubstr("All stored files are intact."), Not(HasSubstr("note"))));
}

TEST_F(Checksums, AChangedValueOfACellIsRefusedAndFound) {
  make_study();
  const std::string before = run({"show", "study", "--json"}).out;
  change_values();
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"show", "study"},
        {"report", "study", "--out", "page.html"},
        {"export", "study", "--format", "csv", "--out", "exported"},
        {"compare", "--preset", "smoke", "--out", "study", "--quiet"}}) {
    const Outcome refused = run(words);
    EXPECT_EQ(refused.exit_code, 4) << words.front();
    EXPECT_THAT(refused.err,
                AllOf(HasSubstr("/cell.json: was changed after it was written"),
                      HasSubstr("SHA256SUMS has"), HasSubstr("armwright doctor study")))
        << words.front();
  }
  const Outcome found = run({"doctor", "study"});
  EXPECT_EQ(found.exit_code, 4);
  for (const char* cell : kCells) {
    EXPECT_THAT(found.out, HasSubstr(std::string("cells/") + cell + "/cell.json"));
  }
  // The repaired copy gets the right values back.
  ASSERT_EQ(run({"doctor", "study", "--repair"}).exit_code, 0);
  EXPECT_EQ(run({"doctor", "study.repaired"}).exit_code, 0)
      << run({"doctor", "study.repaired"}).out;
  ASSERT_EQ(
      run({"compare", "study.repaired/study.toml", "--out", "study.repaired", "--quiet"}).exit_code,
      0);
  EXPECT_EQ(run({"show", "study.repaired", "--json"}).out, before);
  EXPECT_EQ(run({"doctor", "study.repaired"}).exit_code, 0);
}

TEST_F(Checksums, AChangedValueOfACellOfVersionOneIsFoundByItsRecords) {
  make_study();
  remove_checksums(folder_ / "study");
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / "study/cells")) {
    if (entry.path().filename() == "manifest.json") {
      replace(entry.path().lexically_relative(folder_.path()).string(), "\"has_checksums\": true",
              "\"has_checksums\": false");
    }
  }
  EXPECT_EQ(run({"doctor", "study"}).exit_code, 0);
  change_values();
  const std::string once = "its value is not that of the run's winner\n";
  EXPECT_EQ(find_damage("study", "cell.json"), once + once + once + once);
}

TEST_F(Checksums, ACellWithOtherChecksumsIsFoundByTheStudy) {
  make_study();
  std::filesystem::copy_file(folder_ / "study/cells/sphere/ga/r01/SHA256SUMS",
                             folder_ / "study/cells/sphere/ga/r02/SHA256SUMS",
                             std::filesystem::copy_options::overwrite_existing);
  const Outcome found = run({"doctor", "study"});
  EXPECT_EQ(found.exit_code, 4);
  EXPECT_THAT(found.out, HasSubstr("cells/sphere/ga/r02/"));
  const Outcome shown = run({"show", "study"});
  EXPECT_EQ(shown.exit_code, 4);
  EXPECT_THAT(shown.err, HasSubstr("r02/"));
}

TEST_F(Checksums, AChangedLoadNeverReachesTheDataSheet) {
  make_run();
  replace("run/manifest.json", "\"load_kg\": 5", "\"load_kg\": 9");
  const Outcome refused = run({"export", "run", "--format", "datasheet", "--out", "sheet"});
  EXPECT_EQ(refused.exit_code, 4);
  EXPECT_THAT(refused.err, HasSubstr("run/manifest.json: was changed after it was written"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "sheet"));
  EXPECT_THAT(find_damage("run", "manifest.json"), HasSubstr("it was changed"));
}

TEST_F(Checksums, OfDerivedFilesAreCompared) {
  make_run();
  const std::string shown = run({"show", "run", "--json"}).out;
  replace("run/winner.toml", "effort_max_n_m = ", "effort_max_n_m = 1");
  EXPECT_THAT(find_damage("run", "winner.toml"), HasSubstr("it was changed"));
  const Outcome refused = run({"show", "run"});
  EXPECT_EQ(refused.exit_code, 4);
  EXPECT_THAT(refused.err, HasSubstr("run/winner.toml: was changed"));
  // A design may be edited to try it; this is said.
  const Outcome tried =
      run({"evaluate", "run/winner.toml", "--problem", "q1-complex", "--cases", "1"});
  EXPECT_EQ(tried.exit_code, 0) << tried.err;
  EXPECT_THAT(tried.err, HasSubstr("warning: run/winner.toml: was changed"));
  ASSERT_EQ(run({"doctor", "run", "--repair"}).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "run.repaired/winner.toml.damaged"));
  EXPECT_EQ(run({"doctor", "run.repaired"}).exit_code, 0);
}

TEST_F(Checksums, RemovedFilesAreMadeAgainWithTheSameChecksums) {
  make_run();
  const std::string sums = read_text(folder_ / "run/SHA256SUMS");
  for (const char* file : {"result.json", "winner.toml", "convergence.csv", "results.sqlite"}) {
    std::filesystem::remove(folder_ / "run" / file);
  }
  const Outcome missing = run({"doctor", "run"});
  EXPECT_EQ(missing.exit_code, 0);
  EXPECT_THAT(missing.out, AllOf(HasSubstr("winner.toml"), HasSubstr("makes it again")));
  make_run();
  const auto without_database = [](std::string text) {
    const std::size_t at = text.find("  results.sqlite\n");
    return text.erase(at - 64, 64 + 17);
  };
  EXPECT_EQ(without_database(read_text(folder_ / "run/SHA256SUMS")), without_database(sums));
  // Without checksums, the same command writes them again.
  std::filesystem::remove(folder_ / "run/SHA256SUMS");
  EXPECT_THAT(find_damage("run", "SHA256SUMS"), HasSubstr("it is missing"));
  make_run();
  EXPECT_EQ(run({"doctor", "run"}).exit_code, 0);
}

TEST_F(Checksums, ALostJudgementIsFoundAndJudgedAgain) {
  make_run();
  const std::string result = read_text(folder_ / "run/result.json");
  for (const bool has_checksums : {true, false}) {
    std::filesystem::copy(folder_ / "run", folder_ / "kept",
                          std::filesystem::copy_options::recursive);
    rewrite_journal(
        [](const EvaluationRecord& one) { return one.cases.role == CaseRole::test ? 0 : 1; });
    if (!has_checksums) {
      remove_checksums(folder_ / "run");
    }
    EXPECT_THAT(find_damage("run", "journal"), HasSubstr("lost: 1 of the judgements"));
    ASSERT_EQ(run({"doctor", "run", "--repair"}).exit_code, 0);
    const Outcome resumed =
        run({"optimize", "q1-complex", "--optimizer", "ga", "--engine", "articulated", "--budget",
             "70", "--set", "sets.test_cases=3", "--set", "sets.validation_cases=2", "--set",
             "task.load_kg=5", "--out", "run.repaired", "--quiet"});
    EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
    EXPECT_EQ(read_text(folder_ / "run.repaired/result.json"), result);
    std::filesystem::remove_all(folder_ / "run.repaired");
    std::filesystem::remove_all(folder_ / "run");
    std::filesystem::rename(folder_ / "kept", folder_ / "run");
  }
}

TEST_F(Checksums, ADoubledJudgementIsHarmless) {
  make_run();
  const std::string result = read_text(folder_ / "run/result.json");
  rewrite_journal([](const EvaluationRecord&) { return 2; });
  remove_checksums(folder_ / "run");
  std::filesystem::remove(folder_ / "run/result.json");
  make_run();
  EXPECT_EQ(read_text(folder_ / "run/result.json"), result);
  const Outcome noted = run({"doctor", "run"});
  EXPECT_EQ(noted.exit_code, 0) << noted.out;
  EXPECT_THAT(noted.out, HasSubstr("judgements are recorded more than once"));
}

TEST_F(Checksums, SummariesAreComputedAgain) {
  make_run();
  const struct {
    const char* from;
    const char* to;
    const char* found;
  } changes[] = {
      {"\"seed\": 1", "\"seed\": 2", "with seed 2, and manifest.json is of ga with 1"},
      {"\"without_number\": 0", "\"without_number\": 1", "does not follow from its other values"},
      {"\"test_set\": \"", "\"test_set\": \"other-", "its test_set is other-"},
      {"\"candidate\": ", "\"candidate\": 1", "is not a result that armwright wrote"},
  };
  for (const auto& [from, to, found] : changes) {
    const std::string before = read_text(folder_ / "run/result.json");
    replace("run/result.json", from, to);
    EXPECT_THAT(find_damage("run", "result.json"), HasSubstr(found)) << from;
    std::ofstream(folder_ / "run/result.json", std::ios::binary) << before;
  }
  EXPECT_EQ(run({"doctor", "run"}).exit_code, 0);
}

}  // namespace
}  // namespace armwright
