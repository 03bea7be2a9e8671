// Makes pages of tiny runs of every kind and checks their JSON.
#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/temporary_folder.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "problems/config/config_files.hpp"
#include "problems/config/design_file.hpp"
#include "problems/config/problem_loader.hpp"
#include "problems/tracking/tracking_problem.hpp"
#include "report/page/data_contract.hpp"
#include "report/page/page_data.hpp"
#include "report/page/unpack.hpp"
#include "study/run_support.hpp"
#include "study/verification/winner_check.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

// Returns the fields of an interface of the page's data, without those of its base.
std::set<std::string> read_interface(const std::string& name) {
  std::istringstream file(read_page_types());
  const std::regex field("^  (\\w+)\\??: .*");
  std::set<std::string> fields;
  bool inside = false;
  for (std::string line; std::getline(file, line);) {
    std::smatch match;
    if (line.starts_with("export interface " + name + " ")) {
      inside = true;
    } else if (line.starts_with("}")) {
      inside = false;
    } else if (inside && std::regex_match(line, match, field)) {
      fields.insert(match[1]);
    }
  }
  return fields;
}

void expect_interface(const json& object, const std::vector<std::string>& interfaces) {
  std::set<std::string> expected;
  for (const std::string& name : interfaces) {
    expected.merge(read_interface(name));
  }
  std::set<std::string> keys;
  for (const auto& [key, value] : object.items()) {
    keys.insert(key);
  }
  EXPECT_EQ(keys, expected) << interfaces.front();
}

class RunPage : public RunTest {
 protected:
  RunPlan make_plan(const std::string& problem, const std::string& optimizer, std::int64_t budget,
                    std::vector<std::string> overrides = {}) {
    RunPlan plan;
    const bool arm = problem != "rastrigin" && !problem.starts_with("gasparetto");
    if (arm) {
      overrides.insert(overrides.end(), {"physics.engine=articulated", "sets.validation_cases=3",
                                         "sets.test_cases=6"});
    }
    plan.problem = load_problem(problem, overrides);
    plan.optimizer = load_optimizer(optimizer);
    const std::vector<std::string> options =
        optimizer == "ga" ? std::vector<std::string>{"population=8"} : std::vector<std::string>{};
    plan.options = Options::parse(optimizer, plan.optimizer.options, options);
    plan.budget = budget;
    plan.schedule = choose_schedule(plan.problem, plan.optimizer);
    words_ = {"/somewhere/armwright", "optimize", problem, "--set", "physics.engine=articulated"};
    return plan;
  }
  void make_run(const RunPlan& plan, const std::string& folder) {
    StopSignal stop;
    ASSERT_TRUE(execute_run({plan, temporary_ / folder, 2, words_}, stop, observer_));
  }
  std::string make_text(const std::string& folder, const PageOptions& options = {}) {
    StopSignal stop;
    return make_run_page(temporary_ / folder, options, stop, observer_).value();
  }
  json make_page(const std::string& folder, const PageOptions& options = {}) {
    return json::parse(make_text(folder, options));
  }
  static std::vector<std::string> notes_of(const json& page) {
    return page["notes"].get<std::vector<std::string>>();
  }
  std::vector<std::string> words_;
};

