// Wrong and malicious texts: each must give a message of one line that says where and why.
#include <gtest/gtest.h>

#include <functional>

#include "base/config.hpp"
#include "base/expect_error.hpp"
#include "base/some_settings.hpp"

namespace armwright {
namespace {

std::string refusal_of(std::string_view toml) {
  return usage_error_of([&] { ConfigTable::parse(toml, "q1.toml"); });
}

std::string repeat(std::string_view text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) {
    all += text;
  }
  return all;
}

constexpr const char* kTooDeep =
    "tables and arrays nest deeper than 64 levels (each dot in a key is one)";

TEST(HostileConfig, SyntaxErrorsNameTheLineAndTheReason) {
  EXPECT_EQ(refusal_of("x = 1\ny = \n"),
            "q1.toml:2: this is not valid TOML; key-value pair: expected value, saw '\\n'");
  EXPECT_EQ(
      refusal_of("x = 1\nx = 2\n"),
      "q1.toml:2: this is not valid TOML; key-value pair: cannot redefine existing integer 'x'");
  EXPECT_EQ(refusal_of("[a]\nb = 1\n[a]\n"),
            "q1.toml:3: this is not valid TOML; table header: cannot redefine existing table 'a'");
  EXPECT_EQ(refusal_of("x = 1.5kg\n"),
            "q1.toml:1: this is not valid TOML; floating-point: expected decimal digit, saw 'k'");
  EXPECT_EQ(refusal_of("x = 1,5\n"),
            "q1.toml:1: this is not valid TOML; key-value pair: expected a comment or whitespace, "
            "saw ','");
  EXPECT_EQ(refusal_of("x = 9223372036854775808\n"),
            "q1.toml:1: this is not valid TOML; decimal integer: '9223372036854775808' is not "
            "representable in 64 bits");
}

TEST(HostileConfig, NumbersThatAreNotFiniteAreRefusedWhereverTheyStand) {
  EXPECT_EQ(refusal_of("\nx = nan\n"), "q1.toml:2: x is nan; it must be a finite number");
  EXPECT_EQ(refusal_of("[a]\nx = -inf\n"), "q1.toml:2: a.x is -inf; it must be a finite number");
  EXPECT_EQ(refusal_of("[[a]]\nx = [1,\n  {y = +nan}]\n"),
            "q1.toml:3: a[0].x[1].y is +nan; it must be a finite number");
  EXPECT_EQ(refusal_of("x = 1e999\n"),
            "q1.toml:1: this is not valid TOML; floating-point: '1e999' could not be interpreted "
            "as a value");
}

TEST(HostileConfig, SizeIsLimited) {
  constexpr std::size_t kLimit_bytes = 1 << 20;
  EXPECT_EQ(refusal_of(std::string(kLimit_bytes + 1, '#')),
            "q1.toml: is larger than the limit of 1048576 bytes for a configuration");
  EXPECT_EQ(ConfigTable::parse(std::string(kLimit_bytes, '#'), "q1.toml").to_json(), "{}");
}

TEST(HostileConfig, DepthIsLimited) {
  for (const std::string& toml :
       {repeat("a.", 100000) + "a = 1", "[" + repeat("a.", 65) + "a]",
        "[[" + repeat("a . ", 65) + "a]]", repeat("'a.b'.", 65) + "a = 1",
        "a = " + repeat("[", 65) + repeat("]", 65), "a = " + repeat("{a = ", 65),
        "a = " + repeat("{a.a.a.a.a = ", 13),
        "[" + repeat("a.", 40) + "a]\n" + repeat("b.", 40) + "b = 1",
        "[" + repeat("a.", 40) + "a]\nx = " + repeat("[", 40)}) {
    EXPECT_TRUE(refusal_of(toml).ends_with(kTooDeep)) << toml.substr(0, 80);
  }
  EXPECT_EQ(refusal_of("\n\na = [\n" + repeat("[", 64)), std::string("q1.toml:4: ") + kTooDeep);
}

TEST(HostileConfig, DepthWithinTheLimitIsFine) {
  for (const std::string& toml :
       {repeat("a.", 63) + "a = 1", "a = " + repeat("[", 64) + repeat("]", 64),
        "a = " + repeat("{a = ", 60) + "1" + repeat("}", 60),
        repeat("[[a]]\nb.c = [1.5, 2.5]\n", 200), "a = [" + repeat("1.5, ", 200) + "]",
        "a = [\n" + repeat("{b.c = 1.5},\n", 200) + "]",
        "a = \"" + repeat("[.", 200) + "\" # " + repeat("[.", 200),
        "a = '''\n" + repeat("[.", 200) + "\n'''",
        "a = \"\"\"\\\"" + repeat("[.", 200) + "\"\"\"\"\"\nb = 1",
        "a = \"\\\\\" # " + repeat("[", 100)}) {
    EXPECT_NO_THROW(ConfigTable::parse(toml, "q1.toml")) << toml.substr(0, 80);
  }
}

TEST(HostileConfig, InvalidUtf8IsRefusedEverywhere) {
  const std::string message = "this line is not valid UTF-8 text; save the file as UTF-8";
  EXPECT_EQ(refusal_of("x = 1\ny = \"\xff\"\n"), "q1.toml:2: " + message);
  EXPECT_EQ(refusal_of("x = '''\n\n\xc5'''\n"), "q1.toml:3: " + message);
  EXPECT_EQ(refusal_of("# \xed\xa0\x80\n"), "q1.toml:1: " + message);
  EXPECT_EQ(refusal_of("x\xff = 1\n"), "q1.toml:1: " + message);
}

TEST(HostileConfig, KeysBeyondAsciiNeedQuotes) {
  EXPECT_EQ(refusal_of("x = 1\nŭ = 1\n"),
            "q1.toml:2: 'ŭ' stands outside quotes; keys are made of a-z A-Z 0-9 _ -, anything else "
            "needs quotes");
  EXPECT_EQ(
      refusal_of("[délka]\n"),
      "q1.toml:1: 'délka' stands outside quotes; keys are made of a-z A-Z 0-9 _ -, anything else "
      "needs quotes");
  EXPECT_EQ(ConfigTable::parse("\"ŭ\" = 'é' # ž\n", "q1.toml").get(text("ŭ")), "é");
}

TEST(HostileConfig, AHeaderNeedsAName) {
  EXPECT_EQ(refusal_of("x = 1\n[#a]\n"),
            "q1.toml:2: expected the name of a table behind '[', saw '#'");
  EXPECT_EQ(refusal_of("[[ .a]]\n"), "q1.toml:1: expected the name of a table behind '[', saw '.'");
  EXPECT_EQ(refusal_of("[[[a]]]\n"), "q1.toml:1: expected the name of a table behind '[', saw '['");
  EXPECT_EQ(refusal_of("[\na]\n"), "q1.toml:1: expected the name of a table behind '[', saw '?'");
  EXPECT_EQ(refusal_of("[ ]\n"),
            "q1.toml:1: this is not valid TOML; table header: tables with blank bare keys are "
            "explicitly prohibited");
}

TEST(HostileConfig, ValuesBeginWhereTheyCan) {
  for (const std::string toml :
       {"x = 2'ﻷ'\n", "x = [1 'ŭ']\n", "[a] 'b' = 1\n", "x = 1.'ŭ'\n", "x = [1\t'ŭ']"}) {
    EXPECT_EQ(
        refusal_of(toml),
        "q1.toml:1: ' stands where nothing can begin with it; is a comma or a quote missing?");
  }
  EXPECT_EQ(refusal_of("\nx = {a = 1 \"ŭ\" = 2}\n"),
            "q1.toml:2: \" stands where nothing can begin with it; is a comma or a quote missing?");
  EXPECT_EQ(refusal_of("x = -[\"ŭ\"]\n"),
            "q1.toml:1: [ stands where nothing can begin with it; is a comma or a quote missing?");
  EXPECT_EQ(refusal_of("x = 1\ny = 1='ŭ'\n"), "q1.toml:2: = stands in a value; text needs quotes");
  EXPECT_EQ(refusal_of("x = [1, a = 2]\n"), "q1.toml:1: = stands in a value; text needs quotes");
  EXPECT_EQ(
      ConfigTable::parse(
          "  'a'.\"b\" = [ 'c', \n 'd',\n\t'e' ]\nf = {'g' = 'h', 'i' = 1}\n['j'.'k']\n", "q1.toml")
          .to_json(),
      R"({"a":{"b":["c","d","e"]},"f":{"g":"h","i":1},"j":{"k":{}}})");
}

TEST(HostileConfig, ALetterBeyondAsciiDoesNotFollowABackslash) {
  const std::string message =
      "a letter beyond ASCII behind a backslash; write the text without this backslash";
  EXPECT_EQ(refusal_of("x = 1\ny = \"\"\"\na \\\n  ž\"\"\"\n"), "q1.toml:4: " + message);
  EXPECT_EQ(refusal_of("x = \"\\ž\"\n"), "q1.toml:1: " + message);
  EXPECT_EQ(ConfigTable::parse("x = \"\"\"ž \\\n  a\"\"\"\n", "q1.toml").get(text("x")), "ž a");
  EXPECT_EQ(ConfigTable::parse("x = '\\ž'\n", "q1.toml").get(text("x")), "\\ž");
  EXPECT_EQ(ConfigTable::parse("x = \"\\\\ž\"\n", "q1.toml").get(text("x")), "\\ž");
}

TEST(HostileConfig, ADateNeedsItsTimeBehindTheT) {
  EXPECT_EQ(refusal_of("x = [1979-05-27 2]\n"), "q1.toml:1: expected a time behind the date");
  EXPECT_EQ(refusal_of("x = 1\ny = 1979-05-27T.5:\n"),
            "q1.toml:2: expected a time behind the date");
  EXPECT_EQ(
      ConfigTable::parse("x = [1979-05-27T07:32:00Z, 1979-05-27, 07:32:00, 1979-05-27 07:32:00, "
                         "1979-05-27 ]\nTt = 1\n",
                         "q1.toml")
          .to_json(),
      R"({"Tt":1,"x":["1979-05-27T07:32:00Z","1979-05-27","07:32:00","1979-05-27 07:32:00","1979-05-27"]})");
}

TEST(HostileConfig, ABraceDoesNotStandForAValue) {
  EXPECT_EQ(refusal_of("x = [1,\n}]\n"), "q1.toml:2: '}' stands directly behind ','");
  EXPECT_EQ(refusal_of("x = [ }\n"), "q1.toml:1: '}' stands directly behind '['");
}

TEST(HostileConfig, AByteOrderMarkIsSkipped) {
  EXPECT_EQ(ConfigTable::parse("\xef\xbb\xbfx = 1\n", "q1.toml").get(number("x")), 1);
}

TEST(HostileConfig, TextCutOffAnywhereGivesAMessageOrAValue) {
  const std::string toml =
      "a.\"b.c\" = [1.5, { d = 'e', \"ž\" = \"\\u0041\\\"\" }]\n[[f.g]]\nh = "
      "\"\"\"i\n\"\"\"\"\"\nj = '''k''' # ž\n"
      "[l]\nm = 1979-05-27T07:32:00Z\nn = 0x1F\no = [\n true,\n]\n";
  ConfigTable::parse(toml, "q1.toml");
  for (std::size_t length = 0; length < toml.size(); ++length) {
    try {
      ConfigTable::parse(toml.substr(0, length), "q1.toml");
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      EXPECT_TRUE(std::string(error.what()).starts_with("q1.toml:")) << error.what();
    }
  }
}

TEST(HostileConfig, LargeFilesOfTinyPiecesAreRead) {
  EXPECT_EQ(
      ConfigTable::parse("a = [" + repeat("1,", 500000) + "]", "q1.toml").get(numbers("a")).size(),
      500000U);
  EXPECT_EQ(ConfigTable::parse(repeat("[[a]]\n", 150000), "q1.toml").get_tables(array("a")).size(),
            150000U);
}

}  // namespace
}  // namespace armwright
