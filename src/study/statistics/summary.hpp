// What is said of a set of test cases: never a mean alone, because a few arms that lose their
// target decide it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace armwright {

struct ErrorSummary {
  std::uint64_t cases = 0;
  std::uint64_t without_number =
      0;                       // diverged or unreachable: they have no error, and count as failures
  std::uint64_t failures = 0;  // error above the threshold, or without number
  std::optional<double> mean;  // over the cases with a number; nothing if there is none
  std::optional<double> median;  // a case without number counts as larger than all others
  std::optional<double> percentile_95;
  std::optional<double> worst;  // nothing if any case is without number
};

// `errors`: one a case, NaN for a case without number. A case fails if its error exceeds
// `failure_error`: kFailureError_m for an arm, infinity for a function.
ErrorSummary summarize(std::span<const double> errors, double failure_error);

}  // namespace armwright
