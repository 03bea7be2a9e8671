#pragma once

#include <gmock/gmock.h>

#include <limits>
#include <stdexcept>

namespace armwright {

inline constexpr double kInf = std::numeric_limits<double>::infinity();
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

inline auto refuses(const char* part) {
  return testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr(part));
}

}  // namespace armwright
