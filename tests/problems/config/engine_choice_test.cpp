// The choice of engines: which engine simulates which cases, and what the configuration records.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "base/config.hpp"
#include "base/expect_error.hpp"
#include "problems/config/config_files.hpp"
#include "problems/config/problem_loader.hpp"
#include "problems/lanes_engine.hpp"
#include "problems/load_tracking.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

LoadedProblem load_with_lanes(std::vector<std::string> overrides) {
  overrides.insert(overrides.begin(), {"physics.engine=ode", "workspace.points=4"});
  return load_problem("q1-complex", overrides, engines_with_lanes());
}

std::shared_ptr<const TrackingProblem> track_with_lanes(std::vector<std::string> overrides) {
  return share_tracking(load_with_lanes(std::move(overrides)));
}

std::string refusal_of(const std::vector<std::string>& overrides) {
  return usage_error_of([&] { load_with_lanes(overrides); });
}

const std::string kLevel = "scalar";  // every machine has it

double calc_lanes_error_m(const TrackingProblem& problem, std::span<const double> x,
                          const std::string& set, std::uint64_t number, Precision precision) {
  const TargetTable targets = problem.setup().make_targets(problem.get_set(set).make_case(number));
  return LanesEngine::calc_error_m(problem.make_design(x), targets, precision);
}

double simulate(const TrackingProblem& problem, std::span<const double> x, CaseRole role) {
  const CaseBlock block{role, role == CaseRole::training ? "train/1" : "test/2", {3}};
  return problem.evaluate(x, block).case_errors.at(0);
}

TEST(EngineChoice, OneEngineTrainsAndJudgesUnlessTheProblemSaysOtherwise) {
  const LoadedProblem loaded = load_with_lanes({});
  const EnginePair& engines = loaded.tracking()->config().engines;
  EXPECT_EQ(engines.training_name, "ode");
  EXPECT_EQ(engines.judging_name, "ode");
  EXPECT_EQ(engines.training, engines.judging);
  EXPECT_EQ(loaded.tracking()->batch_size(CaseRole::training).largest, 1U);
}

TEST(EngineChoice, NothingIsAddedToTheConfigurationOfOde) {
  for (const std::string setting : {"physics.engine=ode", "physics.simd=auto"}) {
    const std::vector<std::string> overrides = {"physics.engine=ode", setting};
    const auto file = resolve_config("problems", "q1-complex");
    EXPECT_EQ(json::parse(load_problem("q1-complex", overrides).resolved_json).at("physics"),
              json::parse(ConfigTable::load(file, overrides).to_json()).at("physics"));
  }
}

TEST(EngineChoice, TheSimdLevelInUseIsRecorded) {
  const auto get_recorded = [](const std::vector<std::string>& overrides) {
    return json::parse(load_with_lanes(overrides).resolved_json).at("physics").at("simd");
  };
  const std::string best = to_string(find_best_simd());
  EXPECT_EQ(get_recorded({"physics.engine=lanes"}), best);
  EXPECT_EQ(get_recorded({"physics.engine=lanes", "physics.simd=auto"}), best);
  EXPECT_EQ(get_recorded({"physics.engine=lanes", "physics.simd=" + kLevel}), kLevel);
  EXPECT_EQ(get_recorded({"physics.judging_engine=lanes"}), best);
  EXPECT_EQ(get_recorded({"physics.engine=lanes", "physics.judging_engine=ode"}), best);
}

TEST(EngineChoice, FloatIsForTrainingOnly) {
  const auto problem = track_with_lanes({"physics.engine=lanes", "physics.precision=float"});
  const std::vector<double> x = problem->make_vector(problem->config().start);
  for (const auto role : {CaseRole::training, CaseRole::validation, CaseRole::test}) {
    const bool training = role == CaseRole::training;
    const std::string set = training ? "train/1" : "test/2";
    const double in_double = calc_lanes_error_m(*problem, x, set, 3, Precision::double_);
    const double in_float = calc_lanes_error_m(*problem, x, set, 3, Precision::single);
    ASSERT_NE(in_double, in_float);
    EXPECT_EQ(simulate(*problem, x, role), training ? in_float : in_double);
  }
  const double in_double = calc_lanes_error_m(*problem, x, "test/2", 3, Precision::double_);
  EXPECT_EQ(problem->track(problem->config().start, problem->get_set("test/2"), 3).mean_error_m,
            in_double);
}

