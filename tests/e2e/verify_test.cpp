// armwright verify, and the settings that it stands on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"
#include "sim/engines/engine_table.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::IsEmpty;

// What is tried under a design's own engine and time step: of configs/perturbations all but weak,
// and added rotors with rigid and with elastic joints.
constexpr std::size_t kPresets = 8;

class Verify : public testing::Test {
 protected:
  Outcome run(const std::vector<std::string>& arguments) {
    return run_program(folder_.path(), arguments);
  }
  json verify(std::vector<std::string> arguments, int exit_code) {
    arguments.insert(arguments.begin(), "verify");
    arguments.insert(arguments.end(), {"--json", "--quiet"});
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
    EXPECT_THAT(outcome.err, IsEmpty());
    return json::parse(outcome.out);
  }
  TemporaryFolder folder_;
};

json find_row(const json& verified, const std::string& engine, int substeps, double mass_factor) {
  for (const json& row : verified["rows"]) {
    if (row["engine"] == engine && row["substeps"] == substeps &&
        row["mass_factor"] == mass_factor) {
      return row;
    }
  }
  ADD_FAILURE() << "no row " << engine << " " << substeps << " " << mass_factor;
  return {};
}

// The published design is tuned to one step of the simulation in a control period: 0.08 mm become
// 0.1 m, in every engine.
TEST_F(Verify, ShowsThatTableA10FailsWithTwoSubsteps) {
  const json verified = verify({"table-a10", "--cases", "2"}, 3);
  EXPECT_EQ(verified["problem"], "q2-e6");
  EXPECT_EQ(verified["holds"], false);
  EXPECT_EQ(verified["rows"].size(), engine_names().size() * 4 * 3 + kPresets);
  EXPECT_EQ(verified["rows"][0]["own_setting"], true);
  for (const std::string& engine : engine_names()) {
    const json once = find_row(verified, engine, 1, 1);
    EXPECT_EQ(once["verdict"], "holds") << engine;
    EXPECT_NEAR(once["median_ratio"], 1, 0.01) << engine;
    EXPECT_NEAR(once["median_error_m"], 0.074e-3, 0.02e-3) << engine;
    const json twice = find_row(verified, engine, 2, 1);
    EXPECT_EQ(twice["verdict"], "fails") << engine;
    EXPECT_EQ(twice["failures"], 2) << engine;
    EXPECT_GT(twice["median_ratio"], 1000) << engine;
  }
  EXPECT_THAT(verified["conclusion"].get<std::string>(), HasSubstr("It fails with 2 substeps"));
}

TEST_F(Verify, ShowsThatTableA5GetsWorseWithTwoSubstepsAndFailsWithMore) {
  const json verified = verify({"table-a5", "--cases", "2"}, 3);
  for (const std::string& engine : engine_names()) {
    EXPECT_EQ(find_row(verified, engine, 1, 0.9)["verdict"], "holds") << engine;
    EXPECT_EQ(find_row(verified, engine, 1, 1.1)["verdict"], "holds") << engine;
    EXPECT_EQ(find_row(verified, engine, 2, 1)["verdict"], "worse") << engine;
    EXPECT_EQ(find_row(verified, engine, 5, 1)["verdict"], "fails") << engine;
    EXPECT_EQ(find_row(verified, engine, 10, 1)["verdict"], "fails") << engine;
  }
}

// Its rows are what `evaluate` gives under the same settings.
TEST_F(Verify, TriesWhatItSays) {
  const json verified = verify({"table-a5", "--problem", "q1-complex", "--cases", "1", "--set",
                                "robot.mass_scale=2", "--set", "physics.substeps=3"},
                               3);
  EXPECT_EQ(verified["rows"].size(), engine_names().size() * 5 * 3 + kPresets);
  const json evaluated = json::parse(
      run({"evaluate", "table-a5", "--problem", "q1-complex", "--engine", "ode", "--cases", "1",
           "--set", "robot.mass_scale=1.8", "--set", "physics.substeps=2", "--json", "-q"})
          .out);
  EXPECT_EQ(find_row(verified, "ode", 2, 0.9)["mean_error_m"],
            evaluated["summary"]["mean_error_m"]);
}

