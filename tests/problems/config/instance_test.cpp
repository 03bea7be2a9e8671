// Instances of functions: the keys of [function], what is recorded, and what a replicate gets.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "problems/config/problem_loader.hpp"
#include "problems/problem_folder.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kFunctionHead = "kind = 'analytic'\n[function]\n";

LoadedProblem load_with(const std::string& name, const std::vector<std::string>& overrides) {
  return load_problem(name, overrides);
}

const std::vector<double>& get_minimiser(const LoadedProblem& problem) {
  return problem.problem->description().known_optimum;
}

LoadedProblem make_one(const LoadedProblem& problem, int replicate) {
  return make_replicate(problem, replicate, "train/x",
                        std::vector<double>(get_minimiser(problem).size(), 0.5));
}

// A configuration recorded by version 1.0 has none of the keys.
TEST(Instances, WithoutAKeyAFunctionHasThePlainFormOfVersion1) {
  const ProblemFolder folder;
  folder.write("p.toml", std::string(kFunctionHead) + "name = 'rastrigin'\ndimension = 3\n");
  const LoadedProblem loaded = folder.load("p.toml");
  ASSERT_TRUE(loaded.function.has_value());
  EXPECT_EQ(loaded.function->instance, 0);
  EXPECT_EQ(get_minimiser(loaded),
            get_minimiser(load_with("rastrigin", {"function.instance=0", "function.dimension=3"})));
  EXPECT_EQ(loaded.resolved_json,
            R"({"function":{"dimension":3,"name":"rastrigin"},"kind":"analytic"})");
  EXPECT_EQ(get_minimiser(make_one(loaded, 1)), get_minimiser(make_one(loaded, 2)));
}

TEST(Instances, ThePlainFormIsRecordedAsVersion1Did) {
  const LoadedProblem plain = load_with("sphere", {"function.instance=0"});
  EXPECT_EQ(json::parse(plain.resolved_json).at("function"), json({{"name", "sphere"}}));
  EXPECT_EQ(get_minimiser(plain), make_analytic("sphere", 10)->description().known_optimum);
}

TEST(Instances, ShippedFunctionsHaveAnotherInstancePerReplicate) {
  for (const std::string name :
       {"sphere", "ellipsoid", "rosenbrock", "rastrigin", "sphere-int", "ellipsoid-int", "bbob-f1",
        "bbob-f2", "bbob-f3", "bbob-f8", "bbob-f10", "bbob-f15"}) {
    SCOPED_TRACE(name);
    const LoadedProblem loaded = load_problem(name);
    EXPECT_EQ(loaded.function->instance, 1);
    EXPECT_EQ(loaded.problem->description().optimum, 0);
    const LoadedProblem first = make_one(loaded, 1);
    const LoadedProblem fifth = make_one(loaded, 5);
    EXPECT_EQ(get_minimiser(first), get_minimiser(loaded));
    EXPECT_NE(get_minimiser(fifth), get_minimiser(loaded));
    EXPECT_EQ(get_minimiser(fifth), get_minimiser(make_one(loaded, 5))) << "for every optimizer";
    EXPECT_EQ(get_minimiser(fifth), get_minimiser(load_with(name, {"function.instance=5"})));
    EXPECT_EQ(fifth.problem->description().variables[0].start, 0.5);
  }
  EXPECT_EQ(load_problem("constrained").function->instance, 0);
}

TEST(Instances, ARecordedReplicateIsLoadedWithItsInstance) {
  const LoadedProblem fifth = make_one(load_problem("rosenbrock"), 5);
  const json function = json::parse(fifth.resolved_json).at("function");
  EXPECT_EQ(function.at("instance"), 5);
  EXPECT_EQ(function.at("instance_per_replicate"), false);
  const LoadedProblem again = load_recorded_problem(fifth.resolved_json, "rosenbrock", ".");
  EXPECT_EQ(get_minimiser(again), get_minimiser(fifth));
  EXPECT_EQ(json::parse(again.resolved_json), json::parse(fifth.resolved_json));
}

TEST(Instances, AFixedInstanceIsTheSameForAllReplicates) {
  const LoadedProblem loaded =
      load_with("sphere", {"function.instance=7", "function.instance_per_replicate=false"});
  EXPECT_EQ(get_minimiser(make_one(loaded, 1)), get_minimiser(loaded));
  EXPECT_EQ(get_minimiser(make_one(loaded, 9)), get_minimiser(loaded));
  EXPECT_NE(get_minimiser(loaded), get_minimiser(load_problem("sphere")));
}

TEST(Instances, FunctionsOfBbobHaveTheirFOptUnlessToldOtherwise) {
  const ProblemFolder folder;
  folder.write("p.toml", std::string(kFunctionHead) + "name = 'bbob-f1'\n");
  const LoadedProblem loaded = folder.load("p.toml");
  EXPECT_EQ(loaded.problem->description().optimum, 79.48);  // instance 1 of the reference code
  EXPECT_THAT(loaded.resolved_json, HasSubstr(R"("instance":1)"));
  folder.write("p.toml", std::string(kFunctionHead) + "name = 'bbob-f1'\nadd_f_opt = false\n");
  EXPECT_EQ(folder.load("p.toml").problem->description().optimum, 0);
}

