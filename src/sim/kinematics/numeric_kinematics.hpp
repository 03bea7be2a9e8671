// Inverse kinematics of any serial chain by damped least squares, for arms without a closed form.
//
// Let J be the derivatives of the task (below) with respect to the joint positions, e the task's
// error, and w the preferred displacement of the joints. Each iteration solves
//   (J^T J + mu^2 1) dq = J^T e + mu^2 w,   mu^2 = |e|^2 + 1e-9 max_i (J^T J)_ii.
// Damping by the residual e converges from any start, and quadratically at the end, also near
// singularities (Sugihara 2011, Solvability-unconcerned inverse kinematics by the
// Levenberg-Marquardt method, IEEE Transactions on Robotics 27, 984-991). Motions that the task
// leaves free follow w, which pulls joints towards the middle of their ranges. A joint that would
// leave its range is held at the range's end, and the step is solved again for the other joints
// (Flacco, De Luca and Khatib 2012, Motion control of redundant robots under joint constraints,
// ICRA).
//
// The task's error consists of the error of the tip's position (m) and, depending on
// ToolTask::orientation, of
//   pointing  L times the difference of the tool's axis from its target (m),
//   pose      L times the rotation vector between the tool's orientation and its target (m).
//
// The norms that the iteration weighs up add rad and m. A sliding joint's way is therefore counted
// in units of the distance that it slides while the turning joints turn by 1 rad, all at their speed
// limits: of joints that could do the same, the slow one moves less (Chan and Dubey 1995, A weighted
// least-norm solution based scheme for avoiding joint limits for redundant joint manipulators, IEEE
// Transactions on Robotics and Automation 11, 286-292). `scalar` counts in m.
//
// Two solvers iterate in this way. `lanes` solves eight postures at once in SIMD lanes
// (posture_solver.hpp). `scalar` is that of version 1.0, one posture at a time; recorded
// configurations of 1.0 keep it, because the last bits of the two differ.
//
// Unactuated joints are held at 0: their ranges are 0 to 0, and J has columns of 0 for them. Ranges
// are then always kept. Without `within_limits`, those of the other joints are infinite.
//
// Joint positions q are in rad or m, one per joint. Positions of revolute joints are not wrapped,
// so they are continuous along a path.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "base/random.hpp"
#include "sim/kinematics/posture_solver.hpp"
#include "sim/kinematics/tool_task.hpp"
#include "sim/robot/robot_model.hpp"

namespace armwright {

enum class NumericSolver { lanes, scalar };
const std::vector<std::string>& numeric_solver_names();  // in the order of the enum

// The iterative inverse kinematics of one robot and one task. Its const functions may run in
// several threads at once.
class NumericKinematics {
 public:
  static constexpr int kMostJoints = postures::kMostJoints;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostJoints, 1>;
  using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMostJoints>;

  // `home` is the start of searches, one position per joint. If it is empty, searches start at the
  // middle of each joint's range, or at 0 for a joint without range. If `within_limits` is true,
  // joints stay in their ranges. Throws Error{bad_data} for more than kMostJoints joints,
  // Error{usage} for a home of another length.
  NumericKinematics(const RobotModel& robot, const ToolTask& tool, std::vector<double> home,
                    bool within_limits, NumericSolver solver = NumericSolver::lanes);

  // One posture that is searched for: what approach() takes and gives.
  struct Approach {
    ToolPose target;
    Vector q;     // where the search starts; afterwards the posture, invalid if it was not reached
    Vector wish;  // w in the first iteration
    int iterations = 0;
    double longest_step = 0;  // rad or m
    bool reached = false;
  };
  // Searches for every posture. Each result is the same bit for bit, whatever else is searched for.
  // Fastest for multiples of postures::kLanes.
  void approach(std::span<Approach* const> some) const;
  // Makes the search of follow().
  Approach make_following() const;
  // Makes a search that may begin far from its target, at q.
  Approach make_search(const ToolPose& target, std::span<const double> q) const;

  // The sequence of searches by which find() finds a posture. The caller executes them, so that
  // several sequences can share the lanes.
  class Finding {
   public:
    // Keeps a reference to the kinematics, which must live as long as this object.
    Finding(const NumericKinematics& kinematics, const ToolPose& target);
    // The next search to execute.
    Approach& search() { return search_; }
    // Takes the executed search. Returns whether another one must be executed.
    bool advance();
    bool is_found() const { return is_found_; }
    const Vector& posture() const { return posture_; }  // if it is found

