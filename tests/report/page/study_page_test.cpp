#include <gmock/gmock.h>

#include <cstdio>
#include <fstream>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "base/expect_error.hpp"
#include "base/remove_checksums.hpp"
#include "base/text.hpp"
#include "report/page/data_contract.hpp"
#include "report/page/page_data.hpp"
#include "report/page/study_parts.hpp"
#include "study/compare/rerun.hpp"
#include "study/compare/study_support.hpp"
#include "study/statistics/power.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::Contains;
using testing::Each;
using testing::HasSubstr;
using testing::IsEmpty;

class StudyPage : public StudyTest {
 protected:
  std::string make_text(const std::string& name, PageOptions options = {}) {
    StopSignal stop;
    return make_study_page(temporary_ / name, options, stop, observer_).value();
  }
  json make(const std::string& name, const PageOptions& options = {}) {
    return json::parse(make_text(name, options));
  }
  void record(const StudyPlan& plan, const Cell& cell, const CellOutcome& outcome) {
    remove_checksums(temporary_ / "study");
    std::ofstream(temporary_ / "study" / make_cell_path(plan, cell) / "cell.json")
        << to_json(outcome);
  }
};

StudyRequest make_arm_request() {
  StudyRequest request;
  request.problems = {"q1-complex"};
  request.optimizers = {"cmaes", "random"};
  request.settings = {"physics.engine=articulated", "workspace.points=4", "sets.validation_cases=3",
                      "sets.test_cases=4"};
  request.replicates = 2;
  request.budget = 40;
  request.baselines = false;
  return request;
}

StudyRequest make_front_request() {
  StudyRequest request = make_arm_request();
  request.problems = {"q2-pareto"};
  request.optimizers = {"cmaes", "random"};
  request.replicates = 3;
  request.budget = 300;
  return request;
}

TEST_F(StudyPage, HasEveryKeyOfTheContract) {
  study(make_study_plan(make_small_request()), "study");
  const json page = make("study");
  EXPECT_EQ(list_keys(page), read_contract("StudyData"));
  EXPECT_EQ(list_keys(page["program"]), read_contract("Program"));
  EXPECT_EQ(list_keys(page["facts"][0]), read_contract("Fact"));
  EXPECT_EQ(list_keys(page["overall"]), read_contract("StudyOverall"));
  for (const json& problem : page["problems"]) {
    EXPECT_EQ(list_keys(problem), read_contract("StudyProblem"));
    EXPECT_EQ(list_keys(problem["pairs"][0]), read_contract("StudyPair"));
    for (const json& result : problem["results"]) {
      EXPECT_EQ(list_keys(result), read_contract("StudyOptimizerResult"));
      EXPECT_EQ(list_keys(result["cells"][0]), read_contract("StudyCell"));
    }
  }
}