TEST(Instances, MistakesAreNamed) {
  const ProblemFolder folder;
  const auto refusal_of = [&](const std::string& text) {
    return folder.refusal_of(kFunctionHead + text);
  };
  EXPECT_EQ(refusal_of("name = 'sphere'\ninstance = -1"),
            "p.toml:4: function.instance is -1; it must be an integer from 0 to 200000");
  EXPECT_EQ(refusal_of("name = 'bbob-f8'\ninstance = 0"),
            "p.toml:4: function.instance is 0; bbob-f8 has no plain form; its instances are 1 to "
            "200000");
  EXPECT_EQ(refusal_of("name = 'constrained'\ninstance = 1"),
            "p.toml:4: function.instance is 1; constrained has the plain form only, instance 0");
  EXPECT_EQ(refusal_of("name = 'sphere'\nadd_f_opt = true"),
            "p.toml:4: function.add_f_opt is true; sphere has no f_opt; its minimum is 0");
  EXPECT_EQ(refusal_of("name = 'bbob-f3'\ninstance_per_replicate = true"),
            "p.toml:4: function.instance_per_replicate is true; replicates whose minima differ "
            "cannot be compared; set function.add_f_opt to false");
  const LoadedProblem highest = load_with("sphere", {"function.instance=200000"});
  EXPECT_EQ(make_one(highest, 1).function->instance, 200000);
  EXPECT_EQ(usage_error_of([&] { make_one(highest, 2); }),
            "problem 'sphere': replicate 2 needs an instance above 200000, the highest; choose a "
            "lower function.instance than 200000");
}

// Which solver of the numeric inverse kinematics a recorded problem has.

LoadedProblem load_arm(std::vector<std::string> overrides = {}) {
  // With a given workspace, none has to be proposed.
  overrides.insert(overrides.end(), {"robot.urdf=irb4600_six", "workspace.centre_m=[1.4,0,0.9]",
                                     "workspace.radius_m=0.3"});
  return load_problem("robot", overrides);
}

NumericSolver get_solver(const LoadedProblem& problem) {
  return problem.tracking()->setup().task().solver;
}

TEST(RecordedSolver, OfANewRunIsRecordedAndReadAgain) {
  const LoadedProblem problem = load_arm();
  EXPECT_EQ(get_solver(problem), NumericSolver::lanes);
  EXPECT_EQ(json::parse(problem.resolved_json)["task"]["solver"], "lanes");
  const LoadedProblem again = load_recorded_problem(problem.resolved_json, "robot", "/nowhere");
  EXPECT_EQ(get_solver(again), NumericSolver::lanes);
  EXPECT_EQ(again.resolved_json, problem.resolved_json);
}

// So recorded version 1.0, which had only this solver.
TEST(RecordedSolver, IsTheScalarOneWhereTheRecordHasNone) {
  const LoadedProblem problem = load_arm({"task.solver=scalar"});
  EXPECT_EQ(get_solver(problem), NumericSolver::scalar);
  EXPECT_FALSE(json::parse(problem.resolved_json)["task"].contains("solver"));
  const LoadedProblem again = load_recorded_problem(problem.resolved_json, "robot", "/nowhere");
  EXPECT_EQ(get_solver(again), NumericSolver::scalar);
  EXPECT_EQ(again.resolved_json, problem.resolved_json);
  const auto calc_targets = [](const LoadedProblem& its) {
    return its.tracking()->setup().make_targets(its.tracking()->get_set("test/1").make_case(3));
  };
  EXPECT_EQ(calc_targets(again).joint_positions, calc_targets(problem).joint_positions);
}

TEST(RecordedSolver, IsLeftOutWhereTheArmHasAClosedForm) {
  const LoadedProblem problem = load_problem("q1-complex");
  EXPECT_FALSE(json::parse(problem.resolved_json)["task"].contains("solver"));
}

// Version 1.0 recorded no [task] for a file without one, also when it read the record again.
TEST(RecordedSolver, AddsNoTask) {
  const ProblemFolder folder;
  folder.write("p.toml",
               "kind = 'tracking'\n[robot]\nurdf = 'irb4600_40_255'\n[variables]\n"
               "start = 'table-a1'\n[[variables.joint]]\nname = 'joint_1'\noptimize = ['p']\n");
  const LoadedProblem problem = folder.load("p.toml");
  EXPECT_FALSE(json::parse(problem.resolved_json).contains("task"));
  const LoadedProblem again = load_recorded_problem(problem.resolved_json, "p", "/nowhere");
  EXPECT_EQ(again.resolved_json, problem.resolved_json);
}

TEST(RecordedSolver, OfAnotherNameIsRefused) {
  const ProblemFolder folder;
  EXPECT_THAT(folder.refusal_of_base_with("[task]\nsolver = \"eigen\"\n"),
              HasSubstr("p.toml:3: unknown task.solver 'eigen'. Valid: lanes, scalar"));
}

}  // namespace
}  // namespace armwright