   private:
    void begin_attempt();
    void begin_relaxation();

    const NumericKinematics& kinematics_;
    RandomStream random_;
    Approach search_;
    int attempts_ = 0;
    int relaxations_ = 0;
    bool is_found_ = false;
    Vector posture_;
  };

  // Moves q from a nearby posture to one at the target. Where the task leaves joints free, they
  // move by `wish`, one displacement per joint. Returns false if this fails; q is then invalid.
  bool follow(const ToolPose& target, std::span<const double> wish, std::span<double> q) const;
  // Writes a posture at the target into q. Starts from home, then from random postures, which are
  // the same in every call. Moves joints as near to the middle of their ranges as the task allows.
  // Returns false if it finds no posture.
  bool find(const ToolPose& target, std::span<double> q) const;

  ToolPose calc_pose(std::span<const double> q) const;
  // Returns where the joints' origins and, at the end, the tip are in the world (m). The origin of
  // a prismatic joint moves with its link.
  std::vector<Eigen::Vector3d> calc_places(std::span<const double> q) const;
  // Returns the distance of a posture from a target in the task's measure (m, tool_task.hpp).
  double calc_distance(const ToolPose& target, std::span<const double> q) const;
  // Returns J: one row per component of the task's error, one column per joint.
  Jacobian calc_jacobian(std::span<const double> q) const;
  // Returns the rank of J at a posture without singularity.
  int rank() const { return rank_; }
  // suits_task() returns whether that rank is sufficient for the task; check_task() throws
  // Error{bad_data} if it is not. A tool that points up or down, as ToolTask::turn says, needs only
  // four: most arms turn about the vertical and bend in one plane, in which they can do it.
  bool suits_task() const;
  void check_task(const RobotModel& robot) const;
  // Returns the ratio of J's smallest singular value (among the first rank()) to its largest.
  // Lengths are in units of the arm's length, turns in rad. It is 0 in a singular posture.
  double calc_dexterity(std::span<const double> q) const;
  // Returns the joint with the largest part in the motion that moves the tool least.
  std::size_t find_idle_joint(std::span<const double> q) const;
  // Returns the middle of the joint's range, or 0 if it has none.
  double get_middle(std::size_t joint) const { return chain_[joint].middle; }
  bool has_middle(std::size_t joint) const { return chain_[joint].has_middle; }
  const std::vector<double>& home() const { return home_; }
  std::size_t joint_count() const { return chain_.size(); }
  // Returns a distance from the first joint (m) that the tip cannot exceed; may be infinite.
  double reach_m() const { return lane_chain_.reach_m; }
  // Returns a random posture, one position per joint, drawn from the part of the joint's range
  // within +-pi rad or +-1 m.
  std::vector<double> draw_posture(RandomStream& random) const;

 private:
  struct Part {
    Eigen::Matrix3d turn;
    Eigen::Vector3d place;
    Eigen::Vector3d axis;
    Eigen::Matrix3d cross, outer;  // [a]x and a a^T, a the axis
    bool slides = false;
    double unit = 1;  // of a sliding joint's way, in `lanes` (m)
    double lower = 0, upper = 0, middle = 0;
    bool has_middle = false;
    bool held = false;
  };
  struct Posture;  // the places of all joints in the world

  void calc_posture(const Vector& q, Posture& posture) const;
  Eigen::Matrix<double, 6, 1> calc_error(const ToolPose& target, const Posture& posture) const;
  Jacobian calc_jacobian(const Posture& posture) const;
  // Makes one step from q. Returns false if the step is not finite.
  bool improve(const Jacobian& jacobian, const Eigen::Matrix<double, 6, 1>& error,
               const Vector& wish, double longest_step, Vector& q) const;
  bool solve(Approach& search) const;
  void make_lane_chain(const RobotModel& robot);
  // Returns J in comparable units: lengths in units of the arm's length, turns in rad.
  Eigen::MatrixXd calc_even_jacobian(std::span<const double> q) const;
  void find_rank();

  ToolTask tool_;
  std::vector<Part> chain_;
  Eigen::Matrix3d tip_turn_;
  Eigen::Vector3d tip_place_;
  std::vector<double> home_;
  bool within_limits_;
  NumericSolver solver_;
  postures::Chain lane_chain_;
  postures::Solve solve_lanes_;
  double length_m_ = 0;
  int rank_ = 0;
  double tolerance_m_ = 0;  // the largest error of a solution
};

}  // namespace armwright
