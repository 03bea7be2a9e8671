// Which test cases a page replays, and why each of them. Only .cpp files include this.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "report/evidence/motions.hpp"

namespace armwright {

// No case twice: what was added first gives the reason that is shown.
class ReplayList {
 public:
  explicit ReplayList(const TrackingProblem& problem) : problem_(problem) {}

  void add(const std::string& set, std::uint64_t number, const std::string& why);
  // "test/2:17". Error{usage} for anything else.
  void add(const std::string& set_and_number, const std::string& why);
  std::vector<ReplayRequest> take() { return std::move(requests_); }

 private:
  const TrackingProblem& problem_;
  std::vector<ReplayRequest> requests_;
};

inline constexpr const char* kAskedFor = "asked for";

// The index of the largest error, one that does not exist before any that does; not of an empty
// list.
std::size_t find_worst_case(std::span<const double> errors);

}  // namespace armwright
