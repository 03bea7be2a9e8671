#include "sim/engines/articulated/lane_block.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/engines/articulated/plant_numbers.hpp"
#include "sim/kinematics/kinematics.hpp"
#include "sim/tracking/engine_support.hpp"

namespace armwright::articulated {
namespace {

constexpr std::size_t calc_size(int packs, int lanes) {
  return static_cast<std::size_t>(packs) * static_cast<std::size_t>(lanes);
}

// The block of one call of simulate_block().
template <class T>
class LaneBlock {
 public:
  // All arguments must outlive the block.
  LaneBlock(const TrackingSetup& setup, const Kernel<T>& kernel, std::span<const TrackingJob> jobs,
            std::span<const std::size_t> chosen, std::vector<TrackingResult>& results);
  // Simulates all jobs of the block. Call it once.
  void run();

 private:
  static constexpr std::size_t kFree = static_cast<std::size_t>(-1);

  std::size_t lanes() const { return static_cast<std::size_t>(kernel_.lanes); }
  const TrackingSetup& setup_of(std::size_t job) const;
  // Return the first number of the slot's lane; its next packs lie lanes() apart.
  T* state(std::size_t slot) const;
  T* model(std::size_t slot) const;
  // Returns the first number of the drives of a state.
  T* loops(T* state) const { return state + state_size_ - calc_size(drive_packs_, kernel_.lanes); }
  void place(std::size_t slot, std::size_t job);
  void reserve_plants(std::span<const std::size_t> chosen, std::size_t groups);
  void place_plant(std::size_t slot, std::size_t job);
  void set_plant(std::size_t first, const Segment& timeline, SegmentCall<T>& call) const;
  // Copies a lane from slot to slot. Each pack of lanes has `size` numbers.
  void copy_lane(const AlignedNumbers<T>& numbers, std::size_t size, std::size_t from,
                 std::size_t to) const;
  void run_segment(std::size_t group, std::size_t segment);
  void end_segment(std::size_t slot);
  void read_records(std::size_t slot, const Segment& segment, int steps);
  void close_up();
  // Reads efforts, clamped steps and energy from a state into a result.
  void read_measures(const T* state, TrackingResult& result) const;
  std::string describe_divergence(std::size_t job, const T* state) const;

