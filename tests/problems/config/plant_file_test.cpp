// The plant of a robot's joints: <dynamics> of its URDF and the file beside it.
#include "problems/config/plant_file.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "base/hash.hpp"
#include "problems/changed_text.hpp"
#include "problems/problem_folder.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Key;
using testing::Not;
using testing::Pair;
using testing::StartsWith;

// A rail, a shoulder with friction, an endless wrist, and a jaw beside the chain.
constexpr const char* kArm = R"(<robot name="arm"><link name="base"/>
<joint name="rail" type="prismatic"><parent link="base"/><child link="cart"/><axis xyz="1 0 0"/>
<limit lower="-0.5" upper="0.5" velocity="2" effort="300"/></joint>
<link name="cart"><inertial><mass value="8"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="shoulder" type="revolute"><parent link="cart"/><child link="bar"/><axis xyz="0 1 0"/>
<limit lower="-1.25" upper="0.75" velocity="3" effort="60"/><dynamics damping="0.5" friction="0.25"/></joint>
<link name="bar"><inertial><origin xyz="0.3 0 0"/><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="wrist" type="continuous"><parent link="bar"/><child link="hand"/><origin xyz="0.6 0 0"/><axis xyz="0 1 0"/></joint>
<link name="hand"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="end" type="fixed"><parent link="hand"/><child link="tip"/><origin xyz="0.4 0 0"/></joint>
<link name="tip"/>
<joint name="jaw" type="prismatic"><parent link="hand"/><child link="finger"/><axis xyz="0 1 0"/>
<limit lower="0" upper="0.04" velocity="1" effort="10"/></joint>
<link name="finger"/></robot>)";

RobotModel make_arm() {
  return parse_urdf(kArm, "arm.urdf", {.tip = "tip", .dynamics = true});
}

// Returns the joint of this number after the text of a plant's file was read.
Joint read_joint(const ProblemFolder& folder, const std::string& text, std::size_t joint) {
  folder.write("arm.plant.toml", text);
  RobotModel robot = make_arm();
  load_plant(folder.path("arm.plant.toml"), robot);
  return robot.joints[joint];
}

std::string refusal_of(const ProblemFolder& folder, const std::string& text) {
  return folder.shorten(error_of(ErrorKind::bad_data, [&] { read_joint(folder, text, 0); }));
}

TEST(Dynamics, OfTheUrdfAreFrictionOnlyIfTheyAreAskedFor) {
  const JointPlant on = make_arm().joints[1].plant;
  EXPECT_EQ(on.viscous, 0.5);
  EXPECT_EQ(on.coulomb, 0.25);
  EXPECT_THAT(make_arm().notes, Not(Contains(HasSubstr("<dynamics>"))));
  const RobotModel off = parse_urdf(kArm, "arm.urdf", {.tip = "tip"});
  EXPECT_FALSE(off.has_plant());
  EXPECT_THAT(off.notes,
              Contains("joints are simulated without the <dynamics> of 'shoulder' (damping 0.5, "
                       "friction 0.25); robot.dynamics = true gives them this friction"));
}

TEST(PlantFile, FillsEveryValueOfAJoint) {
  const ProblemFolder folder;
  const JointPlant turning = read_joint(folder, R"([joint.shoulder]
rotor_inertia_kg_m2 = 0.0001
gear_ratio = 120
viscous_n_m_s_per_rad = 1.5
coulomb_n_m = 2.5
stribeck_n_m = -2
transition_rate_rad_per_s = 0.02
stribeck_rate_rad_per_s = 0.06
offset_n_m = -0.75
stiffness_n_m_per_rad = 4000
damping_n_m_s_per_rad = 3
measured = "link"
)",
                                        1)
                                 .plant;
  EXPECT_DOUBLE_EQ(turning.armature, 0.0001 * 120 * 120);
  EXPECT_EQ(turning.viscous, 1.5);
  EXPECT_EQ(turning.coulomb, 2.5);
  EXPECT_EQ(turning.stribeck, -2);
  EXPECT_EQ(turning.transition_rate, 0.02);
  EXPECT_EQ(turning.stribeck_rate, 0.06);
  EXPECT_EQ(turning.offset, -0.75);
  EXPECT_EQ(turning.stiffness, 4000);
  EXPECT_EQ(turning.damping, 3);
  EXPECT_EQ(turning.measured, MeasuredSide::link);
  const Joint sliding = read_joint(folder,
                                   "[joint.rail]\narmature_kg = 2\nviscous_n_s_per_m = 3\n"
                                   "coulomb_n = 4\nstiffness_n_per_m = 5e5\n",
                                   0);
  EXPECT_THAT(list_plant_numbers(sliding),
              testing::IsSupersetOf({std::pair<const std::string, double>{"armature_kg", 2},
                                     {"viscous_n_s_per_m", 3},
                                     {"coulomb_n", 4},
                                     {"stribeck_n", 0},
                                     {"stiffness_n_per_m", 5e5}}));
  EXPECT_EQ(describe_plant(sliding),
            "armature 2 kg, viscous friction 3 N s/m, Coulomb friction 4 N, stiffness 500000 N/m");
}

