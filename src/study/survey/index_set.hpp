// Which numbers are there, of those that come nearly in order: memory goes with the gaps, not with
// the numbers.
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
  // False if it was there already.
  bool insert(std::uint64_t index);
  bool has(std::uint64_t index) const;
  std::uint64_t size() const { return size_; }
  // One more than the largest; 0 of none.
  std::uint64_t end() const { return ranges_.empty() ? 0 : ranges_.rbegin()->second + 1; }
  // What is not there below `end`, in ascending order.
  std::vector<IndexRange> list_missing(std::uint64_t end) const;

 private:
  std::map<std::uint64_t, std::uint64_t>
      ranges_;  // first -> last, neither touching nor overlapping
  std::uint64_t size_ = 0;
};

std::uint64_t count(const std::vector<IndexRange>& ranges);
// "3, 7 to 9 and 2 more places"; at most `most` of them are named.
std::string describe(const std::vector<IndexRange>& ranges, std::size_t most = 5);

}  // namespace armwright
