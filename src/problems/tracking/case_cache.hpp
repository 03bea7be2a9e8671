// What is made once of a test case, however many designs and threads ask, and kept within a memory
// bound. Value: a type with size_bytes().
#pragma once

#include <atomic>
#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

namespace armwright {

template <class Value>
class CaseCache {
 public:
  explicit CaseCache(std::size_t limit_bytes) : limit_bytes_(limit_bytes) {}

  // The value of case `number` of the set of that name: the one kept, or what `make` returns.
  // Thread-safe. Two threads that ask for the same case at the same time make it once; the oldest
  // values go when the limit is reached (they live on as long as somebody holds them).
  template <class Make>
  std::shared_ptr<const Value> get(const std::string& set, std::uint64_t number, const Make& make);
  void clear();  // thread-safe; values live on as long as somebody holds them
  std::uint64_t computed() const { return computed_; }  // values made so far

 private:
  struct Entry {
    std::mutex mutex;   // held while the value is made: whoever else asks for it waits
    bool made = false;  // not std::call_once, which does not agree everywhere with exceptions
    Value value;
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
      oldest_first_.push_back(key);  // only now: one that cannot be made must not block the others
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
void CaseCache<Value>::clear() {
  const std::lock_guard lock(mutex_);
  for (const Key& key : oldest_first_) {
    entries_.erase(key);  // one that is being made is not in the list, and stays
  }
  oldest_first_.clear();
  size_bytes_ = 0;
}

}  // namespace armwright
