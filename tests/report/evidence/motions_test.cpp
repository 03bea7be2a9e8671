// Compares motions and distance responses with the results that they are made of.
#include "report/evidence/motions.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "problems/config/design_file.hpp"
#include "problems/load_tracking.hpp"
#include "report/evidence/distance_response.hpp"
#include "report/page/unpack.hpp"
#include "study/run_support.hpp"

namespace armwright {
namespace {

using nlohmann::json;

class Motions : public testing::Test {
 protected:
  std::shared_ptr<const TrackingProblem> problem_ =
      load_tracking("q1-complex", {"physics.engine=articulated"});
  ArmDesign design_ = load_design("table-a5").design;
  StopSignal stop_;
  SilentObserver observer_;
  PageSimulator simulator_{2, stop_, observer_};
};

TEST_F(Motions, TheLargestErrorOfAWindowIsThePointsError) {
  const TestSet set = problem_->get_set("test/2");
  const json replay = make_replay_set(simulator_, *problem_, {"run", "Motions"}, 0,
                                      std::vector<NamedDesign>{{"winner", "the winner", design_}},
                                      std::vector<ReplayRequest>{{set, 7, "a case"}});
  const TrackingResult result = problem_->track(design_, set, 7);
  const json& one = replay["cases"][0];
  const json& motion = one["motions"][0];
  EXPECT_EQ(one["id"], "test/2:7");
  EXPECT_EQ(motion["steps"], one["steps"]);
  EXPECT_EQ(motion["mean_error_m"], result.mean_error_m);
  EXPECT_EQ(one["points_m"].size(), one["segments"].size() + 1);
  const auto error = unpack_f32(motion["error_m"]);
  ASSERT_EQ(error.size(), one["steps"].get<std::size_t>());
  ASSERT_EQ(unpack_f32(one["target_m"]).size(), 3 * error.size());
  ASSERT_EQ(unpack_f32(one["target_q"]).size(), 4 * error.size());
  ASSERT_EQ(unpack_f32(motion["q"]).size(), 4 * error.size());
  ASSERT_EQ(unpack_f32(motion["effort"]).size(), 4 * error.size());
  ASSERT_EQ(one["segments"].size(), result.point_error_m.size());
  for (std::size_t k = 0; k < result.point_error_m.size(); ++k) {
    const json& segment = one["segments"][k];
    const std::size_t first = segment["first_step"];
    float largest = 0;
    for (std::size_t i = segment["window_start"]; i < segment["steps"]; ++i) {
      largest = std::max(largest, error[first + i]);
    }
    // The single precision of the largest value.
    EXPECT_NEAR(largest, result.point_error_m[k], 1e-7 * result.point_error_m[k] + 1e-12) << k;
    EXPECT_EQ(motion["point_error_m"][k], result.point_error_m[k]);
  }
}

TEST_F(Motions, ADivergedMotionGoesAsFarAsItWent) {
  ArmDesign wild = design_;
  for (JointDrive& joint : wild.joints) {
    joint.gains[2] = -1e9;
    joint.limits = {-1e9, 1e9};
  }
  const json replay = make_replay_set(
      simulator_, *problem_, {"run", "Motions"}, 0, std::vector<NamedDesign>{{"a", "a", wild}},
      std::vector<ReplayRequest>{{problem_->get_set("test/2"), 0, "a case"}});
  const json& motion = replay["cases"][0]["motions"][0];
  EXPECT_EQ(motion["status"], "diverged");
  EXPECT_NE(motion["reason"], "");
  EXPECT_TRUE(motion["mean_error_m"].is_null());
  EXPECT_LT(motion["steps"], replay["cases"][0]["steps"]);
  const auto error = unpack_f32(motion["error_m"]);
  EXPECT_EQ(error.size(), motion["steps"].get<std::size_t>());
  for (const float e : error) {
    EXPECT_TRUE(std::isfinite(e));
  }
}

TEST_F(Motions, DesignsWithASpeedOfTheirOwnHaveTheirOwnTargets) {
  ArmDesign slow = design_;
  slow.speed_m_per_s = 0.75;
  ArmDesign same = design_;
  same.speed_m_per_s = problem_->config().task.speed_m_per_s;
  const std::vector<NamedDesign> designs = {
      {"slow", "slow", slow}, {"plain", "plain", design_}, {"same", "same", same}};
  const auto groups = divide_by_motion(*problem_, designs);
  ASSERT_EQ(groups.size(), 2u);
  EXPECT_EQ(groups[1].size(), 2u);
  const ReplayText text = make_group_text({"run", "Motions"}, groups, 1);
  EXPECT_EQ(text.id, "run-2");
  EXPECT_EQ(text.title, "Motions: plain; same");
  const ReplayRequest request{problem_->get_set("test/2"), 0, "a case"};
  const auto replay = [&](std::size_t group) {
    return make_replay_set(simulator_, *problem_, text, 0, groups[group], std::span(&request, 1));
  };
  const json own = replay(0);
  EXPECT_EQ(own["task"]["speed_m_per_s"], 0.75);
  EXPECT_EQ(own["cases"][0]["motions"][0]["steps"], own["cases"][0]["steps"]);
  const json plain = replay(1);
  EXPECT_EQ(plain["cases"][0]["motions"][1]["steps"], plain["cases"][0]["steps"]);
  EXPECT_GT(own["cases"][0]["steps"], plain["cases"][0]["steps"]);
}

TEST_F(Motions, AResponseIsTheMeanOfEachPoint) {
  constexpr std::size_t kCases = 9;
  const auto results =
      simulator_.evaluate(*problem_, design_, problem_->get_set("test/2"), 0, kCases);
  EXPECT_EQ(observer_.last.done, kCases);
  const json response = make_distance_response(
      *problem_, {"distance-response", "title", "", ""},
      json::array({make_response_series(*problem_, "name", results, 0.0058, "command")}));
  const json& series = response["series"][0];
  double all = 0;
  for (std::size_t k = 0; k < 25; ++k) {
    double sum = 0;
    double squares = 0;
    for (const TrackingResult& result : results) {
      sum += result.point_error_m[k];
      squares += result.point_error_m[k] * result.point_error_m[k];
    }
    const double mean = sum / kCases;
    EXPECT_NEAR(series["mean_m"][k].get<double>(), mean, 1e-15);
    // This formula for the variance subtracts nearly equal numbers. Their rounding errors are 1e-16
    // of squares near 1e-5.
    EXPECT_NEAR(std::pow(series["standard_error_m"][k].get<double>(), 2),
                (squares - kCases * mean * mean) / (kCases - 1) / kCases, 1e-17);
    all += response["counted"][k] ? mean / 24 : 0;
  }
  EXPECT_NEAR(series["overall_mean_m"].get<double>(), all, 1e-15);
  EXPECT_EQ(response["counted"][0], false);
  EXPECT_DOUBLE_EQ(response["distances_m"][0].get<double>(), 0.8);
  EXPECT_DOUBLE_EQ(response["distances_m"][1].get<double>(), 1.6);
  EXPECT_DOUBLE_EQ(response["distances_m"][24].get<double>(), 0.05);
}

TEST(PointStatistics, LeaveOutCasesWithoutANumber) {
  std::vector<TrackingResult> results(3);
  results[0].point_error_m = {1, 2};
  results[1].point_error_m = {100};
  results[1].status = SimulationStatus::diverged;
  results[2].point_error_m = {3, 6};
  const PointStatistics statistics = calc_point_statistics(results, 2);
  EXPECT_EQ(statistics.mean_m, (std::vector<double>{2, 4}));
  EXPECT_EQ(statistics.standard_error_m, (std::vector<double>{1, 2}));
  EXPECT_TRUE(std::isnan(calc_point_statistics({}, 1).mean_m[0]));
}

TEST_F(Motions, AStopEndsTheSimulating) {
  stop_.request(StopReason::interrupted);
  EXPECT_THROW(simulator_.evaluate(*problem_, design_, problem_->get_set("test/2"), 0, 3),
               WorkStopped);
}

}  // namespace
}  // namespace armwright
