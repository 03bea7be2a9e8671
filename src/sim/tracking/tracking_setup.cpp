#include "sim/tracking/tracking_setup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/read_limit.hpp"
#include "sim/dynamics/chain_model.hpp"
#include "sim/simd/simd_level.hpp"
#include "sim/tracking/path_check.hpp"
#include "sim/tracking/reference_signal.hpp"

namespace armwright {
namespace {

// Tolerance for times that are multiples of the control period up to rounding: t_m + rest = 1.1 s
// is 110 periods of 0.01 s, not 111.
constexpr double kTimeTolerance = 1e-9;  // in control periods

int calc_steps_covering(double duration_s, double period_s) {
  return static_cast<int>(std::ceil(duration_s / period_s - kTimeTolerance));
}

// Returns how many of a segment's steps end before the target has arrived, without any tolerance.
int count_moving_steps(const Segment& segment, double period_s) {
  int steps = segment.window_start;
  while ((steps + 1) * period_s < segment.duration_s) {
    ++steps;
  }
  while (steps > 0 && steps * period_s >= segment.duration_s) {
    --steps;
  }
  return steps;
}

constexpr int kElbowUpJoints = 4;  // of an arm that the closed form can solve

// The rate at which joints move towards the middle of their ranges if the task leaves them free. It
// is slow compared with moves, which take about a second.
constexpr double kCentringRate_hz = 0.5;
// The steps between two looks at the limit of reading.
constexpr int kStepsBetweenLooks = 256;

// Copies the row before `begin` into all rows from `begin` to `end`.
void repeat_row(double* begin, const double* end) {
  if (begin == end) {
    return;
  }
  const double a = begin[-4];
  const double b = begin[-3];
  const double c = begin[-2];
  const double d = begin[-1];
  for (; begin != end; begin += kElbowUpJoints) {
    begin[0] = a;
    begin[1] = b;
    begin[2] = c;
    begin[3] = d;
  }
}

}  // namespace

std::size_t TargetTable::size_bytes() const {
  return sizeof *this + segments.size() * sizeof(Segment) +
         (start_positions.size() + joint_positions.size() + feed_forward_effort.size() +
          holding_effort.size()) *
             sizeof(double) +
         tool_points_m.size() * sizeof(Eigen::Vector3d) + unreachable.size();
}

const std::vector<std::string>& kinematics_names() {
  static const std::vector<std::string> names = {"auto", "palletiser", "numeric"};
  return names;
}

const std::vector<std::string>& limit_policy_names() {
  static const std::vector<std::string> names = {"ignore", "warn", "enforce"};
  return names;
}

const std::vector<std::string>& control_start_names() {
  static const std::vector<std::string> names = {"empty", "gravity"};
  return names;
}

TrackingSetup::TrackingSetup(const RobotModel& robot, const TrackingTask& task)
    : robot_(task.load_kg > 0 ? add_load(robot, task.load_kg, task.load_body) : robot),
      task_(task),
      tool_points_m_(make_tool_points(task.tool)) {
  const bool may_have_closed_form = task.kinematics != KinematicsChoice::numeric &&
                                    task.tool.orientation == ToolOrientation::free &&
                                    !robot.has_unactuated();
  if (task.kinematics == KinematicsChoice::palletiser) {
    closed_form_.emplace(robot, task.ik_bug);
  } else if (may_have_closed_form) {
    closed_form_ = ElbowUpKinematics::make_if_suited(robot, task.ik_bug);
  }
  for (const Eigen::Vector3d& point_m : tool_points_m_) {
    robot_.tool_points_m.push_back(robot_.tip_pose * point_m);
  }
  if (!closed_form_) {
    numeric_ = get_kinematics();
    numeric_->check_task(robot_);
  }
  chain_ = std::make_shared<articulated::ChainModel>(robot_, task.physics.gravity_m_per_s2);
}

std::shared_ptr<const NumericKinematics> TrackingSetup::get_kinematics() const {
  if (numeric_) {
    return numeric_;
  }
  ToolTask tool = task_.tool;
  if (closed_form_) {  // the closed form keeps the last link, which ends in the tip, pointing down
    tool.orientation = ToolOrientation::pointing;
    tool.axis = robot_.tip_pose.linear().transpose() * robot_.tip_pose.translation().normalized();
  }
  return std::make_shared<NumericKinematics>(robot_, tool, task_.home,
                                             task_.limits != LimitPolicy::ignore, task_.solver);
}

targets::SignalCurve TrackingSetup::make_signal(double distance_m) const {
  double speed = task_.speed_m_per_s;
  if (distance_m < task_.distance_limit_m) {
    speed *= distance_m / task_.distance_limit_m;
  }
  return make_signal_curve(task_.signal, distance_m, speed, task_.trapezoid_acceleration_m_per_s2);
}

targets::Move TrackingSetup::make_move(const Segment& segment) const {
  targets::Move move;
  const Eigen::Vector3d way = segment.to_m - segment.from_m;
  Eigen::Vector3d::Map(move.from_m) = segment.from_m;
  Eigen::Vector3d::Map(move.to_m) = segment.to_m;
  Eigen::Vector3d::Map(move.way_m) = way;
  move.curve = make_signal(way.norm());
  move.period_s = task_.control_period_s;
  return move;
}

Eigen::Vector3d TrackingSetup::calc_target_position(const Segment& segment,
                                                    int step_in_segment) const {
  if (segment.is_sample) {
    return segment.to_m;
  }
  Eigen::Vector3d position;
  targets::calc_position(make_move(segment), step_in_segment, position.data());
  return position;
}

ToolPose TrackingSetup::make_pose(const TestCase& test_case, std::size_t point) const {
  return {test_case.points_m[point],
          test_case.turns.empty() ? task_.tool.turn : test_case.turns[point].toRotationMatrix()};
}

int TrackingSetup::count_distinct_steps(const Segment& segment) const {
  return std::min(segment.steps, count_moving_steps(segment, task_.control_period_s) + 1);
}

void TrackingSetup::make_timeline(const TestCase& test_case, TargetTable& table) const {
  const double period = task_.control_period_s;
  for (std::size_t k = 1; k < test_case.points_m.size(); ++k) {
    Segment segment;
    segment.from_m = test_case.points_m[k - 1];
    segment.to_m = test_case.points_m[k];
    segment.first_step = table.steps;
    if (test_case.continuous) {
      segment.is_sample = true;
      segment.duration_s = period;
      segment.steps = 1;
    } else {
      const double distance = (segment.to_m - segment.from_m).norm();
      segment.duration_s = make_signal(distance).duration_s;
      segment.steps = calc_steps_covering(segment.duration_s + task_.rest_s, period);
      segment.window_start = std::max(0, calc_steps_covering(segment.duration_s, period) - 1);
    }
    table.steps += segment.steps;
    table.segments.push_back(segment);
    const ToolPose end = make_pose(test_case, k);
    for (const Eigen::Vector3d& point_m : tool_points_m_) {
      table.tool_points_m.emplace_back(end.position_m + end.turn * point_m);
    }
  }
}

void TrackingSetup::solve_closed_form(const TestCase& test_case, TargetTable& table) const {
  std::array<double, kElbowUpJoints> q{};
  const Eigen::Vector3d& start = test_case.points_m.front();
  if (!closed_form_->solve(start, q)) {
    table.unreachable = "start: " + closed_form_->describe_unreachable(start);
    return;
  }
  table.start_positions.assign(q.begin(), q.end());
  table.joint_positions.resize(static_cast<std::size_t>(table.steps) * table.joints);
  const auto solve_move = targets::get_move_functions(find_best_simd()).solve_move;
  for (std::size_t k = 0; k < table.segments.size(); ++k) {
    const Segment& segment = table.segments[k];
    const std::size_t first = static_cast<std::size_t>(segment.first_step) * table.joints;
    double* const angles = table.joint_positions.data() + first;
    // After its arrival the target stays, and so do the joint positions.
    const int distinct = count_distinct_steps(segment);
    int reached = 0;
    if (segment.is_sample) {
      reached = closed_form_->solve(segment.to_m,
                                    std::span<double, kElbowUpJoints>(angles, kElbowUpJoints));
    } else {
      reached = solve_move(closed_form_->arm(), make_move(segment), distinct, angles);
    }
    if (reached < distinct) {
      table.unreachable =
          fmt::format("on the way to point {}: {}", k + 1,
                      closed_form_->describe_unreachable(calc_target_position(segment, reached)));
      table.joint_positions.resize(first + static_cast<std::size_t>(reached) * table.joints);
      return;
    }
    repeat_row(angles + distinct * kElbowUpJoints, angles + segment.steps * kElbowUpJoints);
  }
}

// Joint positions are sequential in time: each search starts from the one before. So several cases
// share the lanes, not several steps of one case.
class TrackingSetup::NumericPath {
  using Vector = NumericKinematics::Vector;