TEST_F(StudyPage, ShowsTheNumbersOfTheTables) {
  const StudyPlan plan = make_study_plan(make_small_request());
  const StudyResult result = study(plan, "study");
  const json page = make("study");
  EXPECT_TRUE(page["finished"]);
  EXPECT_TRUE(page["progress"].is_null());
  EXPECT_EQ(page["problems"].size(), 2u);
  const std::size_t pairs = result.problems[0].pairs.size();
  EXPECT_EQ(page["fewest_replicates"], find_fewest_pairs(pairs));
  std::vector<double> mean_median_ranks(plan.optimizers.size());
  for (std::size_t p = 0; p < 2; ++p) {
    const ProblemResult& expected = result.problems[p];
    const json& problem = page["problems"][p];
    EXPECT_EQ(problem["label"], expected.label);
    EXPECT_EQ(problem["missing"], 0);
    EXPECT_EQ(problem["order"].get<std::vector<std::size_t>>(), expected.order);
    EXPECT_EQ(problem["friedman"], make_friedman(expected.friedman));
    EXPECT_EQ(problem["pairs"].size(), expected.pairs.size());
    EXPECT_EQ(problem["pairs"][0]["p_holm"], expected.pairs[0].p_holm);
    for (std::size_t o = 0; o < expected.optimizers.size(); ++o) {
      const OptimizerResult& one = expected.optimizers[o];
      const json& shown = problem["results"][o];
      EXPECT_EQ(shown["median"], one.spread.median);
      EXPECT_EQ(shown["min"], *std::ranges::min_element(one.values));
      EXPECT_EQ(shown["max"], *std::ranges::max_element(one.values));
      EXPECT_EQ(shown["mean_rank"], one.mean_rank);
      mean_median_ranks[o] += shown["median_rank"].get<double>() / 2;  // exact: ranks are halves
      EXPECT_EQ(shown["cells"].size(), one.values.size());
      EXPECT_EQ(shown["cells"][2]["value"], one.values[2]);
      EXPECT_EQ(shown["curve"]["median"].size(), problem["checkpoints"].size());
      EXPECT_EQ(shown["ecdf"].size(), problem["checkpoints"].size());
    }
  }
  EXPECT_EQ(page["overall"]["mean_ranks"].get<std::vector<double>>(),
            result.overall.ranking.full.mean_ranks);
  EXPECT_EQ(mean_median_ranks, result.overall.ranking.full.mean_ranks);
  EXPECT_THAT(page["verdict"].get<std::vector<std::string>>(),
              Contains(HasSubstr("with 2 problems, fewer than 6, no pair of optimizers can be "
                                 "decided over problems")));
}

TEST_F(StudyPage, IsTheSameBytesForAnyNumberOfThreadsAndChangesNothing) {
  study(make_study_plan(make_arm_request()), "study");
  const auto before = read_tree(temporary_ / "study");
  const std::string one = make_text("study", {.jobs = 1, .cases = {}});
  EXPECT_EQ(one, make_text("study", {.jobs = 2, .cases = {}}));
  EXPECT_EQ(read_tree(temporary_ / "study"), before);
}

TEST_F(StudyPage, HasReplaysOfTheBestDesigns) {
  study(make_study_plan(make_arm_request()), "study");
  const json page = make("study", {.jobs = 2, .cases = {"test/2:3", "test/9:17"}});
  ASSERT_EQ(page["robots"].size(), 1u);
  ASSERT_EQ(page["replays"].size(), 1u);
  const json& replay = page["replays"][0];
  EXPECT_EQ(list_keys(replay), read_contract("ReplaySet"));
  EXPECT_EQ(replay["robot"], 0);
  ASSERT_EQ(replay["designs"].size(), 3u);  // of two optimizers, and the start
  const json& order = page["problems"][0]["order"];
  EXPECT_THAT(replay["designs"][0]["name"].get<std::string>(),
              HasSubstr(page["optimizers"][order[0].get<std::size_t>()]["label"]));
  EXPECT_EQ(replay["designs"][2]["id"], "start");
  std::vector<std::string> ids;
  for (const json& one : replay["cases"]) {
    ids.push_back(one["id"]);
    EXPECT_EQ(one["motions"].size(), 3u);
  }
  EXPECT_EQ(ids.front(), "test/2:0");
  EXPECT_THAT(ids, Contains("test/2:3"));
  EXPECT_THAT(ids, Contains("test/9:17"));
  EXPECT_THAT(usage_error_of([&] { make("study", {.cases = {"test/2"}}); }),
              HasSubstr("it must be SET:NUMBER"));
}

TEST_F(StudyPage, ReplaysAMethodsDesignsInItsOwnProblem) {
  std::ofstream(temporary_ / "plan.toml") << R"(
replicates = 2
budget = 40
baselines = false
[[problem]]
name = "q2-e6"
set = ["physics.engine=articulated", "workspace.points=4", "sets.validation_cases=3",
       "sets.test_cases=4"]
[[optimizer]]
name = "random"
label = "pid"
[[optimizer]]
name = "random"
label = "gravity"
set = ["control.controller=pid_gravity"]
)";
  StudyRequest request;
  request.file = (temporary_ / "plan.toml").string();
  study(make_study_plan(request), "study");
  const json page = make("study", {.jobs = 2, .cases = {}});
  ASSERT_EQ(page["replays"].size(), 1u);
  std::set<std::string> ids;
  for (const json& replay : page["replays"]) {
    EXPECT_EQ(replay["robot"], 0);
    for (const json& motion : replay["cases"][0]["motions"]) {
      ids.insert(motion["design"]);
      EXPECT_LE(motion["steps"], replay["cases"][0]["steps"]);
    }
  }
  EXPECT_EQ(ids, (std::set<std::string>{"optimizer-0", "optimizer-1", "start"}));
}

