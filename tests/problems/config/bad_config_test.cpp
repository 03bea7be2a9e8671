// What a user reads who got a problem's file or an override wrong. Each message is compared as a
// whole: it names file, line, field, the value found and what is allowed.
#include <gmock/gmock.h>

#include "base/text.hpp"
#include "problems/problem_folder.hpp"
#include "sim/engines/engine_table.hpp"

namespace armwright {
namespace {

constexpr const char* kTopKeys =
    "name, title, description, kind, schedule, racing, sets, run, published, robot, tubes, "
    "physics, "
    "task, control, obstacle, workspace, path, objective, training, variables, motors, "
    "perturbation, requirement, sweep";
constexpr const char* kTaskKeys =
    "signal, speed_m_per_s, distance_limit_m, trapezoid_acceleration_m_per_s2, rest_s, "
    "count_first_point, ik_bug, load_kg, load_inertia_kg_m2, load_com_m, kinematics, solver, "
    "limits, floor_m, orientation, tool_rpy_rad, tool_axis, orientation_arm_m, home, "
    "self_clearance, clearance_m";

std::string list_keys(const std::string& typed, const char* keys) {
  return list_near(typed, keys, "armwright list settings");
}

struct Mistake {
  std::string text;     // behind `extends = "base"`, from line 2 on
  std::string message;  // behind "p.toml:"
};

void PrintTo(const Mistake& mistake, std::ostream* out) {
  *out << mistake.text;
}

class BadSection : public testing::TestWithParam<Mistake> {};

TEST_P(BadSection, IsRefusedWithPlaceValueAndWhatIsAllowed) {
  EXPECT_EQ(ProblemFolder().refusal_of_base_with(GetParam().text), "p.toml:" + GetParam().message);
}

const std::vector<Mistake> kTask = {
    {"[task]\nsignal = 'complx'",
     "3: unknown task.signal 'complx'; did you mean 'complex'? Valid: step, ramp, trapezoid, "
     "triangular, complex"},
    {"[task]\nsignal = 5",
     "3: task.signal is 5, an integer; it must be one of these strings: step, ramp, trapezoid, "
     "triangular, complex"},
    {"[task]\nspeed_m_per_s = 0",
     "3: task.speed_m_per_s is 0; it must be a finite number >= 0.0001 and <= 100"},
    {"[task]\nspeed_m_per_s = 100.5",
     "3: task.speed_m_per_s is 100.5; it must be a finite number >= 0.0001 and <= 100"},
    {"[task]\n\n\nspeed_m_per_s = 'fast'",
     "5: task.speed_m_per_s is 'fast', a string; it must be a finite number >= 0.0001 and <= 100"},
    {"[task]\nspeed_m_per_s = nan", "3: task.speed_m_per_s is nan; it must be a finite number"},
    {"[task]\nspeed_m_per_s = -inf", "3: task.speed_m_per_s is -inf; it must be a finite number"},
    {"[task]\nspeed = 2",
     std::string("3: unknown key task.speed; did you mean 'task.speed_m_per_s'? Valid here: ") +
         list_keys("speed_m_per_s", kTaskKeys)},
    {"[task]\ndistance_limit_m = -0.1",
     "3: task.distance_limit_m is -0.1; it must be a finite number >= 0 and <= 100"},
    {"[task]\ntrapezoid_acceleration_m_per_s2 = 0",
     "3: task.trapezoid_acceleration_m_per_s2 is 0; it must be a finite number > 0 and <= "
     "1000000"},
    {"[task]\nhome = [0, 1]",
     "3: task.home is [0, 1]; it must hold 4 numbers, one a joint of the robot"},
    {"[task]\nrest_s = -0.5", "3: task.rest_s is -0.5; it must be a finite number >= 0 and <= 60"},
    {"[task]\ncount_first_point = 1",
     "3: task.count_first_point is 1, an integer; it must be true or false"},
    {"[task]\nik_bug = 'yes'", "3: task.ik_bug is 'yes', a string; it must be true or false"},
    {"[task]\nload_kg = -20",
     "3: task.load_kg is -20; it must be a finite number >= 0 and <= 1000"},
    {"[task]\nload_kg = 2\nload_com_m = [0, 0]",
     "4: task.load_com_m is [0, 0]; it must be three numbers: x, y and z in m, in the tip's frame"},
    {"[task]\nload_kg = 2\nload_inertia_kg_m2 = [1, 1, 1, 0, 0, 0]",
     "4: task.load_inertia_kg_m2 is [1, 1, 1, 0, 0, 0]; it needs task.load_com_m, the load's "
     "centre "
     "of mass"},
    {"[task]\nload_kg = 2\nload_com_m = [0, 0, 0]\nload_inertia_kg_m2 = [1, 1, 3, 0, 0, 0]",
     "5: task.load_inertia_kg_m2 is [1, 1, 3, 0, 0, 0]; no body has its principal moments 1, 1 and "
     "3: none may be negative, and the largest must not exceed the sum of the others"},
    {"[task]\nload_kg = 2\nload_com_m = [0, 0, 0]\nload_inertia_kg_m2 = [1, 1, 1]",
     "5: task.load_inertia_kg_m2 is [1, 1, 1]; it must be six numbers: ixx, iyy, izz, ixy, ixz and "
     "iyz"},
    {"[task]\nload_com_m = [0, 0, 0]",
     "3: task.load_com_m is [0, 0, 0]; it needs task.load_kg > 0, the mass that it belongs to, or "
     "a load in [perturbation]"},
    {"[task]\nload_com_m = [0, 0, 0]\nload_inertia_kg_m2 = [1, 1, 1, 0, 0, 0]",
     "4: task.load_inertia_kg_m2 is [1, 1, 1, 0, 0, 0]; it needs task.load_kg > 0, the mass that "
     "it belongs to"},
    {"[robot]\nurdf = 'irb4600_40_255'\nelastic_hz = 5",
     "4: robot.elastic_hz is 5; none of the robot's joints has an armature, which an elastic joint "
     "needs; give robot.armature_share, or armatures in the file of robot.plant"},
    {"task = 3", "2: task is 3, an integer; it must be a table, [task]"},
    // Each allowed for itself, but together 1e8 periods and more.
    {"[task]\nspeed_m_per_s = 0.01\n[control]\nperiod_s = 1e-5",
     "5: control.period_s is 1e-5; a test case would take 2.42e+08 control periods, possible are "
     "1e+07; raise control.period_s or task.speed_m_per_s, or lower task.distance_limit_m, "
     "task.rest_s or workspace.points"},
    {"[task]\nspeed_m_per_s = 0.01\ndistance_limit_m = 100",
     "3: task.speed_m_per_s is 0.01; a test case would take 2.5e+07 control periods, possible are "
     "1e+07; raise control.period_s or task.speed_m_per_s, or lower task.distance_limit_m, "
     "task.rest_s or workspace.points"},
};
INSTANTIATE_TEST_SUITE_P(Task, BadSection, testing::ValuesIn(kTask));

const std::vector<Mistake> kControl = {
    {"[control]\nperiod_s = 1",
     "3: control.period_s is 1; it must be a finite number >= 1e-05 and <= 0.1"},
    {"[control]\ncontroller = 'pidd'",
     "3: unknown control.controller 'pidd'; did you mean 'pid'? "
     "Valid: " +
         list_valid("pidd", controller_names(), "armwright list settings control.controller")},
    {"[control]\nperiod = 0.01",
     "3: unknown key control.period; did you mean 'control.period_s'? Valid here: period_s, "
     "start, interface, bandwidth_hz, delay_s, resolution_rad, resolution_m, controller"},
};
INSTANTIATE_TEST_SUITE_P(Control, BadSection, testing::ValuesIn(kControl));

const std::vector<Mistake> kPhysics = {
    {"[physics]\nengine = 'odee'",
     "3: unknown physics.engine 'odee'; did you mean 'ode'? Valid: " + join(engine_names(), ", ")},
    {"[physics]\ngravity_m_per_s2 = -9.81",
     "3: physics.gravity_m_per_s2 is -9.81; it must be a finite number >= 0 and <= 1000"},
    {"[physics]\nsubsteps = 0", "3: physics.substeps is 0; it must be an integer from 1 to 1000"},
    {"[physics]\nsubsteps = 1.5",
     "3: physics.substeps is 1.5, a floating-point number; it must be an integer from 1 to 1000"},
    {"[physics]\nerp = 2", "3: physics.erp is 2; it must be a finite number >= 0 and <= 1"},
    {"[physics]\ncfm = -1", "3: physics.cfm is -1; it must be a finite number >= 0 and <= 1"},
    {"[physics]\ndamping = 1",
     "3: unknown key physics.damping. Valid here: engine, judging_engine, precision, simd, "
     "gravity_m_per_s2, substeps, erp, cfm"},
};
INSTANTIATE_TEST_SUITE_P(Physics, BadSection, testing::ValuesIn(kPhysics));

const std::vector<Mistake> kWorkspace = {
    {"[workspace]\ncentre_m = [1, 2]",
     "3: workspace.centre_m is [1, 2]; it must be three numbers: x, y and z in metres"},
    {"[workspace]\ncentre_m = 1.4",
     "3: workspace.centre_m is 1.4, a floating-point number; it must be an array, each element of "
     "it a finite number >= -1000 and <= 1000"},
    {"[workspace]\ncentre_m = [1, 2, 'a']",
     "3: workspace.centre_m[2] is 'a', a string; it must be a finite number >= -1000 and <= 1000"},
    {"[workspace]\nradius_m = 0",
     "3: workspace.radius_m is 0; it must be a finite number >= 0.001 and <= 100"},
    {"[workspace]\npoints = 2", "3: workspace.points is 2; it must be an integer from 3 to 1000"},
    {"[workspace]\npoints = 1001",
     "3: workspace.points is 1001; it must be an integer from 3 to 1000"},
    {"[workspace]\nshortest_move_m = 2",
     "3: workspace.shortest_move_m is 2; it must be a finite number >= 1e-06 and <= 1.6"},
};
INSTANTIATE_TEST_SUITE_P(Workspace, BadSection, testing::ValuesIn(kWorkspace));

const std::vector<Mistake> kObjective = {
    {"[objective]\nkind = 'errors'",
     "3: unknown objective.kind 'errors'; did you mean 'error'? Valid: error, "
     "error_and_torque, torque_with_error_limit, error_with_torque_limit, front, "
     "error_vs_torque"},
    {"[objective]\nkind = 'torque_with_error_limit'",
     "2: objective.error_limit_m is missing; it must be a finite number > 0 and <= 1000000000000"},
    {"[objective]\nkind = 'torque_with_error_limit'\nerror_limit_m = 0",
     "4: objective.error_limit_m is 0; it must be a finite number > 0 and <= 1000000000000"},
    {"[objective]\nkind = 'error_with_torque_limit'",
     "2: objective.total_torque_limit_n_m is missing; it must be a finite number > 0 and <= "
     "1000000000000"},
    {"[objective]\nkind = 'error_with_torque_limit'\ntotal_torque_limit_n_m = -3",
     "4: objective.total_torque_limit_n_m is -3; it must be a finite number > 0 and <= "
     "1000000000000"},
    // A limit that this kind would not keep.
    {"[objective]\nkind = 'error_and_torque'\nerror_limit_m = 0.1",
     "4: unknown key objective.error_limit_m. Valid here: kind, logarithm, torque_weight, "
     "error_scale_m, torque_scale_n_m, statistic, cvar_share, failure_penalty_m, energy_weight, "
     "energy_scale_j, duration_weight, duration_scale_s"},
    {"[objective]\nkind = 'error_with_torque_limit'\ntotal_torque_limit_n_m = 851",
     "4: objective.total_torque_limit_n_m is 851; no design within the bounds has less than 852 N "
     "m; raise it or variables.bounds_factor"},
    {"[objective]\nkind = 'error_vs_torque'\nlogarithm = true",
     "4: objective.logarithm is true; the objectives of a front are compared as they are; "
     "leave it out"},
    {"[objective]\ntorque_weight = -1",
     "3: objective.torque_weight is -1; it must be a finite number >= 0 and <= 1000000"},
    {"[objective]\nerror_scale_m = 0",
     "3: objective.error_scale_m is 0; it must be a finite number > 0 and <= 1000000000000"},
    {"[objective]\ntorque_scale_n_m = 0",
     "3: objective.torque_scale_n_m is 0; it must be a finite number > 0 and <= 1000000000000"},
    {"[training]\ncutoff_error_m = 0.01",
     "3: training.cutoff_error_m is 0.01; it must be a finite number >= 0.1 and <= 1000000"},
    {"[training]\ncutoff = 2",
     "3: unknown key training.cutoff; did you mean 'training.cutoff_error_m'? Valid here: "
     "cutoff_error_m, failure_rule"},
    {"[training]\nfailure_rule = 'order'",
     "3: unknown training.failure_rule 'order'; did you mean 'ordered'? Valid: ordered, thesis"},
};
INSTANTIATE_TEST_SUITE_P(Objective, BadSection, testing::ValuesIn(kObjective));

const std::vector<Mistake> kSets = {
    {"[sets]\ntraining = \"test/1\"",
     "3: sets.training is \"test/1\"; a training set must be named train/ID, as in train/1"},
    {"[sets]\ntraining = 'train/'",
     "3: sets.training is 'train/'; a training set must be named train/ID, as in train/1"},
    {"[sets]\nvalidation = '1'",
     "3: sets.validation is '1'; a validation set must be named validation/ID, as in "
     "validation/1"},
    {"[sets]\ntest = 2", "3: sets.test is 2, an integer; it must be a string"},
    {"[sets]\ntest = 'train/1'",
     "3: sets.test is 'train/1'; a test set must be named test/ID, as in test/1"},
    {"[sets]\ntest_cases = 0", "3: sets.test_cases is 0; it must be an integer from 1 to 1000000"},
    {"[sets]\nvalidation_cases = 1000001",
     "3: sets.validation_cases is 1000001; it must be an integer from 1 to 1000000"},
    {"[schedule]\nkind = 'new'",
     "3: unknown schedule.kind 'new'. Valid: fixed, fresh, coevolution, growing"},
    {"[schedule]\nkind = 'coevolution'\ncases = 3",
     "4: schedule.cases is 3; it must be an integer from 4 to 1000000"},
    {"[racing]\nkind = 'half'", "3: unknown racing.kind 'half'. Valid: none, halving, abandonment"},
    {"[racing]\nkind = 'halving'\neta = 1",
     "4: racing.eta is 1; it must be an integer from 2 to 1000"},
    {"[racing]\nkind = 'halving'\nfirst_cases = 0",
     "4: racing.first_cases is 0; it must be an integer from 1 to 1000000"},
    {"[racing]\nkind = 'abandonment'\nmargin = 0.5",
     "4: racing.margin is 0.5; it must be a finite number >= 1 and <= 1000000"},
    // An option of another kind, which would change nothing.
    {"[racing]\nkind = 'halving'\nmargin = 2",
     "4: unknown key racing.margin. Valid here: kind, first_cases, eta"},
    {"[schedule]\ncases = 0", "3: schedule.cases is 0; it must be an integer from 1 to 1000000"},
    {"[run]\nbudget = -1", "3: run.budget is -1; it must be an integer from 0 to 1000000000000"},
    {"[run]\nbudget = 1.5",
     "3: run.budget is 1.5, a floating-point number; it must be an integer from 0 to "
     "1000000000000"},
    {"[run]\noptimizer = 3", "3: run.optimizer is 3, an integer; it must be a string"},
    {"[run]\nseed = 3", "3: unknown key run.seed. Valid here: optimizer, budget"},
};
INSTANTIATE_TEST_SUITE_P(Sets, BadSection, testing::ValuesIn(kSets));

const std::vector<Mistake> kVariables = {
    {"[variables]\nstart = 'table-b1'",
     std::string("3: variables.start is 'table-b1'; unknown design 'table-b1'; did you mean "
                 "'table-a1'? Valid: ") +
         list_designs("table-b1") + " (or the path of a .toml file)"},
    {"[variables]\noptimize = ['p', 'effort']",
     "3: variables.optimize is ['p', 'effort']; unknown design parameter 'effort'; did you mean "
     "'effort_min'? Valid: gains, p, i, d, effort_min, effort_max, length_scale, section_scale, "
     "tube_diameter, tube_wall"},
    {"[variables]\noptimize = ['effort_mn']",
     "3: variables.optimize is ['effort_mn']; unknown design parameter 'effort_mn'; did you mean "
     "'effort_min'? Valid: gains, p, i, d, effort_min, effort_max, length_scale, section_scale, "
     "tube_diameter, tube_wall"},
    {"[variables]\noptimize = ['d', 'p', 'd']",
     "3: variables.optimize is ['d', 'p', 'd']; 'd' stands there twice; name it once"},
    {"[variables]\noptimize = []",
     "3: variables.optimize is []; at least one design parameter of one joint must be optimized"},
    {"[variables]\noptimize = 'p'",
     "3: variables.optimize is 'p', a string; it must be an array of strings"},
    {"[variables]\noptimize = ['p', 2]",
     "3: variables.optimize[1] is 2, an integer; it must be a string"},
    {"[variables]\nbounds_factor = 1",
     "3: variables.bounds_factor is 1; it must be a finite number > 1 and <= 1000000000"},
    {"[variables]\nbound_factor = 10",
     "3: unknown key variables.bound_factor; did you mean 'variables.bounds_factor'? Valid here: "
     "start, start_bandwidth_rad_per_s, within_effort_limits, bounds_factor, optimize, joint, "
     "task, "
     "length_bounds_factor, section_bounds_factor, speed_bounds_factor"},
    {"[variables]\nstart_bandwidth_rad_per_s = 5",
     "3: variables.start_bandwidth_rad_per_s is 5; it belongs to a proposed start; leave it out, "
     "or "
     "set variables.start to \"proposed\""},
    {"[[variables.joint]]\nname = 'joint_9'\noptimize = ['p']",
     "3: unknown variables.joint[0].name 'joint_9'; did you mean 'joint_1'? Valid: joint_1, "
     "joint_2, joint_3, joint_4"},
    {"[[variables.joint]]\nname = 'joint_1'",
     "2: variables.joint[0].optimize is missing; it must be an array of strings"},
    {"[[variables.joint]]\nname = 'joint_1'\noptimise = ['p']",
     "2: variables.joint[0].optimize is missing; it must be an array of strings (is "
     "variables.joint[0].optimise in p.toml:4 meant?)"},
    {"[[variables.joint]]\nname = 'joint_1'\noptimize = ['i', 'kp']",
     "4: variables.joint[0].optimize is ['i', 'kp']; unknown design parameter 'kp'; did you mean "
     "'p'? Valid: gains, p, i, d, effort_min, effort_max, length_scale, section_scale, "
     "tube_diameter, tube_wall"},
    {"[[variables.joint]]\nname = 'joint_1'\noptimize = ['p']\n"
     "[[variables.joint]]\nname = 'joint_1'\noptimize = ['d']",
     "6: variables.joint[1].name is 'joint_1'; another [[variables.joint]] has that name; put them "
     "together"},
    {"[variables.joint]\nname = 'joint_1'\noptimize = ['p']",
     "2: variables.joint is a table; it must be an array of tables, [[variables.joint]]"},
};
INSTANTIATE_TEST_SUITE_P(Variables, BadSection, testing::ValuesIn(kVariables));

const std::vector<Mistake> kOther = {
    {"[published]\nerror_m = 0", "3: published.error_m is 0; it must be a finite number > 0"},
    {"[published]\ntotal_torque = 3",
     "3: unknown key published.total_torque; did you mean 'published.total_torque_n_m'? Valid "
     "here: error_m, total_torque_n_m, design, where, set"},
    {"[published]\ndesign = 'q1-complex'",
     std::string("3: published.design is 'q1-complex'; unknown design 'q1-complex'. Valid: ") +
         list_designs("q1-complex") + " (or the path of a .toml file)"},
    {"[sweep]\nvalues = [1]\ndesign = 'table-a10'",
     "2: sweep.parameter is missing; it must be a string"},
    {"[sweep]\nparameter = 'task.load_kg'\nvalues = []\ndesign = 'table-a10'",
     "4: sweep.values is []; it must hold at least one number"},
    {"[sweep]\nparameter = 'task.load_kg'\nvalues = [1, nan]\ndesign = 'table-a10'",
     "4: sweep.values[1] is nan; it must be a finite number"},
    {"[sweep]\nparameter = 'task.load_kg'\nvalues = [1]\ndesign = 'tabl-a5'",
     std::string("5: sweep.design is 'tabl-a5'; unknown design 'tabl-a5'; did you mean "
                 "'table-a5'? Valid: ") +
         list_designs("tabl-a5") + " (or the path of a .toml file)"},
    {"colour = 'red'",
     std::string("2: unknown key colour. Valid here: ") + list_keys("colour", kTopKeys)},
    {"title = 3", "2: title is 3, an integer; it must be a string"},
};
INSTANTIATE_TEST_SUITE_P(Other, BadSection, testing::ValuesIn(kOther));

TEST(BadWorkspace, ThatMakesNoCasesIsRefusedWhenItIsRead) {
  // Not at the first evaluation. The bounds are test_case.cpp's; here it matters where they show.
  const ProblemFolder folder;
  EXPECT_THAT(folder.refusal_of_base_with("[workspace]\nshortest_move_m = 1.59"),
              testing::AllOf(testing::StartsWith("p.toml:3: workspace.shortest_move_m is 1.59; "),
                             testing::HasSubstr("it must be from ")));
  EXPECT_THAT(folder.refusal_of_base_with("[workspace]\nradius_m = 0.01"),
              testing::AllOf(testing::StartsWith("p.toml:3: workspace.radius_m is 0.01; "),
                             testing::HasSubstr("the shortest move is 0.05 m; it must be from ")));
}

TEST(BadConfig, EveryUnknownKeyIsNamedAtOnce) {
  EXPECT_EQ(ProblemFolder().refusal_of_base_with(
                "colour = 'red'\n[task]\nspeed = 1\n[robot]\nurdf = 'irb4600_40_255'\nurl = 'x'"),
            std::string("p.toml:2: unknown key colour. Valid here: ") +
                list_keys("colour", kTopKeys) +
                "\np.toml:4: unknown key task.speed; did you mean 'task.speed_m_per_s'? Valid "
                "here: " +
                list_keys("speed_m_per_s", kTaskKeys) +
                "\np.toml:7: unknown key robot.url. Valid here: " +
                list_keys("url",
                          "urdf, mass_scale, base, tip, density_kg_per_m3, dynamics, repair, "
                          "mass_from_shapes, packages, plant, friction_scale, armature_scale, "
                          "stiffness_scale, armature_share, elastic_hz, propose"));
}

TEST(BadConfig, WhatIsMissingIsNamed) {
  const ProblemFolder folder;
  EXPECT_EQ(folder.refusal_of(""),
            "p.toml:1: kind is missing; it must be one of these strings: tracking, analytic, "
            "program, command, external, identification, excitation, motion");
  EXPECT_EQ(folder.refusal_of("kind = 'trackin'"),
            "p.toml:1: unknown kind 'trackin'; did you mean 'tracking'? Valid: tracking, analytic, "
            "program, command, external, identification, excitation, motion");
  EXPECT_EQ(folder.refusal_of("kind = 'tracking'"),
            "p.toml:1: robot is missing; it must be a table, [robot]");
  EXPECT_EQ(folder.refusal_of("kind = 'tracking'\n[robot]\n"),
            "p.toml:2: robot.urdf is missing; it must be a string");
  EXPECT_EQ(folder.refusal_of("kind = 'tracking'\n[robot]\nurdf = 'irb4600_40_255'\n"),
            "p.toml:1: variables is missing; it must be a table, [variables]");
  EXPECT_EQ(folder.refusal_of("kind = 'analytic'"),
            "p.toml:1: function is missing; it must be a table, [function]");
}

TEST(BadConfig, TorqueThatIsNoVariableIsNotMinimised) {
  EXPECT_EQ(ProblemFolder().refusal_of(
                "extends = \"base\"\n[objective]\nkind = 'torque_with_error_limit'\n"
                "error_limit_m = 0.1\n[variables]\noptimize = ['p', 'i']\n"),
            "p.toml:3: objective.kind is 'torque_with_error_limit'; no effort limit is optimized, "
            "so that the total torque is always 85200 N m; add effort_min and effort_max to "
            "variables.optimize");
}

TEST(BadConfig, TextThatIsNoTomlIsRefusedAtItsLine) {
  const ProblemFolder folder;
  EXPECT_THAT(folder.refusal_of("kind = 'tracking'\n[robot\nurdf = 'x'\n"),
              testing::AllOf(testing::StartsWith("p.toml:2: "), testing::HasSubstr("']'")));
  EXPECT_THAT(folder.refusal_of_base_with("[task]\nload_kg = 20 kg\n"),
              testing::StartsWith("p.toml:3: "));
  EXPECT_THAT(folder.refusal_of_base_with("[task]\nload_kg = 0,5\n"),
              testing::AllOf(testing::StartsWith("p.toml:3: "), testing::HasSubstr("','")));
  EXPECT_THAT(folder.refusal_of_base_with("[task]\nload_kg = 1\nload_kg = 2\n"),
              testing::AllOf(testing::StartsWith("p.toml:4: "), testing::HasSubstr("load_kg")));
}

TEST(BadConfig, AnalyticFunctionsAreCheckedToo) {
  const ProblemFolder folder;
  EXPECT_EQ(folder.refusal_of("kind = 'analytic'\n[function]\nname = 'spere'"),
            "p.toml:3: unknown function.name 'spere'; did you mean 'sphere'? Valid: " +
                list_near("spere",
                          "sphere, ellipsoid, rosenbrock, rastrigin, ackley, branin, hartmann6, "
                          "constrained, sphere-int, ellipsoid-int, zdt1, dtlz2, bbob-f1, bbob-f2, "
                          "bbob-f3, bbob-f8, bbob-f10, bbob-f15",
                          "armwright list settings function.name"));
  EXPECT_EQ(folder.refusal_of("kind = 'analytic'\n[function]\nname = 'rosenbrock'\ndimension = 1"),
            "p.toml:4: function.dimension is 1; it must be an integer from 2 to 1000");
  EXPECT_EQ(folder.refusal_of(
                "kind = 'analytic'\n[function]\nname = 'sphere'\n[task]\nspeed_m_per_s = 1"),
            "p.toml:4: unknown key task. Valid here: name, title, description, kind, schedule, "
            "racing, sets, "
            "run, published, function");
}

struct BadOverride {
  std::string text;
  std::string message;
};

TEST(BadConfig, OverridesAreNamedAsSuch) {
  const std::vector<BadOverride> mistakes = {
      {"task.sped_m_per_s=2",
       std::string("--set task.sped_m_per_s=2: unknown key task.sped_m_per_s; did you mean "
                   "'task.speed_m_per_s'? Valid here: ") +
           list_keys("speed_m_per_s", kTaskKeys)},
      {"tsk.speed_m_per_s=2",
       std::string(
           "--set tsk.speed_m_per_s=2: unknown key tsk; did you mean 'task'? Valid here: ") +
           list_keys("task", kTopKeys)},
      {"task.speed_m_per_s=0",
       "--set task.speed_m_per_s=0: task.speed_m_per_s is 0; it must be a finite number >= 0.0001 "
       "and <= 100"},
      {"task.speed_m_per_s=inf",
       "--set task.speed_m_per_s=inf: task.speed_m_per_s is inf; it must be a finite number"},
      {"task.speed_m_per_s=fast",
       "--set task.speed_m_per_s=fast: task.speed_m_per_s is fast, a string; it must be a finite "
       "number >= 0.0001 and <= 100"},
      {"task.speed_m_per_s",
       "--set task.speed_m_per_s: there is no '=' in it; write KEY=VALUE, as in --set "
       "task.speed_m_per_s=2"},
      {"=2",
       "--set =2: there is no usable key before the '='; write KEY=VALUE, as in --set "
       "task.speed_m_per_s=2"},
      {"task.speed_m_per_s=2 m/s",
       "--set task.speed_m_per_s=2 m/s: '2 m/s' is neither a TOML value nor a word of letters, "
       "digits, _ - . and /; put text in quotes, as in --set 'task.speed_m_per_s=\"two words\"'"},
      {"task=3", "--set task=3: task is 3, an integer; it must be a table, [task]"},
      {"robot.urdf.name=x",
       "--set robot.urdf.name=x: robot.urdf is \"irb4600_40_255\", a string (base.toml:3), not a "
       "table; nothing below it can be set"},
      {"extends=other",
       "--set extends=other: extends cannot be overridden; name another file instead"},
      {"sets.training=test/1",
       "--set sets.training=test/1: sets.training is test/1; a training set must be named "
       "train/ID, as in train/1"},
      {"variables.optimize=[\"p\",\"p\"]",
       "--set variables.optimize=[\"p\",\"p\"]: variables.optimize is [\"p\",\"p\"]; 'p' stands "
       "there twice; name it once"},
  };
  const ProblemFolder folder;
  for (const BadOverride& mistake : mistakes) {
    EXPECT_EQ(folder.refusal_of("extends = \"base\"\n", {mistake.text}), mistake.message);
  }
}

}  // namespace
}  // namespace armwright
