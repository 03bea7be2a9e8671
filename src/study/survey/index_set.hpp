// A set of indices that are inserted nearly in order. Its memory is proportional to the number of
// gaps, not to the number of indices.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace armwright {

struct IndexRange {
  std::uint64_t first = 0;
  std::uint64_t last = 0;  // included
};

class IndexSet {
 public:
  // Returns false if the index was in the set already.
  bool insert(std::uint64_t index);
  bool has(std::uint64_t index) const;
  std::uint64_t size() const { return size_; }
  // Returns the largest index plus 1; 0 for an empty set.
  std::uint64_t end() const { return ranges_.empty() ? 0 : ranges_.rbegin()->second + 1; }
  // Returns the ranges of missing indices below `end`, ascending.
  std::vector<IndexRange> list_missing(std::uint64_t end) const;

 private:
  // first -> last of each range; ranges neither touch nor overlap
  std::map<std::uint64_t, std::uint64_t> ranges_;
  std::uint64_t size_ = 0;
};

// Returns the number of indices in all ranges.
std::uint64_t count(const std::vector<IndexRange>& ranges);
// Returns "3, 7 to 9 and 2 more places", with at most `most` ranges named.
std::string describe(const std::vector<IndexRange>& ranges, std::size_t most = 5);

}  // namespace armwright