TEST_F(RunPage, HasWhatTheContractSaysForAnArm) {
  make_run(make_plan("q1-complex", "ga", 24), "a");
  PageOptions options;
  options.cases = {"test/2:17"};
  const json page = make_page("a", options);
  expect_interface(page, {"RunData", "PageBase"});
  expect_interface(page["training"], {"Training"});
  expect_interface(page["training"]["incumbents"], {"Incumbents"});
  expect_interface(page["variables"][0], {"VariableHistory"});
  expect_interface(page["test"], {"TestErrors"});
  expect_interface(page["arm"], {"ArmEvidence"});
  expect_interface(page["arm"]["response"], {"DistanceResponse"});
  expect_interface(page["arm"]["response"]["series"][0], {"ResponseSeries"});
  expect_interface(page["arm"]["signals"], {"Signals"});
  expect_interface(page["arm"]["signals"]["curves"][0], {"SignalCurve"});
  expect_interface(page["arm"]["sweep"], {"Sweep"});
  expect_interface(page["arm"]["designs"][0], {"DesignInfo"});
  expect_interface(page["headline"], {"Headline"});
  expect_interface(page["headline"]["motion"], {"MotionErrors"});
  const json& health = page["arm"]["health"];
  expect_interface(health, {"Health"});
  expect_interface(health["joints"][0], {"JointHealth"});
  expect_interface(health["moves"], {"MoveHealth"});
  const json& replay = page["replays"][0];
  expect_interface(replay, {"ReplaySet"});
  expect_interface(replay["task"], {"TaskInfo"});
  expect_interface(replay["cases"][0], {"ReplayCase"});
  expect_interface(replay["cases"][0]["segments"][0], {"Segment"});
  expect_interface(replay["cases"][0]["motions"][0], {"Motion"});
  expect_interface(page["robots"][0], {"Robot"});

  EXPECT_EQ(page["training"]["index"], json({1, 2, 3}));
  EXPECT_EQ(page["training"]["cases"], json({8, 16, 24}));
  EXPECT_EQ(page["variables"].size(), 20u);
  EXPECT_EQ(page["arm"]["parameters"].size(), 20u);
  EXPECT_EQ(page["training"]["incumbents"]["test"].size(), 3u);
  EXPECT_EQ(replay["cases"].back()["id"], "test/2:17");
  std::set<std::string> ids;
  for (const json& one : replay["cases"]) {
    EXPECT_TRUE(ids.insert(one["id"]).second) << one["id"];
    EXPECT_EQ(one["motions"].size(), 3u);
  }
  EXPECT_TRUE(ids.contains("train/1:1"));
  EXPECT_TRUE(ids.contains("test/2:0"));
  EXPECT_EQ(page["command"], "armwright optimize q1-complex --set physics.engine=articulated");
  // The simulation repeats the errors that the run recorded.
  EXPECT_EQ(page["notes"], json::array());
  EXPECT_EQ(page["arm"]["results"][0]["cases"], 6);
  EXPECT_EQ(page["test"]["designs"].size(), 3u);
}

TEST_F(RunPage, HasTheHealthOfTheWinnerOnTheMedianCase) {
  make_run(make_plan("q1-complex", "ga", 24), "a");
  const json page = make_page("a");
  const json& health = page["arm"]["health"];
  EXPECT_EQ(health["joints"].size(), 4u);
  EXPECT_EQ(health["cases"], 6);
  EXPECT_EQ(health["moves"]["count"], 24);  // the first of 25 points does not count
  const json& replay = page["replays"][0];
  // The page opens with the first case, the median by error.
  const json& median = replay["cases"][0];
  ASSERT_EQ(median["id"], health["case"]);
  const auto label = median["label"].get<std::string>();
  EXPECT_TRUE(label.ends_with("the median of 6 by error")) << label;
  // The replay has the same efforts in single precision.
  const json& motion = median["motions"][0];
  const auto efforts = unpack_f32(motion["effort"]);
  for (std::size_t joint = 0; joint < 4; ++joint) {
    const json& limits = replay["designs"][0]["effort_limits"][joint];
    double used = 0;
    for (std::size_t i = joint; i < efforts.size(); i += 4) {
      const double limit = limits[efforts[i] < 0 ? 0 : 1];
      used = std::max(used, efforts[i] / limit);
    }
    EXPECT_NEAR(health["joints"][joint]["used_share"].get<double>(), used, 1e-6);
  }

  PageOptions options;
  options.simulate = false;
  const json without = make_page("a", options);
  EXPECT_TRUE(without["arm"]["health"].is_null());
  EXPECT_EQ(without["headline"], page["headline"]);
  EXPECT_EQ(page["headline"]["cases"], 24);
  EXPECT_EQ(page["headline"]["test_cases"], 6);
  EXPECT_EQ(page["headline"]["value"], page["arm"]["results"][0]["mean_m"]);
  EXPECT_EQ(page["headline"]["total_torque_n_m"], page["arm"]["results"][0]["total_torque_n_m"]);
}