 public:
  NumericPath(const TrackingSetup& setup, const TestCase& test_case, TargetTable& table)
      : setup_(setup),
        kinematics_(*setup.numeric_),
        test_case_(test_case),
        table_(table),
        finding_(kinematics_, setup.make_pose(test_case, 0)),
        following_(kinematics_.make_following()),
        calc_positions_(targets::get_move_functions(find_best_simd()).calc_positions),
        centring_(std::min(1.0, kCentringRate_hz * setup.task_.control_period_s)) {}

  // The next search to execute.
  NumericKinematics::Approach* search() { return is_following_ ? &following_ : &finding_.search(); }

  // Takes the executed search. Returns whether another one must be executed.
  bool advance() {
    if (!is_following_) {
      return finding_.advance() || begin_following();
    }
    if (!following_.reached) {
      table_.unreachable =
          fmt::format("on the way to point {}: {}", segment_ + 1, describe(following_, before_));
      table_.joint_positions.resize(static_cast<std::size_t>(count_steps()) * table_.joints);
      return false;
    }
    write_row();
    ++step_;
    return begin_step();
  }

 private:
  bool begin_following() {
    if (!finding_.is_found()) {
      table_.unreachable =
          "start: " + describe(finding_.search(), Vector::Zero(following_.q.size()));
      return false;
    }
    is_following_ = true;
    following_.q = finding_.posture();
    before_ = following_.q;
    table_.start_positions.assign(before_.begin(), before_.end());
    table_.joint_positions.resize(static_cast<std::size_t>(table_.steps) * table_.joints);
    begin_segment();
    return begin_step();
  }

