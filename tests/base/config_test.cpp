#include "base/config.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <clocale>
#include <limits>
#include <locale>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "base/expect_error.hpp"
#include "base/some_settings.hpp"

namespace armwright {
namespace {

const std::vector<std::string> kKinds = {"ga", "random"};

ConfigTable parse(std::string_view toml) {
  return ConfigTable::parse(toml, "q1.toml");
}

TEST(Config, HandsOutEveryType) {
  const ConfigTable config = parse(R"(
name = "Žitný\t1"
kind = 'ga'
speed_m_per_s = 2.5
count = 3
mass_kg = 3
enabled = true
gains = [1, 2.5, -3e-2]
tags = ["a", "b"]
empty = []
[task]
x = 1
[[joints]]
y = 2
[[joints]]
y = 3
)");
  EXPECT_EQ(config.get(text("name")), "Žitný\t1");
  EXPECT_EQ(config.get(choice("kind", kKinds)), "ga");
  EXPECT_EQ(config.get(number("speed_m_per_s")), 2.5);
  EXPECT_EQ(config.get(number("mass_kg")), 3.0);  // an integer is a number too
  EXPECT_EQ(config.get(integer("count", {.lower = 1, .upper = 3})), 3);
  EXPECT_TRUE(config.get(boolean("enabled")));
  EXPECT_EQ(config.get(numbers("gains")), (std::vector<double>{1, 2.5, -0.03}));
  EXPECT_EQ(config.get(texts("tags")), (std::vector<std::string>{"a", "b"}));
  EXPECT_TRUE(config.get(numbers("empty")).empty());
  EXPECT_TRUE(config.get(texts("empty")).empty());
  EXPECT_TRUE(config.get_tables(array("empty")).empty());
  EXPECT_EQ(config.get_table(table("task")).get(number("x")), 1);
  const auto joints = config.get_tables(array("joints"));
  ASSERT_EQ(joints.size(), 2U);
  EXPECT_EQ(joints[0].get(number("y")), 2);
  EXPECT_EQ(joints[1].get(number("y")), 3);
  config.refuse_unknown();
}

TEST(Config, ADefaultStandsForAMissingKeyOnly) {
  const ConfigTable config = parse("x = 1\nname = 'a'\nbad = 'b'\n");
  EXPECT_EQ(config.get(number("x", {}, 7)), 1);
  EXPECT_EQ(config.get(number("y", {}, 7)), 7);
  EXPECT_EQ(config.get(integer("x", {.lower = 0, .upper = 9}, 7)), 1);
  EXPECT_EQ(config.get(integer("n", {.lower = 0, .upper = 9}, 7)), 7);
  EXPECT_TRUE(config.get(boolean("b", true)));
  EXPECT_EQ(config.get(text("name", "z")), "a");
  EXPECT_EQ(config.get(text("title", "z")), "z");
  EXPECT_EQ(config.get(choice("kind", kKinds, "ga")), "ga");
  EXPECT_FALSE(config.get_table_or_empty(table("task")).has("x"));
  EXPECT_TRUE(config.get_tables_or_empty(array("joints")).empty());
  EXPECT_EQ(usage_error_of([&] { config.get(number("bad", {}, 7)); }),
            "q1.toml:3: bad is 'b', a string; it must be a finite number");
}

TEST(Config, NamesFileLineFieldValueAndRange) {
  const ConfigTable config =
      parse("# a comment\n\n[task]\n\nspeed_m_per_s = -4 # too slow\nratio = 1.50\n");
  const ConfigTable task = config.get_table(table("task"));
  const auto refusal = [&](const char* key, Range range) {
    return usage_error_of([&] { task.get(number(key, range)); });
  };
  EXPECT_EQ(refusal("speed_m_per_s", {.lower = 0, .lower_open = true}),
            "q1.toml:5: task.speed_m_per_s is -4; it must be a finite number > 0");
  EXPECT_EQ(refusal("speed_m_per_s", {.lower = 0}),
            "q1.toml:5: task.speed_m_per_s is -4; it must be a finite number >= 0");
  EXPECT_EQ(refusal("ratio", {.lower = 0, .upper = 1, .lower_open = true}),
            "q1.toml:6: task.ratio is 1.50; it must be a finite number > 0 and <= 1");
  EXPECT_EQ(refusal("ratio", {.upper = 0.1}),
            "q1.toml:6: task.ratio is 1.50; it must be a finite number <= 0.1");
}

TEST(Config, TheEndsOfARangeBelongToItUnlessOpen) {
  const ConfigTable config = parse("zero = 0\none = 1\n");
  EXPECT_EQ(config.get(number("zero", {.lower = 0, .upper = 1})), 0);
  EXPECT_EQ(config.get(number("one", {.lower = 0, .upper = 1})), 1);
  EXPECT_EQ(usage_error_of([&] { config.get(number("zero", {.lower = 0, .lower_open = true})); }),
            "q1.toml:1: zero is 0; it must be a finite number > 0");
  EXPECT_EQ(config.get(integer("one", {.lower = 1, .upper = 1})), 1);
  EXPECT_EQ(usage_error_of([&] { config.get(integer("one", {.lower = 2, .upper = 9})); }),
            "q1.toml:2: one is 1; it must be an integer from 2 to 9");
  EXPECT_EQ(usage_error_of([&] { config.get(integer("one", {.lower = 2})); }),
            "q1.toml:2: one is 1; it must be an integer >= 2");
  EXPECT_EQ(usage_error_of([&] { config.get(integer("one", {.upper = 0})); }),
            "q1.toml:2: one is 1; it must be an integer <= 0");
}

TEST(Config, NamesTheTypeThatWasFound) {
  const ConfigTable config = parse(R"(
text = "fast"
real = 2.0
flag = true
day = 1979-05-27
list = [1, 2]
inline = {x = 1}
[table]
)");
  const auto as_number = [&](const char* key) {
    return usage_error_of([&] { config.get(number(key)); });
  };
  EXPECT_EQ(as_number("text"), "q1.toml:2: text is \"fast\", a string; it must be a finite number");
  EXPECT_EQ(as_number("flag"), "q1.toml:4: flag is true, a boolean; it must be a finite number");
  EXPECT_EQ(as_number("day"),
            "q1.toml:5: day is 1979-05-27, a date or time; it must be a finite number");
  EXPECT_EQ(as_number("list"), "q1.toml:6: list is [1, 2], an array; it must be a finite number");
  EXPECT_EQ(as_number("inline"), "q1.toml:7: inline is a table; it must be a finite number");
  EXPECT_EQ(as_number("table"), "q1.toml:8: table is a table; it must be a finite number");
  EXPECT_EQ(usage_error_of([&] { config.get(integer("real", {.lower = 0, .upper = 9})); }),
            "q1.toml:3: real is 2.0, a floating-point number; it must be an integer from 0 to 9");
  EXPECT_EQ(usage_error_of([&] { config.get(boolean("text")); }),
            "q1.toml:2: text is \"fast\", a string; it must be true or false");
  EXPECT_EQ(usage_error_of([&] { config.get(text("flag")); }),
            "q1.toml:4: flag is true, a boolean; it must be a string");
  EXPECT_EQ(usage_error_of([&] { config.get_table(table("flag")); }),
            "q1.toml:4: flag is true, a boolean; it must be a table, [flag]");
  EXPECT_EQ(usage_error_of([&] { config.get_tables(array("table")); }),
            "q1.toml:8: table is a table; it must be an array of tables, [[table]]");
  EXPECT_EQ(usage_error_of([&] { config.get_tables(array("list")); }),
            "q1.toml:6: list[0] is 1, an integer; it must be a table");
  EXPECT_EQ(usage_error_of([&] { config.get(numbers("flag")); }),
            "q1.toml:4: flag is true, a boolean; it must be an array, each element of it a finite "
            "number");
  EXPECT_EQ(usage_error_of([&] { config.get(texts("list")); }),
            "q1.toml:6: list[0] is 1, an integer; it must be a string");
}

TEST(Config, CountsMayHaveAnExponentOrKOrMAndAreRecordedAsIntegers) {
  const ConfigTable config = ConfigTable::parse("a = 1e3\nb = \"10k\"\n[[t]]\nc = 2.5e3\n",
                                                "q1.toml", std::vector<std::string>{"d=2M"});
  EXPECT_EQ(config.get(integer("a")), 1000);
  EXPECT_EQ(config.get(integer("b")), 10'000);
  EXPECT_EQ(config.get_tables(array("t"))[0].get(integer("c")), 2500);
  EXPECT_EQ(config.get(integer("d")), 2'000'000);
  EXPECT_EQ(config.to_json(), R"({"a":1000,"b":10000,"d":2000000,"t":[{"c":2500}]})");
  for (const char* value : {"1.0", "1.5", "1e-3", "1e19", "\"1000\"", "\"1.2345k\"", "\"k\""}) {
    EXPECT_EQ(usage_error_of([&] {
                parse(fmt::format("a = {}\n", value)).get(integer("a", {.lower = 1, .upper = 9}));
              }),
              fmt::format("q1.toml:1: a is {}, {}; it must be an integer from 1 to 9", value,
                          value[0] == '"' ? "a string" : "a floating-point number"));
  }
  EXPECT_EQ(usage_error_of([&] { parse("a = 1e3\n").get(integer("a", {.lower = 1, .upper = 9})); }),
            "q1.toml:1: a is 1e3; it must be an integer from 1 to 9");
}

TEST(Config, AsksWhetherATooLargeLengthIsInMillimetres) {
  const Range range{.lower = 0.001, .upper = 100};
  EXPECT_EQ(
      usage_error_of([&] { parse("radius_m = 450\n").get(number("radius_m", range)); }),
      "q1.toml:1: radius_m is 450; it must be a finite number >= 0.001 and <= 100; 450 m: were "
      "millimetres meant? Then write 0.45");
  EXPECT_EQ(
      usage_error_of([&] {
        parse("centre_m = [0.5, -5000]\n")
            .get(numbers("centre_m", {.lower = -1000, .upper = 1000}));
      }),
      "q1.toml:1: centre_m[1] is -5000; it must be a finite number >= -1000 and <= 1000; -5000 m: "
      "were millimetres meant? Then write -5");
  const auto speed = number("speed_m_per_s", range);
  EXPECT_THAT(usage_error_of([&] { parse("speed_m_per_s = 1500\n").get(speed); }),
              testing::EndsWith("; 1500 m/s: were millimetres meant? Then write 1.5"));
  // A thousandth of it is not in the range either, and torques are not in millimetres.
  for (const char* key : {"radius_m = 450000", "radius_m = -1", "torque_n_m = 450"}) {
    const std::string name(key, std::string(key).find(' '));
    EXPECT_THAT(
        usage_error_of([&] { parse(std::string(key) + "\n").get(number(name.c_str(), range)); }),
        testing::EndsWith("and <= 100"));
  }
}

TEST(Config, NamesTheElementOfAnArrayAndItsOwnLine) {
  const ConfigTable config = parse("gains = [1,\n 2,\n -3]\n");
  EXPECT_EQ(usage_error_of([&] { config.get(numbers("gains", {.lower = 0})); }),
            "q1.toml:3: gains[2] is -3; it must be a finite number >= 0");
  EXPECT_EQ(usage_error_of([&] { config.get(number("gains")); }),
            "q1.toml:1: gains is an array of length 3; it must be a finite number");
}

TEST(Config, NamesTheTableOfAnArrayOfTables) {
  const ConfigTable config = parse("[[arm.joints]]\nkp = 1\n[[arm.joints]]\nkp = -1\n");
  const auto joints = config.get_table(table("arm")).get_tables(array("joints"));
  EXPECT_EQ(usage_error_of([&] { joints[1].get(number("kp", {.lower = 0})); }),
            "q1.toml:4: arm.joints[1].kp is -1; it must be a finite number >= 0");
  EXPECT_EQ(usage_error_of([&] { joints[1].get(number("kd")); }),
            "q1.toml:3: arm.joints[1].kd is missing; it must be a finite number");
}

TEST(Config, NamesTheTableOfAMissingKey) {
  const ConfigTable config = parse("x = 1\n\n[task]\n[deep.er]\n");
  EXPECT_EQ(usage_error_of([&] {
              config.get_table(table("task")).get(number("speed_m_per_s", {.lower = 0}));
            }),
            "q1.toml:3: task.speed_m_per_s is missing; it must be a finite number >= 0");
  EXPECT_EQ(usage_error_of([&] { config.get(text("name")); }),
            "q1.toml:1: name is missing; it must be a string");
  EXPECT_EQ(usage_error_of([&] { config.get(choice("kind", kKinds)); }),
            "q1.toml:1: kind is missing; it must be one of these strings: ga, random");
  EXPECT_EQ(usage_error_of([&] {
              config.get_table(table("deep")).get(integer("n", {.lower = 1, .upper = 2}));
            }),
            "q1.toml:4: deep.n is missing; it must be an integer from 1 to 2");
  EXPECT_EQ(
      usage_error_of([&] {
        config.get_table_or_empty(table("absent")).get_table_or_empty(table("a")).get(boolean("b"));
      }),
      "q1.toml:1: absent.a.b is missing; it must be true or false");
}

TEST(Config, AsksWhetherAMistypedKeyIsTheMissingOne) {
  const ConfigTable task = parse("[task]\nsped = 1\n").get_table(table("task"));
  EXPECT_EQ(usage_error_of([&] { task.get(number("speed_m_per_s")); }),
            "q1.toml:1: task.speed_m_per_s is missing; it must be a finite number (is task.sped in "
            "q1.toml:2 "
            "meant?)");
}

TEST(Config, ListsTheChoicesAndTheNearest) {
  const ConfigTable config = parse("[optimizer]\nkind = \"gaa\"\nother = 3\n");
  const ConfigTable optimizer = config.get_table(table("optimizer"));
  EXPECT_EQ(usage_error_of([&] { optimizer.get(choice("kind", kKinds)); }),
            "q1.toml:2: unknown optimizer.kind 'gaa'; did you mean 'ga'? Valid: ga, random");
  EXPECT_EQ(
      usage_error_of([&] { optimizer.get(choice("other", kKinds, "ga")); }),
      "q1.toml:3: optimizer.other is 3, an integer; it must be one of these strings: ga, random");
}

TEST(Config, NamesTheCommandThatListsManyChoicesAndKeys) {
  std::vector<std::string> words;
  for (int i = 1; i <= 13; ++i) {
    words.push_back(fmt::format("word{}", i));
  }
  const Setting<std::string> quantity{"quantity", one_of(words), kNoDefault, ""};
  const SettingTable one{.key = "one", .is_array = true, .settings = {&quantity}};
  const SettingTable file{.key = "", .tables = {&one}, .listed_as = "study:"};
  const ConfigTable table =
      ConfigTable::parse(file, "[[one]]\nquantity = \"word\"\n", "q1.toml").get_tables(one)[0];
  EXPECT_EQ(usage_error_of([&] { table.get(quantity); }),
            "q1.toml:2: unknown one[0].quantity 'word'; did you mean 'word1'? Valid: word1, word2, "
            "word3 and 10 more, which 'armwright list settings study:one[].quantity' lists");
  // Choices that depend on the document are not listed there.
  words.push_back("word14");
  EXPECT_THAT(usage_error_of([&] { table.get(quantity.among(words)); }),
              testing::EndsWith("word3 and 11 more"));

  std::vector<Setting<double>> settings;
  SettingTable many{.key = "", .listed_as = ""};
  for (const std::string& word : words) {
    settings.emplace_back(word, std::nullopt, "");
  }
  for (const Setting<double>& setting : settings) {
    many.settings.push_back(&setting);
  }
  const ConfigTable flat = ConfigTable::parse(many, "wurd7 = 1\n", "q1.toml");
  for (const Setting<double>& setting : settings) {
    flat.has(setting);
  }
  EXPECT_EQ(
      usage_error_of([&] { flat.refuse_unknown(); }),
      "q1.toml:1: unknown key wurd7; did you mean 'word7'? Valid here: word7, word1, word2 and "
      "11 more, which 'armwright list settings' lists");
}

TEST(Config, RefusesEveryKeyNobodyAskedFor) {
  const ConfigTable config =
      parse("[task]\nspeed_m_per_s = 1\nsped = 2\n\n[tsk]\nx = 1\n[[joints]]\na = 1\nzzz = 2\n");
  const ConfigTable task = config.get_table(table("task"));
  task.get(number("speed_m_per_s"));
  task.has("optional");
  task.get(number("limit_n_m", {}, 1));
  config.get_tables(array("joints"))[0].get(number("a"));
  EXPECT_EQ(usage_error_of([&] { config.refuse_unknown(); }),
            "q1.toml:3: unknown key task.sped; did you mean 'task.speed_m_per_s'? Valid here: "
            "speed_m_per_s, "
            "optional, limit_n_m\n"
            "q1.toml:5: unknown key tsk; did you mean 'task'? Valid here: task, joints\n"
            "q1.toml:9: unknown key joints[0].zzz. Valid here: a");
}

TEST(Config, ATableThatWasNeverFetchedIsUnknown) {
  const ConfigTable config = parse("[task]\n[[joints]]\n");
  EXPECT_EQ(usage_error_of([&] { config.refuse_unknown(); }),
            "q1.toml:1: unknown key task. Valid here: (none)\nq1.toml:2: unknown key joints. Valid "
            "here: (none)");
  config.get_table(table("task"));
  config.get_tables_or_empty(array("joints"));
  config.refuse_unknown();
}

TEST(Config, WhatATableRefusesIsOnlyWhatLiesInIt) {
  const ConfigTable config = parse("stray = 1\n[task]\nx = 1\n");
  const ConfigTable task = config.get_table(table("task"));
  task.get(number("x"));
  task.refuse_unknown();
  EXPECT_EQ(usage_error_of([&] { config.refuse_unknown(); }),
            "q1.toml:1: unknown key stray. Valid here: task");
}

TEST(Config, ShowsOnlyTheFirstOfManyUnknownKeys) {
  std::string toml;
  for (int i = 0; i < 20; ++i) {
    toml += fmt::format("k{} = 1\n", i);
  }
  const std::string message = usage_error_of([&] { parse(toml).refuse_unknown(); });
  EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 8);
  EXPECT_TRUE(message.starts_with("q1.toml:1: unknown key k0.")) << message;
  EXPECT_TRUE(message.ends_with("\nand 12 more unknown keys")) << message;
}

TEST(Config, RefusesForReasonsOfTheCaller) {
  const ConfigTable task = parse("[task]\nx = [1, 2]\n").get_table(table("task"));
  EXPECT_EQ(usage_error_of([&] { task.refuse("x", "it must have three elements"); }),
            "q1.toml:2: task.x is [1, 2]; it must have three elements");
  EXPECT_EQ(usage_error_of([&] { task.refuse("y", "x needs it"); }),
            "q1.toml:1: task.y is missing; x needs it");
}

TEST(Config, MessagesArePrintableAndShort) {
  const ConfigTable config = parse("\"a\\u001b[31m\" = 1\nlong = \"" + std::string(500, 'x') +
                                   "\"\nescape = \"\\u001b[31m\"\nlines = '''a\nb'''\n");
  EXPECT_EQ(
      usage_error_of([&] { config.get(number("long")); }),
      "q1.toml:2: long is \"" + std::string(59, 'x') + "..., a string; it must be a finite number");
  EXPECT_EQ(usage_error_of([&] { config.get(choice("escape", kKinds)); }),
            "q1.toml:3: unknown escape '?[31m'. Valid: ga, random");
  EXPECT_EQ(usage_error_of([&] { config.get(number("lines")); }),
            "q1.toml:4: lines is '''a?b''', a string; it must be a finite number");
  EXPECT_EQ(usage_error_of([&] { config.get(boolean("a\x1b[31m")); }),
            "q1.toml:1: \"a?[31m\" is 1, an integer; it must be true or false");
}

TEST(Config, FindsValuesBehindLettersBeyondAscii) {
  const ConfigTable config = parse("a = { b = \"žluťoučký\", c = 12 }\r\n# ž\r\nd = 34\r\n");
  EXPECT_EQ(usage_error_of([&] { config.get_table(table("a")).get(boolean("c")); }),
            "q1.toml:1: a.c is 12, an integer; it must be true or false");
  EXPECT_EQ(usage_error_of([&] { config.get(boolean("d")); }),
            "q1.toml:3: d is 34, an integer; it must be true or false");
}

TEST(Config, WritesCanonicalJson) {
  const ConfigTable config = parse(R"(
z = 1
a = [0.1, 2.0, 1e300, -0.0, 3, true, 1979-05-27]
big = 9007199254740993
"key \"q\"" = "ž\u0001\n"
[m.n]
[[t]]
y = 1
x = {}
)");
  EXPECT_EQ(
      config.to_json(),
      "{\"a\":[0.1,2.0,1e+300,-0.0,3,true,\"1979-05-27\"],\"big\":9007199254740993,"
      "\"key \\\"q\\\"\":\"ž\\u0001\\n\",\"m\":{\"n\":{}},\"t\":[{\"x\":{},\"y\":1}],\"z\":1}");
  EXPECT_EQ(nlohmann::json::parse(config.to_json())["big"], 9007199254740993);
  EXPECT_EQ(config.get_table(table("m")).to_json(), "{\"n\":{}}");
  EXPECT_EQ(parse("b = 1\na = 2\n").to_json(), parse("a = 0x2 # two\n\nb = 1").to_json());
}

// A locale's decimal comma must not reach the parser, neither through C++ streams nor through the C
// library.
class DecimalComma : public std::numpunct<char> {
 protected:
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

void expect_numbers_read_and_written_with_a_point() {
  const ConfigTable config = parse("x = 1234.5\nn = 1_234_567\n");
  EXPECT_EQ(config.get(number("x")), 1234.5);
  EXPECT_EQ(config.get(integer("n", {.lower = 0, .upper = 10000000})), 1234567);
  EXPECT_EQ(config.to_json(), R"({"n":1234567,"x":1234.5})");
  EXPECT_EQ(usage_error_of([&] { config.get(number("x", {.upper = 1000.5})); }),
            "q1.toml:1: x is 1234.5; it must be a finite number <= 1000.5");
}

TEST(Config, IgnoresTheLocaleOfCppStreams) {
  const std::locale before =
      std::locale::global(std::locale(std::locale::classic(), new DecimalComma));
  expect_numbers_read_and_written_with_a_point();
  std::locale::global(before);
}

TEST(Config, IgnoresTheLocaleOfTheCLibrary) {
  const char* found = nullptr;
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "cs_CZ.UTF-8", "fr_FR.UTF-8", "de_DE"}) {
    found = found == nullptr ? std::setlocale(LC_ALL, name) : found;
  }
  if (found == nullptr) {
    GTEST_SKIP()
        << "no locale with a decimal comma is installed (de_DE.UTF-8, cs_CZ.UTF-8, fr_FR.UTF-8)";
  }
  ASSERT_STREQ(std::localeconv()->decimal_point, ",");
  expect_numbers_read_and_written_with_a_point();
  std::setlocale(LC_ALL, "C");
}

TEST(Config, TwoDefaultsForOneKeyMayDiffer) {
  const ConfigTable config = parse("x = 1\n");
  EXPECT_EQ(config.get_or(number("x", {}, 7), 8), 1);
  EXPECT_EQ(config.get_or(number("y", {}, 7), 8), 8);
  EXPECT_EQ(config.find(number("x")), 1);
  EXPECT_EQ(config.find(number("y")), std::nullopt);
  EXPECT_EQ(config.get_choice(choice("kind", kKinds, "random")), 1U);
}

TEST(Config, ReadsDeclaredSettingsOnly) {
  const auto speed = number("speed");
  const auto count = integer("count", {.lower = 0});
  SettingTable joint = array("joint");
  joint.settings = {&count};
  SettingTable task = table("task");
  task.settings = {&speed};
  task.tables = {&joint};
  const SettingTable file{.key = "", .tables = {&task}};
  const ConfigTable config = ConfigTable::parse(
      file, "[task]\nspeed = 1\nsped = 2\n[[task.joint]]\ncount = 3\n", "q1.toml");
  const ConfigTable inner = config.get_table(task);
  EXPECT_EQ(inner.get(speed), 1);
  EXPECT_EQ(inner.get(number("speed", {.upper = 1})), 1) << "a narrower range is the same setting";
  EXPECT_EQ(inner.get_tables(joint).at(0).get(count), 3);
  EXPECT_THROW(inner.get(number("sped")), std::logic_error);
  EXPECT_THROW(inner.get_or(number("absent"), 1), std::logic_error);
  EXPECT_THROW(inner.find(count), std::logic_error);
  EXPECT_THROW(inner.has(count), std::logic_error);
  EXPECT_THROW(inner.settle(number("absent"), 1), std::logic_error);
  EXPECT_THROW(inner.get_tables(joint).at(0).get(speed), std::logic_error);
  EXPECT_THROW(config.get_table(table("task")), std::logic_error) << "another declaration";
  EXPECT_THROW(config.get_table_or_empty(table("absent")), std::logic_error);
  EXPECT_THROW(config.get_tables_or_empty(joint), std::logic_error);
}

TEST(Config, SettledValuesAreInTheJsonAndNowhereElse) {
  const ConfigTable config = parse("a = 1\n[task]\nspeed = 'auto'\n");
  const ConfigTable task = config.get_table(table("task"));
  task.settle(text("speed"), "slow");
  task.settle(numbers("home"), {1.5, -0.0, 2e20});
  const ConfigTable absent = config.get_table_or_empty(table("absent"));
  absent.settle(number("whole"), 2.0);
  absent.settle(integer("count", {}), 3);
  config.settle(text("name"), "x");
  EXPECT_EQ(config.to_json(), R"({"a":1,"absent":{"count":3,"whole":2},"name":"x",)"
                              R"("task":{"home":[1.5,0,2e+20],"speed":"slow"}})");
  EXPECT_EQ(task.to_json(), R"({"home":[1.5,0,2e+20],"speed":"slow"})");
  EXPECT_EQ(task.get(text("speed")), "auto");
  EXPECT_FALSE(task.has("home"));
  EXPECT_FALSE(config.has("absent"));
}

TEST(Config, LeftOutKeysAreMissingInTheJsonOnly) {
  const ConfigTable config = parse("a = 1\n[task]\nspeed = 'auto'\nhome = [1, 2]\n");
  const ConfigTable task = config.get_table(table("task"));
  task.leave_out(text("speed"));
  task.leave_out(text("gone"));
  EXPECT_EQ(config.to_json(), R"({"a":1,"task":{"home":[1,2]}})");
  EXPECT_EQ(task.get(text("speed")), "auto");
}

// A file without the table and a file with nothing but the key have the same record.
TEST(Config, TablesWithLeftOutKeysOnlyAreMissingInTheJson) {
  for (const char* file : {"a = 1\n", "a = 1\n[task]\nspeed = 'auto'\n"}) {
    const ConfigTable config = parse(file);
    const ConfigTable task = config.get_table_or_empty(table("task"));
    task.leave_out(text("speed"));
    task.leave_out(text("gone"));
    EXPECT_EQ(config.to_json(), R"({"a":1})");
    task.settle(text("name"), "x");
    EXPECT_EQ(config.to_json(), R"({"a":1,"task":{"name":"x"}})");
  }
  const ConfigTable empty = parse("[task]\n");
  empty.get_table(table("task")).leave_out(text("speed"));
  EXPECT_EQ(empty.to_json(), R"({"task":{}})");
}

TEST(Config, SettlesWhatAnotherDocumentHasAndThisOneLacks) {
  const ConfigTable config = parse("[plant]\na = 1\n");
  const ConfigTable plant = config.get_table(table("plant"));
  plant.settle_missing(parse("a = 2\nb = 0.0\nc = 0\nd = ['x', true]\n"));
  EXPECT_EQ(config.to_json(), R"({"plant":{"a":1,"b":0.0,"c":0,"d":["x",true]}})");
}

}  // namespace
}  // namespace armwright
