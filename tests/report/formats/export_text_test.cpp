#include "report/formats/export_text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/text.hpp"

namespace armwright {
namespace {

TEST(YamlText, QuotesWhatIsNoPlainAsciiByNumber) {
  EXPECT_EQ(quote_yaml("joint_1"), R"("joint_1")");
  EXPECT_EQ(quote_yaml(R"(say "a\b": #1)"), R"("say \"a\\b\": #1")");
  EXPECT_EQ(quote_yaml("é"), R"("\xe9")");
  EXPECT_EQ(quote_yaml("中\u00a0"), R"("\u4e2d\xa0")");
  EXPECT_EQ(quote_yaml("😀"), R"("\U0001f600")");
  EXPECT_EQ(quote_yaml(""), R"("")");
  EXPECT_EQ(escape_yaml("a\"b"), R"(a\"b)");
  EXPECT_EQ(escape_yaml("a\u2028b\nc\x85"), "a?b?c?");  // characters that are not printable
}

TEST(YamlText, NumbersAreNeverIntegersAndLoseNoDigit) {
  EXPECT_EQ(format_yaml(270000), "270000.0");
  EXPECT_EQ(format_yaml(0), "0.0");
  EXPECT_EQ(format_yaml(-3), "-3.0");
  EXPECT_EQ(format_yaml(1e20), "1.0e+20");
  EXPECT_EQ(format_yaml(5e-324), "5.0e-324");
  EXPECT_EQ(format_yaml(-1.5e-7), "-1.5e-07");
  for (const double value : {1.0 / 3, 6274.58416712417, 1e300, std::nextafter(1.0, 2.0),
                             std::numeric_limits<double>::max()}) {
    EXPECT_EQ(parse_finite(format_yaml(value)), value);
  }
}

}  // namespace
}  // namespace armwright