TEST(PlantFile, ReplacesTheFrictionOfTheUrdfKeyByKey) {
  const ProblemFolder folder;
  const JointPlant plant =
      read_joint(folder, "[joint.shoulder]\ncoulomb_n_m = 3\ntransition_rate_rad_per_s = 0.02\n", 1)
          .plant;
  EXPECT_EQ(plant.viscous, 0.5);
  EXPECT_EQ(plant.coulomb, 3);
  EXPECT_EQ(plant.transition_rate, 0.02);
  EXPECT_EQ(plant.stribeck_rate, 0.2);  // ten times the transition rate
}

// The table covers more than the joint's range, -1.25 to 0.75 rad.
TEST(PlantFile, SamplesTheCounterbalanceOverTheJointsRange) {
  const ProblemFolder folder;
  const Counterbalance balance =
      read_joint(folder,
                 "[joint.shoulder.counterbalance]\npositions_rad = [-2.75, 0.25, 2.75]\n"
                 "efforts_n_m = [-20, 40, -10]\n",
                 1)
          .plant.counterbalance;
  EXPECT_EQ(balance.lower, -1.25);
  EXPECT_EQ(balance.upper, 0.75);
  ASSERT_EQ(balance.efforts.size(), 1025u);
  EXPECT_DOUBLE_EQ(balance.efforts.front(), 10);     // -20 + 20 x 1.5
  EXPECT_DOUBLE_EQ(balance.efforts[384], 25);        // at -1.25 + 2 x 384 / 1024 = -0.5
  EXPECT_DOUBLE_EQ(balance.efforts[768], 40);        // at 0.25
  EXPECT_DOUBLE_EQ(balance.efforts[768 + 128], 35);  // at 0.5: 40 - 20 x 0.25
  EXPECT_DOUBLE_EQ(balance.efforts.back(), 30);      // at 0.75
}

// The counterbalance of a KUKA KR300's axis 2 with the numbers of Weigand et al. (2021).
TEST(PlantFile, TheEffortOfAGasSpringIsTheSlopeOfItsEnergy) {
  const ProblemFolder folder;
  const Counterbalance balance =
      read_joint(folder,
                 "[joint.shoulder.gas_spring]\ndistance_m = 0.8\narm_m = 0.2\n"
                 "angle_offset_rad = 1.658\npiston_diameter_m = 0.055\nrod_diameter_m = 0.03\n"
                 "volume_m3 = 0.00096\npressure_volume_j = 15633.2\n",
                 1)
          .plant.counterbalance;
  EXPECT_EQ(balance.lower, -1.25);
  EXPECT_EQ(balance.upper, 0.75);
  ASSERT_EQ(balance.efforts.size(), 1025u);
  // At constant temperature the gas takes the work c ln(V0 / V).
  const auto calc_energy_j = [&](double position) {
    const double length_m =
        std::sqrt(0.8 * 0.8 + 0.2 * 0.2 - 2 * 0.8 * 0.2 * std::cos(position + 1.658));
    const double area_m2 = std::numbers::pi * (0.055 * 0.055 - 0.03 * 0.03) / 4;
    return -15633.2 * std::log(0.00096 - area_m2 * (length_m - 0.6));
  };
  const double step = 2.0 / 1024;
  double largest = 0;
  for (std::size_t i = 1; i < 1024; ++i) {
    const double position = -1.25 + step * static_cast<double>(i);
    const double slope =
        (calc_energy_j(position + step) - calc_energy_j(position - step)) / (2 * step);
    // The third derivative of the energy is at most some 20 times the largest slope, as ln V has a
    // factor V0 / V of up to 3 per derivative. The difference has an error of a sixth of it x
    // step^2.
    EXPECT_NEAR(balance.efforts[i], -slope, 20 * 13000 * step * step / 6) << position;
    largest = std::max(largest, std::abs(slope));
  }
  EXPECT_LT(largest, 13000);
  EXPECT_GT(largest, 1000);
  EXPECT_LT(balance.efforts[512], 0);  // it pulls the joint back to -95 degrees
}

