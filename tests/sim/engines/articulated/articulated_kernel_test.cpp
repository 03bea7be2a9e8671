// Compares the compiled kernels of every instruction set, called as the engine calls them, with a
// plain loop over one arm and its controllers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "physics/test_arms.hpp"
#include "physics/tracking_arms.hpp"
#include "sim/dynamics/chain_model.hpp"
#include "sim/engines/articulated/articulated_arm.hpp"
#include "sim/engines/articulated/lane_block.hpp"
#include "sim/kinematics/kinematics.hpp"

namespace armwright {
namespace {

using namespace articulated;
using namespace physics_test;

constexpr double kPeriod_s = 0.01;

std::vector<SimdLevel> find_levels() {
  std::vector<SimdLevel> levels;
  for (const std::string& name : supported_simd_names()) {
    levels.push_back(parse_simd(name));
  }
  return levels;
}

// The input of one lane.
struct LaneCase {
  RobotModel model;
  VectorXd start;
  std::vector<JointDrive> drives;
  std::vector<double> targets;  // one row per step
  Vector3d point_m;
};

struct Timeline {
  int steps = 100, window_start = 60, substeps = 1;
};

// The output of one lane.
struct Outcome {
  VectorXd q, qd, peak, squares, clamped;
  double energy_j, worst_squared;
};

std::vector<double> draw_targets(const VectorXd& start, int steps, RandomStream& random) {
  std::vector<double> targets;
  const double phase = random.uniform(0, 6);
  for (int step = 0; step < steps; ++step) {
    for (Eigen::Index i = 0; i < start.size(); ++i) {
      const double k = static_cast<double>(i);
      targets.push_back(start[i] + 0.5 * std::sin((2 + k) * kPeriod_s * step + phase + k));
    }
  }
  return targets;
}

// Lanes with different masses and drives, all on one kind of arm.
LaneCase draw_lane(const RobotModel& kind, int lane, const Timeline& time) {
  RandomStream random("test/sim/kernels/lane", static_cast<std::uint64_t>(lane));
  LaneCase one;
  one.model = kind;
  const std::size_t n = kind.joint_count();
  one.start.resize(static_cast<Eigen::Index>(n));
  for (std::size_t i = 0; i < n; ++i) {
    Inertial& body = one.model.links[i].inertial;
    const double scale = random.uniform(0.7, 1.4);
    body.mass_kg *= scale;
    body.inertia_kg_m2 *= scale;
    const bool slides = kind.joints[i].kind == JointKind::prismatic;
    one.start[static_cast<Eigen::Index>(i)] =
        slides ? random.uniform(-1, 1) : random.uniform(-4, 4);
    const double p = random.uniform(5, 20), integral = random.uniform(1, 9);
    one.drives.push_back({{p, integral, random.uniform(0.05, 0.3)}, {-8, 6}});
  }
  one.targets = draw_targets(one.start, time.steps, random);
  one.point_m = Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0, 1));
  return one;
}

Outcome simulate_one_arm(const LaneCase& one, const Timeline& time) {
  const std::size_t n = one.model.joint_count();
  const auto size = static_cast<Eigen::Index>(n);
  auto arm = make_arm<ArticulatedArm>(one.model, one.start);
  std::vector<std::unique_ptr<Controller>> controllers;
  for (std::size_t i = 0; i < n; ++i) {
    controllers.push_back(find_controller("pid").make(one.drives[i].gains, one.drives[i].limits,
                                                      one.model.joints[i].kind));
  }
  Outcome o{VectorXd(size),
            VectorXd(size),
            VectorXd::Zero(size),
            VectorXd::Zero(size),
            VectorXd::Zero(size),
            0,
            0};
  VectorXd q = physics_test::read_positions(arm, n), effort(size);
  for (int step = 0; step < time.steps; ++step) {
    for (std::size_t i = 0; i < n; ++i) {
      const auto joint = static_cast<Eigen::Index>(i);
      const double target = one.targets[static_cast<std::size_t>(step) * n + i];
      effort[joint] = controllers[i]->step(target, q[joint], kPeriod_s);
      o.clamped[joint] += controllers[i]->saturated() ? 1 : 0;
    }
    for (int substep = 0; substep < time.substeps; ++substep) {
      physics_test::step(arm, effort, kPeriod_s / time.substeps);
    }
    const VectorXd after = physics_test::read_positions(arm, n);
    const VectorXd way = calc_motion(one.model, q, after);
    o.energy_j += effort.cwiseProduct(way).cwiseMax(0).sum();
    q = after;
    o.peak = o.peak.cwiseMax(effort.cwiseAbs());
    o.squares += effort.cwiseAbs2();
    if (step >= time.window_start) {
      o.worst_squared =
          std::max(o.worst_squared, (arm.tip_position_m() - one.point_m).squaredNorm());
    }
  }
  o.q = q;
  o.qd = physics_test::read_rates(arm, n);
  return o;
}

