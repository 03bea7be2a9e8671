#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "report/formats/formats.hpp"
#include "report/hand_made_traces.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;

TEST(IohRows, AreTheFirstTheImprovementsAndTheLast) {
  EXPECT_EQ(make_ioh_rows(make_trace({3.0, 4.0, 2.5, 2.5, 1e-12, 7.0, 0.1})),
            "evaluations raw_y simulated_cases feasible x0\n"
            "1 3 1 1 0.5\n"
            "3 2.5 3 1 0.5\n"
            "5 1e-12 5 1 0.5\n"
            "7 0.1 7 1 0.5\n");
}

TEST(IohRows, HaveNoSecondRowForALastImprovement) {
  EXPECT_EQ(make_ioh_rows(make_trace({3.0, 2.0})),
            "evaluations raw_y simulated_cases feasible x0\n"
            "1 3 1 1 0.5\n"
            "2 2 2 1 0.5\n");
}

TEST(IohRows, ShowWhatIsNotFeasibleAsInfinite) {
  EXPECT_EQ(make_ioh_rows(make_trace({std::nullopt, -1.0, std::nullopt})),
            "evaluations raw_y simulated_cases feasible x0\n"
            "1 inf 1 0 0.5\n"
            "2 -1 2 1 0.5\n"
            "3 inf 3 0 0.5\n");
  EXPECT_EQ(make_ioh_rows(make_trace({std::nullopt, std::nullopt})),
            "evaluations raw_y simulated_cases feasible x0\n"
            "1 inf 1 0 0.5\n"
            "2 inf 2 0 0.5\n");
}

TEST(IohRows, BearMetricsAndSeveralObjectivesAndSayWhereThereIsNone) {
  RunTrace trace = make_trace({2.0, std::nullopt}, [](std::vector<TracedEvaluation>& evaluations) {
    evaluations[0].objectives = {0.5, 3};
    evaluations[0].metrics = {0.25};
    evaluations[0].simulated_cases = 5;
    evaluations[1].simulated_cases = 10;
  });
  trace.names.objectives = {"error", "torque"};
  trace.names.metrics = {"energy"};
  EXPECT_EQ(make_ioh_rows(trace),
            "evaluations raw_y simulated_cases feasible error torque energy x0\n"
            "1 2 5 1 0.5 3 0.25 0.5\n"
            "2 inf 10 0 None None None 0.5\n");
}

TEST(IohColumns, AreToldApartFromEachOtherAndFromVariables) {
  TraceNames names;
  names.objectives = {"error"};
  names.metrics = {"raw y", "x1", "x", "Feasible", "a b", "a-b", "1"};
  EXPECT_THAT(make_ioh_columns(names),
              ElementsAre("evaluations", "raw_y", "simulated_cases", "feasible", "raw_y_2", "c_x1",
                          "x", "Feasible_2", "a_b", "a_b_2", "c_1"));
}

}  // namespace
}  // namespace armwright
