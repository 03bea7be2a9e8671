// A block of simulations on one timeline: hands its packs of lanes to a kernel segment by segment,
// collects what ends, and closes up when lanes have become free. All memory is taken before
// the first step.
#pragma once

#include <memory>
#include <new>
#include <span>
#include <string>
#include <vector>

#include "sim/dynamics/chain_model.hpp"
#include "sim/engines/articulated/kernels.hpp"
#include "sim/tracking/tracking.hpp"

namespace armwright::articulated {

// Numbers that begin at a multiple of the widest vector's size; all zero at first.
template <class T>
class AlignedNumbers {
 public:
  explicit AlignedNumbers(std::size_t count = 0)
      : data_(count == 0 ? nullptr : new (kAlignment) T[count]()) {}
  T* data() const { return data_.get(); }

 private:
  static constexpr std::align_val_t kAlignment{64};
  struct Deleter {
    void operator()(T* data) const { operator delete[](data, kAlignment); }
  };
  std::unique_ptr<T[], Deleter> data_;
};

template <class T>
class LaneBlock {
 public:
  // `chosen`: the jobs' numbers, all of one timeline, of arms of one shape and under one
  // controller, and either all with a PlantVariation or none; results[i] is that of jobs[i].
  LaneBlock(const TrackingSetup& setup, const Kernel<T>& kernel, std::span<const TrackingJob> jobs,
            std::span<const std::size_t> chosen, std::vector<TrackingResult>& results);
  void run();

 private:
  static constexpr std::size_t kFree = static_cast<std::size_t>(-1);

  std::size_t lanes() const { return static_cast<std::size_t>(kernel_.lanes); }
  const TrackingSetup& setup_of(std::size_t job) const;
  T* state(std::size_t slot) const;  // of the slot's lane; packs lie lanes() apart
  T* model(std::size_t slot) const;
  void place(std::size_t slot, std::size_t job);
  void reserve_plants(std::span<const std::size_t> chosen, std::size_t groups);
  void place_plant(std::size_t slot, std::size_t job);
  void set_plant(std::size_t first, const Segment& timeline, SegmentCall<T>& call) const;
  // What the two slots' lanes have there: `size` numbers a pack of lanes.
  void copy_lane(const AlignedNumbers<T>& numbers, std::size_t size, std::size_t from,
                 std::size_t to) const;
  void run_segment(std::size_t group, std::size_t segment);
  void end_segment(std::size_t slot);
  void read_records(std::size_t slot, const Segment& segment, int steps);
  void close_up();
  // What the result says of the controllers and of energy, from a state.
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
  bool own_models_ = false;  // some job has an arm of its own: every pack of lanes has a model
  bool recording_ = false;
  bool prismatic_ = false;
  bool tilted_gravity_ = false;
  std::vector<std::uint8_t> flags_;
  void (*control_)(SegmentCall<T>& call, int step) = nullptr;
  int control_packs_ = 0;
  std::size_t state_size_, model_size_,
      record_size_;  // numbers of a pack of lanes (records: a step)
  bool perturbed_ = false;
  int past_length_ = 1;
  std::size_t plant_size_ = 0, past_size_ = 0;
  std::vector<int> delays_;  // one a slot
  AlignedNumbers<T> plants_, pasts_;
  AlignedNumbers<T> states_, models_, scratch_, final_state_, records_;
};

extern template class LaneBlock<double>;
extern template class LaneBlock<float>;

}  // namespace armwright::articulated
