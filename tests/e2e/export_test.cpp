// Real runs, exported and read again: by strict readers in Python that know nothing of ours, and by
// armwright itself.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/temporary_folder.hpp"
#include "base/text.hpp"
#include "e2e/program.hpp"
#include "problems/config/design_file.hpp"
#include "problems/config/problem_loader.hpp"
#include "study/journal/journal.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

struct Cell {
  std::string problem;  // in cell.json
  std::string label;
  std::string function;  // what is run
  std::string optimizer;
};

// What has to be escaped somewhere: the first two problems and labels are even equal once it is.
const std::string kSphere = "1st 'sphere', \"round\": 100 % ünï/..\\cödé";
const std::string kRosenbrock = "1st 'sphere'; \"round\": 100 % ünï/..\\cödé";
const std::string kConstrained = "../constrained";
const std::string kGa = "ga, 'p=12' \"x\"|50%";
const std::string kRandom = "ga; 'p=12' \"x\"|50%";

const std::vector<Cell>& list_cells() {
  static const std::vector<Cell> cells = {
      {kSphere, kGa, "sphere", "ga"},
      {kSphere, kRandom, "sphere", "random"},
      {kRosenbrock, kGa, "rosenbrock", "ga"},
      {kRosenbrock, kRandom, "rosenbrock", "random"},
      {kConstrained, kRandom, "constrained", "random"},
      {kConstrained, "", "constrained", "ga"},
  };
  return cells;
}

constexpr int kReplicates = 2;
constexpr int kBudget = 150;

std::filesystem::path get_cell_folder(std::size_t cell, int replicate) {
  return std::filesystem::path("study/cells") / std::to_string(cell) / "label" /
         std::to_string(replicate);
}

// A study as its folder looks, made once of single runs; and one run on an arm.
class Export : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    for (std::size_t i = 0; i < list_cells().size(); ++i) {
      for (int replicate = 1; replicate <= kReplicates; ++replicate) {
        const Cell& cell = list_cells()[i];
        const auto path = get_cell_folder(i, replicate);
        const Outcome outcome =
            run({"optimize", cell.function, "--optimizer", cell.optimizer, "--seed",
                 std::to_string(replicate), "--budget", std::to_string(kBudget), "--out", path});
        ASSERT_TRUE(outcome.exit_code == 0 || outcome.exit_code == 3) << outcome.err;
        std::ofstream(*folder_ / (path / "cell.json")) << json{{"problem", cell.problem},
                                                               {"label", cell.label},
                                                               {"optimizer", cell.optimizer},
                                                               {"replicate", replicate}};
      }
    }
    std::filesystem::create_directories(*folder_ / "study/cells/0/label/3");
    const Outcome outcome =
        run({"optimize", "q1-complex", "--optimizer", "ga", "--engine", "articulated", "--simd",
             "sse2", "--budget", "70", "--set", "sets.validation_cases=3", "--set",
             "sets.test_cases=4", "--out", "arm"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static Outcome run(const std::vector<std::string>& arguments) {
    return run_program(folder_->path(), arguments);
  }
  static std::filesystem::path path(const std::string& name) { return *folder_ / name; }

  static void expect_refused(const std::vector<std::string>& arguments, int exit_code,
                             const testing::Matcher<std::string>& message) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, exit_code);
    EXPECT_THAT(outcome.out, IsEmpty());
    EXPECT_THAT(outcome.err, message);
  }

  static std::string read_text_of(const std::string& reader, const std::string& folder) {
    return read_with(reader, path(folder));
  }
  static json read(const std::string& reader, const std::string& folder) {
    const std::string text = read_text_of(reader, folder);
    const json read = json::parse(text, nullptr, false);
    EXPECT_FALSE(read.is_discarded()) << text;
    return read;
  }
  // The file without its last line.
  static void cut_last_line(const std::string& file) {
    const std::string text = read_text(path(file));
    std::ofstream(path(file)) << text.substr(0, text.rfind('\n', text.size() - 2) + 1);
  }

  // Of a run, from its journal.
  struct Recorded {
    std::uint64_t evaluations = 0;
    std::uint64_t rows = 0;  // improvements, and the first and last evaluation if they are none
    double best = HUGE_VAL;  // of the feasible ones
  };
  static Recorded look_up(const std::filesystem::path& run_folder) {
    const JournalContent journal = read_journal(path(run_folder / "journal"));
    Recorded recorded;
    recorded.evaluations = journal.training.size();
    for (const EvaluationRecord& record : journal.training) {
      const bool improves =
          is_feasible(record.evaluation) && record.evaluation.objectives.front() < recorded.best;
      if (improves) {
        recorded.best = record.evaluation.objectives.front();
      }
      const bool is_end = record.index == 0 || record.index + 1 == recorded.evaluations;
      recorded.rows += improves || is_end ? 1 : 0;
    }
    return recorded;
  }

  inline static std::unique_ptr<TemporaryFolder> folder_;
};

