// What runs and studies have in common of what is asked for: where to, on how many threads, for how
// long; and values that are checked alike.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "problems/interface/schedule.hpp"

namespace armwright::python {

inline constexpr std::int64_t kMostBudget = 1'000'000'000'000;

struct Place {
  std::optional<std::string> out;
  bool another = false;
  unsigned jobs = 1;
  std::optional<double> time_limit_s;

  // results/NAME unless told otherwise; with `another` the first free of it, NAME-002, ...
  std::filesystem::path choose(const std::string& name) const;
};

// Error{usage} if it is not from `lower` to `upper`.
std::int64_t check_number(std::string_view name, std::int64_t value, std::int64_t lower,
                          std::int64_t upper);
Schedule parse_schedule(const std::string& text);

}  // namespace armwright::python