TEST_F(RunPage, HasTheCheckOfTheWinnerIfItWasMade) {
  const RunPlan plan = make_plan("q1-complex", "ga", 8);
  make_run(plan, "a");
  EXPECT_TRUE(make_page("a")["arm"]["health"]["check"].is_null());
  const ProblemLoader load = [](std::vector<std::string> changes) {
    changes.emplace_back("sets.test_cases=6");
    return load_problem("q1-complex", changes);
  };
  StopSignal stop;
  ASSERT_TRUE(check_winner({plan, temporary_ / "a", 2, words_}, load_result(temporary_ / "a"), load,
                           stop, observer_));
  const json check = make_page("a")["arm"]["health"]["check"];
  expect_interface(check, {"WinnerCheck"});
  expect_interface(check["settings"][0], {"CheckedSetting"});
  EXPECT_EQ(check["cases"], 6);
  EXPECT_EQ(check["settings"][0]["name"], "engine ode");
}

TEST_F(RunPage, IsTheSameForAnyNumberOfThreads) {
  make_run(make_plan("q1-complex", "ga", 16), "a");
  PageOptions two;
  two.jobs = 2;
  EXPECT_EQ(make_text("a"), make_text("a", two));
}

TEST_F(RunPage, CommandsLeadToTheRunsProblem) {
  make_run(make_plan("q1-complex", "ga", 16, {"task.load_kg=3"}), "a");
  const json page = make_page("a");
  const std::string command = page["arm"]["response"]["series"][0]["command"];
  EXPECT_THAT(command, HasSubstr("/a/winner.toml --problem q1-complex "));
  EXPECT_THAT(command, HasSubstr("--set task.load_kg=3"));
  EXPECT_THAT(command, HasSubstr("--test-set test/2 --cases 6"));
  // The published numbers belong to the arm without a load.
  for (const json& row : page["arm"]["results"]) {
    EXPECT_TRUE(row["published_mean_m"].is_null());
  }
}

TEST_F(RunPage, CommandsNameMotorsAndPlants) {
  make_run(make_plan("q1-complex", "ga", 16,
                     {"motors.torque_per_mass_n_m_per_kg=50", "perturbation.mass_relative=0.1",
                      "perturbation.load_kg=[1,2]"}),
           "a");
  const std::string command = make_page("a")["arm"]["response"]["series"][0]["command"];
  EXPECT_THAT(command, HasSubstr("motors.torque_per_mass_n_m_per_kg=50"));
  EXPECT_THAT(command, HasSubstr("perturbation.mass_relative=0.1"));
  EXPECT_THAT(command, HasSubstr("perturbation.load_kg=[1"));
  // The manifest records a preset as its settings.
  make_run(make_plan("q1-complex", "ga", 16, {"perturbation.preset=weak"}), "b");
  const std::string other = make_page("b")["arm"]["response"]["series"][0]["command"];
  EXPECT_THAT(other, HasSubstr("--set perturbation.effort_limit_sigma="));
}

TEST_F(RunPage, SweepsNoDesignWithASpeedOfItsOwn) {
  make_run(make_plan("q1-complex", "ga", 200,
                     {R"(variables.task=["speed"])", "physics.engine=articulated"}),
           "a");
  const json page = make_page("a");
  const json& sweep = page["arm"]["sweep"];
  ASSERT_EQ(sweep["series"].size(), 1u);  // the published design
  EXPECT_EQ(sweep["series"][0]["name"], page["arm"]["designs"][2]["name"]);
  EXPECT_THAT(sweep["command"].get<std::string>(), Not(HasSubstr("winner.toml")));
  EXPECT_THAT(notes_of(page), Contains(HasSubstr("leaves out winner.")));
  // The signals have the winner's own speed too.
  const auto speed = page["arm"]["signals"]["speed_m_per_s"].get<double>();
  EXPECT_NE(speed, 1.5);
  EXPECT_EQ(speed, page["replays"][0]["task"]["speed_m_per_s"]);
}

