// The sources of a configuration: files, the files that they extend, and overrides.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/config.hpp"
#include "base/expect_error.hpp"
#include "base/file.hpp"
#include "base/some_settings.hpp"
#include "base/temporary_folder.hpp"

namespace armwright {
namespace {

class ConfigFiles : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, std::string_view toml) const {
    write_file_atomically(folder_.path() / name, toml);
    return folder_.path() / name;
  }
  std::string at(const std::string& name) const { return (folder_.path() / name).string(); }

  TemporaryFolder folder_;
};

TEST_F(ConfigFiles, ReadsAFile) {
  const auto path = write("q1.toml", "x = 1\n");
  const ConfigTable config = ConfigTable::load(path);
  EXPECT_EQ(config.get(number("x")), 1);
  EXPECT_EQ(config.file(), path);
  EXPECT_EQ(config.files(), std::vector<std::filesystem::path>{path});
  EXPECT_EQ(usage_error_of([&] { config.get(boolean("x")); }),
            at("q1.toml") + ":1: x is 1, an integer; it must be true or false");
}

TEST_F(ConfigFiles, SaysThatAFileCannotBeRead) {
  EXPECT_EQ(error_of(ErrorKind::io, [&] { ConfigTable::load(at("no.toml")); }),
            at("no.toml") + ": cannot open it: No such file or directory");
  EXPECT_EQ(error_of(ErrorKind::io, [&] { ConfigTable::load(folder_.path()); }),
            folder_.path().string() + ": cannot read it: Is a directory");
}

TEST_F(ConfigFiles, ExtendsMergesTablesAndReplacesTheRest) {
  const auto base =
      write("base.toml",
            "name = 'base'\n[task]\na = 1\nb = [1, 2, 3]\n[task.deep]\nc = 1\n[[t]]\nx = 1\n");
  const auto middle = write("middle.toml", "extends = 'base'\n[task]\na = 2\n[task.deep]\nd = 2\n");
  const auto top = write("q1.toml", "extends = \"middle\"\nt = []\n[task]\nb = [9]\n");
  const ConfigTable config = ConfigTable::load(top);
  EXPECT_EQ(config.to_json(),
            R"({"name":"base","t":[],"task":{"a":2,"b":[9],"deep":{"c":1,"d":2}}})");
  EXPECT_EQ(config.file(), top);
  EXPECT_EQ(config.files(), (std::vector<std::filesystem::path>{top, middle, base}));
}

TEST_F(ConfigFiles, MessagesNameTheFileWhereTheValueStands) {
  write("base.toml", "\n\n[task]\na = 1\nb = 2\n[only_base]\n");
  const ConfigTable config =
      ConfigTable::load(write("q1.toml", "extends = 'base'\n[task]\nb = 3\n"));
  const ConfigTable task = config.get_table(table("task"));
  EXPECT_EQ(usage_error_of([&] { task.get(boolean("a")); }),
            at("base.toml") + ":4: task.a is 1, an integer; it must be true or false");
  EXPECT_EQ(usage_error_of([&] { task.get(boolean("b")); }),
            at("q1.toml") + ":3: task.b is 3, an integer; it must be true or false");
  EXPECT_EQ(usage_error_of([&] { task.get(boolean("missing")); }),
            at("q1.toml") + ":2: task.missing is missing; it must be true or false");
  EXPECT_EQ(usage_error_of([&] { config.get_table(table("only_base")).get(boolean("missing")); }),
            at("base.toml") + ":6: only_base.missing is missing; it must be true or false");
}

TEST_F(ConfigFiles, UnknownKeysOfAnExtendedFileAreRefusedThere) {
  write("base.toml", "name = 'x'\nnaem = 'y'\n");
  const ConfigTable config = ConfigTable::load(write("q1.toml", "extends = 'base'\n"));
  config.get(text("name"));
  EXPECT_EQ(usage_error_of([&] { config.refuse_unknown(); }),
            at("base.toml") + ":2: unknown key naem; did you mean 'name'? Valid here: name");
}

TEST_F(ConfigFiles, ATypeMayBeReplacedAndIsCheckedAfterwards) {
  write("base.toml", "[task]\nx = 1\n");
  const ConfigTable config = ConfigTable::load(write("q1.toml", "extends = 'base'\ntask = 3\n"));
  EXPECT_EQ(usage_error_of([&] { config.get_table(table("task")); }),
            at("q1.toml") + ":2: task is 3, an integer; it must be a table, [task]");
}

