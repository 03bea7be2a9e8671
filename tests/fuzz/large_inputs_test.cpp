// Inputs that are large in one way each: what no small corpus holds, and fuzzers, which begin with
// small ones, hardly find. Each is read or refused soon, and with a message that fits a screen.
#include <gtest/gtest.h>

#include <ctime>
#include <functional>
#include <string>

#include "fuzz/harness.hpp"

namespace armwright::fuzz {
namespace {

constexpr std::size_t kMiB = std::size_t{1} << 20;
constexpr double kLongestRead_s =
    30;  // of processor time; work that grows with the square of its input takes hours

std::string repeat(std::size_t count, const std::function<std::string(std::size_t)>& make) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) {
    text += make(i);
  }
  return text;
}

std::string repeat(std::size_t count, const std::string& text) {
  return repeat(count, [&](std::size_t) { return text; });
}

void expect_soon(void (*run)(std::string_view), const std::string& input, const char* what) {
  const std::clock_t before = std::clock();
  EXPECT_NO_THROW(run(input)) << what;
  EXPECT_LT(static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC, kLongestRead_s) << what;
}

TEST(LargeInputs, NestedJson) {
  const std::string arrays = repeat(200'000, "[");
  const std::string objects = repeat(100'000, "{\"a\":");
  for (const auto run :
       {fuzz_records, fuzz_manifest, fuzz_export_json, fuzz_test_cases, fuzz_messages}) {
    expect_soon(run, arrays, "arrays");
    expect_soon(run, objects, "objects");
    expect_soon(run, "{\"configuration\":" + arrays, "within");
    expect_soon(
        run, "{\"format\":1,\"build\":{},\"configuration\":" + arrays + repeat(200'000, "]") + "}",
        "closed");
    expect_soon(run, arrays + repeat(200'000, "]"), "closed, alone");
  }
}

TEST(LargeInputs, NestedToml) {
  for (const auto run : {fuzz_problem, fuzz_study, fuzz_design}) {
    expect_soon(run, "a = " + repeat(kMiB / 2, "["), "arrays");
    expect_soon(run, "a = " + repeat(kMiB / 8, "{a="), "tables");
    expect_soon(run, repeat(kMiB / 4, "a.") + "a = 1", "dots");
    expect_soon(run, "[" + repeat(kMiB / 4, "a.") + "a]", "a header's dots");
  }
}

TEST(LargeInputs, LongNames) {
  const std::string name(kMiB / 2, 'x');
  expect_soon(fuzz_problem, "kind = \"" + name + "\"", "a word");
  expect_soon(fuzz_problem, "kind = \"analytic\"\n" + name + " = 1", "a key");
  expect_soon(fuzz_problem, "extends = \"" + name + "\"", "a file");
  expect_soon(fuzz_study, "optimizers = [\"" + name + "\"]\nproblems = [\"sphere\"]\nbudget = 9",
              "an optimizer");
  expect_soon(fuzz_design, "controller = \"" + name + "\"", "a controller");
  expect_soon(fuzz_export_csv, name, "a column");
  expect_soon(fuzz_log, name + ",time_s,time\n", "a column of a log");
  expect_soon(fuzz_log, "time_s,position_1\n0," + name, "a number of a log");
  expect_soon(fuzz_records, "{\"format\":\"" + name + "\"}", "a format");
  const std::string value = "\"" + name + "\"";
  expect_soon(fuzz_messages, R"({"type":"description","protocol":)" + value + "}", "a version");
  expect_soon(fuzz_urdf, "<" + name + "/>", "an element");
  expect_soon(
      fuzz_urdf,
      "<robot name=" + value + "><link name=" + value + "/><link name=" + value + "/></robot>",
      "names");
}

TEST(LargeInputs, ManyColumnsAndRecordsOfLogs) {
  expect_soon(fuzz_log, repeat(9'000, "position_1,") + "time\n", "columns");
  expect_soon(fuzz_log, repeat(200'000, "a,"), "too many columns");
  const std::string record("\x07\0\0\0\0\0\0\0\0", 9);
  expect_soon(fuzz_log, std::string("\x89MCAP0\r\n\1\0\0\0\0\0\0\0\0", 17) + repeat(kMiB, record),
              "records");
  // A topic of 64 letters per record.
  expect_soon(fuzz_log,
              std::string("\x89MCAP0\r\n\1\0\0\0\0\0\0\0\0", 17) +
                  repeat(40'000,
                         [](std::size_t i) {
                           const std::string topic = std::to_string(i) + std::string(64, 't');
                           std::string content("\0\0\0\0", 4);
                           content += static_cast<char>(topic.size());
                           content += std::string(3, '\0') + topic + std::string(8, '\0');
                           std::string head("\4\0\0\0\0\0\0\0\0", 9);
                           head[1] = static_cast<char>(content.size());
                           return head + content;
                         }),
              "topics");
}

TEST(LargeInputs, ManyKeys) {
  const auto make_key = [](std::size_t i) { return "k" + std::to_string(i) + " = 1\n"; };
  const std::string keys = repeat(80'000, make_key);
  expect_soon(fuzz_problem, "kind = \"analytic\"\nfunction.name = \"sphere\"\n" + keys,
              "unknown keys");
  expect_soon(fuzz_design, keys, "unknown keys");
  expect_soon(fuzz_study, "budget = 9\nproblems = [\"sphere\"]\noptimizers = [\"random\"]\n" + keys,
              "unknown keys");
  expect_soon(fuzz_problem, repeat(60'000, "[[variables]]\n"), "an array of tables");
}

TEST(LargeInputs, ManyElements) {
  const std::string body =
      "<inertial><mass value='2'/><inertia ixx='0.2' iyy='0.2' izz='0.1' ixy='0' ixz='0' "
      "iyz='0'/></inertial>";
  const std::string colors = repeat(20'000, [](std::size_t i) {
    return "<material name='m" + std::to_string(i) + "'><color rgba='1 0 0 1'/></material>";
  });
  expect_soon(fuzz_urdf,
              "<robot name='a'>" + colors +
                  "<link name='w'><visual><geometry><sphere radius='1'/>" +
                  "</geometry><material name='m'/></visual></link></robot>",
              "materials");
  const std::string long_color =
      "<material name='" + std::string(4 * kMiB, 'm') + "'><color rgba='1 0 0 1'/></material>";
  expect_soon(fuzz_urdf,
              "<robot name='a'>" + long_color + "<link name='w'><visual><geometry><sphere " +
                  "radius='1'/></geometry><material name='m'/></visual></link></robot>",
              "a long material");
  std::string chain = "<link name='l0'/>";
  for (int i = 1; i < 900; ++i) {
    const std::string number = std::to_string(i);
    chain += "<link name='l" + number + "'>" + body + "</link><joint name='j" + number +
             "' type='continuous'><parent link='l" + std::to_string(i - 1) + "'/><child link='l" +
             number + "'/></joint>";
  }
  expect_soon(fuzz_urdf, "<robot name='a'>" + chain + "</robot>", "a chain");
}

TEST(LargeInputs, Studies) {
  const std::string head = "budget = 100\nstart_spread = 1.0\nbaselines = false\n";
  const auto make_problem = [](std::size_t i) {
    return "[[problem]]\nname = \"sphere\"\nlabel = \"p" + std::to_string(i) + "\"\n";
  };
  const auto make_optimizer = [](std::size_t i) {
    return "[[optimizer]]\nname = \"random\"\nlabel = \"o" + std::to_string(i) + "\"\n";
  };
  expect_soon(fuzz_study, head + "optimizers = [\"random\"]\n" + repeat(10'000, make_problem),
              "problems");
  expect_soon(fuzz_study, head + "problems = [\"sphere\"]\n" + repeat(10'000, make_optimizer),
              "optimizers");
  expect_soon(fuzz_study,
              head + "replicates = 10000\n" + repeat(20, make_problem) + repeat(20, make_optimizer),
              "cells");
  expect_soon(fuzz_study,
              "budget = 1000000000\nreplicates = 10000\nbaselines = false\noptimizers = [\"ga\"]\n"
              "problems = [\"q1-complex\"]\nschedule = \"fresh:1000\"\n"
              "set = [\"sets.test_cases=1000000\"]\n",
              "test cases");
}

TEST(LargeInputs, Tables) {
  expect_soon(fuzz_export_csv, std::string(8 * kMiB, ','), "columns");
  expect_soon(fuzz_export_csv, std::string(8 * kMiB, '\n'), "rows");
  expect_soon(fuzz_export_csv, "\"" + std::string(8 * kMiB, '"'), "quotes");
  expect_soon(fuzz_test_cases, "case,point,x_m,y_m,z_m\n" + repeat(kMiB, "0,0,1,2,3\n"), "rows");
  expect_soon(fuzz_test_cases, "{\"cases\":[" + repeat(kMiB, "[],") + "]}", "empty cases");
}

}  // namespace
}  // namespace armwright::fuzz