TEST_F(RunPage, SaysThatATrainingCaseIsReplayedOnAnotherPlant) {
  const auto get_label = [&](const std::string& folder, std::vector<std::string> overrides) {
    make_run(make_plan("q1-complex", "ga", 16, std::move(overrides)), folder);
    const json page = make_page(folder);
    const json& training = page["replays"][0]["cases"].back();
    EXPECT_EQ(training["set"], "train/1");
    return training["label"].get<std::string>();
  };
  const std::string mass = "perturbation.mass_relative=0.1";
  EXPECT_THAT(get_label("a", {mass}), Not(HasSubstr("plant")));
  EXPECT_THAT(get_label("b", {mass, "perturbation.apply_to=training"}),
              HasSubstr("here on the nominal one"));
  EXPECT_THAT(get_label("c", {mass, "perturbation.apply_to=judging"}),
              HasSubstr("here on a perturbed one"));
}

TEST_F(RunPage, DesignsThatMoveAnotherArmHaveAReplayOfTheirOwn) {
  make_run(make_plan("q1-complex", "ga", 16, {R"(variables.optimize=["p","length_scale"])"}), "a");
  const json page = make_page("a");
  ASSERT_EQ(page["replays"].size(), 2u);
  const json& own = page["replays"][0];
  const json& nominal = page["replays"][1];
  EXPECT_EQ(own["title"], "Motions: winner");
  ASSERT_EQ(own["designs"].size(), 1u);
  EXPECT_EQ(nominal["designs"].size(), 2u);
  EXPECT_NE(own["id"], nominal["id"]);
  const auto get_end = [&](const json& replay) {
    return page["robots"][replay["robot"].get<std::size_t>()]["joints"][2]["origin"]["position"];
  };
  EXPECT_NE(get_end(own), get_end(nominal));
  EXPECT_NE(own["cases"][1]["start_q"], nominal["cases"][1]["start_q"]);
}

TEST_F(RunPage, OfAFunctionHasNoArm) {
  make_run(make_plan("rastrigin", "random", 900), "a");
  const json page = make_page("a");
  expect_interface(page, {"RunData", "PageBase"});
  EXPECT_TRUE(page["arm"].is_null());
  EXPECT_TRUE(page["robots"].empty());
  EXPECT_TRUE(page["test"]["failure_error"].is_null());
  EXPECT_EQ(page["training"]["index"].back(), page["training"]["cases"].back());
  EXPECT_LE(page["training"]["index"].size(), 400u);
  EXPECT_LE(page["training"]["incumbents"]["index"].size(), 24u);
  // A function has the same value on the test set.
  EXPECT_EQ(page["training"]["incumbents"]["test"], page["training"]["incumbents"]["training"]);
}

TEST_F(RunPage, OfSeveralObjectivesHasAFront) {
  make_run(make_plan("q2-pareto", "ga", 40), "a");
  const json page = make_page("a");
  expect_interface(page["front"], {"RunFront"});
  const json& point = page["front"]["points"][0];
  expect_interface(point["file"], {"DesignFile"});
  const std::string name = point["file"]["name"];
  EXPECT_EQ(name, "front-" + std::to_string(point["evaluation"].get<int>()) + ".toml");
  EXPECT_THAT(point["file"]["command"].get<std::string>(),
              HasSubstr("armwright evaluate " + name + " --problem q2-pareto"));
  // The file is the design.
  const TemporaryFolder saved;
  write_file_atomically(saved / name, point["file"]["text"].get<std::string>());
  const auto problem = load_problem("q2-pareto");
  EXPECT_EQ(problem.tracking()->make_vector(load_design((saved / name).string()).design),
            point["x"].get<std::vector<double>>());
  EXPECT_EQ(page["front"]["objectives"].size(), 2u);
  EXPECT_TRUE(page["front"]["winner"].is_number());
  EXPECT_FALSE(page["front"]["points"].empty());
}