  const TrackingSetup& setup_;
  const Kernel<T>& kernel_;
  std::span<const TrackingJob> jobs_;
  const ControllerRow& controller_;
  std::vector<TrackingResult>& results_;
  std::size_t joints_;
  int tool_points_;
  std::vector<std::size_t> slots_;  // the job in each lane, or kFree
  bool own_models_ = false;         // a job has its own arm, so every pack of lanes has a model
  bool recording_ = false;
  bool prismatic_ = false;
  bool tilted_gravity_ = false;
  std::vector<std::uint8_t> flags_;
  void (*control_)(SegmentCall<T>& call, int step) = nullptr;
  int control_packs_ = 0;
  CommandClock clock_;   // at the start of the case
  int drive_packs_ = 0;  // of the control packs; 0: controllers command efforts
  // Count of numbers per pack of lanes (record_size_: per step).
  std::size_t state_size_, model_size_, record_size_;
  bool has_plant_ = false;
  bool perturbed_ = false;
  std::vector<std::uint8_t> drives_;   // DriveFlag bits per joint
  std::vector<BalanceGrid> balances_;  // one per joint
  int past_length_ = 1;
  std::size_t plant_size_ = 0, past_size_ = 0;
  std::vector<int> delays_;  // one per slot
  AlignedNumbers<T> plants_, pasts_;
  AlignedNumbers<T> states_, models_, scratch_, final_state_, records_;
};

template <class T>
LaneBlock<T>::LaneBlock(const TrackingSetup& setup, const Kernel<T>& kernel,
                        std::span<const TrackingJob> jobs, std::span<const std::size_t> chosen,
                        std::vector<TrackingResult>& results)
    : setup_(setup),
      kernel_(kernel),
      jobs_(jobs),
      controller_(find_controller(jobs[chosen.front()].design->controller)),
      results_(results),
      joints_(setup.robot().joint_count()),
      tool_points_(static_cast<int>(setup.robot().tool_points_m.size())) {
  const int n = static_cast<int>(joints_);
  const std::size_t groups = (chosen.size() + lanes() - 1) / lanes();
  control_packs_ =
      calc_control_packs(n, controller_.states, static_cast<int>(controller_.gains.size()));
  const TrackingTask& task = setup.task();
  if (task.drives.has_loops()) {
    clock_ = task.drives.make_clock(task.control_period_s, task.physics.substeps);
    drive_packs_ = calc_drive_packs(n, clock_);
    control_packs_ += drive_packs_;
  }
  kernel.find_control(controller_.law, control_);
  state_size_ = calc_size(calc_state_packs(n) + control_packs_, kernel.lanes);
  model_size_ = calc_size(calc_model_packs(n), kernel.lanes);
  record_size_ = calc_size(calc_record_packs(n), kernel.lanes);
  const ChainModel& chain = setup_of(chosen.front()).chain();
  flags_ = chain.flags();
  tilted_gravity_ = chain.tilted_gravity();
  prismatic_ = chain.prismatic();
  for (const std::size_t job : chosen) {
    own_models_ |= jobs[job].setup != nullptr;
    recording_ |= jobs[job].recording.any();
  }
  states_ = AlignedNumbers<T>(groups * state_size_);
  models_ = AlignedNumbers<T>((own_models_ ? groups : 1) * model_size_);
  scratch_ = AlignedNumbers<T>(calc_size(calc_scratch_packs(n), kernel.lanes));
  final_state_ = AlignedNumbers<T>(state_size_);
  if (recording_) {
    int longest = 0;
    for (const Segment& segment : jobs[chosen.front()].targets->segments) {
      longest = std::max(longest, segment.steps);
    }
    records_ = AlignedNumbers<T>(static_cast<std::size_t>(longest) * record_size_);
  }
  reserve_plants(chosen, groups);
  slots_.assign(groups * lanes(), kFree);
  for (std::size_t slot = 0; slot < slots_.size(); ++slot) {
    // Lanes without a job get the first job's arm, at rest and without controllers.
    const std::size_t job = chosen[slot < chosen.size() ? slot : 0];
    if (own_models_ || slot < lanes()) {
      const std::vector<double>& numbers = setup_of(job).chain().numbers();
      T* out = model(slot);
      for (std::size_t k = 0; k < numbers.size(); ++k) {
        out[k * lanes()] = static_cast<T>(numbers[k]);
      }
    }
    if (slot < chosen.size()) {
      place(slot, job);
    }
  }
}

template <class T>
const TrackingSetup& LaneBlock<T>::setup_of(std::size_t job) const {
  return jobs_[job].choose_setup(setup_);
}

template <class T>
T* LaneBlock<T>::state(std::size_t slot) const {
  return states_.data() + slot / lanes() * state_size_ + slot % lanes();
}

template <class T>
T* LaneBlock<T>::model(std::size_t slot) const {
  return models_.data() + (own_models_ ? slot / lanes() * model_size_ : 0) + slot % lanes();
}

template <class T>
void LaneBlock<T>::place(std::size_t slot, std::size_t job) {
  slots_[slot] = job;
  const TrackingJob& one = jobs_[job];
  T* numbers = state(slot);
  const auto first_control = static_cast<std::size_t>(calc_state_packs(static_cast<int>(joints_)));
  std::vector<double> held(static_cast<std::size_t>(controller_.states));
  for (std::size_t i = 0; i < joints_; ++i) {
    const auto set = [&](StateField field, double value) {
      numbers[(field * joints_ + i) * lanes()] = static_cast<T>(value);
    };
    const JointDrive& drive = one.design->joints[i];
    set(kQ, one.targets->start_positions[i]);
    set(kMotor, one.targets->start_positions[i]);
    set(kIntegrating, 1);
    const EffortLimits limits =
        setup_.task().drives.get_command_limits(setup_of(job).robot().joints[i], drive.limits);
    set(kEffortMin, limits.min);
    set(kEffortMax, limits.max);
    if (!one.targets->holding_effort.empty()) {
      controller_.hold(one.targets->holding_effort[i], limits, drive.gains, held.data());
      for (std::size_t k = 0; k < held.size(); ++k) {
        numbers[(first_control + k * joints_ + i) * lanes()] = static_cast<T>(held[k]);
      }
    }
    const std::size_t first_gain =
        first_control + static_cast<std::size_t>(controller_.states) * joints_ + i;
    for (std::size_t gain = 0; gain < controller_.gains.size(); ++gain) {
      numbers[(first_gain + gain * joints_) * lanes()] = static_cast<T>(drive.gains[gain]);
    }
  }
  numbers[(kStateFields * joints_ + kCutoffSquared) * lanes()] =
      static_cast<T>(one.cutoff_m * one.cutoff_m);
  if (drive_packs_ > 0) {
    const auto set = [&](std::size_t pack, double value) {
      loops(numbers)[pack * lanes()] = static_cast<T>(value);
    };
    set_drive_packs(setup_of(job), one, clock_, set);
    for (std::size_t i = 0; i < joints_; ++i) {
      set(kMotorMin * joints_ + i, one.design->joints[i].limits.min);
      set(kMotorMax * joints_ + i, one.design->joints[i].limits.max);
    }
  }
  if (has_plant_) {
    place_plant(slot, job);
  }
  TrackingResult& result = results_[job];
  result.point_error_m.reserve(one.targets->segments.size());
  if (one.recording.error_series) {
    result.error_series_m.reserve(static_cast<std::size_t>(one.targets->steps));
  }
}

template <class T>
void LaneBlock<T>::reserve_plants(std::span<const std::size_t> chosen, std::size_t groups) {
  const TrackingJob& first = jobs_[chosen.front()];
  has_plant_ = first.has_plant(setup_);
  if (!has_plant_) {
    return;
  }
  for (const Joint& joint : setup_of(chosen.front()).robot().joints) {
    drives_.push_back(get_drive_flags(joint.plant));
    balances_.push_back(make_balance_grid(joint));
  }
  plant_size_ = calc_size(calc_plant_packs(static_cast<int>(joints_)), kernel_.lanes);
  plants_ = AlignedNumbers<T>(groups * plant_size_);
  perturbed_ = first.variation != nullptr;
  if (!perturbed_) {
    return;
  }
  for (const std::size_t job : chosen) {
    past_length_ = std::max(past_length_, jobs_[job].variation->delay_substeps + 1);
  }
  past_size_ = calc_size(past_length_ * static_cast<int>(joints_), kernel_.lanes);
  pasts_ = AlignedNumbers<T>(groups * past_size_);
  delays_.assign(groups * lanes(), 0);
}

template <class T>
void LaneBlock<T>::place_plant(std::size_t slot, std::size_t job) {
  T* const numbers = plants_.data() + slot / lanes() * plant_size_ + slot % lanes();
  const auto set = [&](std::size_t pack, double value) {
    numbers[pack * lanes()] = static_cast<T>(value);
  };
  const std::vector<Joint>& joints = setup_of(job).robot().joints;
  for (std::size_t i = 0; i < joints_; ++i) {
    set_plant_numbers(joints[i].plant,
                      [&](PlantField field, double value) { set(field * joints_ + i, value); });
  }
  if (!perturbed_) {
    return;
  }
  const PlantVariation& variation = *jobs_[job].variation;
  for (std::size_t i = 0; i < joints_; ++i) {
    set(kViscous * joints_ + i, variation.viscous_friction[i]);
    set(kCoulomb * joints_ + i, variation.coulomb_friction[i]);
    set(kRipple * joints_ + i, variation.torque_ripple[i]);
    set(kRipplePhase * joints_ + i, variation.ripple_phase_rad[i]);
  }
  set(kPlantFields * joints_ + kRateScale, 1 / variation.friction_transition_rate);
  set(kPlantFields * joints_ + kRippleCycles, variation.ripple_cycles_per_turn);
  set(kPlantFields * joints_ + kQuantum, variation.quantum);
  delays_[slot] = variation.delay_substeps;
  T* const past = pasts_.data() + slot / lanes() * past_size_ + slot % lanes();
  for (std::size_t pack = 0; pack < past_size_ / lanes(); ++pack) {
    past[pack * lanes()] = static_cast<T>(jobs_[job].targets->start_positions[pack % joints_]);
  }
}

template <class T>
void LaneBlock<T>::set_plant(std::size_t first, const Segment& timeline,
                             SegmentCall<T>& call) const {
  if (!has_plant_) {
    return;
  }
  call.plant = plants_.data() + first / lanes() * plant_size_;
  set_drives(drives_, setup_.task().drives, perturbed_, call);
  call.balances = balances_.data();
  if (!perturbed_) {
    return;
  }
  const std::int64_t substeps = std::int64_t{timeline.first_step} * call.substeps;
  call.past = pasts_.data() + first / lanes() * past_size_;
  call.past_length = past_length_;
  call.newest = static_cast<int>(substeps % past_length_);
  call.delay = delays_.data() + first;
}

template <class T>
void LaneBlock<T>::copy_lane(const AlignedNumbers<T>& numbers, std::size_t size, std::size_t from,
                             std::size_t to) const {
  const T* const source = numbers.data() + from / lanes() * size + from % lanes();
  T* const target = numbers.data() + to / lanes() * size + to % lanes();
  for (std::size_t k = 0; k < size; k += lanes()) {
    target[k] = source[k];
  }
}

template <class T>
void LaneBlock<T>::run() {
  const std::size_t segments = jobs_[slots_.front()].targets->segments.size();
  for (std::size_t segment = 0; segment < segments && !slots_.empty(); ++segment) {
    for (std::size_t group = 0; group < slots_.size() / lanes(); ++group) {
      run_segment(group, segment);
    }
    close_up();
  }
  for (std::size_t slot = 0; slot < slots_.size(); ++slot) {
    if (slots_[slot] != kFree) {
      TrackingResult& result = results_[slots_[slot]];
      read_measures(state(slot), result);
      complete_result(setup_.task(), jobs_[slots_[slot]], result);
    }
  }
}

template <class T>
void LaneBlock<T>::run_segment(std::size_t group, std::size_t segment) {
  const std::size_t first = group * lanes();
  std::size_t any = kFree;  // a job whose targets fill the free lanes
  SegmentCall<T> call;
  for (std::size_t lane = 0; lane < lanes(); ++lane) {
    const std::size_t job = slots_[first + lane];
    if (job == kFree) {
      continue;
    }
    any = any == kFree ? job : any;
    call.alive |= std::uint32_t{1} << lane;
    const Segment& one = jobs_[job].targets->segments[segment];
    const Eigen::Vector3d point = setup_of(job).chain().base_pose().inverse() * one.to_m;
    T* singles = state(first + lane) + kStateFields * joints_ * lanes();
    const auto set_point = [&](int field, const Eigen::Vector3d& at_m) {
      for (int axis = 0; axis < 3; ++axis) {
        singles[static_cast<std::size_t>(field + axis) * lanes()] = static_cast<T>(at_m[axis]);
      }
    };
    set_point(kPointX, point);
    for (int k = 0; k < tool_points_; ++k) {
      set_point(kToolTargetX + 3 * k, setup_of(job).chain().base_pose().inverse() *
                                          jobs_[job].targets->tool_points(segment)[k]);
    }
  }
  if (any == kFree) {
    return;
  }
  const Segment& timeline = jobs_[any].targets->segments[segment];
  const double* targets[kMaxLanes];
  const double* feed_forward[kMaxLanes];
  call.shared_targets = true;
  for (std::size_t lane = 0; lane < lanes(); ++lane) {
    const std::size_t job = slots_[first + lane] == kFree ? any : slots_[first + lane];
    targets[lane] = jobs_[job].targets->positions(timeline.first_step).data();
    call.shared_targets &= targets[lane] == targets[0];
    if (controller_.feed_forward != FeedForward::none) {
      feed_forward[lane] = jobs_[job].targets->feed_forward(timeline.first_step).data();
    }
  }
  call.joints = static_cast<int>(joints_);
  call.flags = flags_.data();
  call.tilted_gravity = tilted_gravity_;
  call.prismatic = prismatic_;
  call.model = model(first);
  call.state = state(first);
  call.control_packs = control_packs_;
  call.control = control_;
  if (drive_packs_ > 0) {
    call.loops = loops(state(first));
    call.clock = clock_;
    call.clock.substep = std::int64_t{timeline.first_step} * clock_.substeps;
  }
  call.scratch = scratch_.data();
  call.steps = timeline.steps;
  call.window_start = timeline.window_start;
  call.tool_points = tool_points_;
  call.substeps = setup_.task().physics.substeps;
  call.period_s = static_cast<T>(setup_.task().control_period_s);
  call.first_step_of_case = segment == 0;
  set_plant(first, timeline, call);
  call.targets = targets;
  call.feed_forward = feed_forward;
  call.final_state = final_state_.data();
  for (std::size_t lane = 0; recording_ && lane < lanes(); ++lane) {
    const std::size_t job = slots_[first + lane];
    if (job != kFree && jobs_[job].recording.any()) {
      call.records = records_.data();
    }
  }
  kernel_.run_segment(call);

  for (std::size_t lane = 0; lane < lanes(); ++lane) {
    const std::size_t slot = first + lane;
    const std::size_t job = slots_[slot];
    if (job == kFree) {
      continue;
    }
    TrackingResult& result = results_[job];
    const LaneEvent event = call.event[lane];
    // A step that diverges does not count, but one that is cut off does.
    const int steps = event == LaneEvent::none       ? timeline.steps
                      : event == LaneEvent::diverged ? call.event_step[lane]
                                                     : call.event_step[lane] + 1;
    if (call.records != nullptr) {
      read_records(slot, jobs_[job].targets->segments[segment], steps);
    }
    result.steps += steps;
    if (event == LaneEvent::none) {
      end_segment(slot);
      continue;
    }
    const T* final_state = final_state_.data() + lane;
    read_measures(final_state, result);
    if (event == LaneEvent::cut_off) {
      apply_cutoff(setup_.task(), jobs_[job], result);
    } else {
      apply_divergence(setup_.task(), jobs_[job], describe_divergence(job, final_state), result);
    }
    complete_result(setup_.task(), jobs_[job], result);
    slots_[slot] = kFree;
  }
}

template <class T>
void LaneBlock<T>::end_segment(std::size_t slot) {
  const std::size_t job = slots_[slot];
  TrackingResult& result = results_[job];
  const T worst = state(slot)[(kStateFields * joints_ + kWorstSquared) * lanes()];
  result.point_error_m.push_back(std::sqrt(static_cast<double>(worst)));
  if (apply_abandonment(setup_.task(), jobs_[job], result)) {
    read_measures(state(slot), result);
    complete_result(setup_.task(), jobs_[job], result);
    slots_[slot] = kFree;
  }
}

template <class T>
void LaneBlock<T>::read_records(std::size_t slot, const Segment& segment, int steps) {
  const std::size_t job = slots_[slot];
  const RecordingOptions& recording = jobs_[job].recording;
  const TrackingSetup& setup = setup_of(job);
  if (!recording.any()) {
    return;  // only another lane needs the records
  }
  TrackingResult& result = results_[job];
  const std::size_t before = result.joint_positions.size();
  if (recording.motion) {
    result.joint_positions.resize(before + static_cast<std::size_t>(steps) * joints_);
  }
  double* position = result.joint_positions.data() + before;
  for (int step = 0; step < steps; ++step) {
    const T* numbers =
        records_.data() + static_cast<std::size_t>(step) * record_size_ + slot % lanes();
    const auto get = [&](std::size_t pack) { return static_cast<double>(numbers[pack * lanes()]); };
    const Eigen::Vector3d tip =
        setup.chain().base_pose() *
        Eigen::Vector3d(get(2 * joints_), get(2 * joints_ + 1), get(2 * joints_ + 2));
    if (recording.motion) {
      result.tips_m.push_back(tip);
      for (std::size_t i = 0; i < joints_; ++i) {
        *position++ = get(i);
      }
    }
    if (!recording.error_series && !recording.trajectory) {
      continue;  // the target's position costs more to compute than all the rest
    }
    const Eigen::Vector3d target = setup.calc_target_position(segment, step);
    if (recording.error_series) {
      result.error_series_m.push_back((tip - target).norm());
    }
    if (recording.trajectory) {
      TrajectorySample sample;
      sample.time_s = (result.steps + step + 1) * setup.task().control_period_s;
      const auto targets = jobs_[job].targets->positions(segment.first_step + step);
      sample.target_q.assign(targets.begin(), targets.end());
      for (std::size_t i = 0; i < joints_; ++i) {
        const bool turns = setup.robot().joints[i].kind == JointKind::revolute;
        sample.q.push_back(turns ? wrap_angle(get(i)) : get(i));
        sample.effort.push_back(get(joints_ + i));
      }
      sample.tip_m = tip;
      sample.target_m = target;
      result.trajectory.push_back(std::move(sample));
    }
  }
}

// Moves simulations from the end into the gaps as soon as a whole pack of lanes can become free.
template <class T>
void LaneBlock<T>::close_up() {
  const auto busy = static_cast<std::size_t>(
      std::count_if(slots_.begin(), slots_.end(), [](std::size_t job) { return job != kFree; }));
  const std::size_t groups = (busy + lanes() - 1) / lanes();
  if (groups == slots_.size() / lanes()) {
    return;
  }
  const std::size_t kept = groups * lanes();
  std::size_t gap = 0;
  for (std::size_t slot = kept; slot < slots_.size(); ++slot) {
    if (slots_[slot] == kFree) {
      continue;
    }
    while (slots_[gap] != kFree) {
      ++gap;
    }
    copy_lane(states_, state_size_, slot, gap);
    if (own_models_) {
      copy_lane(models_, model_size_, slot, gap);
    }
    if (has_plant_) {
      copy_lane(plants_, plant_size_, slot, gap);
    }
    if (perturbed_) {
      copy_lane(pasts_, past_size_, slot, gap);
      delays_[gap] = delays_[slot];
    }
    slots_[gap] = slots_[slot];
  }
  slots_.resize(kept);
}

template <class T>
void LaneBlock<T>::read_measures(const T* numbers, TrackingResult& result) const {
  const auto get = [&](StateField field, std::size_t joint) {
    return static_cast<double>(numbers[(field * joints_ + joint) * lanes()]);
  };
  for (std::size_t i = 0; i < joints_; ++i) {
    result.peak_effort.push_back(get(kPeakEffort, i));
    // These two are sums until complete_result().
    result.rms_effort.push_back(get(kSquaredEffort, i));
    result.saturated_share.push_back(get(kClampedSteps, i));
  }
  result.energy_j = static_cast<double>(numbers[(kStateFields * joints_ + kEnergy) * lanes()]);
}

template <class T>
std::string LaneBlock<T>::describe_divergence(std::size_t job, const T* numbers) const {
  const auto get = [&](StateField field, std::size_t joint) {
    return static_cast<double>(numbers[(field * joints_ + joint) * lanes()]);
  };
  // Find the joint with the largest position and rate; NaN counts as the largest.
  std::size_t worst = 0;
  double farthest = -1;
  for (std::size_t i = 0; i < joints_; ++i) {
    const double out = std::abs(get(kQ, i)) + std::abs(get(kRate, i));
    if (!(out <= farthest)) {
      farthest = out;
      worst = i;
      if (std::isnan(out)) {
        break;
      }
    }
  }
  const Joint& joint = setup_of(job).robot().joints[worst];
  const bool turns = joint.kind == JointKind::revolute;
  if (!std::isfinite(farthest)) {
    return fmt::format("joint {} ({}): {}", worst + 1, joint.name, kNotFinite);
  }
  return fmt::format("joint {} ({}): it is at {:.3g} {} and moves at {:.3g} {}", worst + 1,
                     joint.name, get(kQ, worst), turns ? "rad" : "m", get(kRate, worst),
                     turns ? "rad/s" : "m/s");
}

}  // namespace

template <class T>
void simulate_block(const TrackingSetup& setup, const Kernel<T>& kernel,
                    std::span<const TrackingJob> jobs, std::span<const std::size_t> chosen,
                    std::vector<TrackingResult>& results) {
  LaneBlock<T>(setup, kernel, jobs, chosen, results).run();
}

template void simulate_block(const TrackingSetup& setup, const Kernel<double>& kernel,
                             std::span<const TrackingJob> jobs, std::span<const std::size_t> chosen,
                             std::vector<TrackingResult>& results);
template void simulate_block(const TrackingSetup& setup, const Kernel<float>& kernel,
                             std::span<const TrackingJob> jobs, std::span<const std::size_t> chosen,
                             std::vector<TrackingResult>& results);

}  // namespace armwright::articulated