struct BadPlant {
  std::string text, message;
};

TEST(PlantFile, RefusalsNameFileLineValueAndWhatIsAllowed) {
  const ProblemFolder folder;
  const std::string shoulder = "[joint.shoulder]\n";
  const std::string points = "[joint.shoulder.counterbalance]\n";
  const std::string spring =
      "[joint.shoulder.gas_spring]\ndistance_m = 0.8\narm_m = 0.2\narea_m2 = 0.002\n";
  const std::vector<BadPlant> cases = {
      {shoulder + "armature_kg_m2 = -1\n",
       "arm.plant.toml:2: joint.shoulder.armature_kg_m2 is -1; it must be a finite number >= 0"},
      {shoulder + "viscous_n_m_s_per_rad = -1\n", "viscous_n_m_s_per_rad is -1; it must be"},
      {shoulder + "coulomb_n_m = -0.1\n", "coulomb_n_m is -0.1; it must be a finite number >= 0"},
      {shoulder + "stiffness_n_m_per_rad = -5\n", "stiffness_n_m_per_rad is -5; it must be"},
      {shoulder + "coulomb_n_m = 1\nstribeck_n_m = -1.5\n",
       ":3: joint.shoulder.stribeck_n_m is -1.5; it must be at least -1, the Coulomb friction with "
       "the other sign"},
      {shoulder + "transition_rate_rad_per_s = 0\n",
       ":2: joint.shoulder.transition_rate_rad_per_s is 0; it must be a finite number >= 1e-09"},
      {shoulder + "stribeck_rate_rad_per_s = 0\n", "stribeck_rate_rad_per_s is 0; it must be"},
      {shoulder + "transition_rate_rad_per_s = 0.2\nstribeck_rate_rad_per_s = 0.1\n",
       ":3: joint.shoulder.stribeck_rate_rad_per_s is 0.1; it must be at least 0.2, the "
       "transition_rate_rad_per_s"},
      {shoulder + "stiffness_n_m_per_rad = 5\n",
       ":2: joint.shoulder.stiffness_n_m_per_rad is 5; an elastic joint needs a motor with "
       "inertia: give armature_kg_m2, or rotor_inertia_kg_m2 and gear_ratio"},
      {shoulder + "damping_n_m_s_per_rad = 5\n", "it needs stiffness_n_m_per_rad > 0"},
      {shoulder + "measured = \"link\"\n", "it needs stiffness_n_m_per_rad > 0"},
      {shoulder + "gear_ratio = 5\n", "gear_ratio is 5; it needs rotor_inertia_kg_m2"},
      {shoulder + "rotor_inertia_kg_m2 = 5\n", "it needs gear_ratio"},
      {shoulder + "armature_kg_m2 = 1\nrotor_inertia_kg_m2 = 5\ngear_ratio = 2\n",
       ":3: joint.shoulder.rotor_inertia_kg_m2 is 5; armature_kg_m2 is given, too"},
      {shoulder + "armature_kg = 1\n",
       ":2: joint.shoulder.armature_kg is 1; the joint turns, so the key must be armature_kg_m2"},
      {"[joint.rail]\ncoulomb_n_m = 1\n",
       ":2: joint.rail.coulomb_n_m is 1; the joint slides, so the key must be coulomb_n"},
      {shoulder + "armature = 1\n", "did you mean 'joint.shoulder.armature_kg"},
      {"[joint.sholder]\narmature_kg_m2 = 1\n",
       ":1: unknown key joint.sholder; did you mean 'joint.shoulder'? Valid here: rail, shoulder, "
       "wrist, jaw"},
      {"[joint.jaw]\ncolomb_n = 1\n", "unknown key joint.jaw.colomb_n; did you mean"},
      {points + "positions_rad = [-1, 1]\nefforts_n_m = [0, 1]\n",
       ":2: joint.shoulder.counterbalance.positions_rad is [-1, 1]; positions must cover the "
       "joint's range in the URDF, -1.25 to 0.75"},
      {points + "positions_rad = [-2, 1, 1]\nefforts_n_m = [0, 1, 2]\n",
       "positions must increase; number 3 is 1 after 1"},
      {points + "positions_rad = [-2, 1]\nefforts_n_m = [0]\n",
       ":3: joint.shoulder.counterbalance.efforts_n_m is [0]; it must hold 2 efforts, one "
       "per position"},
      {points + "positions_rad = [1]\nefforts_n_m = [0]\n", "it must hold at least two positions"},
      {points + "positions_m = [-2, 1]\nefforts_n_m = [0, 1]\n", "the key must be positions_rad"},
      {"[joint.wrist.counterbalance]\npositions_rad = [-9, 9]\nefforts_n_m = [0, 1]\n",
       ":1: joint.wrist.counterbalance is a table; the joint must have a finite range of at most "
       "one turn; its range in the URDF is -inf to inf rad"},
      {"[joint.rail.gas_spring]\ndistance_m = 1\n", "its formula is for a joint that turns"},
      {spring + "volume_m3 = 0.0002\npressure_pa = 1e6\n",
       ":5: joint.shoulder.gas_spring.volume_m3 is 0.0002; the piston takes "},
      {spring + "piston_diameter_m = 0.1\n", "area_m2 is given, too"},
      {spring + "volume_m3 = 0.002\n", "joint.shoulder.gas_spring.pressure_pa is missing"},
      {"[joint.shoulder.gas_spring]\ndistance_m = 0.1\narm_m = 0.2\narea_m2 = 1\nvolume_m3 = 9\n"
       "pressure_pa = 1\n",
       ":3: joint.shoulder.gas_spring.arm_m is 0.2; it must be less than distance_m, 0.1"},
  };
  for (const BadPlant& bad : cases) {
    EXPECT_THAT(refusal_of(folder, bad.text),
                AllOf(StartsWith("arm.plant.toml:"), HasSubstr(bad.message)));
  }
}