TEST_F(Verify, AnEnginesOwnChoicesAreNotTheOthers) {
  const json verified =
      verify({"table-a5", "--problem", "q1-complex", "--cases", "1", "--engine", "articulated",
              "--simd", "scalar", "--set", "physics.precision=float"},
             3);
  EXPECT_EQ(verified["rows"].size(), engine_names().size() * 4 * 3 + kPresets);
}

// Flags choose the matrix; a row is what `evaluate` gives with the preset, and the command that it
// names for its first failure simulates that case.
TEST_F(Verify, TriesPerturbedPlantsAndSaysHowToReplayAFailure) {
  const json verified =
      verify({"table-a10", "--engines", "articulated", "--substeps", "1,2", "--perturbations",
              "none,masses-10", "--cases", "3", "--set", "physics.engine=articulated"},
             3);
  ASSERT_EQ(verified["rows"].size(), 4U);
  const json& masses = verified["rows"][1];
  EXPECT_EQ(masses["perturbation"], "masses-10");
  const json evaluated =
      json::parse(run({"evaluate", "table-a10", "--cases", "3", "--engine", "articulated", "--set",
                       "perturbation.preset=masses-10", "--json", "-q"})
                      .out);
  EXPECT_EQ(masses["mean_error_m"], evaluated["summary"]["mean_error_m"]);
  EXPECT_FALSE(masses.contains("replay"));
  const json& failed = verified["rows"][2];
  EXPECT_EQ(failed["substeps"], 2);
  EXPECT_EQ(failed["first_failure"], 0);
  std::vector<std::string> words;
  std::istringstream text(failed["replay"].get<std::string>());
  for (std::string word; text >> word;) {
    std::erase(word, '\'');
    words.push_back(word);
  }
  ASSERT_EQ(words.front(), "armwright");
  words.erase(words.begin());
  EXPECT_NE(run(words).exit_code, 2);
  std::ifstream motion(folder_.path() / "case-0.csv");
  std::string header;
  std::getline(motion, header);
  EXPECT_THAT(header, HasSubstr("time_s"));
}

TEST_F(Verify, PrintsATableAndAConclusion) {
  const Outcome outcome = run({"verify", "table-a10", "--cases", "1"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("table-a10 on q2-e6: the first 1 case of test/2"),
                                 HasSubstr("its own setting"), HasSubstr("table-a10 holds in "),
                                 ContainsRegex("\nengine +substeps  plant ")));
  EXPECT_THAT(outcome.err, HasSubstr("--problem is not given; using q2-e6"));
}

// An arm of 7 joints, with elastic joints that one substep cannot simulate.
const std::vector<std::string> kElasticArm7 = {"start",
                                               "--robot",
                                               "arm7",
                                               "--cases",
                                               "1",
                                               "--engines",
                                               "articulated",
                                               "--set",
                                               "robot.armature_share=0.5",
                                               "--set",
                                               "robot.elastic_hz=15"};

// Its loads are shares of its mass, and a setting that cannot be simulated costs a row and not the
// command, also if the user named the preset.
TEST_F(Verify, EndsForEveryRobotAndSaysWhatCouldNotBeSimulated) {
  const Outcome outcome =
      run(std::vector<std::string>{"verify"} + kElasticArm7 +
          std::vector<std::string>{"--substeps", "1,10", "--perturbations", "none,load-0-40"});
  EXPECT_THAT(outcome.exit_code, testing::AnyOf(0, 3)) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("articulated, 10 substeps, load-0-40: 0 to 1.98 kg"));
  EXPECT_THAT(outcome.out, HasSubstr("2 settings could not be simulated."));
  EXPECT_THAT(outcome.out,
              ContainsRegex("articulated, 1 substep, load-0-40: .*physics.substeps is 1; the "
                            "spring of joint '[^']*' .stiffness "));
  EXPECT_THAT(outcome.out, ContainsRegex(" 1  load-0-40 +- +- +- +- +- +not simulated"));
}

