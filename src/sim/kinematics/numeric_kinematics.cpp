#include "sim/kinematics/numeric_kinematics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/decompositions.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "sim/simd/simd_level.hpp"

namespace armwright {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Error6 = Eigen::Matrix<double, 6, 1>;
using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0,
                             NumericKinematics::kMostJoints, NumericKinematics::kMostJoints>;

// Allowed error as a fraction of the arm's length; far below the accuracy of any controller.
constexpr double kTolerance = 1e-10;
// The same for a tool that four joints keep vertical: in files, angles such as 1.5708 rad for a
// quarter of a turn leave it a little tilted.
constexpr double kTiltedTolerance = 3e-5;
constexpr double kLeastDamping = 1e-9;  // the least mu^2, as a fraction of the largest (J^T J)_ii
// Following a path starts near the solution and needs few iterations; a search needs more.
constexpr int kFollowIterations = 30;
constexpr double kFollowStep = 0.5;  // rad or m
constexpr int kSearchIterations = 200;
constexpr double kSearchStep = 0.3;
constexpr double kVertical = 1 - 1e-9;  // |z| of a direction that counts as vertical
constexpr int kRelaxations = 300;
constexpr double kRelaxationShare = 0.2;
constexpr double kRelaxed = 1e-7;
constexpr int kRestarts = 60;
constexpr int kRankPostures = 20;
constexpr double kNoMotion =
    1e-6;  // smaller singular values, as a fraction of the largest, count as 0
// Joints without range are drawn from one turn (revolute) or from +-kSlide_m (prismatic).
constexpr double kSlide_m = 1;
constexpr double kShortest_m = 1e-3;  // the least length of an arm; avoids a division by zero

Matrix3d make_cross(const Vector3d& a) {
  Matrix3d cross;
  cross << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return cross;
}

// Returns the rotation vector: along the rotation's axis, with the angle in [0, pi] as its length.
Vector3d calc_rotation_vector(const Matrix3d& turn) {
  const Eigen::AngleAxisd rotation(turn);
  return rotation.angle() * rotation.axis();
}

NumericKinematics::Vector to_vector(std::span<const double> q) {
  return Eigen::Map<const Eigen::VectorXd>(q.data(), static_cast<Eigen::Index>(q.size()));
}

void copy(const NumericKinematics::Vector& from, std::span<double> to) {
  std::copy_n(from.data(), to.size(), to.begin());
}

std::string describe_task(ToolOrientation orientation) {
  switch (orientation) {
    case ToolOrientation::free:
      break;
    case ToolOrientation::pointing:
      return "position and direction of the tool, 5 in all";
    case ToolOrientation::pose:
      return "position and orientation of the tool, 6 in all";
  }
  return "position of the tip";
}

// Returns the distance that the joint slides while turning joints turn by 1 rad, all at their speed
// limits: the nearest power of two, so that counting in it does not round. 1 without such limits.
double calc_unit_of_slides(const RobotModel& robot, const Joint& sliding) {
  double sum_rad_per_s = 0;
  int turning = 0;
  for (const Joint& joint : robot.joints) {
    if (joint.kind == JointKind::revolute) {
      sum_rad_per_s += joint.speed_limit;
      ++turning;
    }
  }
  const double unit = sliding.speed_limit * turning / sum_rad_per_s;
  return std::isfinite(unit) && unit > 0 ? std::exp2(std::round(std::log2(unit))) : 1;
}

}  // namespace

const std::vector<std::string>& numeric_solver_names() {
  static const std::vector<std::string> names = {"lanes", "scalar"};
  return names;
}

struct NumericKinematics::Posture {
  Vector3d axis[kMostJoints];
  Vector3d place[kMostJoints];
  Matrix3d turn;  // orientation of the tip's frame
  Vector3d tip;
};

