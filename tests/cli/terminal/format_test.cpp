#include "cli/terminal/format.hpp"

#include <gtest/gtest.h>

namespace armwright {
namespace {

TEST(FormatDuration, HasSecondsMinutesAndHours) {
  EXPECT_EQ(format_duration(0), "0 s");
  EXPECT_EQ(format_duration(58.5), "59 s");
  EXPECT_EQ(format_duration(59.5), "1:00");
  EXPECT_EQ(format_duration(3599), "59:59");
  EXPECT_EQ(format_duration(3600), "1:00:00");
  EXPECT_EQ(format_duration(2 * 3600 + 5 * 60 + 3), "2:05:03");
  EXPECT_EQ(format_duration(25 * 3600), "25:00:00");
}

}  // namespace
}  // namespace armwright