// Calls a kernel once; every lane has its own arm, drives and targets. `allowed` has the JointFlags
// that the kernel may use.
template <class T>
std::vector<Outcome> simulate_lanes(SimdLevel level, const std::vector<LaneCase>& cases,
                                    const Timeline& time, int allowed = 0xff) {
  const Kernel<T> kernel = get_kernels<T>(level).ideal;
  const auto lanes = static_cast<std::size_t>(kernel.lanes);
  const std::size_t n = cases.front().model.joint_count();
  const int joints = static_cast<int>(n);
  const auto make_packs = [&](int packs) {
    return AlignedNumbers<T>(static_cast<std::size_t>(packs) * lanes);
  };
  const auto model = make_packs(calc_model_packs(joints));
  const ControllerRow& pid = find_controller("pid");
  const int control_packs = calc_control_packs(joints, pid.states, 3);
  const auto state = make_packs(calc_state_packs(joints) + control_packs);
  const auto scratch = make_packs(calc_scratch_packs(joints));
  const auto final_state = make_packs(calc_state_packs(joints) + control_packs);
  SegmentCall<T> call;
  std::vector<std::uint8_t> flags(n, static_cast<std::uint8_t>(allowed));
  std::vector<const double*> targets;
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const LaneCase& one = cases[lane];
    const ChainModel chain(one.model, kGravity_m_per_s2);
    for (std::size_t i = 0; i < n; ++i) {
      flags[i] &= chain.flags()[i];
    }
    call.tilted_gravity |= chain.tilted_gravity();
    call.prismatic |= chain.prismatic();
    for (std::size_t k = 0; k < chain.numbers().size(); ++k) {
      model.data()[k * lanes + lane] = static_cast<T>(chain.numbers()[k]);
    }
    const auto set = [&](std::size_t pack, double value) {
      state.data()[pack * lanes + lane] = static_cast<T>(value);
    };
    for (std::size_t i = 0; i < n; ++i) {
      const JointDrive& drive = one.drives[i];
      set(kQ * n + i, one.start[static_cast<Eigen::Index>(i)]);
      set(kIntegrating * n + i, 1);
      const std::size_t first_gain = static_cast<std::size_t>(calc_state_packs(joints)) +
                                     static_cast<std::size_t>(pid.states) * n + i;
      for (std::size_t gain = 0; gain < 3; ++gain) {
        set(first_gain + gain * n, drive.gains[gain]);
      }
      set(kEffortMin * n + i, drive.limits.min);
      set(kEffortMax * n + i, drive.limits.max);
    }
    const Vector3d point = chain.base_pose().inverse() * one.point_m;
    for (int axis = 0; axis < 3; ++axis) {
      set(kStateFields * n + static_cast<std::size_t>(kPointX + axis), point[axis]);
    }
    set(kStateFields * n + kCutoffSquared, kNever);
    targets.push_back(one.targets.data());
    call.alive |= std::uint32_t{1} << lane;
  }
  const std::uint32_t all = call.alive;
  call.joints = joints;
  call.flags = flags.data();
  call.model = model.data();
  call.state = state.data();
  call.control_packs = control_packs;
  call.scratch = scratch.data();
  call.final_state = final_state.data();
  call.steps = time.steps;
  call.window_start = time.window_start;
  call.substeps = time.substeps;
  call.period_s = static_cast<T>(kPeriod_s);
  call.first_step_of_case = true;
  call.targets = targets.data();
  kernel.run_segment(call);
  EXPECT_EQ(call.alive, all) << "lanes were lost";

  std::vector<Outcome> outcomes;
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const auto get = [&](std::size_t pack) {
      return static_cast<double>(state.data()[pack * lanes + lane]);
    };
    const auto get_field = [&](StateField field) {
      VectorXd values(joints);
      for (std::size_t i = 0; i < n; ++i) {
        values[static_cast<Eigen::Index>(i)] = get(field * n + i);
      }
      return values;
    };
    outcomes.push_back({get_field(kQ), get_field(kRate), get_field(kPeakEffort),
                        get_field(kSquaredEffort), get_field(kClampedSteps),
                        get(kStateFields * n + kEnergy), get(kStateFields * n + kWorstSquared)});
  }
  return outcomes;
}

