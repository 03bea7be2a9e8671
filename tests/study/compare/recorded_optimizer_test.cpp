// Optimizers that a program outside of armwright implements. The program compares them with others;
// their records can be read without the program.
#include "optimizers/plugins/recorded_optimizer.hpp"

#include <gmock/gmock.h>

#include "base/expect_error.hpp"
#include "optimizers/builtin/random_search.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "study/compare/study_support.hpp"

namespace armwright {
namespace {

constexpr const char* kDescription =
    R"({"type": "description", "protocol": 1, "name": "mine", "summary": "Something of mine",
        "capabilities": ["bounds", "local"],
        "options": [{"name": "step", "default": 0.5, "lower": 0, "upper": 1}]})";

// Described as above, and random search inside.
OptimizerRow make_mine() {
  OptimizerRow row = read_host_row("python:mine", kDescription);
  row.input_hashes = {{"class Mine", "0123"}};
  row.make = [](const Options&) {
    const OptimizerRow random = make_random_search_rows().front();
    return random.make(Options::parse(random.name, random.options, {}));
  };
  return row;
}

StudyRequest make_its_request() {
  StudyRequest request = make_small_request();
  request.optimizers = {"python:mine", "ga"};
  request.rows = {make_mine()};
  return request;
}

class ForeignOptimizerTest : public StudyTest {};

TEST_F(ForeignOptimizerTest, StandsInAStudyThatIsReadWithoutIt) {
  const StudyPlan plan = make_study_plan(make_its_request());
  // It is a local search itself, so no other local search is added as a baseline.
  ASSERT_EQ(plan.optimizers.size(), 4U);
  EXPECT_EQ(run_all(plan, "mine", 2), 0U);

  const StudyPlan recorded = load_study_plan(temporary_ / "mine");
  EXPECT_EQ(to_toml(recorded), to_toml(plan));
  ASSERT_EQ(recorded.optimizers.size(), 4U);
  EXPECT_EQ(recorded.optimizers[0].row.name, "python:mine");
  EXPECT_EQ(recorded.optimizers[0].parsed.get_number("step"), 0.5);
  EXPECT_TRUE(recorded.optimizers[0].row.capabilities.local);
  const StudyResult result = analyze_study(recorded, temporary_ / "mine");
  EXPECT_TRUE(result.missing.empty());
  EXPECT_EQ(to_json(recorded, result), to_json(plan, analyze_study(plan, temporary_ / "mine")));
}

TEST_F(ForeignOptimizerTest, RunsNowhereElse) {
  const StudyPlan plan = make_study_plan(make_its_request());
  const auto path = temporary_ / "mine";
  const StudyFolder folder(path, plan);
  const StudyPlan recorded = load_study_plan(path);
  StopSignal stop;
  EXPECT_THAT(
      error_of(ErrorKind::usage,
               [&] { run_cell(recorded, list_cells(recorded)[0], path, stop, observer_); }),
      testing::HasSubstr("optimizer 'python:mine' is a class in somebody's Python program"));
  EXPECT_THAT(error_of(ErrorKind::usage, [&] { load_optimizer("python:mine"); }),
              testing::HasSubstr("armwright.serve"));
}

TEST_F(ForeignOptimizerTest, IsKnownAgainWhenItHasChanged) {
  StudyRequest request = make_its_request();
  { const StudyFolder folder(temporary_ / "mine", make_study_plan(request)); }
  request.rows[0].input_hashes["class Mine"] = "4567";
  EXPECT_THAT(
      error_of(ErrorKind::usage,
               [&] { const StudyFolder folder(temporary_ / "mine", make_study_plan(request)); }),
      testing::HasSubstr("optimizer python:mine: inputs.0: recorded \"class Mine 0123\""));
}

TEST_F(ForeignOptimizerTest, DescriptionsThatAreNone) {
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { read_host_row("python:mine", "{}"); }),
              testing::HasSubstr("its description"));
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { read_host_row("python:mine", "{"); }),
              testing::HasSubstr("is no JSON"));
  EXPECT_THAT(
      error_of(ErrorKind::bad_data, [&] { read_host_row("python:mine", std::string(1000, '[')); }),
      testing::HasSubstr("nest deeper"));
  EXPECT_THAT(error_of(ErrorKind::bad_data,
                       [&] {
                         load_plan(temporary_,
                                   "problems = [\"sphere\"]\nbudget = 9\n[[optimizer]]\n"
                                   "name = \"ga\"\ndescription = \"{}\"\n");
                       }),
              testing::HasSubstr("is not needed"));
}

}  // namespace
}  // namespace armwright