  void begin_segment() {
    if (segment_ < table_.segments.size()) {
      const Segment& its = table_.segments[segment_];
      distinct_ = setup_.count_distinct_steps(its);
      end_ = setup_.make_pose(test_case_, segment_ + 1);
      if (!its.is_sample) {
        move_ = setup_.make_move(its);
        positions_m_.resize(static_cast<std::size_t>(distinct_));
        calc_positions_(move_, distinct_, positions_m_.front().data());
      }
    }
  }

  // Prepares the search of the next step whose target moves. Returns false at the end of the case.
  bool begin_step() {
    while (segment_ < table_.segments.size() && step_ >= distinct_) {
      for (; step_ < table_.segments[segment_].steps; ++step_) {  // the target rests
        before_ = following_.q;
        write_row();
      }
      ++segment_;
      step_ = 0;
      begin_segment();
    }
    if (segment_ == table_.segments.size()) {
      return false;
    }
    // The search starts where the joints would be at their present speed, so it needs only one or
    // two iterations. Motion that the task leaves free goes towards the middle of the ranges.
    for (Eigen::Index i = 0; i < before_.size(); ++i) {
      const auto joint = static_cast<std::size_t>(i);
      double& position = following_.q[i];
      const double carried = position - before_[i];
      const double drawn = kinematics_.has_middle(joint)
                               ? centring_ * (kinematics_.get_middle(joint) - position)
                               : 0;
      before_[i] = position;
      position += carried;
      following_.wish[i] = drawn - carried;
    }
    set_target();
    return true;
  }