NumericKinematics::NumericKinematics(const RobotModel& robot, const ToolTask& tool,
                                     std::vector<double> home, bool within_limits,
                                     NumericSolver solver)
    : tool_(tool),
      tip_turn_(robot.tip_pose.linear()),
      tip_place_(robot.tip_pose.translation()),
      home_(std::move(home)),
      within_limits_(within_limits || robot.has_unactuated()),
      solver_(solver),
      solve_lanes_(postures::get_solve(find_best_simd())) {
  const std::size_t n = robot.joint_count();
  if (n > kMostJoints) {
    throw Error(ErrorKind::bad_data,
                fmt::format("robot '{}' has {} joints; the inverse kinematics takes at most {}",
                            sanitize(robot.name), n, kMostJoints));
  }
  if (!home_.empty() && home_.size() != n) {
    throw Error(ErrorKind::usage,
                fmt::format("task.home has {} positions for the {} joints of robot '{}'",
                            home_.size(), n, sanitize(robot.name)));
  }
  length_m_ = tip_place_.norm();
  for (const Joint& joint : robot.joints) {
    Part part;
    part.turn = joint.origin.linear();
    part.place = joint.origin.translation();
    part.axis = joint.axis;
    part.cross = make_cross(joint.axis);
    part.outer = joint.axis * joint.axis.transpose();
    part.slides = joint.kind == JointKind::prismatic;
    part.lower = joint.lower;
    part.upper = joint.upper;
    part.has_middle = std::isfinite(joint.lower) && std::isfinite(joint.upper);
    part.middle = part.has_middle ? 0.5 * (joint.lower + joint.upper) : 0;
    length_m_ += part.place.norm() + (part.slides && part.has_middle ? part.upper - part.lower : 0);
    if (joint.plant.unactuated) {
      part.held = true;
      part.lower = part.upper = part.middle = 0;
    } else if (within_limits_ && !within_limits) {
      part.lower = -std::numeric_limits<double>::infinity();
      part.upper = std::numeric_limits<double>::infinity();
    }
    part.unit = part.slides ? calc_unit_of_slides(robot, joint) : 1;
    chain_.push_back(part);
  }
  if (home_.empty()) {
    for (std::size_t i = 0; i < n; ++i) {
      home_.push_back(chain_[i].middle);
    }
  }
  length_m_ = std::max(length_m_, kShortest_m);
  find_rank();
  const bool may_tilt = tool_.orientation == ToolOrientation::pointing && rank_ == 4;
  tolerance_m_ = (may_tilt ? kTiltedTolerance : kTolerance) * length_m_;
  make_lane_chain(robot);
}

