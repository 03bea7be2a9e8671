#include "problems/config/setting_descriptions.hpp"

namespace armwright {

const std::vector<SettingWords>& problem_setting_words() {
  static const std::vector<SettingWords> words = {
      {"title", "one line, for lists and reports (default: the name)"},
      {"description", "some lines more"},
      {"kind",
       "tracking: an arm follows a moving target; analytic: a function with a known optimum"},
      {"name",
       "what runs and folders are called (default: the file's name); {robot} in it stands "
       "for the name of the URDF's file"},

      {"robot.urdf", "the arm: a URDF beside this file, or the name of a shipped one"},
      {"robot.base", "link that stands still (default: the root of the tree)"},
      {"robot.tip",
       "link whose frame is the tool (default: the chain's last, where there is one "
       "chain)"},
      {"robot.density_kg_per_m3",
       "gives links without <inertial> the mass of their shapes; 0: they "
       "are refused"},
      {"robot.mass_scale", "every mass and inertia of the arm times this"},
      {"robot.propose",
       "whether what the file leaves out of workspace, pace and controllers is "
       "proposed from the URDF"},

      {"task.signal", "how the target moves from point to point (armwright list signals)"},
      {"task.speed_m_per_s", "nominal speed of the target"},
      {"task.distance_limit_m", "moves that are shorter take as long as one of this length"},
      {"task.trapezoid_acceleration_m_per_s2", "of the signal trapezoid"},
      {"task.rest_s", "how long the target rests after a move; the error goes on counting"},
      {"task.count_first_point",
       "whether the first move, from rest, counts (default: false; of a "
       "[path] true)"},
      {"task.ik_bug", "the thesis's own error in its inverse kinematics"},
      {"task.load_kg", "mass at the tool"},
      {"task.kinematics", "auto: the closed form where the arm is a palletiser, else numeric"},
      {"task.limits",
       "joint ranges, speeds and singularities along the paths: ignored, warned of "
       "or enforced"},
      {"task.orientation",
       "what of the tool counts beside its place: nothing, the axis's "
       "direction, or the whole pose"},
      {"task.tool_rpy_rad", "the tool's frame in the world, as roll, pitch and yaw, three numbers"},
      {"task.tool_axis", "direction in the tip's frame that points, three numbers (default: z)"},
      {"task.orientation_arm_m", "what a turn by 1 rad counts like"},
      {"task.home",
       "where the search for the first posture begins: a position a joint, rad or m "
       "(default: the middle of the ranges)"},

      {"control.period_s", "sample period of the controllers"},
      {"control.controller",
       "law of all joints (armwright list controllers; default: that of the "
       "start)"},

      {"workspace.centre_m", "of the sphere in which test cases lie, three numbers"},
      {"workspace.radius_m", "of that sphere"},
      {"workspace.normal", "test cases lie in the disc across this direction, three numbers"},
      {"workspace.shortest_move_m", "between two points of a test case"},
      {"workspace.points", "of a test case, beside the place where it begins"},

      {"path.kind", "a path of your own instead of generated cases"},
      {"path.from_m", "of kind line: one end, three numbers"},
      {"path.to_m", "of kind line: the other end, three numbers"},
      {"path.centre_m", "of kind circle, three numbers"},
      {"path.normal",
       "of kind circle: it is gone round counterclockwise about this, three numbers"},
      {"path.radius_m", "of kind circle"},
      {"path.start", "of kind circle: direction from its centre to where it begins, three numbers"},
      {"path.repeats", "how often a line is gone there and back, or a circle round"},
      {"path.file", "of kind file: CSV beside this file (docs/tasks.md)"},
      {"path.point[].position_m",
       "of kind points: where to, three numbers; the first is the start"},
      {"path.point[].rpy_rad",
       "the tool's turn there, roll, pitch and yaw; for all points or none"},

      {"physics.engine",
       "simulates, and judges unless judging_engine says otherwise (armwright "
       "list engines)"},
      {"physics.judging_engine", "simulates validation and test cases (default: the engine)"},
      {"physics.precision", "of training, by engines with SIMD"},
      {"physics.simd",
       "instruction set; auto: the widest here. It is recorded, as the last digits "
       "depend on it"},
      {"physics.gravity_m_per_s2", "downwards, along -z"},
      {"physics.substeps", "steps of the physics in a control period"},
      {"physics.erp",
       "ODE's error reduction parameter: share of a joint's error that is corrected "
       "in a step"},
      {"physics.cfm", "ODE's constraint force mixing: how soft its joints are"},

      {"training.cutoff_error_m",
       "a training case is given up at this error, and its remaining "
       "points count as much"},

      {"schedule.kind",
       "which training cases: fixed: always the first; fresh: other ones for every "
       "generation; coevolution: bred against the designs"},
      {"schedule.cases", "how many a candidate is simulated on"},
      {"schedule.fixed_cases",
       "how many fixed ones an optimizer without generations gets where the "
       "kind wants generations"},
      {"racing.kind",
       "halving: candidates get their cases rung by rung, and only the better "
       "go on; abandonment: those that are certain to be worse are given up"},
      {"racing.first_cases", "of halving: cases that all candidates get"},
      {"racing.eta", "of halving: one of so many goes on to the next rung"},
      {"racing.margin", "of abandonment: how many times the incumbent's error is bad enough"},
      {"racing.chunk_cases", "of abandonment: cases between two looks"},

      {"sets.training", "name of the training set, train/ID: another name, other cases"},
      {"sets.validation", "of the validation set, validation/ID"},
      {"sets.test", "of the test set, test/ID"},
      {"sets.validation_cases", "on which candidates for the win are judged"},
      {"sets.test_cases", "on which the winner is judged"},

      {"run.optimizer", "what armwright optimize uses unless told otherwise"},
      {"run.budget", "training cases that it may simulate, likewise"},

      {"objective.kind", "what is minimised; of error_vs_torque both, the others are one number"},
      {"objective.logarithm", "the natural logarithm of the objective instead: the same minimiser"},
      {"objective.statistic", "how the errors of the cases become one"},
      {"objective.cvar_share", "of statistic cvar: share of the worst cases whose mean counts"},
      {"objective.failure_penalty_m", "of mean_with_failures: what a share of failures of 1 costs"},
      {"objective.torque_weight", "of error_and_torque"},
      {"objective.torque_scale_n_m", "total torque that counts 1"},
      {"objective.error_scale_m", "error that counts 1"},
      {"objective.energy_weight", "of kinds that are sums"},
      {"objective.energy_scale_j", "energy that counts 1; required with a weight above 0"},
      {"objective.duration_weight", "of kinds that are sums"},
      {"objective.duration_scale_s", "duration that counts 1; required with a weight above 0"},
      {"objective.error_limit_m", "of torque_with_error_limit"},
      {"objective.total_torque_limit_n_m", "of error_with_torque_limit"},

      {"variables.start",
       "the design to start from: a file beside this one, the name of a shipped "
       "one, or proposed"},
      {"variables.optimize",
       "what is optimized of every joint: gains, or single ones of the "
       "controller, effort_min, effort_max, length_scale, section_scale "
       "(default: gains and effort limits)"},
      {"variables.task", "[\"speed\"]: the nominal speed is optimized too"},
      {"variables.bounds_factor",
       "gains and limits may be the start's divided by this to times this"},
      {"variables.length_bounds_factor", "likewise of length_scale"},
      {"variables.section_bounds_factor", "likewise of section_scale"},
      {"variables.speed_bounds_factor", "likewise of the speed"},
      {"variables.within_effort_limits", "effort limits stay within the URDF's"},
      {"variables.joint[].name",
       "a joint of the arm (here: of the shipped one) that has an own list"},
      {"variables.joint[].optimize", "its list, instead of variables.optimize"},
      {"motors.torque_per_mass_n_m_per_kg",
       "gives every joint a motor with the mass of its effort "
       "limit divided by this; 0: without mass"},

      {"requirement[].quantity", "what is measured (docs/requirements.md)"},
      {"requirement[].joint",
       "of a joint's quantities: that one only, by the arm's own names (default: "
       "the worst)"},
      {"requirement[].use", "report: shown as a traffic light; constraint: optimizers keep it too"},
      {"requirement[].band_m", "of settling_time (default: 2 % of the move's length)"},
      {"requirement[].limit_relative", "of overshoot: a share of the move's length"},
      {"requirement[].limit_s", "of rise_time and settling_time"},
      {"requirement[].limit_m", "of tip_error"},
      {"requirement[].limit_n_m", "of peak_torque and rms_torque"},
      {"requirement[].limit_n", "of the same, of joints that slide"},
      {"requirement[].limit_rad_per_s", "of joint_speed"},
      {"requirement[].limit_m_per_s", "of the same, of joints that slide"},
      {"requirement[].limit_j", "of energy"},

      {"perturbation.preset",
       "name of a shipped one or a file, on top of which the other keys "
       "come"},
      {"perturbation.set", "name of the set of plants, plant/ID"},
      {"perturbation.apply_to", "which simulations have perturbed plants"},
      {"perturbation.mass_relative", "each link's mass and inertia off by at most this share"},
      {"perturbation.load_kg", "the lightest and the heaviest load; []: the task's"},
      {"perturbation.viscous_friction_n_m_s_per_rad", "at most, a number a joint; []: none"},
      {"perturbation.coulomb_friction_n_m", "at most, a number a joint; []: none"},
      {"perturbation.friction_transition_rad_per_s",
       "speed from which on Coulomb friction is at its "
       "full size"},
      {"perturbation.quantisation_rad", "measured angles are multiples of this; 0: they are exact"},
      {"perturbation.delay_s", "measured angles are at most so old"},
      {"perturbation.torque_ripple_relative", "at most this share of the torque"},
      {"perturbation.ripple_cycles_per_turn", "of the torque ripple"},
      {"perturbation.effort_limit_sigma",
       "effort limits times exp(-this |N|), N normally "
       "distributed"},
      {"perturbation.gain_sigma", "gains times exp(this N)"},

      {"sweep.parameter", "key that armwright sweep changes"},
      {"sweep.values", "what it is set to, one after the other"},
      {"sweep.design", "design that is evaluated"},

      {"published.error_m", "the source's winner, for comparison: its error"},
      {"published.total_torque_n_m", "its total torque"},
      {"published.design", "its design file"},
      {"published.where", "where the source says so"},

      {"function.name", "of kind analytic: which function"},
      {"function.dimension", "of kind analytic: number of variables"},
  };
  return words;
}

const std::vector<SettingWords>& design_setting_words() {
  static const std::vector<SettingWords> words = {
      {"name", "of the design (default: the file's)"},
      {"title", "one line"},
      {"source", "where it comes from"},
      {"controller", "law of all joints (armwright list controllers)"},
      {"speed_m_per_s", "nominal speed, instead of the task's"},
      {"joint[].name", "of the joint, from the base on"},
      {"joint[].effort_min_n_m",
       "what the drive can do in the negative direction; N of joints that "
       "slide"},
      {"joint[].effort_max_n_m", "what it can do in the positive direction"},
      {"joint[].length_scale", "the link that the joint moves is so much longer"},
      {"joint[].section_scale", "its section is so much larger"},
      {"published[].label", "a published result of the design, by which tables name it"},
      {"published[].problem", "shipped problem that it is of"},
      {"published[].set", "what is changed about that, KEY=VALUE"},
      {"published[].error_m", "the published error"},
      {"published[].total_torque_n_m", "the published total torque"},
      {"published[].where", "where it stands"},
  };
  return words;
}

}  // namespace armwright