  void set_target() {
    const Segment& its = table_.segments[segment_];
    ToolPose& target = following_.target;
    target = end_;
    if (its.is_sample) {
      return;
    }
    target.position_m = positions_m_[static_cast<std::size_t>(step_)];
    const double time_s = (step_ + 1) * move_.period_s;
    if (!test_case_.turns.empty() && time_s < its.duration_s) {
      // The tool turns in proportion to the distance covered (Shoemake 1985, Animating rotation
      // with quaternion curves, SIGGRAPH 19).
      const double share = targets::calc_distance(move_.curve, time_s) / move_.curve.distance_m;
      target.turn = test_case_.turns[segment_]
                        .slerp(share, test_case_.turns[segment_ + 1])
                        .toRotationMatrix();
    }
  }

  int count_steps() const { return table_.segments[segment_].first_step + step_; }
  void write_row() {
    std::copy_n(
        following_.q.data(), table_.joints,
        table_.joint_positions.data() + static_cast<std::size_t>(count_steps()) * table_.joints);
  }
  std::string describe(const NumericKinematics::Approach& search, const Vector& from) const {
    return describe_unreachable(kinematics_, setup_.robot_, setup_.task_.tool, search.target,
                                std::span(from.data(), static_cast<std::size_t>(from.size())));
  }

  const TrackingSetup& setup_;
  const NumericKinematics& kinematics_;
  const TestCase& test_case_;
  TargetTable& table_;
  NumericKinematics::Finding finding_;
  NumericKinematics::Approach following_;
  targets::CalcPositions* const calc_positions_;
  const double centring_;
  bool is_following_ = false;
  Vector before_;  // a step earlier
  std::size_t segment_ = 0;
  int step_ = 0;      // of the segment
  int distinct_ = 0;  // its steps with targets of their own
  ToolPose end_;      // the target at the end of the segment
  targets::Move move_;
  std::vector<Eigen::Vector3d> positions_m_;  // of the target, one per distinct step
};

void TrackingSetup::take_joints(const TestCase& test_case, TargetTable& table) const {
  table.start_positions = test_case.joints.front();
  for (std::size_t k = 1; k < test_case.joints.size(); ++k) {
    table.joint_positions.insert(table.joint_positions.end(), test_case.joints[k].begin(),
                                 test_case.joints[k].end());
  }
}

void TrackingSetup::solve_numerically(std::span<const TestCase> test_cases,
                                      std::span<const std::size_t> searched,
                                      std::span<TargetTable> tables) const {
  // A case that ends leaves its lane to the next one.
  std::vector<std::unique_ptr<NumericPath>> paths;
  std::vector<NumericKinematics::Approach*> searches;
  std::size_t begun = 0;
  for (int looks = 0;; ++looks) {
    for (; begun < searched.size() && paths.size() < postures::kLanes; ++begun) {
      const std::size_t i = searched[begun];
      paths.push_back(std::make_unique<NumericPath>(*this, test_cases[i], tables[i]));
    }
    if (paths.empty()) {
      return;
    }
    if (looks % kStepsBetweenLooks == 0) {
      check_reading();
    }
    searches.clear();
    for (const auto& path : paths) {
      searches.push_back(path->search());
    }
    numeric_->approach(searches);
    std::erase_if(paths, [](const auto& path) { return !path->advance(); });
  }
}

std::vector<TargetTable> TrackingSetup::make_targets(std::span<const TestCase> test_cases) const {
  std::vector<TargetTable> tables(test_cases.size());
  std::vector<std::size_t> searched;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    tables[i].joints = robot_.joint_count();
    make_timeline(test_cases[i], tables[i]);
    if (!test_cases[i].joints.empty()) {
      take_joints(test_cases[i], tables[i]);
    } else if (closed_form_) {
      solve_closed_form(test_cases[i], tables[i]);
    } else {
      searched.push_back(i);
    }
  }
  solve_numerically(test_cases, searched, tables);
  for (TargetTable& table : tables) {
    if (!table.unreachable.empty()) {
      continue;
    }
    if (task_.limits == LimitPolicy::enforce) {
      const std::vector<PathFault> faults = find_path_faults(*this, table);
      if (!faults.empty()) {
        table.unreachable = armwright::describe(faults.front(), robot_);
        continue;
      }
    }
    fill_efforts(table);
  }
  return tables;
}

TargetTable TrackingSetup::make_targets(const TestCase& test_case) const {
  return std::move(make_targets(std::span(&test_case, 1)).front());
}

}  // namespace armwright
