// The kernels: functions that simulate one segment of the timeline for one pack of lanes, compiled
// once per instruction set. This header has the memory layout, the call and the table of kernels.
//
// All numbers lie in packs: a pack has one number per lane, side by side. A field has one pack per
// joint, a single number one pack.
//
// This header is compiled for every instruction set (lane_pack.hpp), so it must not use templates
// of the standard library.
#pragma once

#include <cstdint>

#include "sim/dynamics/chain_layout.hpp"
#include "sim/dynamics/drive_loop.hpp"

namespace armwright {
enum class SimdLevel : std::uint8_t;
}

namespace armwright::articulated {

// The state of one joint, which a simulation carries from step to step.
enum StateField : int {
  kQ,
  kRate,
  kIntegrating,  // 1, or 0 after a clamped step
  kEffortMin,
  kEffortMax,
  kEffort,  // written by every controller but the PID
  kPeakEffort,
  kSquaredEffort,  // summed over the steps
  kClampedSteps,
  kMotor,  // position and rate of an elastic joint's motor
  kMotorRate,
  kStateFields
};
// The state of the simulation, which follows the joints' states.
enum StateSingle : int {
  kEnergy,
  kWorstSquared,  // largest squared distance in the segment's measuring window
  kPointX,        // the segment's end, in the kernel's frame
  kPointY,
  kPointZ,
  kCutoffSquared,
  kToolTargetX,  // x, y and z of each tool point at the segment's end, in the same frame
  kStateSingles = kToolTargetX + 3 * kMostToolPoints
};

// The numbers of a plant that is not ideal: of each joint, then of the arm.
enum PlantField : int {
  kViscous,  // the first four of a perturbation (sim/tracking/plant_variation.hpp)
  kCoulomb,
  kRipple,
  kRipplePhase,
  kArmature,  // the others of the robot (sim/robot/joint_plant.hpp)
  kDrag,      // viscous friction
  kBreakaway,
  kStribeck,
  kInverseTransition,
  kInverseStribeck,
  kOffset,
  kStiffness,
  kDamping,
  kPlantFields
};
// The numbers of a perturbation.
enum PlantSingle : int {
  kRateScale,     // 1 / v_s
  kRippleCycles,  // per turn
  kQuantum,
  kPlantSingles
};

// The parts of a joint's plant, the same in all lanes.
enum DriveFlag : std::uint8_t {
  kHasArmature = 1,
  kHasFriction = 2,
  kHasStribeck = 4,
  kElastic = 8,
  kMeasuresMotor = 16,  // elastic, and the controller measures the motor's position
  kBalanced = 32,       // has a counterbalance
};

constexpr int calc_state_packs(int joints) {
  return joints * kStateFields + kStateSingles;
}
// The control packs follow the state packs: first the controller's states, then its gains, each of
// them a field, last the drives (drive_loop.hpp), if there are any.
constexpr int calc_control_packs(int joints, int states, int gains) {
  return joints * (states + gains);
}
constexpr int calc_plant_packs(int joints) {
  return joints * kPlantFields + kPlantSingles;
}
constexpr int calc_scratch_packs(int joints) {
  return 9 * joints + calc_dynamics_packs(joints);
}
// A recorded step: the joint positions, the efforts, and the tip's position.
inline constexpr int kRecordSingles = 3;
constexpr int calc_record_packs(int joints) {
  return joints * 2 + kRecordSingles;
}

inline constexpr int kMaxLanes = 16;

enum class LaneEvent : std::uint8_t { none, cut_off, diverged };

struct BalanceGrid;  // sim/dynamics/joint_laws.hpp

// One segment of the timeline for one pack of lanes. The caller owns all memory. It must be aligned
// to 64 bytes.
template <class T>
struct SegmentCall {
  int joints = 0;
  const std::uint8_t* flags = nullptr;  // JointFlag bits, one byte per joint
  bool tilted_gravity = false;          // gravity is not parallel to the first axis
  bool prismatic = false;               // at least one joint is
  const T* model = nullptr;             // calc_model_packs() packs
  T* state = nullptr;                   // calc_state_packs() packs and the control packs
  int control_packs = 0;
  T* loops = nullptr;  // the drives among the control packs; null: controllers command efforts
  CommandClock clock;  // of the drives
  // Computes the efforts of one step for all joints. Null: the PID, which the kernels have inlined.
  void (*control)(SegmentCall& call, int step) = nullptr;
  T* scratch = nullptr;  // calc_scratch_packs() packs, for chains of any length
  int steps = 0;
  int window_start = 0;
  int tool_points = 0;  // count of tool points that are measured; 0: the tip is measured
  int substeps = 1;
  T period_s = 0;
  bool first_step_of_case = false;
  bool shared_targets = false;  // all lanes have the same table: that of lane 0
  // One pointer per lane, to the setpoints of the segment's first step; one row per step.
  const double* const* targets = nullptr;
  const double* const* feed_forward = nullptr;  // likewise; null if the controller needs none
  // The following are for plants that are not ideal. `plant` is null for ideal ones.
  const T* plant = nullptr;               // calc_plant_packs() packs
  const std::uint8_t* drives = nullptr;   // DriveFlag bits, one byte per joint
  const BalanceGrid* balances = nullptr;  // one per joint, the same in all lanes
  bool elastic = false;                   // at least one joint is
  bool measures_apart = false;            // measured positions are not the joints' true ones
  // The following four are for perturbed plants. `past` is null for others.
  T* past = nullptr;           // a ring of `past_length` x joints packs: the positions of the
                               // measured sides after substeps
  int past_length = 1;         // larger than any lane's delay
  int newest = 0;              // the place of the present positions in the ring
  const int* delay = nullptr;  // one per lane: age of the measured positions, in substeps
  T* records = nullptr;        // calc_record_packs() per step, or null
  std::uint32_t alive = 0;     // one bit per lane; in and out
  // Output for lanes that ended in this call: how, in which step, and their state at that time.
  LaneEvent event[kMaxLanes] = {};
  int event_step[kMaxLanes] = {};
  T* final_state = nullptr;  // laid out like the state
};

template <class T>
using RunSegment = void(SegmentCall<T>& call);
template <class T>
using ControlFunction = void (*)(SegmentCall<T>& call, int step);
// Sets SegmentCall::control for the law at that place of the table.
template <class T>
using FindControl = void(int law, ControlFunction<T>& control);

template <class T>
struct Kernel {
  RunSegment<T>* run_segment = nullptr;
  int lanes = 1;
  FindControl<T>* find_control = nullptr;
};

template <class T>
struct Kernels {
  Kernel<T> ideal;  // of ideal joints, with or without a perturbation
  Kernel<T> plant;  // of joints that have plants
};
// Returns the kernels of a level, which this CPU must support.
template <class T>
Kernels<T> get_kernels(SimdLevel level);

// Each of these is defined in a file that is compiled for its instruction set. Kernels of plants
// have half as many lanes with AVX2, because their code is longer: the processor's store of decoded
// instructions must hold it.
RunSegment<double> run_segment_scalar, run_segment_sse2, run_segment_avx2, run_segment_avx512;
RunSegment<double> run_plant_scalar, run_plant_sse2, run_plant_avx2, run_plant_avx512;
FindControl<double> find_control_scalar, find_control_sse2, find_control_avx2, find_control_avx512;
FindControl<double> find_plant_control_avx2;
RunSegment<float> run_segment_scalar, run_segment_sse2, run_segment_avx2, run_segment_avx512;
RunSegment<float> run_plant_scalar, run_plant_sse2, run_plant_avx2, run_plant_avx512;
FindControl<float> find_control_scalar, find_control_sse2, find_control_avx2, find_control_avx512;
FindControl<float> find_plant_control_avx2;

}  // namespace armwright::articulated