TEST_F(Export, AsIohIsReadByAStrictReader) {
  const Outcome outcome = run({"export", "study", "--format", "ioh", "--out", "ioh"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.out, HasSubstr("12 runs"));
  EXPECT_THAT(outcome.err, HasSubstr("1 cell"));
  const json all = read("read_ioh.py", "ioh");
  ASSERT_EQ(all.size(), 3u) << all;
  for (std::size_t i = 0; i < list_cells().size(); ++i) {
    const Cell& cell = list_cells()[i];
    const json& runs = all.at(cell.label).at(cell.problem);
    ASSERT_EQ(runs.size(), static_cast<std::size_t>(kReplicates));
    for (int replicate = 1; replicate <= kReplicates; ++replicate) {
      const auto [evaluations, rows, best] = look_up(get_cell_folder(i, replicate));
      const json& read_run = runs.at(std::to_string(replicate));
      EXPECT_EQ(read_run[0], evaluations);
      EXPECT_EQ(read_run[1], std::isfinite(best) ? best : std::numeric_limits<double>::max());
      EXPECT_EQ(read_run[2], rows);
    }
  }
}

TEST_F(Export, AsCocoIsReadByAStrictReader) {
  const Outcome outcome = run({"export", "study", "--format", "coco", "--out", "coco"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json all = read("read_coco.py", "coco");
  ASSERT_EQ(all.size(), 3u) << all;
  // The smallest values of the functions are known, so they are the references.
  const std::map<std::string, std::pair<std::string, double>> functions = {
      {kConstrained, {"29-4", -44}}, {kSphere, {"25-10", 0}}, {kRosenbrock, {"27-10", 0}}};
  const std::map<std::string, std::string> ids = {
      {"", "unnamed"}, {kGa, "ga___p_12___x__50_"}, {kRandom, "ga___p_12___x__50_-2"}};
  for (std::size_t i = 0; i < list_cells().size(); ++i) {
    const Cell& cell = list_cells()[i];
    const auto& [function, reference] = functions.at(cell.problem);
    const json& runs = all.at(ids.at(cell.label)).at(function);
    ASSERT_EQ(runs.size(), static_cast<std::size_t>(kReplicates));
    for (int replicate = 1; replicate <= kReplicates; ++replicate) {
      const auto [evaluations, rows, best] = look_up(get_cell_folder(i, replicate));
      const json& read_run = runs.at(std::to_string(replicate));
      EXPECT_EQ(read_run[0], evaluations);
      const double difference = std::isfinite(best) ? best - reference : 1e10 - reference;
      EXPECT_NEAR(read_run[1].get<double>(), difference, 1e-9 * std::abs(difference));
    }
  }
}

TEST_F(Export, IsReadStrictly) {
  const std::string run_folder = get_cell_folder(5, 1);
  ASSERT_EQ(run({"export", run_folder, "--format", "ioh", "--out", "cut-ioh"}).exit_code, 0);
  cut_last_line("cut-ioh/ga/data_f29_constrained/IOHprofiler_f29_DIM4.dat");
  EXPECT_THAT(read_text_of("read_ioh.py", "cut-ioh"), HasSubstr("run 1: the last row is"));
  ASSERT_EQ(run({"export", run_folder, "--format", "coco", "--out", "cut-coco"}).exit_code, 0);
  cut_last_line("cut-coco/ga/data_f29/bbobexp_f29_DIM4.tdat");
  EXPECT_THAT(read_text_of("read_coco.py", "cut-coco"), HasSubstr("run 1: .tdat has rows at"));
}

TEST_F(Export, TablesBearEveryEvaluationWithEveryDigit) {
  ASSERT_EQ(run({"export", "study", "--format", "json", "--out", "json"}).exit_code, 0);
  ASSERT_EQ(run({"export", "study", "--format", "csv", "--out", "csv"}).exit_code, 0);
  const json root = json::parse(read_text(path("json/runs.json")));
  std::map<std::string, json> runs;  // by problem, label and replicate
  for (const json& problem : root.at("problems")) {
    for (const json& one : problem.at("runs")) {
      runs[json{problem.at("name"), one.at("label"), one.at("replicate")}.dump()] = one;
    }
  }
  ASSERT_EQ(runs.size(), 12u);
  for (std::size_t i = 0; i < list_cells().size(); ++i) {
    const Cell& cell = list_cells()[i];
    const JournalContent journal = read_journal(path(get_cell_folder(i, 2) / "journal"));
    const json& evaluations = runs.at(json{cell.problem, cell.label, 2}.dump()).at("evaluations");
    ASSERT_EQ(evaluations.size(), journal.training.size());
    for (std::size_t k = 0; k < evaluations.size(); ++k) {
      const Evaluation& evaluation = journal.training[k].evaluation;
      EXPECT_EQ(evaluations[k].at("x"), json(journal.training[k].x));
      EXPECT_EQ(evaluations[k].at("objectives"), json(evaluation.objectives));
      EXPECT_EQ(evaluations[k].at("constraints"), json(evaluation.constraint_values));
      EXPECT_EQ(evaluations[k].at("feasible"), is_feasible(evaluation));
      EXPECT_EQ(evaluations[k].at("simulated_cases"), k + 1);
    }
  }
  // One file a problem, however alike their names.
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(path("csv/evaluations"))) {
    files.push_back(entry.path().filename());
  }
  std::ranges::sort(files);
  EXPECT_THAT(files,
              ElementsAre("1st__sphere____round___100____n__.._c_d_-2.csv",
                          "1st__sphere____round___100____n__.._c_d_.csv", "_._constrained.csv"));
  const std::string table = read_text(path("csv/evaluations/_._constrained.csv"));
  EXPECT_THAT(table, StartsWith("problem,label,optimizer,replicate,evaluation,simulated_cases,"
                                "status,feasible,objective,objective.f,constraint.1,constraint.2,"
                                "constraint.3,"));
  EXPECT_EQ(std::ranges::count(table, '\n'), 1 + 2 * kReplicates * kBudget);
  EXPECT_THAT(read_text(path("csv/evaluations/1st__sphere____round___100____n__.._c_d_.csv")),
              HasSubstr("\n\"1st 'sphere', \"\"round\"\": 100 % ünï/..\\cödé\",\"ga, 'p=12' "
                        "\"\"x\"\"|50%\",ga,1,1,1,ok,1,"));
}

TEST_F(Export, OfASingleRunIsThatRun) {
  const Outcome outcome =
      run({"export", get_cell_folder(0, 1).string(), "--format", "ioh", "--out", "single"});
  ASSERT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.err, IsEmpty());
  const json all = read("read_ioh.py", "single");
  EXPECT_EQ(all.at("ga").at("sphere").size(), 1u) << all;
}

TEST_F(Export, OfARunThatFoundNothingFeasibleHasNoInfinityInJson) {
  // The genetic algorithm's first individual violates a constraint.
  const Outcome outcome = run({"optimize", "constrained", "--optimizer", "ga", "--budget", "1",
                               "--seed", "1", "--out", "infeasible"});
  ASSERT_EQ(outcome.exit_code, 3) << outcome.err;
  for (const std::string format : {"ioh", "coco", "csv", "json"}) {
    ASSERT_EQ(run({"export", "infeasible", "--format", format}).exit_code, 0) << format;
  }
  EXPECT_EQ(read("read_ioh.py", "infeasible/export-ioh").at("ga").at("constrained").at("1"),
            json({1, std::numeric_limits<double>::max(), 1}));
  EXPECT_EQ(read("read_coco.py", "infeasible/export-coco").at("ga").at("29-4").at("1"),
            json({1, 1e10 + 40, 1, 1}));  // 1e10 - (-44) in ten digits
  const json root = json::parse(read_text(path("infeasible/export-json/runs.json")));
  EXPECT_TRUE(root.at("problems")[0].at("runs")[0].at("best").is_null());
  EXPECT_EQ(root.at("problems")[0].at("runs")[0].at("evaluations").size(), 1u);
  for (const std::string format : {"ioh", "csv", "json"}) {
    expect_refused({"import", "infeasible/export-" + format}, 2,
                   HasSubstr("no run that was chosen found anything feasible"));
  }
}

TEST_F(Export, OverwritesNothingAndLeavesNothingHalfDone) {
  ASSERT_EQ(run({"export", "study", "--format", "json"}).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(path("study/export-json/runs.json")));
  expect_refused({"export", "study", "--format", "json"}, 2,
                 AllOf(HasSubstr("study/export-json: exists already"), HasSubstr("--out")));
  expect_refused({"export", "study", "--format", "jsn", "--out", "x"}, 2,
                 HasSubstr("unknown --format 'jsn'; did you mean 'json'? Valid: csv, ioh"));
  expect_refused({"export", "nowhere", "--format", "json", "--out", "x"}, 2,
                 HasSubstr("nowhere: is neither the folder of a run"));
  std::filesystem::create_directories(path("damaged/cells"));
  std::filesystem::copy(path("study/cells/0"), path("damaged/cells/0"),
                        std::filesystem::copy_options::recursive);
  std::ofstream(path("damaged/cells/0/label/1/result.json")) << "{}";
  expect_refused({"export", "damaged", "--format", "json", "--out", "x"}, 4,
                 HasSubstr("damaged/cells/0/label/1/result.json"));
  for (const std::string& name : folder_->list()) {
    EXPECT_FALSE(name.starts_with("x")) << name;
  }
}

TEST_F(Export, RefusesRunsOnOneProblemWithOtherVariables) {
  for (const std::size_t cell : {0, 4}) {
    const auto copy = path("mixed/cells") / std::to_string(cell) / "label";
    std::filesystem::create_directories(copy);
    std::filesystem::copy(path(get_cell_folder(cell, 1)), copy / "1");
    std::ofstream(copy / "1/cell.json") << json{
        {"problem", "p"}, {"label", std::to_string(cell)}, {"optimizer", "ga"}, {"replicate", 1}};
  }
  expect_refused({"export", "mixed", "--format", "csv"}, 4,
                 AllOf(HasSubstr("mixed/cells/0/label/1 and "),
                       HasSubstr("mixed/cells/4/label/1 are both runs on 'p', but with other "
                                 "variables")));
}

TEST_F(Export, AsCocoHasRoomFor21FunctionsBesideTheShippedOnes) {
  for (int i = 1; i <= 23; ++i) {
    const auto cell = path("many/cells") / std::to_string(i) / "ga/1";
    std::filesystem::create_directories(cell);
    std::filesystem::copy(path(get_cell_folder(0, 1)), cell,
                          std::filesystem::copy_options::recursive |
                              std::filesystem::copy_options::overwrite_existing);
    std::ofstream(cell / "cell.json") << json{
        {"problem", std::to_string(i)}, {"label", "ga"}, {"optimizer", "ga"}, {"replicate", 1}};
  }
  expect_refused({"export", "many", "--format", "coco"}, 2,
                 AllOf(HasSubstr("at most 21 functions"), HasSubstr("here are 22")));
  std::filesystem::remove_all(path("many/cells/23"));
  EXPECT_EQ(run({"export", "many", "--format", "coco"}).exit_code, 0);
  EXPECT_EQ(read("read_coco.py", "many/export-coco").at("ga").size(), 22u);
  ASSERT_EQ(run({"export", "many", "--format", "ioh"}).exit_code, 0);
  EXPECT_EQ(read("read_ioh.py", "many/export-ioh").at("ga").size(), 22u);
}

TEST_F(Export, NumbersAFunctionOnceForAllItsDimensionsAndOthersAsThePlanLists) {
  std::ofstream(path("dimensions.toml"))
      << "optimizers = [\"random\"]\nreplicates = 1\nbudget = 40\nbaselines = false\n"
         "[[problem]]\nname = \"sphere\"\nlabel = \"z\"\n"
         "set = [\"function.name=ellipsoid\", \"function.dimension=3\"]\n"
         "[[problem]]\nname = \"ellipsoid\"\nlabel = \"large\"\nset = "
         "[\"function.dimension=20\"]\n"
         "[[problem]]\nname = \"sphere\"\nlabel = \"a\"\n"
         "set = [\"function.name=rastrigin\", \"function.dimension=3\"]\n"
         "[[problem]]\nname = \"ellipsoid\"\nlabel = \"small\"\nset = "
         "[\"function.dimension=5\"]\n";
  const Outcome outcome = run({"compare", "dimensions.toml", "--out", "dimensions", "--quiet"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  ASSERT_EQ(run({"export", "dimensions", "--format", "coco"}).exit_code, 0);
  ASSERT_EQ(run({"export", "dimensions", "--format", "ioh"}).exit_code, 0);
  const auto list_keys = [](const json& runs) {
    std::vector<std::string> keys;
    for (const auto& [key, value] : runs.items()) {
      keys.push_back(key);
    }
    return keys;
  };
  EXPECT_THAT(list_keys(read("read_coco.py", "dimensions/export-coco").at("random")),
              ElementsAre("26-20", "26-5", "72-3", "73-3"));
  EXPECT_THAT(read_text(path("dimensions/export-coco/run_cocopp.py")),
              AllOf(HasSubstr("\nFUNCTIONS = {26: \"ellipsoid\", 72: \"z\", 73: \"a\"}\n"),
                    HasSubstr("\nDIMENSIONS = [3, 5, 20]\n")));
  EXPECT_THAT(list_keys(read("read_ioh.py", "dimensions/export-ioh").at("random")),
              ElementsAre("a", "large", "small", "z"));
  EXPECT_TRUE(std::filesystem::exists(
      path("dimensions/export-ioh/random/data_f26_ellipsoid/IOHprofiler_f26_DIM20.dat")));
  // The problem was found: it is only no arm, of which a design could be made.
  expect_refused({"import", "dimensions/export-ioh", "--problem", "small", "--config", "ellipsoid"},
                 2, HasSubstr("is an analytic function"));
  // Nobody comes near 0 on the ellipsoid, and the export says so.
  const json small = read("read_coco.py", "dimensions/export-coco").at("random").at("26-5").at("1");
  const auto recorded = look_up("dimensions/cells/small/random/r01");
  EXPECT_GT(recorded.best, 1);
  EXPECT_NEAR(small[1].get<double>(), recorded.best, 1e-9 * recorded.best);
}

TEST_F(Export, HasTheWinnersDesignAndTheTestCasesThatItMet) {
  ASSERT_EQ(run({"export", "arm", "--format", "csv", "--out", "arm-csv"}).exit_code, 0);
  EXPECT_EQ(read_text(path("arm-csv/designs/q1-complex-ga-1.toml")),
            read_text(path("arm/winner.toml")));
  const auto evaluate = [&](const std::vector<std::string>& cases) {
    std::vector<std::string> words = {"evaluate", "arm/winner.toml", "--problem", "q1-complex",
                                      "--engine", "articulated",     "--simd",    "sse2",
                                      "--json"};
    words.insert(words.end(), cases.begin(), cases.end());
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return json::parse(outcome.out).at("cases");
  };
  const json on_file = evaluate({"--test-cases", "arm-csv/test-cases/q1-complex.json"});
  EXPECT_EQ(on_file.size(), 4u);
  EXPECT_EQ(on_file, evaluate({"--test-set", "2", "--cases", "4"}));
  // And as the run itself has judged it.
  const json result = json::parse(read_text(path("arm/result.json")));
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(on_file[i].at("mean_error_m"), result.at("winner").at("test").at("case_errors")[i]);
  }
}

TEST_F(Export, ComesBackAsADesignBitForBit) {
  const JournalContent journal = read_journal(path("arm/journal"));
  EvaluationRecord best = journal.training.front();
  for (const EvaluationRecord& record : journal.training) {
    best = record.evaluation.objectives < best.evaluation.objectives ? record : best;
  }
  for (const std::string format : {"csv", "json", "ioh"}) {
    const std::string out = "back-" + format;
    ASSERT_EQ(run({"export", "arm", "--format", format, "--out", out}).exit_code, 0);
    const Outcome outcome = run({"import", out, "--out", out + ".toml"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const DesignFile design = load_design(path(out + ".toml").string());
    EXPECT_EQ(load_problem("q1-complex").tracking()->make_vector(design.design), best.x);
    EXPECT_EQ(run({"import", out}).out, read_text(path(out + ".toml")));
  }
  EXPECT_EQ(read("read_ioh.py", "back-ioh").at("ga").at("q1-complex").size(), 1u);
  EXPECT_EQ(run({"evaluate", "back-ioh.toml", "--problem", "q1-complex", "--cases", "1"}).exit_code,
            0);
}

TEST_F(Export, IsImportedOnlyWhereItIsClearWhatIsMeant) {
  ASSERT_EQ(run({"export", "study", "--format", "ioh", "--out", "choose"}).exit_code, 0);
  expect_refused({"import", "choose"}, 2,
                 AllOf(HasSubstr("holds runs on 3 problems"), HasSubstr("--problem: ../constr")));
  expect_refused({"import", "choose", "--problem", "../constraine"}, 2,
                 HasSubstr("did you mean '../constrained'?"));
  expect_refused({"import", "choose", "--problem", kSphere, "--replicate", "3"}, 2,
                 HasSubstr("unknown --replicate '3'"));
  expect_refused({"import", "choose", "--problem", kSphere, "--config", "sphere"}, 2,
                 HasSubstr("is an analytic function"));
  expect_refused({"import", "choose", "--problem", kSphere, "--config", "q1-complex"}, 4,
                 AllOf(HasSubstr("are x_1, x_2"), HasSubstr("joint_1.p, joint_1.i")));
  expect_refused({"import", "study"}, 2, HasSubstr("holds no export"));
}

}  // namespace
}  // namespace armwright