// What was set for the run is in the command that evaluates its designs.
TEST_F(RunPage, OfAMotionHasDesignsWithItsSettings) {
  const std::string points =
      "motion.point=[{joints=[0,1,-1,0,0,0]},{free=true},{joints=[0.5,1.2,-1,0,1,0]}]";
  make_run(make_plan("gasparetto-front", "random", 40,
                     {points, "motion.samples=31", "objective.quantities=[\"duration\",\"energy\"]",
                      "obstacle=[{name=\"far\",kind=\"sphere\",centre_m=[9,9,9],radius_m=0.5}]"}),
           "a");
  const json page = make_page("a");
  const json& file = page["front"]["points"][0]["file"];
  EXPECT_THAT(file["text"].get<std::string>(), HasSubstr("[[variable]]\nname = \"interval_1\""));
  EXPECT_THAT(
      file["command"].get<std::string>(),
      testing::AllOf(HasSubstr("--problem gasparetto-front"), HasSubstr("motion.samples=31"),
                     HasSubstr("{free=true}"), HasSubstr("centre_m=[9"), HasSubstr("\"energy\"")));
}

TEST_F(RunPage, OfConstraintsCountsOnlyDesignsThatKeepThem) {
  make_run(make_plan("q2-torque", "ga", 24), "a");
  const json page = make_page("a");
  EXPECT_THAT(notes_of(page), Contains(HasSubstr("meet all constraints")));
  const JournalContent journal = read("a");
  const json& training = page["training"];
  ASSERT_FALSE(training["index"].empty());
  for (std::size_t g = 0; g < training["index"].size(); ++g) {
    bool feasible = false;
    for (const EvaluationRecord& record : journal.training) {
      feasible |= record.generation == training["index"][g] && is_feasible(record.evaluation);
    }
    EXPECT_EQ(training["best"][g].is_number(), feasible) << g;
  }
}

// One requirement is met by every design, the other one by no design. The values come from the
// winner's test and are not simulated again.
TEST_F(RunPage, HasTheLightsOfWhatIsRequired) {
  make_run(make_plan("q1-complex", "ga", 24,
                     {"workspace.points=4",
                      "requirement=[{quantity='tip_error', limit_m=100}, "
                      "{quantity='peak_torque', joint='joint_2', limit_n_m=1}]"}),
           "a");
  PageOptions options;
  options.simulate = false;
  const json page = make_page("a", options);
  const json& lights = page["requirements"];
  ASSERT_EQ(lights.size(), 2u);
  expect_interface(lights[0], {"RequirementLight"});
  EXPECT_EQ(lights[0]["grade"], "met");
  EXPECT_EQ(lights[0]["quantity"], json({{"name", "tip error"}, {"unit", "m"}}));
  EXPECT_EQ(lights[1]["grade"], "missed");
  EXPECT_EQ(lights[1]["binds"], true);
  EXPECT_EQ(lights[1]["limit"], 1);
  EXPECT_EQ(lights[1]["is_constraint"], false);
  const json recorded = json::parse(read_result("a"));
  EXPECT_EQ(lights[1]["value"], recorded["winner"]["test"]["metrics"].back());
}

