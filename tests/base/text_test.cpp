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

TEST(Text, FindsNamesWithOtherCapitalsAndSeparators) {
  const std::vector<std::string> names = {"cmaes",        "pagmo:cmaes",   "nlopt:neldermead",
                                          "nlopt:cobyla", "speed_m_per_s", "Speed_m_per_s"};
  EXPECT_EQ(find_nearest("CMA-ES", names), "cmaes");
  EXPECT_EQ(find_nearest("Nelder-Mead", names), "nlopt:neldermead");
  EXPECT_EQ(find_nearest("nelder mead", names), "nlopt:neldermead");
  EXPECT_EQ(find_nearest("NLOPT:Cobyla", names), "nlopt:cobyla");
  EXPECT_EQ(find_nearest("cobyla", names), "nlopt:cobyla");  // behind the ':'
  EXPECT_EQ(find_nearest("pagmo cma-es", names), "pagmo:cmaes");
  EXPECT_EQ(find_nearest("Speed_m_per_S", names), "Speed_m_per_s");  // the nearer as it is written
  EXPECT_EQ(find_nearest("--", names), std::nullopt);
}

TEST(Text, NamesTheThreeNearestOfMoreThanTwelveNames) {
  std::vector<std::string> names = {"auto", "ga", "gaco", "cmaes"};
  for (int i = 5; i <= 12; ++i) {
    names.push_back("random" + std::to_string(i));
  }
  EXPECT_EQ(
      describe_unknown("optimizer", "gacoo", names, "armwright list optimizers"),
      "unknown optimizer 'gacoo'; did you mean 'gaco'? Valid: auto, ga, gaco, cmaes, random5, "
      "random6, random7, random8, random9, random10, random11, random12");
  names.push_back("random13");
  EXPECT_EQ(describe_unknown("optimizer", "gaa", names, "armwright list optimizers"),
            "unknown optimizer 'gaa'; did you mean 'ga'? Valid: ga, gaco, auto and 10 more, which "
            "'armwright list optimizers' lists");
  EXPECT_EQ(describe_unknown("joint", "cma", names),
            "unknown joint 'cma'; did you mean 'cmaes'? Valid: ga, cmaes, auto and 10 more");
  EXPECT_EQ(describe_unknown("joint", "cm", names).find("did you mean"), std::string::npos);
  EXPECT_EQ(list_valid("", names), "auto, ga, gaco and 10 more");
  EXPECT_EQ(list_valid(std::string(65, 'r'), names), "auto, ga, gaco and 10 more");
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

TEST(Text, ParsesCountsExactly) {
  const std::pair<const char*, long long> counts[] = {
      {"42", 42},
      {"+42", 42},
      {"-3", -3},
      {"1e3", 1000},
      {"1E3", 1000},
      {"1e+3", 1000},
      {"10k", 10'000},
      {"2M", 2'000'000},
      {"1.5k", 1500},
      {"0.25M", 250'000},
      {"1.50e1", 15},
      {".5k", 500},
      {"-1k", -1000},
      {"1e18", 1'000'000'000'000'000'000},
      {"9223372036854775.807k", 9'223'372'036'854'775'807}};
  for (const auto& [text, count] : counts) {
    EXPECT_EQ(parse_count(text), count) << text;
  }
  for (const char* text : {"",
                           "1.5",
                           "1.0",
                           "1e-3",
                           "1000e-3",
                           "1.5e0",
                           "1.2345k",
                           "1e",
                           "e3",
                           "k",
                           "1kk",
                           "1k5",
                           "1e3k",
                           "1K",
                           "1m",
                           "1G",
                           " 1k",
                           "1 k",
                           "1_0k",
                           "1.5.0k",
                           "1e19",
                           "10e18",
                           "9300000000000000M",
                           "0x1e3",
                           "1e3.0",
                           "+-1k",
                           "ten"}) {
    EXPECT_EQ(parse_count(text), std::nullopt) << "'" << text << "'";
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