TEST(EngineChoice, AnotherEngineJudges) {
  const auto problem = track_with_lanes(
      {"physics.engine=lanes", "physics.judging_engine=ode", "physics.precision=float"});
  EXPECT_EQ(problem->config().engines.judging_name, "ode");
  const auto ode = track_with_lanes({});
  const std::vector<double> x = problem->make_vector(problem->config().start);
  EXPECT_EQ(simulate(*problem, x, CaseRole::training),
            calc_lanes_error_m(*problem, x, "train/1", 3, Precision::single));
  for (const auto role : {CaseRole::validation, CaseRole::test}) {
    EXPECT_EQ(simulate(*problem, x, role), simulate(*ode, x, role));
  }
  EXPECT_EQ(problem->batch_size(CaseRole::training).largest, 16U);
  EXPECT_EQ(problem->batch_size(CaseRole::training).granularity, 4U);
  EXPECT_EQ(problem->batch_size(CaseRole::validation).largest, 1U);
}

TEST(EngineChoice, OneCallMayMixWhatDifferentEnginesSimulate) {
  const auto problem = track_with_lanes({"physics.engine=lanes", "physics.judging_engine=ode"});
  const std::vector<double> x = problem->make_vector(problem->config().start);
  const CaseBlock train{CaseRole::training, "train/1", {3}};
  const CaseBlock test{CaseRole::test, "test/2", {3}};
  std::vector<CaseJob> jobs;
  for (const CaseBlock* block : {&train, &test, &test, &train, &test}) {
    jobs.push_back({.x = x, .block = block, .number = 3});
  }
  const auto outcomes = problem->simulate(jobs);
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    EXPECT_EQ(outcomes.at(i).error, simulate(*problem, x, jobs[i].block->role)) << i;
  }
}

TEST(EngineChoice, EveryTableOfTargetsIsMadeOnceForAllOfABatch) {
  const auto problem = track_with_lanes({"physics.engine=lanes"});
  const std::vector<double> x = problem->make_vector(problem->config().start);
  std::vector<double> y = x;
  y[0] *= 2;
  const CaseBlock block{CaseRole::training, "train/1", {4, 2, 4}};
  std::vector<CaseJob> jobs;
  for (const auto& point : {x, y}) {
    for (const std::uint64_t number : block.numbers) {
      jobs.push_back({.x = point == x ? x : y, .block = &block, .number = number});
    }
  }
  const auto outcomes = problem->simulate(jobs);
  EXPECT_EQ(problem->targets().computed(), 2U);
  EXPECT_EQ(outcomes[0].error, outcomes[2].error);
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    EXPECT_EQ(outcomes[i].error, calc_lanes_error_m(*problem, jobs[i].x, "train/1", jobs[i].number,
                                                    Precision::double_));
  }
}

TEST(EngineChoice, SeveralCasesOfADesignAreTrackedAsOneByOne) {
  const auto problem = track_with_lanes({"physics.judging_engine=lanes"});
  const TestSet set = problem->get_set("test/5");
  const auto together = problem->track(problem->config().start, set, 2, 3, {});
  ASSERT_EQ(together.size(), 3U);
  for (std::uint64_t i = 0; i < 3; ++i) {
    EXPECT_EQ(together[i].mean_error_m,
              problem->track(problem->config().start, set, 2 + i).mean_error_m);
  }
}

TEST(EngineChoice, WhatAnEngineDoesNotHaveIsRefused) {
  EXPECT_THAT(refusal_of({"physics.precision=float"}),
              AllOf(HasSubstr("--set physics.precision=float: physics.precision is"),
                    HasSubstr("engine 'ode' always computes in double")));
  EXPECT_THAT(refusal_of({"physics.simd=" + kLevel}),
              AllOf(HasSubstr("physics.simd is"), HasSubstr("engine 'ode' has none to choose"),
                    HasSubstr("('auto' suits every engine)")));
  // The judging engine always uses double, so the setting is for the training engine, ODE.
  EXPECT_THAT(refusal_of({"physics.judging_engine=lanes", "physics.precision=float"}),
              HasSubstr("engine 'ode' always computes in double"));
  EXPECT_THAT(refusal_of({"physics.engine=lane"}), HasSubstr("'lanes'"));
  EXPECT_THAT(refusal_of({"physics.judging_engine=lane"}), HasSubstr("'lanes'"));
  EXPECT_THAT(refusal_of({"physics.engine=lanes", "physics.simd=avx"}), HasSubstr("avx2"));
  EXPECT_THAT(refusal_of({"physics.engine=lanes", "physics.precision=half"}), HasSubstr("float"));
}

TEST(EngineChoice, ALevelThatTheCpuLacksIsRefused) {
  if (is_supported(SimdLevel::avx512)) {
    GTEST_SKIP() << "this CPU has every level";
  }
  EXPECT_THAT(refusal_of({"physics.engine=lanes", "physics.simd=avx512"}),
              AllOf(HasSubstr("--set physics.simd=avx512: physics.simd is"),
                    HasSubstr("this CPU lacks; possible here: scalar")));
}

}  // namespace
}  // namespace armwright