TEST_F(StudyPage, HasTheFixedTargetsOfTheStudy) {
  std::ofstream(temporary_ / "plan.toml") << R"(
problems = ["sphere", "rosenbrock"]
replicates = 2
budget = 40
reference = "random"
baselines = false
optimizers = ["random", "nlopt:sbplx"]
[[target]]
label = "easy"
problems = ["sphere"]
value = 1000.0
[[target]]
label = "never"
problems = ["sphere"]
value = -1.0
)";
  StudyRequest request;
  request.file = (temporary_ / "plan.toml").string();
  const StudyResult result = study(make_study_plan(request), "study");
  const json page = make("study");
  EXPECT_EQ(page["reference"], "random");
  const json& sphere = page["problems"][0];
  EXPECT_EQ(sphere["fixed_targets"], (json{"'easy' (f at most 1000)", "'never' (f at most -1)"}));
  EXPECT_THAT(page["problems"][1]["fixed_targets"], IsEmpty());
  const json& times = sphere["results"][1]["target_times"];
  const TargetTime& easy = result.problems[0].optimizers[1].target_times[0];
  EXPECT_EQ(times[0]["reached"], 2);
  EXPECT_EQ(times[0]["kept"], 2);
  EXPECT_EQ(times[0]["expected"], easy.expected);
  EXPECT_EQ(times[0]["interval"], (json{easy.interval.lower, easy.interval.upper}));
  EXPECT_EQ(times[0]["ratio"], *easy.ratio->ratio);
  EXPECT_EQ(times[1], (json{{"reached", 0},
                            {"kept", 0},
                            {"expected", nullptr},
                            {"interval", {nullptr, nullptr}},
                            {"ratio", nullptr},
                            {"ratio_interval", {nullptr, nullptr}}}));
}

TEST_F(StudyPage, SimulatesNothingIfSoAsked) {
  study(make_study_plan(make_arm_request()), "study");
  const json page = make("study", {.cases = {}, .simulate = false});
  EXPECT_THAT(page["replays"], IsEmpty());
  EXPECT_THAT(page["notes"].get<std::vector<std::string>>(),
              Contains(HasSubstr("there is no replay")));
}

TEST_F(StudyPage, AStoppedOneIsNone) {
  study(make_study_plan(make_arm_request()), "study");
  StopSignal stop;
  stop.request(StopReason::interrupted);
  EXPECT_FALSE(make_study_page(temporary_ / "study", {}, stop, observer_));
}

