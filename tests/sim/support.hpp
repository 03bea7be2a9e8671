// Helpers for the test files of this room.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "physics/test_arms.hpp"
#include "physics/tracking_arms.hpp"
#include "sim/controllers/controller.hpp"

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

// Returns the controller 'pid' of one joint.
inline std::unique_ptr<Controller> make_pid(double p, double i, double d, EffortLimits limits,
                                            JointKind kind = JointKind::revolute) {
  return find_controller("pid").make(std::vector<double>{p, i, d}, limits, kind);
}

}  // namespace armwright