TEST_F(RunPage, OfARunUnderWayReadsOnly) {
  make_run(make_plan("q1-complex", "ga", 24), "a");
  const auto folder = temporary_ / "a";
  for (const char* name : {"result.json", "winner.toml", "lock"}) {
    std::filesystem::remove(folder / name);
  }
  // The journal ends in the middle of a record, as while another process writes.
  const auto size = std::filesystem::file_size(folder / "journal");
  std::filesystem::resize_file(folder / "journal", size - 3);
  const json page = make_page("a");
  EXPECT_EQ(std::filesystem::file_size(folder / "journal"), size - 3);
  EXPECT_FALSE(std::filesystem::exists(folder / "lock"));
  EXPECT_EQ(page["finished"], false);
  EXPECT_EQ(page["progress"], json({{"done", 24}, {"total", 24}, {"unit", "cases"}}));
  EXPECT_TRUE(page["test"].is_null());
  EXPECT_TRUE(page["arm"]["sweep"].is_null());
  EXPECT_EQ(page["problem"], "q1-complex");
  EXPECT_EQ(page["replays"][0]["designs"][0]["name"], "best so far");
}

TEST_F(RunPage, OfAChangedRobotSimulatesNothing) {
  const auto own = temporary_ / "own";
  std::filesystem::create_directories(own);
  std::filesystem::copy(resolve_config("robots", "irb4600_40_255"), own / "arm.urdf");
  std::ofstream(own / "mine.toml")
      << "kind = \"tracking\"\n[robot]\nurdf = \"arm.urdf\"\n[variables]\nstart = \"table-a1\"\n";
  const std::string problem = (own / "mine.toml").string();
  make_run(make_plan(problem, "ga", 16), "a");
  EXPECT_EQ(make_page("a")["replays"].size(), 1u);
  std::ofstream(own / "arm.urdf", std::ios::app) << "<!-- changed -->\n";
  const json page = make_page("a");
  EXPECT_THAT(notes_of(page), Contains(HasSubstr("arm.urdf")));
  EXPECT_TRUE(page["replays"].empty());
  EXPECT_TRUE(page["arm"].is_null());
  EXPECT_EQ(page["test"]["designs"].size(), 1u);  // the recorded errors of the winner
  std::filesystem::remove(own / "arm.urdf");
  EXPECT_TRUE(make_page("a")["replays"].empty());
}

TEST_F(RunPage, TakesHostileNamesAsTheyAre) {
  const auto own = temporary_ / "own";
  std::filesystem::create_directories(own);
  const std::string name = "a'b </script>";
  const std::string problem = (own / "x.toml").string();
  std::ofstream(problem) << "title = \"</script><b>\\u007f\"\nkind = \"tracking\"\n[robot]\nurdf = "
                            "\"irb4600_40_255\"\n[variables]\nstart = \"table-a1\"\n";
  make_run(make_plan(problem, "ga", 16), name);
  const json page = make_page(name);
  EXPECT_EQ(page["subtitle"], "</script><b>\x7f");
  const std::string command = page["arm"]["response"]["series"][0]["command"];
  EXPECT_THAT(command, HasSubstr("a'\\''b </script>/winner.toml'"));
}

TEST_F(RunPage, WithoutSimulatingSaysSo) {
  make_run(make_plan("q1-complex", "ga", 16), "a");
  PageOptions options;
  options.simulate = false;
  const json page = make_page("a", options);
  EXPECT_THAT(notes_of(page), Contains(HasSubstr("Nothing was simulated")));
  EXPECT_TRUE(page["replays"].empty());
  EXPECT_TRUE(page["arm"]["response"]["series"].empty());
  EXPECT_EQ(page["arm"]["parameters"].size(), 20u);
  EXPECT_EQ(page["test"]["designs"][0]["errors"].size(), 6u);
}

TEST_F(RunPage, RefusesWhatIsNone) {
  StopSignal stop;
  EXPECT_THROW(make_run_page(temporary_ / "none", {}, stop, observer_), Error);
  make_run(make_plan("q1-complex", "ga", 8), "a");
  for (const char* text : {"17", "test/2", "test/2:-1", "test/2:x", "/:1", ":1"}) {
    PageOptions options;
    options.cases = {text};
    EXPECT_THROW(make_page("a", options), Error) << text;
  }
  stop.request(StopReason::interrupted);
  EXPECT_FALSE(make_run_page(temporary_ / "a", {}, stop, observer_));
}

}  // namespace
}  // namespace armwright
