// A cache of values that depend on a test case only, within a memory limit.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace armwright {

// A thread-safe map from test cases to values. Each value is made once and shared by all designs
// and threads. `Value` must have size_bytes().
template <class Value>
class CaseCache {
 public:
  explicit CaseCache(std::size_t limit_bytes) : limit_bytes_(limit_bytes) {}

  // Returns the value of case `number` of the set with that name. Calls make() if the cache does
  // not hold it. If two threads ask for the same case at the same time, one makes the value and the
  // other waits. Drops the oldest values at the limit, but never the last one; a dropped value
  // lives as long as a caller holds it. Throws what make() throws.
  template <class Make>
  std::shared_ptr<const Value> get(const std::string& set, std::uint64_t number, const Make& make);
  // Makes the values that the cache lacks and no other thread is making, all with one call of
  // make(numbers), which returns one value per number. The caller calls get() for every number
  // afterwards; only then the limit counts them. Throws what make() throws.
  template <class Make>
  void fill(const std::string& set, std::span<const std::uint64_t> numbers, const Make& make);
  // Drops all values. Thread-safe.
  void clear();
  // Returns the number of values made so far.
  std::uint64_t computed() const { return computed_; }

 private:
  struct Entry {
    std::mutex mutex;  // locked while the value is made; other threads wait for it
    bool made =
        false;  // replaces std::call_once, which not every platform combines with exceptions
    Value value;
    bool counted = false;  // its size is in size_bytes_
  };
  using Key = std::pair<std::string, std::uint64_t>;

  const std::size_t limit_bytes_;
  std::mutex mutex_;
  std::map<Key, std::shared_ptr<Entry>> entries_;
  std::list<Key> oldest_first_;
  std::size_t size_bytes_ = 0;
  std::atomic<std::uint64_t> computed_ = 0;
};

template <class Value>
template <class Make>
std::shared_ptr<const Value> CaseCache<Value>::get(const std::string& set, std::uint64_t number,
                                                   const Make& make) {
  const Key key(set, number);
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
      entry->value = make();
      entry->made = true;
      ++computed_;
    }
  }
  {
    const std::lock_guard lock(mutex_);
    if (!entry->counted) {
      entry->counted = true;
      // The list holds made values only. A case whose value cannot be made must not stop the cache
      // from dropping others.
      oldest_first_.push_back(key);
      size_bytes_ += entry->value.size_bytes();
    }
    while (size_bytes_ > limit_bytes_ && oldest_first_.size() > 1) {
      const auto oldest = entries_.find(oldest_first_.front());
      size_bytes_ -= oldest->second->value.size_bytes();
      entries_.erase(oldest);
      oldest_first_.pop_front();
    }
  }
  return {entry, &entry->value};
}

template <class Value>
template <class Make>
void CaseCache<Value>::fill(const std::string& set, std::span<const std::uint64_t> numbers,
                            const Make& make) {
  std::vector<std::shared_ptr<Entry>> entries;
  std::vector<std::unique_lock<std::mutex>> locks;
  std::vector<std::uint64_t> lacking;
  for (const std::uint64_t number : numbers) {
    std::shared_ptr<Entry> entry;
    {
      const std::lock_guard lock(mutex_);
      auto& slot = entries_[Key(set, number)];
      if (!slot) {
        slot = std::make_shared<Entry>();
      }
      entry = slot;
    }
    if (std::ranges::find(entries, entry) != entries.end()) {
      continue;
    }
    // Waiting here while other entries are locked could block two threads for ever.
    std::unique_lock lock(entry->mutex, std::try_to_lock);
    if (lock && !entry->made) {
      entries.push_back(entry);
      locks.push_back(std::move(lock));
      lacking.push_back(number);
    }
  }
  if (lacking.empty()) {
    return;
  }
  std::vector<Value> values = make(std::span<const std::uint64_t>(lacking));
  for (std::size_t i = 0; i < entries.size(); ++i) {
    entries[i]->value = std::move(values[i]);
    entries[i]->made = true;
    ++computed_;
  }
}

template <class Value>
void CaseCache<Value>::clear() {
  const std::lock_guard lock(mutex_);
  for (const Key& key : oldest_first_) {
    entries_.erase(key);  // a value that is being made is not in the list, so it stays
  }
  oldest_first_.clear();
  size_bytes_ = 0;
}

}  // namespace armwright