// The factors of other plants act on armatures and springs that the problem's settings add.
TEST_F(Verify, OtherPlantsDifferFromThoseThatSettingsMake) {
  const json verified = json::parse(
      run(std::vector<std::string>{"verify"} + kElasticArm7 +
          std::vector<std::string>{"--substeps", "10", "--perturbations",
                                   "lighter-rotors,heavier-rotors,softer", "--json", "-q"})
          .out);
  std::set<std::string> errors_m;  // null for an arm that diverges
  for (const json& row : verified["rows"]) {
    errors_m.insert(row["mean_error_m"].dump());
  }
  EXPECT_EQ(verified["rows"].size(), 4U);
  EXPECT_EQ(errors_m.size(), 4U);
}

// Drawn values would replace those that such a plant changes.
TEST_F(Verify, OtherPlantsChangeTheValuesThatWereIdentified) {
  std::ofstream(folder_.path() / "plant.toml")
      << "[joint.shoulder]\narmature_kg_m2 = 0.5\nviscous_n_m_s_per_rad = 2\n[payload]\n"
         "mass_kg = 4\ncom_m = [0.1, 0, 0]\n[identification]\ndelay_s = 0\n"
         "logs = [\"a\"]\nparameters = [\"shoulder.armature\", \"shoulder.viscous\", "
         "\"payload.mass\"]\n"
         "values = [0.5, 2, 4]\ncovariance = [0.01, 0, 0.01, 0, 0, 0.01]\n";
  const json verified =
      json::parse(run({"verify", "start", "--robot", "planar2", "--plant", "plant.toml", "--cases",
                       "2", "--engines", "ode", "--substeps", "10", "--perturbations",
                       "none,lighter,lighter-rotors,heavier-rotors,more-friction", "--json", "-q"})
                      .out);
  ASSERT_EQ(verified["rows"].size(), 6U);
  std::set<std::string> errors_m;
  for (const json& row : verified["rows"]) {
    EXPECT_TRUE(row["mean_error_m"].is_number()) << row;
    errors_m.insert(row["mean_error_m"].dump());
  }
  EXPECT_EQ(errors_m.size(), 6U);
}

// With the fewest substeps that the own springs allow, lighter masses need more of them. Two
// numbers of substeps that are too few give one row.
TEST_F(Verify, GivesSpringsTheirSubsteps) {
  const Outcome refused = run({"evaluate", "start", "--robot", "arm7", "--cases", "1", "--set",
                               "robot.armature_share=0.5", "--set", "robot.elastic_hz=100", "--set",
                               "physics.substeps=1"});
  EXPECT_EQ(refused.exit_code, 2);
  const std::string words = "set physics.substeps to ";
  const std::size_t at = refused.err.find(words);
  ASSERT_NE(at, std::string::npos) << refused.err;
  const int needed = std::stoi(refused.err.substr(at + words.size()));
  const json verified =
      json::parse(run({"verify",          "start",
                       "--robot",         "arm7",
                       "--cases",         "1",
                       "--engines",       "articulated",
                       "--set",           "robot.armature_share=0.5",
                       "--set",           "robot.elastic_hz=100",
                       "--set",           "physics.substeps=" + std::to_string(needed),
                       "--substeps",      std::to_string(needed),
                       "--perturbations", "lighter,heavier,masses-10",
                       "--json",          "-q"})
                      .out);
  ASSERT_EQ(verified["rows"].size(), 4U);
  for (const json& row : verified["rows"]) {
    EXPECT_NE(row["verdict"], "not simulated") << row;
    EXPECT_GE(row["substeps"], needed);
  }
  const json rotors =
      json::parse(run({"verify", "start", "--robot", "arm7", "--cases", "1", "--engines",
                       "articulated", "--set", "physics.substeps=1", "--substeps", "1,2",
                       "--perturbations", "elastic-rotors", "--json", "-q"})
                      .out);
  EXPECT_EQ(rotors["rows"].size(), 2U);
  EXPECT_GT(rotors["rows"][1]["substeps"], 2);
  EXPECT_THAT(rotors["conclusion"].get<std::string>(), HasSubstr("with elastic, rotors added"));
}