// Let B be the rotation that takes z to a joint's axis, in the joint's frame, and A the rotation of
// the next joint's origin. The next joint's B is chosen such that B^T A B_next = Rz(turn) Rx(tilt).
void NumericKinematics::make_lane_chain(const RobotModel& robot) {
  postures::Chain& chain = lane_chain_;
  chain.joints = static_cast<int>(chain_.size());
  chain.within_limits = within_limits_;
  chain.orientation = tool_.orientation;
  chain.arm_m = tool_.arm_m;
  chain.tolerance_m = tolerance_m_;
  chain.least_damping = kLeastDamping;
  Vector3d::Map(chain.tool_axis) = tool_.axis;
  Matrix3d basis = Matrix3d::Identity();  // B of the joint before
  double base_turn_rad = 0;
  double* turn_before = &base_turn_rad;
  for (std::size_t i = 0; i < chain_.size(); ++i) {
    const Part& part = chain_[i];
    postures::ChainJoint& joint = chain.joint[i];
    const Vector3d axis = basis.transpose() * (part.turn * part.axis.normalized());
    joint.tilt_cos = axis.z();
    joint.tilt_sin = std::hypot(axis.x(), axis.y());
    // Angles that are multiples of a right angle up to rounding cost less. Parallel axes have no
    // common normal; any turn is right.
    constexpr double kRounding = 1e-14;
    if (joint.tilt_sin < kRounding) {
      joint.tilt_sin = 0;
      joint.tilt_cos = std::copysign(1.0, axis.z());
    } else if (std::abs(joint.tilt_cos) < kRounding) {
      joint.tilt_cos = 0;
      joint.tilt_sin = 1;
    }
    *turn_before = joint.tilt_sin == 0 ? 0 : std::atan2(axis.x(), -axis.y());
    Matrix3d tilt;
    tilt << 1, 0, 0, 0, joint.tilt_cos, -joint.tilt_sin, 0, joint.tilt_sin, joint.tilt_cos;
    basis = basis * Eigen::AngleAxisd(*turn_before, Vector3d::UnitZ()).toRotationMatrix();
    Vector3d::Map(joint.place_m) = basis.transpose() * part.place;
    basis = part.turn.transpose() * basis * tilt;
    joint.slides = part.slides;
    joint.unit_m = part.unit;
    joint.lower = part.lower / part.unit;
    joint.upper = part.upper / part.unit;
    turn_before = &joint.turn_rad;
    chain.reach_m += part.place.norm();
    if (part.slides) {
      chain.reach_m += within_limits_ ? std::max(std::abs(part.lower), std::abs(part.upper))
                                      : std::numeric_limits<double>::infinity();
    }
  }
  chain.base_turn_cos = std::cos(base_turn_rad);
  chain.base_turn_sin = std::sin(base_turn_rad);
  chain.reach_m += tip_place_.norm();
  Vector3d::Map(chain.tip_place_m) = basis.transpose() * robot.tip_pose.translation();
  const Matrix3d tip_turn = basis.transpose() * robot.tip_pose.linear();
  for (int row = 0; row < 3; ++row) {
    Vector3d::Map(chain.tip_turn[row]) = tip_turn.row(row);
  }
  Vector3d::Map(chain.last_tool_axis) = tip_turn * tool_.axis;
}

void NumericKinematics::find_rank() {
  RandomStream random("inverse kinematics/rank", 0);
  for (int i = 0; i < kRankPostures; ++i) {
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(calc_even_jacobian(draw_posture(random)));
    const auto& values = svd.singularValues();
    int rank = 0;
    while (rank < values.size() && values[rank] > kNoMotion * std::max(values[0], 1e-12)) {
      ++rank;
    }
    rank_ = std::max(rank_, rank);
  }
}

bool NumericKinematics::suits_task() const {
  switch (tool_.orientation) {
    case ToolOrientation::free:
      return rank_ >= 1;
    case ToolOrientation::pointing: {
      const double upright = std::abs((tool_.turn * tool_.axis).z());
      return rank_ >= (upright > kVertical ? 4 : 5);
    }
    case ToolOrientation::pose:
      return rank_ >= 6;
  }
  return false;
}

void NumericKinematics::check_task(const RobotModel& robot) const {
  if (!suits_task()) {
    throw Error(
        ErrorKind::bad_data,
        fmt::format("the joints of robot '{}' move its tool in {} independent directions at most, "
                    "but task.orientation = \"{}\" tracks the {}; choose another orientation",
                    sanitize(robot.name), rank_,
                    tool_orientation_names()[static_cast<std::size_t>(tool_.orientation)],
                    describe_task(tool_.orientation)));
  }
}

std::vector<double> NumericKinematics::draw_posture(RandomStream& random) const {
  std::vector<double> q;
  for (const Part& part : chain_) {
    const double widest = part.slides ? kSlide_m : std::numbers::pi;
    double lower = std::max(part.lower, -widest);
    double upper = std::min(part.upper, widest);
    if (lower > upper) {  // the range lies outside +-widest
      lower = part.lower;
      upper = part.upper;
    }
    q.push_back(random.uniform(lower, upper));
  }
  return q;
}