TEST_F(StudyPage, OfAStudyUnderWayShowsWhatIsThere) {
  const StudyPlan plan = make_study_plan(make_small_request());
  const StudyResult whole = study(plan, "study");
  const auto remove = [&](const Cell& cell) {
    std::filesystem::remove(temporary_ / "study" / make_cell_path(plan, cell) / "cell.json");
  };
  remove({1, 0, 6});
  for (int replicate = 1; replicate <= plan.replicates; ++replicate) {
    remove({1, 1, replicate});
  }
  const json page = make("study");
  EXPECT_FALSE(page["finished"]);
  EXPECT_EQ(page["progress"], (json{{"done", 53}, {"total", 60}, {"unit", "cells"}}));
  const auto verdict = page["verdict"].get<std::vector<std::string>>();
  EXPECT_THAT(verdict, Contains(HasSubstr("On rosenbrock at 120 simulations there is no verdict")));
  EXPECT_THAT(verdict, Contains("7 of 60 cells have not ended and are left out."));
  const json& problem = page["problems"][1];
  EXPECT_EQ(problem["missing"], 7);
  EXPECT_THAT(problem["pairs"], IsEmpty());
  EXPECT_TRUE(problem["friedman"].is_null());
  const json& five = problem["results"][0];
  EXPECT_EQ(five["cells"].size(), 5u);
  EXPECT_TRUE(five["mean_rank"].is_null());
  EXPECT_TRUE(five["median_rank"].is_null());
  std::vector<double> values = whole.problems[1].optimizers[0].values;
  values.pop_back();
  EXPECT_EQ(five["median"], calc_spread(values).median);
  const json& none = problem["results"][1];
  EXPECT_THAT(none["cells"], IsEmpty());
  for (const char* key :
       {"min", "q1", "median", "q3", "max", "mean_rank", "median_rank", "anytime_area", "cases"}) {
    EXPECT_TRUE(none[key].is_null()) << key;
  }
  // The other problem is complete. It is the only one in the comparison over problems.
  EXPECT_EQ(page["problems"][0]["pairs"].size(), whole.problems[0].pairs.size());
  EXPECT_EQ(page["problems"][0]["missing"], 0);
  EXPECT_THAT(page["overall"]["pairs"], IsEmpty());
  EXPECT_EQ(page["overall"]["mean_ranks"].size(), plan.optimizers.size());
}

TEST_F(StudyPage, IsThereBeforeTheFirstCellHasEnded) {
  const StudyPlan plan = make_study_plan(make_arm_request());
  const StudyFolder folder(temporary_ / "study", plan);
  const json page = make("study");
  EXPECT_EQ(page["progress"]["done"], 0);
  EXPECT_TRUE(page["overall"].is_null());
  EXPECT_EQ(page["problems"][0]["missing"], 4);
  EXPECT_TRUE(page["problems"][0]["best_known"].is_null());
  EXPECT_EQ(page["replays"][0]["designs"].size(), 1u);  // the start
}

TEST_F(StudyPage, WhatHasNoNumberIsNull) {
  const StudyPlan plan = make_study_plan(make_small_request());
  study(plan, "study");
  const Cell cell{0, 1, 2};
  CellOutcome outcome = *load_cell(plan, cell, temporary_ / "study");
  outcome.x.clear();
  outcome.value = outcome.validation_value = std::numeric_limits<double>::infinity();
  outcome.failure = "its process was killed by \x1b[31msignal 11";
  outcome.end_reason = "optimizer failed";
  record(plan, cell, outcome);
  const json page = make("study");
  const json& result = page["problems"][0]["results"][1];
  EXPECT_EQ(result["infinite"], 1);
  EXPECT_EQ(result["failed"], 1);
  EXPECT_TRUE(result["max"].is_null());
  EXPECT_FALSE(result["median"].is_null());
  EXPECT_TRUE(result["cells"][1]["value"].is_null());
  EXPECT_THAT(result["cells"][1]["x"], IsEmpty());
  EXPECT_EQ(result["cells"][1]["failure"], "its process was killed by ?[31msignal 11");
}

TEST_F(StudyPage, FrontsHaveWhatNoPointOfTheirRunDominates) {
  const StudyPlan plan = make_study_plan(make_front_request());
  study(plan, "study");
  const json page = make("study", {.cases = {}, .simulate = false});
  const json& front = page["problems"][0]["front"];
  EXPECT_EQ(list_keys(front), read_contract("StudyFront"));
  EXPECT_EQ(front["objectives"].size(), 2u);
  EXPECT_EQ(front["reference_point"].size(), 2u);
  for (const json& optimizer : front["optimizers"]) {
    ASSERT_EQ(optimizer["attainment"].size(), 3u);
    EXPECT_EQ(optimizer["attainment"][1]["share"], 0.5);
    for (const json& a : optimizer["points"]) {
      for (const json& b : optimizer["points"]) {
        const bool dominates = a["replicate"] == b["replicate"] &&
                               a["values"][0] < b["values"][0] && a["values"][1] < b["values"][1];
        EXPECT_FALSE(dominates);
      }
    }
  }
  EXPECT_GT(front["optimizers"][0]["points"].size(), 0u);
}

