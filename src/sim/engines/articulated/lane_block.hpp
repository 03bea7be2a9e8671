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

// Simulates the jobs with the numbers `chosen`; the result of jobs[i] is results[i]. The chosen
// jobs must all have the same timeline, shape of the arm, controller and counterbalances, the same
// DriveFlag bits (kernels.hpp), and either all or none of them a PlantVariation.
template <class T>
void simulate_block(const TrackingSetup& setup, const Kernel<T>& kernel,
                    std::span<const TrackingJob> jobs, std::span<const std::size_t> chosen,
                    std::vector<TrackingResult>& results);

}  // namespace armwright::articulated