void expect_same(const RobotModel& model, const Outcome& found, const Outcome& expected,
                 double tolerance) {
  EXPECT_LT(calc_motion(model, expected.q, found.q).norm(), tolerance * (1 + expected.q.norm()));
  EXPECT_LT((found.qd - expected.qd).norm(), tolerance * (1 + expected.qd.norm()));
  EXPECT_LT((found.peak - expected.peak).norm(), tolerance * expected.peak.norm());
  EXPECT_LT((found.squares - expected.squares).norm(), tolerance * expected.squares.norm());
  EXPECT_EQ(found.clamped, expected.clamped);
  EXPECT_NEAR(found.energy_j, expected.energy_j, tolerance * expected.energy_j);
  EXPECT_NEAR(found.worst_squared, expected.worst_squared, tolerance * expected.worst_squared);
}

// Arms that move freely magnify rounding errors: about 1e-16 per step, times e^(10 t) at most, for
// a second.
constexpr double kTolerance = 1e-9;

template <class T>
std::vector<LaneCase> draw_lanes(SimdLevel level, const RobotModel& kind, const Timeline& time) {
  std::vector<LaneCase> cases;
  for (int lane = 0; lane < get_kernels<T>(level).ideal.lanes; ++lane) {
    cases.push_back(draw_lane(kind, lane, time));
  }
  return cases;
}

// Every lane must agree with a single arm.
void expect_lanes_as_alone(const RobotModel& kind, const Timeline& time) {
  for (const SimdLevel level : find_levels()) {
    const auto cases = draw_lanes<double>(level, kind, time);
    const auto outcomes = simulate_lanes<double>(level, cases, time);
    for (std::size_t lane = 0; lane < cases.size(); ++lane) {
      SCOPED_TRACE(testing::Message() << to_string(level) << ", lane " << lane);
      const Outcome expected = simulate_one_arm(cases[lane], time);
      ASSERT_GT((expected.q - cases[lane].start).norm(), 0.05) << "hardly moves";
      expect_same(kind, outcomes[lane], expected, kTolerance);
    }
  }
}

RobotModel draw_arm(std::size_t joints, std::uint64_t number) {
  RandomStream random("test/sim/kernels", 100 * joints + number);
  return make_random_arm(joints, random);
}

RobotModel draw_turning_arm(std::size_t joints, std::uint64_t number) {
  RobotModel model = draw_arm(joints, number);
  for (Joint& joint : model.joints) {
    joint.kind = JointKind::revolute;
  }
  return model;
}

