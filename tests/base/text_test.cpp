#include "base/text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace armwright {
namespace {

TEST(Text, FindsTheNearestName) {
  const std::vector<std::string> names = {"random", "ga", "nlopt:bobyqa", "speed_m_per_s"};
  EXPECT_EQ(find_nearest("gaa", names), "ga");
  EXPECT_EQ(find_nearest("ag", names), "ga");  // a transposition counts as one
  EXPECT_EQ(find_nearest("nlopt:bobqya", names), "nlopt:bobyqa");
  EXPECT_EQ(find_nearest("rnadmo", names), "random");  // two of six
  EXPECT_EQ(find_nearest("random", names), "random");
  EXPECT_EQ(find_nearest("ranges", names), std::nullopt);  // three of six
  EXPECT_EQ(find_nearest("", names), std::nullopt);
  EXPECT_EQ(find_nearest("ga", {}), std::nullopt);
}

TEST(Text, FindsNothingNearWhereNoLetterAgrees) {
  const std::vector<std::string> names = {"n", "xy"};
  EXPECT_EQ(find_nearest("x", {names.data(), 1}), std::nullopt);
  EXPECT_EQ(find_nearest("ab", names), std::nullopt);
  EXPECT_EQ(find_nearest("xz", names), "xy");
}

TEST(Text, PrefersTheEarlierOfTwoNearNames) {
  const std::vector<std::string> names = {"cats", "bats"};
  EXPECT_EQ(find_nearest("rats", names), "cats");
}

TEST(Text, DoesNotSearchForVeryLongNames) {
  const std::vector<std::string> names = {std::string(65, 'a'), std::string(64, 'a')};
  EXPECT_EQ(find_nearest(std::string(65, 'a'), names), std::nullopt);
  EXPECT_EQ(find_nearest(std::string(64, 'a'), names), names[1]);
}

TEST(Text, DescribesUnknownNames) {
  const std::vector<std::string> names = {"ga", "random"};
  EXPECT_EQ(describe_unknown("optimizer", "gaa", names),
            "unknown optimizer 'gaa'; did you mean 'ga'? Valid: ga, random");
  EXPECT_EQ(describe_unknown("optimizer", "simplex", names),
            "unknown optimizer 'simplex'. Valid: ga, random");
  EXPECT_EQ(describe_unknown("optimizer", "x\x1b[31m", {}),
            "unknown optimizer 'x?[31m'. Valid: (none)");
}

TEST(Text, ParsesFiniteNumbersOnly) {
  EXPECT_EQ(parse_finite("1.5"), 1.5);
  EXPECT_EQ(parse_finite("+1"), 1.0);
  EXPECT_EQ(parse_finite("-1e-3"), -0.001);
  EXPECT_EQ(parse_finite(".5"), 0.5);
  EXPECT_EQ(parse_finite("1.7976931348623157e308"), std::numeric_limits<double>::max());
  for (const char* text : {"",     " 1",       "1 ",    "1.5kg",  "1,5", "nan",   "-nan", "inf",
                           "-inf", "infinity", "1e999", "-1e999", "+-1", "-+1",   "++1",  "+",
                           "-",    ".",        "e5",    "0x10",   "1e",  "1_000", "one"}) {
    EXPECT_EQ(parse_finite(text), std::nullopt) << "'" << text << "'";
  }
  EXPECT_EQ(parse_finite(std::string_view("1\0", 2)), std::nullopt);
}

TEST(Text, ParsesWholeIntegersOnly) {
  EXPECT_EQ(parse_integer("42"), 42);
  EXPECT_EQ(parse_integer("+42"), 42);
  EXPECT_EQ(parse_integer("-9223372036854775808"), std::numeric_limits<long long>::min());
  for (const char* text :
       {"", " 1", "1 ", "1.0", "1e3", "+-1", "0x10", "9223372036854775808", "1_000"}) {
    EXPECT_EQ(parse_integer(text), std::nullopt) << "'" << text << "'";
  }
}

TEST(Text, SplitsAndJoins) {
  EXPECT_EQ(split("a.b.", '.'), (std::vector<std::string>{"a", "b", ""}));
  EXPECT_EQ(split("", '.'), std::vector<std::string>{""});
  EXPECT_EQ(join(split("a.b.c", '.'), ", "), "a, b, c");
  EXPECT_EQ(join({}, ", "), "");
}

TEST(Text, FormatsNumbersSoThatTheyReadBackExactly) {
  EXPECT_EQ(format_exact(0.1), "0.1");
  EXPECT_EQ(format_exact(1.0 / 3.0), "0.3333333333333333");
  for (const double value :
       {0.1, 1.0 / 3.0, 5e-324, 1.7976931348623157e308, -0.0, 1e22, 123456789.123}) {
    EXPECT_EQ(parse_finite(format_exact(value)), value) << format_exact(value);
  }
}

TEST(Text, IsUtf8OrNot) {
  for (const char* text : {"", "plain\ttext", "\xc5\xbd", "\xe2\x80\xae turned around"}) {
    EXPECT_TRUE(is_utf8(text)) << text;
  }
  for (const char* text : {"\xff", "a\xc5", "\xed\xa0\x80", "\xc2\x9b"}) {
    EXPECT_FALSE(is_utf8(text)) << text;
  }
}

TEST(Text, SanitizesControlCharactersAndInvalidBytes) {
  EXPECT_EQ(sanitize("plain text"), "plain text");
  EXPECT_EQ(sanitize("a\x1b[31mred\x07\x7f\n\t"), "a?[31mred????");
  EXPECT_EQ(sanitize("\xc5\xbd \xe2\x82\xac \xf0\x9f\xa4\x96"),
            "\xc5\xbd \xe2\x82\xac \xf0\x9f\xa4\x96");
  EXPECT_EQ(sanitize(std::string_view("a\0b", 3)), "a?b");
  EXPECT_EQ(sanitize("\xff\xfe"), "??");
  EXPECT_EQ(sanitize("a\u202egpj.exe\u2066\u200f\u2028"), "a?gpj.exe???");
  EXPECT_EQ(sanitize("\xc5"), "?");  // cut off
  EXPECT_EQ(sanitize("\xe2\x82"), "??");
  EXPECT_EQ(sanitize("\xc0\xaf"), "??");  // overlong '/'
  EXPECT_EQ(sanitize("\xe0\x80\xaf"), "???");
  EXPECT_EQ(sanitize("\xf0\x80\x80\xaf"), "????");
  EXPECT_EQ(sanitize("\xed\xa0\x80"), "???");       // a surrogate
  EXPECT_EQ(sanitize("\xf4\x90\x80\x80"), "????");  // beyond U+10FFFF
  EXPECT_EQ(sanitize("\xc2\x9b"
                     "31m"),
            "??31m");  // the one-character form of escape [
}

TEST(DescribeNumber, HasWordsForWhatIsNoFiniteNumber) {
  EXPECT_EQ(describe_number(3.14159, "rad"), "3.142 rad");
  EXPECT_EQ(describe_number(2, "", 3), "2");
  EXPECT_EQ(describe_number(-std::nan(""), "rad"), "not a number");
  EXPECT_EQ(describe_number(INFINITY, "mm"), "infinite");
  EXPECT_EQ(describe_number(-INFINITY, "mm"), "minus infinite");
}

}  // namespace
}  // namespace armwright
