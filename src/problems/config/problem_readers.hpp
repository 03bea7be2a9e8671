// The readers of a problem's tables. Internal to this module, except for perturbations and paths,
// which commands and tests read by themselves.
//
// Each .cpp file declares the settings of its tables beside the reader. The constants k...Settings
// list them per table; problem_settings() (problem_loader.hpp) holds all of these.
//
// Every reader throws Error{usage} that names file, line and key, unless its comment says more.
// Readers settle (ConfigTable::settle) each value that the file leaves open and that decides a
// result, so that the recorded configuration has it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/config.hpp"
#include "problems/config/problem_loader.hpp"
#include "problems/interface/schedule.hpp"
#include "problems/tracking/tracking_config.hpp"
#include "sim/engines/engine_table.hpp"
#include "sim/identification/fitted_plant.hpp"
#include "sim/kinematics/arm_clearance.hpp"
#include "sim/robot/tube.hpp"

namespace armwright {

// problem_loader.cpp

// Makes the problem that `table` describes. `path` is its file, or a file that need not exist: it
// names the problem, and files that the table names are looked for beside it. Throws Error as
// load_problem() does.
LoadedProblem read_problem(const ConfigTable& table, const std::filesystem::path& path,
                           std::span<const EngineRow> engines, const ProgramSource& programs);

// Returns the path of the file of `kind` (config_files.hpp) that a setting names. It is looked for
// beside the configuration first.
std::filesystem::path resolve_named(const ConfigTable& table, const Setting<std::string>& setting,
                                    std::string_view kind);

// Returns the path of the file that a setting names: beside the configuration, or in the current
// folder. Refuses a name that is in neither.
std::filesystem::path find_beside(const ConfigTable& table, const Setting<std::string>& setting);

// Records the file's hash as an input of the problem. Throws Error{io} if it cannot be read,
// Error{bad_data} if it is larger than 8 MiB.
void add_input(LoadedProblem& loaded, const std::filesystem::path& file);

// program_reader.cpp: [program], a problem that a user has written

extern const SettingTable kProgramSettings;
// Returns whether a problem's name means a program and not a problem's file:
// "exec:python3 motor.py", "python:motor".
bool is_program_name(std::string_view name);
// Sets the problem, its cases and the hashes of its program's files. Settles the description, so
// that a recorded problem is read without the program. Throws what the program's kind throws
// (problems/user).
void load_program(const ConfigTable& table, const ProgramSource& programs, LoadedProblem& loaded);

// Why a problem that is read from a record cannot be simulated.
inline constexpr const char* kStartsNothing =
    "this command reads what is recorded and starts no program";
// Sets what a description says of cases.
void set_user_cases(const UserDescription& description, LoadedProblem& loaded);

// command_reader.cpp: [command] and the tables of a description, a problem that is a command per
// case

extern const SettingTable kCommandSettings, kUserVariableSettings, kUserObjectiveSettings,
    kUserConstraintSettings, kUserMetricSettings, kUserCasesSettings;
// Does what load_program() does. `path` is the problem's file. loaded.name must be set. Settles the
// texts of templates, so that a recorded problem is read without them.
void load_command(const ConfigTable& table, const std::filesystem::path& path,
                  const ProgramSource& programs, LoadedProblem& loaded);
// Sets a problem that has only a description, for ask and tell. armwright cannot simulate it.
// loaded.name must be set.
void load_external(const ConfigTable& table, LoadedProblem& loaded);

// schedule_reader.cpp: [schedule] and [racing]

extern const SettingTable kScheduleSettings;
extern const SettingTable kRacingSettings;
void read_schedule_table(const ConfigTable& table, LoadedProblem& loaded);
Racing read_racing_table(const ConfigTable& table);
// Settles one training case, always the same, and sets it in `loaded`.
void settle_one_case(const ConfigTable& table, LoadedProblem& loaded);

// tracking_loader.cpp: [robot], [training] and [motors]

extern const SettingTable kRobotSettings;
extern const SettingTable kTrainingSettings;
extern const SettingTable kMotorSettings;
extern const Setting<std::string> kRobotUrdf;
// Calls the function. Puts the robot's file before the message of an Error{bad_data}.
void name_robot_file(const std::filesystem::path& urdf, const std::function<void()>& call);
// The robot that the table [robot] describes, with the masses of its file.
struct ReadRobot {
  RobotModel robot;
  RobotModel plain;             // without the plant's file
  std::filesystem::path plant;  // that file; may be empty
  std::optional<FittedPlant> fitted;
};
// Records the robot's files as inputs.
ReadRobot read_robot(const ConfigTable& table, LoadedProblem& loaded);
// Refuses a floor above the arm's base.
void check_floor(const ConfigTable& table, const Setting<double>& setting, double floor_m,
                 const RobotModel& robot);
// Sets the problem and the hashes of its inputs. Throws Error{bad_data} for a file that a table
// names and that is wrong.
void load_tracking(const ConfigTable& table, std::span<const EngineRow> engines,
                   LoadedProblem& loaded);

// identification_reader.cpp: [identification], a robot's parameters from recorded motions

extern const SettingTable kIdentificationSettings;
// Sets the problem, its cases and the hashes of its inputs. Throws Error{bad_data} for a log that
// cannot be read or fails a check.
void load_identification(const ConfigTable& table, LoadedProblem& loaded);
extern const Setting<std::vector<std::string>> kFitGroups;
std::vector<FitGroup> read_groups(const ConfigTable& table);
extern const Setting<double> kPayloadMass;
extern const Setting<std::vector<double>> kPayloadCom;
// Gives the robot the payload that the table states, if it does.
void read_payload(const ConfigTable& table, RobotModel& robot);

// excitation_reader.cpp: [excitation], a motion that tells a robot's parameters

extern const SettingTable kExcitationSettings;
// Sets the problem, its single case and the hashes of its inputs. Throws Error{bad_data} for a robot
// whose limits do not say what motions are allowed.
void load_excitation(const ConfigTable& table, LoadedProblem& loaded);

// obstacle_reader.cpp: [[obstacle]]
//
// kind = "urdf" stands for all collision shapes of a file. A mesh counts as the capsule around its
// vertices.

extern const SettingTable kObstacleSettings;
// Reads the obstacles of the problem's root table. Returns nothing if there are none and `self` is
// false. Adds notes to the robot, which is read from `urdf`, and inputs to the problem. Throws
// Error{bad_data} for a URDF or mesh that cannot be read.
std::shared_ptr<const ArmClearance> read_clearance(const ConfigTable& table,
                                                   const std::filesystem::path& urdf, bool self,
                                                   RobotModel& robot, LoadedProblem& loaded);
// Sets what config.task must keep clear of, and by how much. Refuses a home that is not clear.
void read_task_clearance(const ConfigTable& table, const std::filesystem::path& urdf,
                         TrackingConfig& config, LoadedProblem& loaded);

// tube_reader.cpp: [tubes], of which an arm is made

extern const SettingTable kTubeSettings;
// Returns the bounds that a setting gives. Refuses other lists than two ascending numbers.
std::optional<VariableBounds> read_bounds(const ConfigTable& table,
                                          const Setting<std::vector<double>>& setting);
// Reads the tubes of the problem's root table. Returns none if it has no [tubes]. Refuses walls that
// are, or can become, thicker than the radius.
ArmTubes read_tubes(const ConfigTable& root, const RobotModel& robot);
// Reads the tubes of a tracking problem, and makes the links of config.robot such tubes.
void read_task_tubes(const ConfigTable& table, TrackingConfig& config);

// motion_reader.cpp: [motion]: a motion that is planned

extern const SettingTable kMotionSettings;
// Sets the problem, its single case and the hashes of its inputs. Throws Error{bad_data} if the arm
// cannot reach a point.
void load_motion(const ConfigTable& table, LoadedProblem& loaded);

// engine_reader.cpp: [physics]

extern const SettingTable kPhysicsSettings;
extern const Setting<int> kPhysicsSubsteps;
// Chooses the engines among those of `table`, and settles the SIMD level if one of them has SIMD:
// the last digits of every result depend on it.
EnginePair read_engines(const ConfigTable& physics, std::span<const EngineRow> table);
PhysicsSettings read_physics(const ConfigTable& physics);

// task_reader.cpp: [task], [control] and [workspace]

extern const SettingTable kTaskSettings;
extern const SettingTable kControlSettings;
extern const SettingTable kWorkspaceSettings;
extern const Setting<std::string> kTaskOrientation, kTaskLimits, kControlController;
extern const Setting<bool> kTaskCountFirstPoint, kTaskSelfClearance;
extern const Setting<double> kTaskClearance, kControlPeriod, kTaskSpeed, kTaskDistanceLimit,
    kTaskFloor, kWorkspaceRadius, kWorkspaceShortestMove;
extern const Setting<std::vector<double>> kTaskHome, kTaskLoadCom, kTaskToolRpy, kTaskToolAxis,
    kWorkspaceCentre, kWorkspaceNormal;

// The most control periods of a test case: the joint position setpoints of four joints then take
// 320 MB. A published case has 3925.
inline constexpr double kMostPeriods = 1e7;

TrackingTask read_task(const ConfigTable& table, const ConfigTable& control);
// Records the solver of numeric inverse kinematics in `table`, the task's, unless it is that of
// version 1.0 or the arm has a closed form.
void settle_solver(const ConfigTable& table, const TrackingSetup& setup);
WorkspaceSphere read_workspace(const ConfigTable& table);
// Refuses values that are each allowed, but together make a test case longer than kMostPeriods.
void check_length(const ConfigTable& table, const ConfigTable& control,
                  const TrackingConfig& config);
// Returns three numbers. `what` completes the message "it must be three numbers: ".
Eigen::Vector3d read_vector(const ConfigTable& table, const Setting<std::vector<double>>& setting,
                            std::string_view what);
// Returns one number per joint. A single number of the file counts for all joints; an empty list stays
// empty. Refuses lists of other lengths.
std::vector<double> read_per_joint(const ConfigTable& table,
                                   const Setting<std::vector<double>>& setting, std::size_t joints);
// Returns three numbers as a unit vector. Refuses the zero vector.
Eigen::Vector3d read_direction(const ConfigTable& table,
                               const Setting<std::vector<double>>& setting);
// The limits of each number of a direction.
inline constexpr Range kDirectionRange{.lower = -1e6, .upper = 1e6};
// The limits of each angle of roll, pitch and yaw, rad.
inline constexpr Range kAngleRange{.lower = -7, .upper = 7};

// drive_reader.cpp: [control], what it says of drives

extern const Setting<std::string> kControlInterface;
extern const Setting<double> kControlBandwidth, kControlDelay, kControlResolution,
    kControlSlideResolution;
// Sets task.drives. The control period and the physics of the task must be set.
void read_drives(const ConfigTable& control, TrackingTask& task);

// robot_proposal.cpp: what robot.propose = true adds

// Proposes what the file leaves out of orientation, home, workspace and speed
// (sim/proposal/workspace_proposal.hpp, sim/proposal/drive_proposal.hpp), completes config.task and
// config.workspace with it, and settles it. Values in the file are kept. Throws Error{usage} if the
// file gives only a part of values that belong together.
void apply_proposal(const ConfigTable& table, TrackingConfig& config);
// Returns the proposed controllers and effort limits, for variables.start = "proposed". Their
// bandwidth is that of [variables], or else 10 rad/s, or another one if simulations of the
// proposal's cases diverge or have large errors; this bandwidth is settled.
ArmDesign propose_start(const ConfigTable& variables, const TrackingConfig& config);

// path_reader.cpp: [path], a path of the user's own in place of cases generated in the workspace
//
// It is the one case that designs are trained, validated and tested on. If plants are perturbed,
// the sets have as many cases as they say, all on this path, each with a plant of its own.
//
//   kind = "points"  [[path.point]] tables with position_m and rpy_rad; either all points have
//                    rpy_rad or none. The tool moves from each point to the next by the task's
//                    reference signal, and rests there.
//   kind = "line"    from_m, to_m, repeats: there and back again, in the same way
//   kind = "circle"  centre_m, normal, radius_m, start (a direction; default: the direction in the
//                    circle's plane that is nearest to x, or to y if the normal is close to x),
//                    repeats: without a stop. The reference signal at task.speed_m_per_s gives the
//                    way along the circle; the error counts all along.
//   kind = "file"    file = "path.csv": the columns of parse_path()
// Orientations turn along the shortest way (slerp).

extern const SettingTable kPathSettings;

// Returns nothing if the table has no kind. Adds the file of a path to the problem's inputs. Throws
// Error{bad_data} with file and line of the path.
std::optional<TestCase> read_path(const ConfigTable& table, const TrackingTask& task,
                                  LoadedProblem& loaded);

// path_file.cpp

inline constexpr double kFarthestPlace_m = 100;  // as in files of test cases
inline constexpr std::size_t kMostPathPoints = 1'000'000;
// The limits of each coordinate of a place in the arm's cell, and of the size of a thing there, m.
inline constexpr Range kCellPlace{.lower = -kFarthestPlace_m, .upper = kFarthestPlace_m};
inline constexpr Range kSize_m{.lower = 0, .upper = kFarthestPlace_m, .lower_open = true};

// Reads a path in CSV. Columns: x_m, y_m, z_m; optionally roll_rad, pitch_rad and yaw_rad, or qw,
// qx, qy and qz; optionally time_s. With times the result is a continuous path with one point per
// control period of the task, straight between the rows, and the error counts all along. Without
// times the rows are the points that the tool moves between. `name` is the file's name in messages.
// Throws Error{bad_data} with file and line.
TestCase parse_path(std::string_view text, const std::string& name, const TrackingTask& task);

// Lets the target stay at the end of a continuous path for the task's rest_s.
void add_rest(const TrackingTask& task, TestCase& path);

// motion_case.cpp

// Reads a motion (problems/logs/motion_file.hpp) as a case of the arm: a continuous path with the
// joint positions of each control period, and the task's rest at its end. The rates and accelerations
// of a file without them are those of a cubic spline. Throws what read_motion_file() throws.
TestCase read_motion_case(const std::filesystem::path& file, const RobotModel& robot,
                          const TrackingTask& task);

// objective_reader.cpp: [objective]

extern const SettingTable kObjectiveSettings;
extern const Setting<std::string> kObjectiveKind;
extern const Setting<std::vector<std::string>> kObjectiveQuantities;
// Reads the weights and scales of the quantities `names`; their places are those in `known`. Refuses
// names that are not there, or twice, and a front of less than two.
std::vector<WeightedQuantity> read_quantities(const ConfigTable& table,
                                              const std::vector<std::string>& names,
                                              const std::vector<std::string>& known, bool is_front);
// Reads the objective, without the quantities of a front.
TrackingObjective read_objective(const ConfigTable& table);
// Reads the quantities of a front. The variables and the requirements must be there.
void read_front(const ConfigTable& table, TrackingConfig& config);
// Refuses, in `table`, limits that no design within the bounds can meet, or that every design
// meets.
void check_limits(const ConfigTable& table, const TrackingConfig& config);

// variables_reader.cpp: [variables]

extern const SettingTable kVariableSettings;
extern const Setting<std::string> kVariablesStart;
extern const Setting<double> kVariablesStartBandwidth;
// Reads the start, the decision vector and its bounds into `config`, and the controller that
// [control] names. Throws Error{bad_data} if no start can be proposed for the robot in `urdf`.
void read_variables(const ConfigTable& variables, const ConfigTable& control,
                    const std::filesystem::path& urdf, TrackingConfig& config,
                    LoadedProblem& loaded);

// perturbation_reader.cpp: [perturbation] (perturbation.hpp)
//
// preset = NAME names a file with the same keys: a shipped one in configs/perturbations, or a path.
// Keys beside it replace the keys of the preset; a load or friction there also replaces the
// preset's other form of it, which is a share or numbers in kg and per joint. An empty list stands
// for none; of load_kg it stands for the task's own load. If NAME.toml has a file _NAME.toml beside
// it, that file is for all robots but those that _robots.toml beside it names.

extern const SettingTable kPerturbationSettings;

// The robot that a perturbation is for, and the design that optimizations start from: shares are
// shares of its masses and of its effort limits. Refers to both.
struct PerturbedRobot {
  const RobotModel& model;
  const ArmDesign& start;
  std::shared_ptr<const FittedPlant> fitted = nullptr;  // what the plant's file leaves uncertain
};

// Reads the preset for the robot by itself: the name of a shipped file, or a path.
Perturbation load_perturbation(const std::string& preset, const PerturbedRobot& robot);
// Returns all keys as KEY=VALUE texts, which replace every key of a problem's table.
std::vector<std::string> make_overrides(const Perturbation& perturbation);
// Settles the values of a preset, and no preset. Records the file that was read for the robot as an
// input of `loaded`.
Perturbation read_perturbation(const ConfigTable& table, const PerturbedRobot& robot,
                               LoadedProblem& loaded);

// Refuses, in [task], a load's centre of mass if the task has no load and no load is drawn.
void check_load(const ConfigTable& task, const ConfigTable& table, const TrackingConfig& config);

// requirement_reader.cpp: [[requirement]] (requirement.hpp)

extern const SettingTable kRequirementSettings;
// Reads the requirements for the robot, task, workspace and start of `config`.
std::vector<Requirement> read_requirements(std::span<const ConfigTable> tables,
                                           const TrackingConfig& config);

}  // namespace armwright
