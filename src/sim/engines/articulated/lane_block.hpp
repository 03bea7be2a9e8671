// A block of simulations on one timeline. It gives its packs of lanes to a kernel segment by
// segment, reads the results of simulations that end, and closes gaps when lanes have become free.
// It allocates all memory before the first step.
#pragma once

#include <memory>
#include <new>
#include <span>
#include <string>
#include <vector>

#include "sim/dynamics/chain_model.hpp"
#include "sim/engines/articulated/kernels.hpp"
#include "sim/tracking/simulation.hpp"

namespace armwright::articulated {

// An array that begins at a multiple of the widest vector's size. All numbers are zero at first.
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
  // `chosen` has the numbers of the block's jobs. They must all have the same timeline, shape of
  // the arm and controller, and either all or none of them a PlantVariation. The result of jobs[i]
  // is results[i]. All arguments must outlive the block.
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
  // Count of numbers per pack of lanes (record_size_: per step).
  std::size_t state_size_, model_size_, record_size_;
  bool perturbed_ = false;
  int past_length_ = 1;
  std::size_t plant_size_ = 0, past_size_ = 0;
  std::vector<int> delays_;  // one per slot
  AlignedNumbers<T> plants_, pasts_;
  AlignedNumbers<T> states_, models_, scratch_, final_state_, records_;
};

extern template class LaneBlock<double>;
extern template class LaneBlock<float>;

}  // namespace armwright::articulated