// Pairs of parallel axes, the first vertical: groups, right angles, offsets along x.
RobotModel draw_grouped_arm(std::size_t joints) {
  RobotModel model = draw_turning_arm(joints, 1);
  const Vector3d axes[] = {Vector3d::UnitZ(), Vector3d::UnitY(), Vector3d::UnitX()};
  for (std::size_t i = 0; i < joints; ++i) {
    model.joints[i].axis = axes[i / 2 % 3];
    model.joints[i].origin.linear().setIdentity();
  }
  return model;
}

TEST(Kernels, ForEveryNumberOfTurningJointsDoAsTheArmAlone) {
  for (std::size_t joints = 1; joints <= 10; ++joints) {
    for (const int substeps : {1, 3}) {
      SCOPED_TRACE(testing::Message() << joints << " joints, " << substeps << " substeps");
      Timeline time;
      time.substeps = substeps;
      expect_lanes_as_alone(draw_turning_arm(joints, 0), time);
      expect_lanes_as_alone(draw_grouped_arm(joints), time);
    }
  }
}

TEST(Kernels, ForChainsWithSlidersDoAsTheArmAlone) {
  int sliders = 0;
  for (const std::size_t joints : {1, 2, 3, 4, 6, 9, 12}) {
    for (std::uint64_t number = 0; number < 3; ++number) {
      SCOPED_TRACE(testing::Message() << joints << " joints, number " << number);
      const RobotModel model = draw_arm(joints, number);
      sliders += has_slider(model) ? 1 : 0;
      expect_lanes_as_alone(model, {});
    }
  }
  EXPECT_GT(sliders, 10);
}

// The thesis's arm, with drives that can carry it.
std::vector<LaneCase> make_palletiser_cases(int lanes, const Timeline& time) {
  std::vector<LaneCase> cases;
  for (int lane = 0; lane < lanes; ++lane) {
    LaneCase one = draw_lane(load_irb4600(), lane, time);
    one.drives = kTableA1.joints;
    cases.push_back(one);
  }
  return cases;
}

// Compares the kernel for this shape with the general ones, which run if one of the shape's flags
// is removed.
TEST(Kernels, OfThePalletiserDoAsThoseOfAnyShape) {
  const Timeline time;
  for (const SimdLevel level : find_levels()) {
    const auto cases = make_palletiser_cases(get_kernels<double>(level).ideal.lanes, time);
    const auto known = simulate_lanes<double>(level, cases, time);
    for (const int missing :
         {kAlongX | 0, kRightAngle | 0, kSameAxis | 0, kAlongX | kRightAngle | kSameAxis}) {
      const auto any = simulate_lanes<double>(level, cases, time, 0xff & ~missing);
      for (std::size_t lane = 0; lane < cases.size(); ++lane) {
        SCOPED_TRACE(testing::Message()
                     << to_string(level) << ", lane " << lane << ", without " << missing);
        expect_same(cases[lane].model, any[lane], known[lane], kTolerance);
      }
    }
    for (std::size_t lane = 0; lane < cases.size(); ++lane) {
      SCOPED_TRACE(testing::Message() << to_string(level) << ", lane " << lane);
      expect_same(cases[lane].model, known[lane], simulate_one_arm(cases[lane], time), kTolerance);
    }
  }
}

// The precision of float, 6e-8, over 30 steps of the same motion.
TEST(Kernels, InSinglePrecisionFollowTheArmAlone) {
  Timeline time;
  time.steps = 30;
  time.window_start = 20;
  for (const SimdLevel level : find_levels()) {
    for (const RobotModel& kind : {draw_turning_arm(3, 0), draw_grouped_arm(5), draw_arm(4, 1)}) {
      const auto cases = draw_lanes<float>(level, kind, time);
      const auto outcomes = simulate_lanes<float>(level, cases, time);
      for (std::size_t lane = 0; lane < cases.size(); ++lane) {
        SCOPED_TRACE(testing::Message() << to_string(level) << ", lane " << lane);
        expect_same(kind, outcomes[lane], simulate_one_arm(cases[lane], time), 2e-4);
      }
    }
  }
}

}  // namespace
}  // namespace armwright