void NumericKinematics::calc_posture(const Vector& q, Posture& posture) const {
  Matrix3d turn = Matrix3d::Identity();
  Vector3d place = Vector3d::Zero();
  for (std::size_t i = 0; i < chain_.size(); ++i) {
    const Part& part = chain_[i];
    const double position = q[static_cast<Eigen::Index>(i)];
    place += turn * part.place;
    turn = turn * part.turn;
    posture.axis[i] = turn * part.axis;
    posture.place[i] = place;
    if (part.slides) {
      place += position * posture.axis[i];
      continue;
    }
    // Rodrigues: cos 1 + sin [a]x + (1 - cos) a a^T.
    const double cosine = std::cos(position);
    turn = turn * (cosine * Matrix3d::Identity() + std::sin(position) * part.cross +
                   (1 - cosine) * part.outer);
  }
  posture.tip = place + turn * tip_place_;
  posture.turn = turn * tip_turn_;
}

Error6 NumericKinematics::calc_error(const ToolPose& target, const Posture& posture) const {
  Error6 error = Error6::Zero();
  error.head<3>() = target.position_m - posture.tip;
  switch (tool_.orientation) {
    case ToolOrientation::free:
      break;
    case ToolOrientation::pointing: {
      // The rotation vector that turns the tool's axis to its target.
      const Vector3d is = posture.turn * tool_.axis;
      const Vector3d should = target.turn * tool_.axis;
      const Vector3d across = is.cross(should);
      const double sine = across.norm();
      const double angle = std::atan2(sine, is.dot(should));
      if (sine > 0) {
        error.tail<3>() = tool_.arm_m * angle / sine * across;
      } else if (angle > 1) {  // opposite directions: any perpendicular axis is right
        error.tail<3>() = tool_.arm_m * angle * is.unitOrthogonal();
      }
      break;
    }
    case ToolOrientation::pose:
      error.tail<3>() = tool_.arm_m * calc_rotation_vector(target.turn * posture.turn.transpose());
      break;
  }
  return error;
}

NumericKinematics::Jacobian NumericKinematics::calc_jacobian(const Posture& posture) const {
  const auto n = static_cast<Eigen::Index>(chain_.size());
  Jacobian jacobian = Jacobian::Zero(6, n);
  const Vector3d pointing = posture.turn * tool_.axis;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vector3d& axis = posture.axis[i];
    if (chain_[static_cast<std::size_t>(i)].held) {
      continue;
    }
    if (chain_[static_cast<std::size_t>(i)].slides) {
      jacobian.col(i).head<3>() = axis;
      continue;
    }
    jacobian.col(i).head<3>() = axis.cross(posture.tip - posture.place[i]);
    if (tool_.orientation == ToolOrientation::pose) {
      jacobian.col(i).tail<3>() = tool_.arm_m * axis;
    } else if (tool_.orientation ==
               ToolOrientation::pointing) {  // turns about the tool's axis are free
      jacobian.col(i).tail<3>() = tool_.arm_m * (axis - axis.dot(pointing) * pointing);
    }
  }
  return jacobian;
}

NumericKinematics::Jacobian NumericKinematics::calc_jacobian(std::span<const double> q) const {
  Posture posture;
  calc_posture(to_vector(q), posture);
  return calc_jacobian(posture);
}

ToolPose NumericKinematics::calc_pose(std::span<const double> q) const {
  Posture posture;
  calc_posture(to_vector(q), posture);
  return {posture.tip, posture.turn};
}

std::vector<Eigen::Vector3d> NumericKinematics::calc_places(std::span<const double> q) const {
  Posture posture;
  calc_posture(to_vector(q), posture);
  std::vector<Eigen::Vector3d> places;
  for (std::size_t i = 0; i < chain_.size(); ++i) {
    places.emplace_back(posture.place[i] + (chain_[i].slides ? q[i] : 0.0) * posture.axis[i]);
  }
  places.push_back(posture.tip);
  return places;
}

double NumericKinematics::calc_distance(const ToolPose& target, std::span<const double> q) const {
  Posture posture;
  calc_posture(to_vector(q), posture);
  return calc_error(target, posture).norm();
}

Eigen::MatrixXd NumericKinematics::calc_even_jacobian(std::span<const double> q) const {
  Eigen::MatrixXd jacobian = calc_jacobian(q);
  jacobian.topRows<3>() /= length_m_;
  jacobian.bottomRows<3>() /= tool_.arm_m;
  for (std::size_t i = 0; i < chain_.size(); ++i) {
    if (chain_[i].slides) {
      jacobian.col(static_cast<Eigen::Index>(i)) *= length_m_;
    }
  }
  return jacobian;
}