TEST(PlantFile, TablesOfJointsBesideTheChainAreIgnored) {
  const ProblemFolder folder;
  EXPECT_EQ(read_joint(folder, "[joint.jaw]\ncoulomb_n = 1\n", 0).plant, JointPlant{});
}

TEST(PlantFile, ItsReaderReadsEverySetting) {
  const ProblemFolder folder;
  const std::string spring =
      "distance_m = 1\narm_m = 0.1\nvolume_m3 = 9\npressure_volume_j = 1\npiston_diameter_m = 1\n"
      "rod_diameter_m = 0.5\n";
  for (const ListedSetting& one : list_settings(plant_settings())) {
    const std::string table = one.path.substr(0, one.path.rfind('.'));
    const std::string others =
        table.ends_with("spring") ? spring
        : table.ends_with("counterbalance") &&
                (one.setting->key == "scale" || one.setting->key == "slope")
            ? "positions_rad = [-2, 1]\nefforts_n_m = [0, 1]\n"
        : table == "payload" || table.starts_with("link") ? "mass_kg = 1\ncom_m = [0, 0, 0]\n"
        : table == "identification"
            ? "parameters = [\"shoulder.viscous\"]\nvalues = [1]\ncovariance = [1]\n"
            : "";
    std::string text = "[" + table + "]\n" + others;
    const std::string own_line = "\n" + one.setting->key + " = ";
    if (const std::size_t at = text.find(own_line); at != std::string::npos && others != spring) {
      text.erase(at + 1, text.find('\n', at + 1) - at);
    }
    for (const auto& [key, replaced] : {std::pair("area_m2", "piston_diameter_m = 1\n"),
                                        std::pair("pressure_pa", "pressure_volume_j = 1\n")}) {
      if (one.setting->key == key) {
        text.replace(text.find(replaced), std::string_view(replaced).size(), "");
      }
    }
    text = change_text(text, "[" + table + "]", one.setting->key, kDate);
    // Each key belongs to a joint that turns or to one that slides, or to both.
    std::vector<std::string> messages;
    for (const char* joint : {"shoulder", "rail", "bar"}) {  // the last one is a link
      std::string of_joint = text;
      if (const std::size_t at = of_joint.find("NAME"); at != std::string::npos) {
        of_joint.replace(at, 4, joint);
      }
      messages.push_back(refusal_of(folder, of_joint));
    }
    EXPECT_THAT(messages,
                Contains(AllOf(HasSubstr("." + one.setting->key + " is " + kDate),
                               EndsWith("it must be " + one.setting->describe_allowed()))));
    EXPECT_FALSE(one.setting->meaning.empty());
  }
}

