#include "study/survey/index_set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "base/text.hpp"

namespace armwright {

bool IndexSet::has(std::uint64_t index) const {
  const auto after = ranges_.upper_bound(index);
  return after != ranges_.begin() && index <= std::prev(after)->second;
}

bool IndexSet::insert(std::uint64_t index) {
  const auto after = ranges_.upper_bound(index);
  const auto before = after == ranges_.begin() ? ranges_.end() : std::prev(after);
  if (before != ranges_.end() && index <= before->second) {
    return false;
  }
  ++size_;
  const bool joins_before = before != ranges_.end() && index - before->second == 1;
  const bool joins_after = after != ranges_.end() && after->first - index == 1;
  if (joins_before && joins_after) {
    before->second = after->second;
    ranges_.erase(after);
  } else if (joins_before) {
    before->second = index;
  } else if (joins_after) {
    const std::uint64_t last = after->second;
    ranges_.erase(after);
    ranges_[index] = last;
  } else {
    ranges_[index] = index;
  }
  return true;
}

std::vector<IndexRange> IndexSet::list_missing(std::uint64_t end) const {
  std::vector<IndexRange> missing;
  std::uint64_t next = 0;
  for (const auto& [first, last] : ranges_) {
    if (first >= end) {
      break;
    }
    if (first > next) {
      missing.push_back({next, first - 1});
    }
    next = last + 1;
  }
  if (next < end) {
    missing.push_back({next, end - 1});
  }
  return missing;
}

std::uint64_t count(const std::vector<IndexRange>& ranges) {
  std::uint64_t sum = 0;
  for (const IndexRange& range : ranges) {
    sum += range.last - range.first + 1;
  }
  return sum;
}

std::string describe(const std::vector<IndexRange>& ranges, std::size_t most) {
  std::vector<std::string> named;
  for (const IndexRange& range : ranges) {
    if (named.size() == most) {
      break;
    }
    named.push_back(range.first == range.last ? fmt::format("{}", range.first)
                                              : fmt::format("{} to {}", range.first, range.last));
  }
  const std::size_t more = ranges.size() - named.size();
  return join(named, ", ") +
         (more > 0 ? fmt::format(" and {} more place{}", more, more == 1 ? "" : "s") : "");
}

}  // namespace armwright