TEST_F(StudyPage, OfAFrontWithManyPointsAtMostTwoHundredAreShown) {
  const StudyPlan plan = make_study_plan(make_front_request());
  study(plan, "study");
  CellOutcome outcome = *load_cell(plan, {0, 0, 1}, temporary_ / "study");
  outcome.front.clear();
  for (int i = 0; i < 1000; ++i) {
    outcome.front.push_back({1e-6 * i, 1e-6 * (1000 - i)});
    outcome.front.push_back({1, 1});  // dominated
  }
  record(plan, {0, 0, 1}, outcome);
  const json page = make("study", {.cases = {}, .simulate = false});
  int shown = 0;
  for (const json& point : page["problems"][0]["front"]["optimizers"][0]["points"]) {
    shown += point["replicate"] == 1 ? 1 : 0;
    EXPECT_LT(point["values"][0], 1);
  }
  EXPECT_EQ(shown, 200);
}

// Divides a shell command into words as a shell does.
std::vector<std::string> read_words(const std::string& command) {
  const std::string script =
      "set -- " + command + "; for word; do printf '%s\\037' \"$word\"; done";
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(
      popen(quote_command(std::vector<std::string>{"sh", "-c", script}).c_str(), "r"), pclose);
  std::string out;
  for (int c = std::fgetc(pipe.get()); c != EOF; c = std::fgetc(pipe.get())) {
    out += static_cast<char>(c);
  }
  auto words = split(out, '\x1f');
  words.pop_back();
  return words;
}

TEST_F(StudyPage, CommandsNameTheirCellsWhateverLabelsHold) {
  std::ofstream(temporary_ / "plan.toml") << R"(
replicates = 2
budget = 40
baselines = false
[[problem]]
name = "sphere"
label = "a/b"
[[problem]]
name = "sphere"
label = "a"
[[optimizer]]
name = "random"
label = "c"
[[optimizer]]
name = "random"
label = "b/c"
[[optimizer]]
name = "random"
label = "</script><img src=x onerror=alert(1)>'; rm -rf $HOME \" & \\"
)";
  StudyRequest request;
  request.file = (temporary_ / "plan.toml").string();
  const StudyPlan plan = make_study_plan(request);
  study(plan, "it's a study");
  const json page = make("it's a study");
  for (std::size_t p = 0; p < 2; ++p) {
    for (std::size_t o = 0; o < 3; ++o) {
      const json& cell = page["problems"][p]["results"][o]["cells"][1];
      const auto words = read_words(cell["command"]);
      ASSERT_EQ(words.size(), 4u);
      EXPECT_EQ(words[1], "rerun");
      EXPECT_EQ(words[2], (temporary_ / "it's a study").string());
      const Cell found = find_cell(plan, words[3]);
      EXPECT_EQ(found.problem, p);
      EXPECT_EQ(found.optimizer, o);
      EXPECT_EQ(found.replicate, 2);
      EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(cell["folder"]) / "cell.json"));
    }
  }
}

TEST(Friedman, OfBlocksThatAgreeHasTheOtherStatisticsP) {
  const std::vector<std::vector<double>> some = {{1, 2, 3}, {1, 3, 2}, {1, 2, 3}};
  const FriedmanTest test = calc_friedman_test(some);
  EXPECT_EQ(make_friedman(test), (json{{"statistic", test.f}, {"p", test.f_p_value}}));
  const std::vector<std::vector<double>> all = {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}};
  EXPECT_EQ(make_friedman(calc_friedman_test(all)),
            (json{{"statistic", nullptr}, {"p", calc_friedman_test(all).p_value}}));
  EXPECT_TRUE(make_friedman(std::nullopt).is_null());
}

TEST(RoundShown, KeepsNineDigits) {
  EXPECT_EQ(round_shown(1.0 / 3), 0.333333333);
  EXPECT_EQ(round_shown(-123456789012.0), -123456789000.0);
  EXPECT_EQ(round_shown(0), 0);
}

}  // namespace
}  // namespace armwright
