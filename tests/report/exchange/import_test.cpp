#include "report/exchange/import.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "base/error.hpp"
#include "base/temporary_folder.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// An export as csv whose two files are written by hand.
class Import : public testing::Test {
 protected:
  Import() {
    std::filesystem::create_directory(folder_ / "evaluations");
    std::ofstream(folder_ / "runs.csv") << "";
  }
  void write(const std::string& name, const std::string& rows) {
    std::ofstream(folder_ / ("evaluations/" + name + ".csv"))
        << "problem,label,replicate,evaluation,feasible,objective,x.a,\"x.\"\"b\"\"\"\n"
        << rows;
  }
  void expect_refused(const ImportChoice& choice, ErrorKind kind, const std::string& part) {
    try {
      import_best(folder_.path(), choice);
      ADD_FAILURE() << "not refused: " << part;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), kind);
      EXPECT_THAT(error.what(), HasSubstr(part));
    }
  }
  TemporaryFolder folder_;
};

TEST_F(Import, TakesTheBestFeasibleOfTheRunsThatAreChosen) {
  write("p",
        "p,\"a,b\",1,1,1,3,0.5,1\n"
        "p,\"a,b\",1,2,0,1,9,9\n"
        "p,\"a,b\",2,1,0,,0,0\n"
        "p,\"a,b\",2,2,1,2.5,0.25,-1e-300\n"
        "p,\"a,b\",2,3,1,2.5,7,7\n"
        "p,c,1,1,1,-4,1,2\n");
  const ImportedRun run = import_best(folder_.path(), {.label = "a,b"});
  EXPECT_EQ(run.problem, "p");
  EXPECT_EQ(run.label, "a,b");
  EXPECT_EQ(run.replicate, 2u);
  EXPECT_EQ(run.evaluation, 2u);
  EXPECT_EQ(run.objective, 2.5);
  EXPECT_THAT(run.variables, ElementsAre("a", "\"b\""));
  EXPECT_THAT(run.x, ElementsAre(0.25, -1e-300));
  EXPECT_EQ(import_best(folder_.path(), {}).label, "c");
  EXPECT_EQ(import_best(folder_.path(), {.label = "a,b", .replicate = 1}).objective, 3);
}

TEST_F(Import, ComparesNoObjectivesOfDifferentProblems) {
  write("p", "p,l,1,1,1,3,0,0\n");
  write("q", "q,l,1,1,1,2,0,0\n");
  expect_refused({}, ErrorKind::usage, "choose one with --problem: p, q");
  EXPECT_EQ(import_best(folder_.path(), {.problem = "p"}).objective, 3);
  expect_refused({.problem = "r"}, ErrorKind::usage, "unknown --problem 'r'");
}

TEST_F(Import, NamesFileAndRowOfWhatItCannotRead) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"p,l,1,1,1,3,0\n", "row 2: it has 7 fields instead of 8"},
      {"p,l,1,1,1,nan,0,0\n", "row 2: 'nan' is no number"},
      {"p,l,1,1,1,3,0,1e999\n", "row 2: '1e999' is no number"},
      {"p,l,1,1,1,3,0,0\np,l,0,1,1,3,0,0\n", "row 3: '0' is no replicate"},
      {"p,\"l,1,1,1,3,0,0\n", "row 2: a quote is not closed"},
  };
  for (const auto& [rows, message] : cases) {
    write("p", rows);
    expect_refused({}, ErrorKind::bad_data,
                   "evaluations/p.csv: is not what armwright exported: " + message);
  }
  std::ofstream(folder_ / "evaluations/p.csv") << "problem,label\n";
  expect_refused({}, ErrorKind::bad_data, "row 1: it has no column 'replicate'");
}

TEST_F(Import, TellsTheProblemsOfOneIohFunctionApart) {
  std::filesystem::remove(folder_ / "runs.csv");
  std::ofstream(folder_ / "IOHprofiler_f25_sphere.json")
      << R"({"function_name":"sphere","algorithm":{"name":"l"},"experiment_attributes":[],"scenarios":[
            {"problem":"small","variables":["a"],"runs":[{"instance":1,"best":{"evals":1,"y":2,"x":[3]}}]},
            {"problem":"large","variables":["a","b"],"runs":[{"instance":1,"best":{"evals":1,"y":1,"x":[4,5]}}]}]})";
  expect_refused({}, ErrorKind::usage, "choose one with --problem: large, small");
  EXPECT_THAT(import_best(folder_.path(), {.problem = "large"}).variables,
              testing::ElementsAre("a", "b"));
  EXPECT_THAT(import_best(folder_.path(), {.problem = "small"}).x, testing::ElementsAre(3));
}

TEST_F(Import, RefusesJsonThatIsNotAnExport) {
  std::filesystem::remove(folder_ / "runs.csv");
  std::ofstream(folder_ / "runs.json") << "{\"problems\":[{\"name\":1}]}";
  expect_refused({}, ErrorKind::bad_data, "runs.json: is not what armwright exported");
  std::filesystem::remove(folder_ / "runs.json");
  expect_refused({}, ErrorKind::usage, "holds no export as csv, json or ioh");
  std::ofstream(folder_ / "IOHprofiler_f1_p.json")
      << R"({"function_name":"p","algorithm":{"name":"l"},"experiment_attributes":[],
            "scenarios":[{"problem":"p","variables":["a"],"runs":[{"instance":1,"best":{"evals":1,"y":2,"x":[1,2]}}]}]})";
  expect_refused({}, ErrorKind::bad_data, "a point has 2 values for 1 variables");
}

}  // namespace
}  // namespace armwright