// Writes a robot with a plant beside it, and a problem p.toml of it with these lines in [robot].
LoadedProblem load_with(const ProblemFolder& folder, const std::string& lines) {
  folder.write("arm.urdf", kArm);
  folder.write("arm.plant.toml", "[joint.rail]\narmature_kg = 2\n");
  folder.write("d.toml", make_joint() + make_joint() + make_joint());
  folder.write("p.toml", "kind = \"tracking\"\n[robot]\nurdf = \"arm.urdf\"\ntip = \"tip\"\n" +
                             lines + "[variables]\nstart = \"d.toml\"\n");
  return folder.load("p.toml");
}

const RobotModel& get_robot(const LoadedProblem& problem) {
  return problem.tracking()->config().robot;
}

TEST(RobotPlant, IsThatOfVersion1UnlessTheProblemSaysOtherwise) {
  const ProblemFolder folder;
  const LoadedProblem problem = load_with(folder, "");
  EXPECT_FALSE(get_robot(problem).has_plant());
  EXPECT_THAT(problem.resolved_json, AllOf(Not(HasSubstr("plant")), Not(HasSubstr("dynamics"))));
  EXPECT_THAT(problem.input_hashes, Not(Contains(Key("arm.plant.toml"))));
}

TEST(RobotPlant, AutoTakesTheFileBesideTheUrdfAndRecordsIt) {
  const ProblemFolder folder;
  const LoadedProblem problem = load_with(folder, "plant = \"auto\"\ndynamics = true\n");
  EXPECT_EQ(get_robot(problem).joints[0].plant.armature, 2);
  EXPECT_EQ(get_robot(problem).joints[1].plant.coulomb, 0.25);
  EXPECT_THAT(problem.resolved_json, HasSubstr(R"("plant":"arm.plant.toml")"));
  EXPECT_THAT(problem.input_hashes,
              Contains(Pair("arm.plant.toml", calc_sha256_hex("[joint.rail]\narmature_kg = 2\n"))));
  const LoadedProblem again =
      load_recorded_problem(problem.resolved_json, problem.name, folder.path(""));
  EXPECT_EQ(again.resolved_json, problem.resolved_json);
  EXPECT_EQ(again.input_hashes, problem.input_hashes);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(get_robot(again).joints[i].plant, get_robot(problem).joints[i].plant);
  }
}

TEST(RobotPlant, AutoRecordsThatThereWasNoFile) {
  const ProblemFolder folder;
  load_with(folder, "");
  std::filesystem::remove(folder.path("arm.plant.toml"));
  const std::vector<std::string> overrides = {"robot.plant=auto"};
  const LoadedProblem problem = folder.load("p.toml", overrides);
  EXPECT_THAT(problem.resolved_json, Not(HasSubstr("\"plant\"")));
  folder.write("arm.plant.toml", "[joint.rail]\narmature_kg = 2\n");  // later
  EXPECT_FALSE(
      get_robot(load_recorded_problem(problem.resolved_json, "p", folder.path(""))).has_plant());
}

TEST(RobotPlant, TheProblemRobotHasIt) {
  const ProblemFolder folder;
  load_with(folder, "");
  std::vector<std::string> overrides = {"robot.urdf=\"" + folder.path("arm.urdf") + "\"",
                                        "robot.tip=tip", "task.orientation=free"};
  const LoadedProblem problem = load_problem("robot", overrides);
  EXPECT_EQ(get_robot(problem).joints[0].plant.armature, 2);
  EXPECT_EQ(get_robot(problem).joints[1].plant.viscous, 0.5);
  overrides.insert(overrides.end(), {"robot.plant=\"\"", "robot.dynamics=false"});
  EXPECT_FALSE(get_robot(load_problem("robot", overrides)).has_plant());
}

TEST(RobotPlant, RefusesAFileThatIsNotThere) {
  const ProblemFolder folder;
  load_with(folder, "");
  const std::vector<std::string> overrides = {"robot.plant=other.toml"};
  EXPECT_THAT(
      usage_error_of([&] { folder.load("p.toml", overrides); }),
      AllOf(HasSubstr("robot.plant is other.toml; "), HasSubstr("there is no file 'other.toml'")));
}

