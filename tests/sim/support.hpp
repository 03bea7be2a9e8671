// Helpers for the test files of this room.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

#include "base/error.hpp"
#include "physics/test_arms.hpp"
#include "physics/tracking_arms.hpp"

namespace armwright {

using physics_test::kPi;
using physics_test::load_irb4600;

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Returns the message with which `action` is refused.
inline std::string usage_message(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    return error.what();
  }
  return "(no error)";
}

}  // namespace armwright
