// Target tables of a task, computed once a test case (case_cache.hpp).
#pragma once

#include <cstdint>
#include <memory>

#include "problems/tracking/case_cache.hpp"
#include "sim/tracking/tracking_setup.hpp"

namespace armwright {

class TargetCache {
 public:
  explicit TargetCache(std::size_t limit_bytes) : tables_(limit_bytes) {}

  // Thread-safe.
  std::shared_ptr<const TargetTable> get(const TrackingSetup& setup, const TestSet& set,
                                         std::uint64_t number) {
    return tables_.get(set.name(), number,
                       [&] { return setup.make_targets(set.make_case(number)); });
  }
  void clear() { tables_.clear(); }
  std::uint64_t computed() const { return tables_.computed(); }  // tables made so far

 private:
  CaseCache<TargetTable> tables_;
};

}  // namespace armwright