double NumericKinematics::calc_dexterity(std::span<const double> q) const {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(calc_even_jacobian(q));
  const auto& values = svd.singularValues();
  return values[0] > 0 ? values[rank_ - 1] / values[0] : 0;
}

std::size_t NumericKinematics::find_idle_joint(std::span<const double> q) const {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(calc_even_jacobian(q), Eigen::ComputeThinV);
  Eigen::Index joint = 0;
  svd.matrixV().col(rank_ - 1).cwiseAbs().maxCoeff(&joint);
  return static_cast<std::size_t>(joint);
}

bool NumericKinematics::improve(const Jacobian& jacobian, const Error6& error, const Vector& wish,
                                double longest_step, Vector& q) const {
  const Eigen::Index n = jacobian.cols();
  Square normal = jacobian.transpose() * jacobian;
  const double damping = error.squaredNorm() + kLeastDamping * normal.diagonal().maxCoeff();
  normal.diagonal().array() += damping;
  Vector right = jacobian.transpose() * error + damping * wish;
  bool held[kMostJoints] = {};
  Vector step;
  for (Eigen::Index round = 0; round <= n; ++round) {
    step = normal.llt().solve(right);
    if (!step.allFinite()) {
      return false;
    }
    const double longest = step.cwiseAbs().maxCoeff();
    if (longest > longest_step) {
      step *= longest_step / longest;
    }
    if (!within_limits_) {
      break;
    }
    Eigen::Index worst = -1;
    double farthest = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
      const Part& part = chain_[static_cast<std::size_t>(i)];
      const double beyond = std::max(q[i] + step[i] - part.upper, part.lower - q[i] - step[i]);
      if (!held[i] && beyond > farthest) {
        worst = i;
        farthest = beyond;
      }
    }
    if (worst < 0) {
      break;
    }
    // This joint is held at the end of its range; the others are solved again.
    const Part& part = chain_[static_cast<std::size_t>(worst)];
    const double way = std::clamp(q[worst] + step[worst], part.lower, part.upper) - q[worst];
    right -= way * normal.col(worst);
    normal.row(worst).setZero();
    normal.col(worst).setZero();
    normal(worst, worst) = 1;
    right[worst] = way;
    held[worst] = true;
  }
  q += step;
  if (within_limits_) {
    for (Eigen::Index i = 0; i < n; ++i) {  // rounding may leave a joint outside its range
      const Part& part = chain_[static_cast<std::size_t>(i)];
      q[i] = std::clamp(q[i], part.lower, part.upper);
    }
  }
  return true;
}

bool NumericKinematics::solve(Approach& search) const {
  const Vector nothing = Vector::Zero(search.q.size());
  Posture posture;
  for (int i = 0;; ++i) {
    calc_posture(search.q, posture);
    const Error6 error = calc_error(search.target, posture);
    if (i > 0 && error.norm() <= tolerance_m_) {
      return true;
    }
    if (i == search.iterations ||
        !improve(calc_jacobian(posture), error, i == 0 ? search.wish : nothing, search.longest_step,
                 search.q)) {
      return false;
    }
  }
}