TEST_F(ConfigFiles, RefusesACircle) {
  write("a.toml", "extends = 'b'\n");
  write("b.toml", "\nextends = 'a'\n");
  EXPECT_EQ(usage_error_of([&] { ConfigTable::load(at("a.toml")); }),
            at("b.toml") +
                ":2: extends is 'a'; the files extend each other in a circle: a.toml -> b.toml -> "
                "a.toml");
  write("self.toml", "extends = 'self'\n");
  EXPECT_EQ(
      usage_error_of([&] { ConfigTable::load(at("self.toml")); }),
      at("self.toml") +
          ":1: extends is 'self'; the files extend each other in a circle: self.toml -> self.toml");
}

TEST_F(ConfigFiles, RefusesMoreThanEightSteps) {
  write("f0.toml", "x = 1\n");
  for (int i = 1; i <= 9; ++i) {
    write(fmt::format("f{}.toml", i), fmt::format("extends = 'f{}'\n", i - 1));
  }
  EXPECT_EQ(ConfigTable::load(at("f8.toml")).get(number("x")), 1);
  EXPECT_EQ(
      usage_error_of([&] { ConfigTable::load(at("f9.toml")); }),
      at("f1.toml") +
          ":1: extends is 'f0'; at most 8 files may be extended in a row: f9.toml -> f8.toml -> "
          "f7.toml -> f6.toml -> f5.toml -> f4.toml -> f3.toml -> f2.toml -> f1.toml -> f0.toml");
}

TEST_F(ConfigFiles, ExtendsTakesAPlainNameOnly) {
  const std::string must =
      "; it must be the name of a file in the same folder or of a shipped one, without .toml: "
      "letters, digits, _ - .";
  for (const std::string name : {"../x", "/etc/x", "a/b", "", ".hidden", "..", "a b", "a\\u001b"}) {
    const auto path = write("q1.toml", "extends = \"" + name + "\"\n");
    EXPECT_EQ(usage_error_of([&] { ConfigTable::load(path); }),
              path.string() + ":1: extends is \"" + name + "\"" + must);
  }
  const auto path = write("q1.toml", "extends = 3\n");
  EXPECT_EQ(usage_error_of([&] { ConfigTable::load(path); }),
            path.string() + ":1: extends is 3, an integer" + must);
  EXPECT_EQ(usage_error_of([&] { ConfigTable::parse("extends = 'a'\n", "text"); }),
            "text:1: extends is 'a'; only a file in a folder can extend another");
}

TEST_F(ConfigFiles, SuggestsTheFileThatIsThere) {
  write("base.toml", "");
  write("notes.txt", "");
  const auto path = write("q1.toml", "extends = 'bsae'\n");
  EXPECT_EQ(usage_error_of([&] { ConfigTable::load(path); }),
            path.string() + ":1: unknown file to extend 'bsae'; did you mean 'base'? Valid: base");
}

TEST_F(ConfigFiles, AMistakeInAnExtendedFileIsReportedThere) {
  write("base.toml", "x = 1\ny = \n");
  const auto path = write("q1.toml", "extends = 'base'\n");
  EXPECT_EQ(usage_error_of([&] { ConfigTable::load(path); }),
            at("base.toml") +
                ":2: this is not valid TOML; key-value pair: expected value, saw '\\n' "
                "(q1.toml extends this file)");
}

ConfigTable parse(const std::vector<std::string>& overrides,
                  std::string_view toml = "[task]\nx = 1\n") {
  return ConfigTable::parse(toml, "q1.toml", overrides);
}

TEST(ConfigOverrides, TakeTomlValuesAndBareWords) {
  EXPECT_EQ(parse({"task.x=2"}).to_json(), R"({"task":{"x":2}})");
  EXPECT_EQ(parse({" task.x = -2.5 "}).to_json(), R"({"task":{"x":-2.5}})");
  EXPECT_EQ(parse({"task.x=true"}).to_json(), R"({"task":{"x":true}})");
  EXPECT_EQ(parse({"task.x=[1, 2]"}).to_json(), R"({"task":{"x":[1,2]}})");
  EXPECT_EQ(parse({"task.x=\"two words = 2\""}).to_json(), R"({"task":{"x":"two words = 2"}})");
  EXPECT_EQ(parse({"task.x=libs/my_lib-2.so"}).to_json(), R"({"task":{"x":"libs/my_lib-2.so"}})");
  EXPECT_EQ(parse({"task.x=3", "task.x=4"}).to_json(), R"({"task":{"x":4}})");
}

TEST(ConfigOverrides, MakeTablesAndMergeIntoThem) {
  EXPECT_EQ(parse({"a.b.c=1", "task.y=2"}).to_json(),
            R"({"a":{"b":{"c":1}},"task":{"x":1,"y":2}})");
  EXPECT_EQ(parse({"task={y=2}"}).to_json(), R"({"task":{"x":1,"y":2}})");
}

