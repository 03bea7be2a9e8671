// Target tables of a task, computed once a test case however many designs and threads ask, and kept
// within a memory bound.
#pragma once

#include <atomic>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "sim/tracking.hpp"

namespace armwright {

class TargetCache {
 public:
  explicit TargetCache(std::size_t limit_bytes) : limit_bytes_(limit_bytes) {}

  // Thread-safe. Two threads that ask for the same case at the same time compute it once; the
  // oldest tables go when the limit is reached (they live on as long as somebody holds them).
  std::shared_ptr<const TargetTable> get(const TrackingSetup& setup, const TestSet& set,
                                         std::uint64_t number);
  std::uint64_t computed() const { return computed_; }  // tables made so far

 private:
  struct Entry {
    std::mutex mutex;   // held while the table is made: whoever else asks for it waits
    bool made = false;  // not std::call_once, which does not agree everywhere with exceptions
    TargetTable table;
    bool counted = false;
  };
  using Key = std::pair<std::string, std::uint64_t>;

  const std::size_t limit_bytes_;
  std::mutex mutex_;
  std::map<Key, std::shared_ptr<Entry>> entries_;
  std::list<Key> oldest_first_;
  std::size_t size_bytes_ = 0;
  std::atomic<std::uint64_t> computed_ = 0;
};

}  // namespace armwright
