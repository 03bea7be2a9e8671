#include "problems/target_cache.hpp"

namespace armwright {

std::shared_ptr<const TargetTable> TargetCache::get(const TrackingSetup& setup, const TestSet& set,
                                                    std::uint64_t number) {
  const Key key(set.name(), number);
  std::shared_ptr<Entry> entry;
  {
    const std::lock_guard lock(mutex_);
    auto& slot = entries_[key];
    if (!slot) {
      slot = std::make_shared<Entry>();
    }
    entry = slot;
  }
  {
    const std::lock_guard lock(entry->mutex);
    if (!entry->made) {
      entry->table = setup.make_targets(set.make_case(number));
      entry->made = true;
      ++computed_;
    }
  }
  {
    const std::lock_guard lock(mutex_);
    if (!entry->counted) {
      entry->counted = true;
      oldest_first_.push_back(key);  // only now: one that cannot be made must not block the others
      size_bytes_ += entry->table.size_bytes();
    }
    while (size_bytes_ > limit_bytes_ && oldest_first_.size() > 1) {
      const auto oldest = entries_.find(oldest_first_.front());
      size_bytes_ -= oldest->second->table.size_bytes();
      entries_.erase(oldest);
      oldest_first_.pop_front();
    }
  }
  return {entry, &entry->table};
}

}  // namespace armwright