TEST(ConfigOverrides, AreNamedInPlaceOfTheLine) {
  const ConfigTable config = parse({"task.x=-4", "task.unit=1.5kg", "new.y=1"});
  const ConfigTable task = config.get_table(table("task"));
  EXPECT_EQ(usage_error_of([&] { task.get(number("x", {.lower = 0, .lower_open = true})); }),
            "--set task.x=-4: task.x is -4; it must be a finite number > 0");
  EXPECT_EQ(usage_error_of([&] { task.get(number("unit")); }),
            "--set task.unit=1.5kg: task.unit is 1.5kg, a string; it must be a finite number");
  EXPECT_EQ(usage_error_of([&] { config.get_table(table("new")).get(number("z")); }),
            "--set new.y=1: new.z is missing; it must be a finite number");
  EXPECT_EQ(usage_error_of([&] { task.get(number("z")); }),
            "q1.toml:1: task.z is missing; it must be a finite number");
}

TEST(ConfigOverrides, ATableThatGainsKeysStaysWhereItWas) {
  const ConfigTable config = parse({"task={y=2}"});
  EXPECT_EQ(usage_error_of([&] { config.get_table(table("task")).get(number("z")); }),
            "q1.toml:1: task.z is missing; it must be a finite number");
}

TEST(ConfigOverrides, UnknownKeysAreRefused) {
  const ConfigTable config = parse({"task.xx=4", "tsk.x=1"});
  config.get_table(table("task")).get(number("x"));
  EXPECT_EQ(usage_error_of([&] { config.refuse_unknown(); }),
            "--set task.xx=4: unknown key task.xx; did you mean 'task.x'? Valid here: x\n"
            "--set tsk.x=1: unknown key tsk; did you mean 'task'? Valid here: task");
}

TEST(ConfigOverrides, MalformedOnesAreRefusedWithAnExample) {
  const std::string example = "; write KEY=VALUE, as in --set task.speed_m_per_s=2";
  const auto refusal = [](const std::string& text) {
    return usage_error_of([&] { parse({text}); });
  };
  EXPECT_EQ(refusal(""), "--set : there is no '=' in it" + example);
  EXPECT_EQ(refusal("task.x"), "--set task.x: there is no '=' in it" + example);
  for (const std::string text :
       {"=3", " =3", "task.=3", ".x=3", "a..b=3", "a b=3", "ž=3", "a\n=3"}) {
    EXPECT_TRUE(refusal(text).ends_with(": there is no usable key before the '='" + example))
        << text;
  }
  std::string deep = "a";
  for (int i = 0; i < 64; ++i) {
    deep += ".a";
  }
  EXPECT_TRUE(refusal(deep + "=1").ends_with(": there is no usable key before the '='" + example));
}

TEST(ConfigOverrides, OtherValuesAreRefusedWithTheWayToQuote) {
  for (const std::string value :
       {"", "two words", "exec:python3", "[1, 2", "\"open", "1 2", "a#b"}) {
    EXPECT_EQ(usage_error_of([&] { parse({"task.x=" + value}); }),
              "--set task.x=" + value + ": '" + value +
                  "' is neither a TOML value nor a word of letters, digits, _ - . and /; put text "
                  "in quotes, as in "
                  "--set 'task.x=\"two words\"'");
  }
}

TEST(ConfigOverrides, CannotSmuggleInMore) {
  EXPECT_EQ(usage_error_of([&] { parse({"task.x=1\ny=2"}); }),
            "--set task.x=1?y=2: the value has a control character in it");
  EXPECT_EQ(usage_error_of([&] { parse({"extends=other"}); }),
            "--set extends=other: extends cannot be overridden; name another file instead");
  EXPECT_EQ(usage_error_of([&] { parse({"task.x=nan"}); }),
            "--set task.x=nan: task.x is nan; it must be a finite number");
  EXPECT_EQ(usage_error_of([&] { parse({"task.x=" + std::string(65, '[')}); }),
            "--set task.x=" + std::string(53, '[') +
                "...: tables and arrays nest deeper than 64 levels (each dot in a key is one)");
}

TEST(ConfigOverrides, DoNotReachThroughAValue) {
  EXPECT_EQ(usage_error_of([&] { parse({"task.x.y=1"}); }),
            "--set task.x.y=1: task.x is 1, an integer (q1.toml:2), not a table; nothing below it "
            "can be set");
}

}  // namespace
}  // namespace armwright