// The shipped arm with an elastic wrist, and a problem that simulates it.
class ElasticWrist : public testing::Test {
 protected:
  void write_wrist(double stiffness) const {
    folder_.write("soft.plant.toml",
                  "[joint.joint_4]\narmature_kg_m2 = 0.01\nstiffness_n_m_per_rad = " +
                      std::to_string(stiffness) + "\n");
    folder_.write("p.toml",
                  "kind = \"tracking\"\n[robot]\nurdf = \"irb4600_40_255\"\n"
                  "plant = \"soft.plant.toml\"\n[variables]\nstart = \"table-a1\"\n");
  }
  std::string refusal_of(std::vector<std::string> overrides) const {
    overrides.emplace_back("physics.engine=articulated");
    return folder_.shorten(usage_error_of([&] { folder_.load("p.toml", overrides); }));
  }
  bool loads(std::vector<std::string> overrides) const {
    overrides.emplace_back("physics.engine=articulated");
    return folder_.load("p.toml", overrides).tracking() != nullptr;
  }
  // Returns the number that follows `words` in the message.
  static double find_number(const std::string& message, const std::string& words) {
    const std::size_t at = message.find(words);
    EXPECT_NE(at, std::string::npos) << words << " is not in: " << message;
    return at == std::string::npos ? 0 : std::stod(message.substr(at + words.size()));
  }
  static std::string set_substeps(int number) {
    return "physics.substeps=" + std::to_string(number);
  }
  ProblemFolder folder_;
};

TEST_F(ElasticWrist, IsRefusedWithFewerSubstepsThanItsSpringNeeds) {
  write_wrist(4000);
  const std::string message = refusal_of({set_substeps(1)});
  EXPECT_THAT(message, AllOf(HasSubstr("physics.substeps is 1; the spring of joint 'joint_4' "
                                       "(stiffness 4000 N m/rad, soft.plant.toml) moves at "),
                             HasSubstr("rad per step of 0.01 s; at most 0.5 rad can be simulated"),
                             HasSubstr("or make the joint less stiff or less damped")));
  const int needed = static_cast<int>(find_number(message, "set physics.substeps to "));
  // The motor on a held link swings at (4000 / 0.01)^(1/2) rad/s; the link's inertia adds to it.
  EXPECT_GE(needed, 13);
  EXPECT_TRUE(loads({set_substeps(needed)}));
  EXPECT_THAT(refusal_of({set_substeps(needed - 1)}), HasSubstr("can be simulated"));
}

TEST_F(ElasticWrist, NeedsTheSubstepsOfTheStiffestPlantThatIsDrawn) {
  write_wrist(4000);
  const double nominal = find_number(refusal_of({}), "moves at ");
  const double perturbed = find_number(
      refusal_of({"perturbation.stiffness_relative=0.8", "perturbation.armature_relative=0.9",
                  "perturbation.mass_relative=0.9"}),
      "moves at ");
  // w^2 = k (1 / A + 1 / M), with two numbers of four digits.
  EXPECT_NEAR(perturbed / nominal, std::sqrt(1.8 / 0.1), 1e-3 * std::sqrt(1.8 / 0.1));
  const std::vector<std::string> spread = {"perturbation.stiffness_relative=0.8"};
  const std::string message = refusal_of(spread);
  EXPECT_THAT(message, HasSubstr("in the fastest of the perturbed plants"));
  const int needed = static_cast<int>(find_number(message, "set physics.substeps to "));
  EXPECT_TRUE(loads({spread[0], set_substeps(needed)}));
  EXPECT_THAT(refusal_of({spread[0], set_substeps(needed - 1)}), HasSubstr("can be simulated"));
}

TEST_F(ElasticWrist, OfGreatStiffnessNeedsAShorterControlPeriod) {
  write_wrist(1e9);
  const std::string message = refusal_of({set_substeps(1000)});
  EXPECT_THAT(message, Not(HasSubstr("or more")));
  const double period_s =
      find_number(message, "set physics.substeps to 1000 and control.period_s to ");
  EXPECT_GT(period_s, 0.001);
  EXPECT_TRUE(loads({set_substeps(1000), "control.period_s=" + std::to_string(period_s)}));
}

}  // namespace
}  // namespace armwright
