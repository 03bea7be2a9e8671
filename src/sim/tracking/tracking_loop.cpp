#include "sim/tracking/tracking_loop.hpp"

#include <algorithm>
#include <cmath>

#include "sim/dynamics/arm_equations.hpp"
#include "sim/dynamics/drive_loop.hpp"
#include "sim/dynamics/joint_effort.hpp"
#include "sim/kinematics/kinematics.hpp"

namespace armwright {
namespace {

struct DriveLevel;  // tags the code that this file instantiates
using DriveNumber = lanes::Single<double, DriveLevel>;

}  // namespace

// The drives' inner loops.
struct ArmPlant::Drives {
  using Loops = articulated::DriveLoops<DriveNumber>;

  Drives(int count, const articulated::CommandClock& at, const articulated::ChainModel& chain)
      : joints(count),
        clock(at),
        memory(static_cast<std::size_t>(articulated::calc_drive_packs(count, at)), DriveNumber(0)),
        equations(chain) {}
  Loops loops() { return {memory.data(), joints, clock}; }

  int joints;
  articulated::CommandClock clock;
  std::vector<DriveNumber> memory;
  articulated::ArmEquations equations;
};

ArmPlant::ArmPlant(const RobotModel& robot, const PlantVariation* variation,
                   std::span<const double> q, double substep_s)
    : robot_(robot),
      variation_(variation),
      substep_s_(substep_s),
      past_(static_cast<std::size_t>(variation == nullptr ? 0 : variation->delay_substeps) + 1,
            std::vector<double>(q.begin(), q.end())),
      measured_(q.size()),
      acting_effort_(q.size()),
      inertia_(robot.has_plant() ? q.size() : 0),
      motor_(q.begin(), q.end()),
      motor_rate_(q.size()) {}

ArmPlant::~ArmPlant() = default;

void ArmPlant::add_drives(const TrackingSetup& setup, const TrackingJob& job) {
  const TrackingTask& task = setup.task();
  if (!task.drives.has_loops()) {
    return;
  }
  const int joints = static_cast<int>(robot_.joint_count());
  const articulated::CommandClock clock =
      task.drives.make_clock(task.control_period_s, task.physics.substeps);
  drives_ = std::make_unique<Drives>(joints, clock, setup.chain());
  inertia_.resize(robot_.joint_count());
  const Drives::Loops loops = drives_->loops();
  const std::vector<double>& start = past_.front();
  const std::vector<double> holding = setup.calc_holding_efforts(start);
  for (int i = 0; i < joints; ++i) {
    const auto joint = static_cast<std::size_t>(i);
    task.drives.set_numbers(
        robot_.joints[joint], holding[joint], start[joint], clock, [&](int field, double number) {
          drives_->memory[static_cast<std::size_t>(field * joints + i)] = number;
        });
    loops.get(articulated::kMotorMin, i) = job.design->joints[joint].limits.min;
    loops.get(articulated::kMotorMax, i) = job.design->joints[joint].limits.max;
  }
}

std::span<const double> ArmPlant::measure() {
  // The oldest positions come after the newest ones in the ring.
  measured_ = past_[(newest_ + 1) % past_.size()];
  const double quantum = variation_ == nullptr ? 0 : variation_->quantum;
  for (std::size_t i = 0; quantum > 0 && i < measured_.size(); ++i) {
    // The motor of an elastic joint may have turned further.
    const double position =
        robot_.joints[i].kind == JointKind::revolute ? wrap_angle(measured_[i]) : measured_[i];
    measured_[i] = std::nearbyint(position / quantum) * quantum;
  }
  for (std::size_t i = 0; drives_ && i < measured_.size(); ++i) {
    const bool slides = robot_.joints[i].kind == JointKind::prismatic;
    measured_[i] = drives_->loops().measure(static_cast<int>(i), measured_[i], slides).v;
  }
  return measured_;
}

void ArmPlant::act(std::span<const double> command, std::span<const double> q,
                   std::span<const double> qd) {
  if (drives_) {
    drives_->equations.set(q, qd);
  }
  for (std::size_t i = 0; i < acting_effort_.size(); ++i) {
    const Joint& joint = robot_.joints[i];
    const JointPlant& its = joint.plant;
    double acting = drives_ ? drive(i, command[i], q[i], qd[i]) : command[i];
    if (variation_ != nullptr) {
      acting = perturb(i, acting, q[i], its.is_elastic() ? motor_rate_[i] : qd[i]);
    }
    if (its.is_elastic()) {
      acting = pass_spring(i, acting, q[i], qd[i]);
    } else if (its.has_friction()) {
      const double chord = articulated::calc_friction_chord(its, qd[i]);
      acting -= its.offset + chord * qd[i];
      inertia_[i] = its.armature + substep_s_ * chord;
    } else if (!inertia_.empty()) {
      inertia_[i] = its.armature;
    }
    if (drives_ && !its.is_elastic()) {
      inertia_[i] += drives_->loops().get_inertia(static_cast<int>(i), substep_s_).v;
    }
    acting_effort_[i] = acting + articulated::calc_counterbalance(joint, q[i]);
  }
}

// Lets a joint's drive begin a substep and returns its effort.
double ArmPlant::drive(std::size_t joint, double command, double q, double rate) {
  const Joint& one = robot_.joints[joint];
  const JointPlant& its = one.plant;
  const Drives::Loops loops = drives_->loops();
  const int i = static_cast<int>(joint);
  loops.command(i, command);
  const double inertia = drives_->equations.mass(joint, joint) + its.armature;
  double own = inertia;
  double pushed_rate = rate;
  double bias = drives_->equations.bias(joint) - articulated::calc_counterbalance(one, q);
  if (its.is_elastic()) {
    own = its.armature;
    pushed_rate = motor_rate_[joint];
    bias = its.stiffness * calc_displacement(one.kind, q, motor_[joint]) +
           its.damping * (pushed_rate - rate);
  }
  if (its.has_friction()) {
    bias += its.offset + articulated::calc_friction_chord(its, pushed_rate) * pushed_rate;
  }
  return loops
      .begin(i, get_measured(joint, q), pushed_rate, inertia, own, bias,
             one.kind == JointKind::prismatic, substep_s_)
      .v;
}

double ArmPlant::get_measured(std::size_t joint, double q) const {
  const JointPlant& its = robot_.joints[joint].plant;
  return its.is_elastic() && its.measured == MeasuredSide::motor ? motor_[joint] : q;
}

std::optional<ArmPlant::DriveMeasures> ArmPlant::take_measures(std::size_t joint) {
  if (!drives_) {
    return {};
  }
  const Drives::Loops loops = drives_->loops();
  const int i = static_cast<int>(joint);
  const auto get = [&](articulated::DriveField field) { return loops.get(field, i).v; };
  const double share = 1.0 / drives_->clock.substeps;
  const DriveMeasures measures{get(articulated::kMotorEffort), get(articulated::kPeriodPeak),
                               share * get(articulated::kPeriodSquares),
                               share * get(articulated::kPeriodClamped),
                               get(articulated::kPeriodWork)};
  loops.clear_measures(i);
  return measures;
}

double ArmPlant::perturb(std::size_t joint, double effort, double q, double rate) const {
  const PlantVariation& its = *variation_;
  const bool turns = robot_.joints[joint].kind == JointKind::revolute;
  const double ripple = turns ? its.torque_ripple[joint] * std::sin(its.ripple_cycles_per_turn * q +
                                                                    its.ripple_phase_rad[joint])
                              : 0;
  const double sliding = std::clamp(rate / its.friction_transition_rate, -1.0, 1.0);
  return effort + effort * ripple -
         (its.viscous_friction[joint] * rate + its.coulomb_friction[joint] * sliding);
}

// Moves the motor by a substep and returns the spring's effort at its start.
double ArmPlant::pass_spring(std::size_t joint, double effort, double q, double rate) {
  const JointPlant& its = robot_.joints[joint].plant;
  double& place = motor_[joint];
  double& speed = motor_rate_[joint];
  const double stretch = calc_displacement(robot_.joints[joint].kind, q, place);
  const double spring = its.stiffness * stretch + its.damping * (speed - rate);
  const double chord = articulated::calc_friction_chord(its, speed);
  double inertia = its.armature + substep_s_ * chord;
  if (drives_) {
    inertia += drives_->loops().get_inertia(static_cast<int>(joint), substep_s_).v;
  }
  speed += substep_s_ * ((effort - spring - its.offset - chord * speed) / inertia);
  place += substep_s_ * speed;
  return spring;
}

void ArmPlant::remember(std::span<const double> q) {
  newest_ = (newest_ + 1) % past_.size();
  for (std::size_t i = 0; i < q.size(); ++i) {
    past_[newest_][i] = get_measured(i, q[i]);
  }
}

void ArmPlant::end_substep(std::span<const double> qd) {
  if (!drives_) {
    return;
  }
  for (std::size_t i = 0; i < qd.size(); ++i) {
    const double rate = robot_.joints[i].plant.is_elastic() ? motor_rate_[i] : qd[i];
    drives_->loops().end(static_cast<int>(i), rate, substep_s_);
  }
  ++drives_->clock.substep;
}

double ArmPlant::get_pushed(std::size_t joint, double q) const {
  return robot_.joints[joint].plant.is_elastic() ? motor_[joint] : q;
}

TrackingLoop::TrackingLoop(const TrackingSetup& setup, const TrackingJob& job)
    : setup_(setup),
      job_(job),
      period_s_(setup.task().control_period_s),
      substep_s_(period_s_ / setup.task().physics.substeps) {
  const std::size_t joints = setup.robot().joint_count();
  const ControllerRow& row = find_controller(job.design->controller);
  check_controller(setup.task(), job);
  has_feed_forward_ = row.feed_forward != FeedForward::none;
  for (std::size_t i = 0; i < joints; ++i) {
    const JointDrive& drive = job.design->joints[i];
    const Joint& joint = setup.robot().joints[i];
    controllers_.push_back(row.make(
        drive.gains, setup.task().drives.get_command_limits(joint, drive.limits), joint.kind));
    if (!job.targets->holding_effort.empty()) {
      controllers_.back()->hold(job.targets->holding_effort[i]);
    }
  }
  q_.resize(joints);
  effort_.resize(joints);
  result_.peak_effort.resize(joints);
  result_.rms_effort.resize(joints);
  result_.saturated_share.resize(joints);
  result_.point_error_m.reserve(job.targets->segments.size());
  if (job.recording.error_series) {
    result_.error_series_m.reserve(static_cast<std::size_t>(job.targets->steps));
  }
}

bool TrackingLoop::add_drive_measures(std::size_t joint) {
  const auto measures = plant_->take_measures(joint);
  if (!measures) {
    return false;
  }
  effort_[joint] = measures->effort;
  result_.peak_effort[joint] = std::max(result_.peak_effort[joint], measures->peak);
  result_.rms_effort[joint] += measures->square;
  result_.saturated_share[joint] += measures->clamped;
  result_.energy_j += measures->work;
  return true;
}

}  // namespace armwright
