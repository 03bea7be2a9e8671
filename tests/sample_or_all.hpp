// For tests that try a sample in the quick check and all of it in `scripts/test --all`
// (long-tests.md).
#pragma once

#include <cstdlib>

namespace armwright {

// Returns `all` in a run of the long tests, otherwise `sample`.
template <typename Value>
Value sample_or_all(Value sample, Value all) {
  return std::getenv("ARMWRIGHT_LONG_TESTS") == nullptr ? sample : all;
}

}  // namespace armwright