void NumericKinematics::approach(std::span<Approach* const> some) const {
  if (solver_ == NumericSolver::scalar) {
    for (Approach* search : some) {
      search->reached = solve(*search);
    }
    return;
  }
  const auto n = static_cast<Eigen::Index>(chain_.size());
  postures::Block block;
  for (; !some.empty(); some = some.subspan(std::min(some.size(), std::size_t{postures::kLanes}))) {
    for (std::size_t lane = 0; lane < postures::kLanes; ++lane) {
      // An unused lane has ordinary numbers, too: the processor may be slow with others.
      const bool is_used = lane < some.size();
      const Approach& search = *some[is_used ? lane : 0];
      for (Eigen::Index i = 0; i < n; ++i) {
        const double unit = chain_[static_cast<std::size_t>(i)].unit;
        block.q[i][lane] = search.q[i] / unit;
        block.wish[i][lane] = search.wish[i] / unit;
      }
      for (Eigen::Index row = 0; row < 3; ++row) {
        block.position_m[row][lane] = search.target.position_m[row];
      }
      if (tool_.orientation != ToolOrientation::free) {
        for (Eigen::Index row = 0; row < 3; ++row) {
          for (Eigen::Index column = 0; column < 3; ++column) {
            block.turn[row][column][lane] = search.target.turn(row, column);
          }
        }
      }
      block.iterations[lane] = is_used ? search.iterations : 0;
      block.longest_step[lane] = search.longest_step;
    }
    const unsigned reached = solve_lanes_(lane_chain_, block);
    for (std::size_t lane = 0; lane < std::min(some.size(), std::size_t{postures::kLanes});
         ++lane) {
      for (Eigen::Index i = 0; i < n; ++i) {
        some[lane]->q[i] = chain_[static_cast<std::size_t>(i)].unit * block.q[i][lane];
      }
      some[lane]->reached = (reached >> lane & 1) != 0;
    }
  }
}

NumericKinematics::Approach NumericKinematics::make_following() const {
  Approach search;
  search.q = Vector::Zero(static_cast<Eigen::Index>(chain_.size()));
  search.wish = search.q;
  search.iterations = kFollowIterations;
  search.longest_step = kFollowStep;
  return search;
}

NumericKinematics::Approach NumericKinematics::make_search(const ToolPose& target,
                                                           std::span<const double> q) const {
  Approach search;
  search.target = target;
  search.q = to_vector(q);
  search.wish = Vector::Zero(search.q.size());
  search.iterations = kSearchIterations;
  search.longest_step = kSearchStep;
  return search;
}

bool NumericKinematics::follow(const ToolPose& target, std::span<const double> wish,
                               std::span<double> q) const {
  Approach search = make_following();
  search.target = target;
  search.q = to_vector(q);
  search.wish = to_vector(wish);
  Approach* const one = &search;
  approach({&one, 1});
  copy(search.q, q);
  return search.reached;
}

NumericKinematics::Finding::Finding(const NumericKinematics& kinematics, const ToolPose& target)
    : kinematics_(kinematics), random_("inverse kinematics/start", 0) {
  search_.target = target;
  begin_attempt();
}

void NumericKinematics::Finding::begin_attempt() {
  search_ = kinematics_.make_search(
      search_.target, attempts_ == 0 ? kinematics_.home_ : kinematics_.draw_posture(random_));
}

void NumericKinematics::Finding::begin_relaxation() {
  search_.q = posture_;
  for (Eigen::Index joint = 0; joint < posture_.size(); ++joint) {
    const Part& part = kinematics_.chain_[static_cast<std::size_t>(joint)];
    search_.wish[joint] = part.has_middle ? kRelaxationShare * (part.middle - posture_[joint]) : 0;
  }
  search_.iterations = kFollowIterations;
}

bool NumericKinematics::Finding::advance() {
  if (!is_found_) {
    if (!search_.reached) {
      if (++attempts_ > kRestarts) {
        return false;
      }
      begin_attempt();
      return true;
    }
    is_found_ = true;
    posture_ = search_.q;
    begin_relaxation();
    return true;
  }
  if (!search_.reached) {
    return false;
  }
  const double moved = (search_.q - posture_).cwiseAbs().maxCoeff();
  posture_ = search_.q;
  if (++relaxations_ == kRelaxations || moved < kRelaxed) {
    return false;
  }
  begin_relaxation();
  return true;
}

bool NumericKinematics::find(const ToolPose& target, std::span<double> q) const {
  Finding finding(*this, target);
  Approach* const one = &finding.search();
  do {
    approach({&one, 1});
  } while (finding.advance());
  if (finding.is_found()) {
    copy(finding.posture(), q);
  }
  return finding.is_found();
}

}  // namespace armwright