TEST_F(Verify, HoldsNeitherWayIfNoOtherSettingIsSimulated) {
  const json verified = verify(
      kElasticArm7 + std::vector<std::string>{"--substeps", "1", "--perturbations", "none"}, 3);
  EXPECT_TRUE(verified["holds"].is_null());
  const json& missing = verified["rows"][1];
  EXPECT_EQ(missing["verdict"], "not simulated");
  EXPECT_TRUE(missing["failures"].is_null());
  EXPECT_TRUE(missing["without_number"].is_null());
}

// Soft controllers hardly notice the time step, and this workspace asks little of them.
TEST_F(Verify, EndsWithZeroWhereEverythingHolds) {
  const json verified = verify(
      {"table-a1", "--problem", "q1-complex", "--cases", "1", "--set", "physics.gravity_m_per_s2=0",
       "--set", "task.speed_m_per_s=0.05", "--set", "task.ik_bug=true", "--set",
       "workspace.points=3", "--perturbations", "none,lighter,heavier,ripple"},
      0);
  EXPECT_EQ(verified["holds"], true);
}

TEST_F(Verify, ExplainsItselfAndRefusesWhatIsWrong) {
  EXPECT_THAT(run({"verify", "--help"}).out, HasSubstr("Examples:\n  armwright verify table-a10"));
  const auto refuse = [&](const std::vector<std::string>& arguments, const std::string& part) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.out, IsEmpty());
    EXPECT_THAT(outcome.err, HasSubstr(part));
  };
  refuse({"verify", "table-a1"}, "--problem is missing");
  refuse({"verify", "table-a5", "--problem", "sphere"}, "'sphere' is an analytic function");
  refuse({"verify", "table-a5", "--cases", "0"}, "--cases is '0'");
  refuse({"verify", "table-a5", "--substeps", "1,0"}, "--substeps is '0'");
  refuse({"verify", "table-a5", "--engines", "od"}, "did you mean 'ode'?");
  refuse({"verify", "table-a5", "--perturbations", "none,fricton"}, "did you mean 'friction'?");
  refuse({"verify", "start", "--robot", "arm7", "--perturbations", "none,lighter-rotors"},
         "--perturbations has 'lighter-rotors': no joint of the robot has an armature "
         "(robot.plant); try added-rotors");
  refuse({"verify", "start", "--robot", "arm7", "--perturbations", "none,absent.toml"},
         "absent.toml");
  refuse({"evaluate", "table-a5", "--set", "robot.mass_scale=0"},
         "robot.mass_scale is 0; it must be a finite number >= 0.01 and <= 100");
}

// Whichever of the two it is.
TEST_F(Verify, AnEngineIsThereOrSaysWhatIsMissing) {
  for (const MissingEngine& missing : missing_engine_table()) {
    const Outcome flag = run({"evaluate", "table-a10", "--engine", missing.name});
    EXPECT_EQ(flag.exit_code, 2);
    EXPECT_THAT(flag.err, AllOf(HasSubstr(missing.name), HasSubstr(missing.reason)));
    const Outcome set = run({"evaluate", "table-a10", "--set", "physics.engine=" + missing.name});
    EXPECT_EQ(set.exit_code, 2);
    EXPECT_THAT(set.err, AllOf(HasSubstr("physics.engine is"), HasSubstr(missing.reason)));
  }
  const std::string listed = run({"list", "engines"}).out;
  for (const std::string& name : engine_names()) {
    EXPECT_THAT(listed, HasSubstr(name));
  }
  for (const MissingEngine& missing : missing_engine_table()) {
    EXPECT_THAT(listed,
                AllOf(HasSubstr(missing.name), HasSubstr("not available: " + missing.reason)));
  }
}

}  // namespace
}  // namespace armwright
