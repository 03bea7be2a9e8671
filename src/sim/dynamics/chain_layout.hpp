// How the numbers of a chain lie in memory, for the code around the kernels and in them alike:
// every field is `joints` (or one) packs of lanes, a pack being `lanes` numbers side by side. No
// templates of the standard library: this is compiled for every instruction set (lane_pack.hpp).
#pragma once

#include <cstdint>

namespace armwright::articulated {

inline constexpr int kMostToolPoints = 4;

// What is constant of one joint and the link behind it; see chain_model.hpp for the meaning.
enum ModelField : int {
  kAngle,
  kTwistCos,
  kTwistSin,
  kOffsetX,
  kOffsetY,
  kOffsetZ,
  kMomentX,  // first moments of mass of the link
  kMomentY,
  kSecondXX,  // second moments
  kSecondXY,
  kSecondXZ,
  kSecondYY,
  kSecondYZ,
  kMass,     // of links on prismatic joints; else 0
  kMomentZ,  // likewise
  kModelFields
};
// After those, once a chain.
enum ModelSingle : int {
  kGravityX,
  kGravityZ,
  kTipX,
  kTipY,
  kTipZ,
  kToolX,  // x, y and z of each tool point (RobotModel::tool_points_m), in the last link's frame
  kModelSingles = kToolX + 3 * kMostToolPoints
};

// What a simulation carries of one joint from step to step.
enum StateField : int {
  kQ,
  kRate,
  kIntegrating,  // 1, or 0 after a clamped step
  kEffortMin,
  kEffortMax,
  kEffort,  // written where the controller is not the PID
  kPeakEffort,
  kSquaredEffort,  // summed over the steps
  kClampedSteps,
  kStateFields
};
enum StateSingle : int {
  kEnergy,
  kWorstSquared,  // of the segment: largest squared distance in the measuring window
  kPointX,        // where the segment ends, in the kernel's frame
  kPointY,
  kPointZ,
  kCutoffSquared,
  kToolTargetX,  // where each tool point is to be then, likewise
  kStateSingles = kToolTargetX + 3 * kMostToolPoints
};

// What a perturbed plant has (sim/plant_variation.hpp), for each joint and once.
enum PlantField : int { kViscous, kCoulomb, kRipple, kRipplePhase, kPlantFields };
enum PlantSingle : int {
  kRateScale,     // 1 / v_s
  kRippleCycles,  // a turn
  kQuantum,
  kPlantSingles
};
// After those the control packs: what the controller keeps of each joint from step to step, then
// its gains, as many fields of `joints` packs as it has.
constexpr int calc_control_packs(int joints, int states, int gains) {
  return joints * (states + gains);
}

// Of a recorded step, after the joints' angles and efforts: where the tip is.
inline constexpr int kRecordSingles = 3;

constexpr int calc_model_packs(int joints) {
  return joints * kModelFields + kModelSingles;
}
constexpr int calc_state_packs(int joints) {
  return joints * kStateFields + kStateSingles;
}
// What the kernels need beside: for a chain of more joints than they are compiled for.
constexpr int calc_dynamics_packs(int joints) {
  return 24 * joints + joints * joints;
}
constexpr int calc_plant_packs(int joints) {
  return joints * kPlantFields + kPlantSingles;
}
constexpr int calc_scratch_packs(int joints) {
  return 4 * joints + calc_dynamics_packs(joints);
}
constexpr int calc_record_packs(int joints) {
  return joints * 2 + kRecordSingles;
}

// What is alike in all lanes of a call: it decides which arithmetic may be left out.
enum JointFlag : std::uint8_t {
  kPrismatic = 1,
  kSameAxis = 2,    // parallel to the joint before: belongs to the same group
  kRightAngle = 4,  // twisted by 90 degrees against the group before
  kAlongX = 8,      // the offset has only an x component
};

inline constexpr int kMaxLanes = 16;

enum class LaneEvent : std::uint8_t { none, cut_off, diverged };

// One segment of the timeline for one pack of lanes. All pointers into memory of the caller's,
// aligned to 64 bytes.
template <class T>
struct SegmentCall {
  int joints = 0;
  const std::uint8_t* flags = nullptr;  // JointFlag bits, one byte a joint
  bool tilted_gravity = false;          // gravity is not parallel to the first axis
  bool prismatic = false;               // any joint is
  const T* model = nullptr;             // calc_model_packs() packs
  T* state = nullptr;                   // calc_state_packs() packs and the control packs
  int control_packs = 0;
  // The efforts of one step for all joints; null: the PID, which the kernels have inlined.
  void (*control)(SegmentCall& call, int step) = nullptr;
  T* scratch = nullptr;  // calc_scratch_packs() packs, for chains of any length
  int steps = 0;
  int window_start = 0;
  int tool_points = 0;  // that are measured; 0: the tip is
  int substeps = 1;
  T period_s = 0;
  bool first_step_of_case = false;
  bool shared_targets = false;             // one table for all lanes: that of lane 0
  const double* const* targets = nullptr;  // a lane: angles of the segment's first step, row a step
  const double* const* feed_forward = nullptr;  // likewise, if the controller asks for it
  // Of perturbed plants; else null.
  const T* plant = nullptr;    // calc_plant_packs() packs
  T* past = nullptr;           // a ring of `past_length` x joints packs: angles after substeps
  int past_length = 1;         // more than any lane's delay
  int newest = 0;              // where in the ring the angles are as they are now
  const int* delay = nullptr;  // a lane: of the measured angles, in substeps
  T* records = nullptr;        // calc_record_packs() a step, or null
  std::uint32_t alive = 0;     // one bit a lane; in and out
  // Out, for lanes that ended here: how, in which step, and the state as it was then.
  LaneEvent event[kMaxLanes] = {};
  int event_step[kMaxLanes] = {};
  T* final_state = nullptr;  // laid out like the state
};

}  // namespace armwright::articulated
