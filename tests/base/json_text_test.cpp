#include "base/json_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/expect_error.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;

std::string nest(std::size_t levels) {
  return std::string(levels, '[') + std::string(levels, ']');
}

TEST(JsonText, MayNestAsDeepAsTheLimit) {
  check_json_depth(nest(kJsonDepthLimit), "a.json");
  check_json_depth(nest(kJsonDepthLimit) + "," + nest(kJsonDepthLimit), "a.json");
}

TEST(JsonText, IsRefusedBeyondItWithTheLine) {
  EXPECT_EQ(error_of(ErrorKind::bad_data,
                     [] { check_json_depth("{}\n\n" + nest(kJsonDepthLimit + 1), "a.json"); }),
            "a.json:3: arrays and objects nest deeper than 64 levels");
}

TEST(JsonText, MayHaveAnyBracketsInStrings) {
  const std::string brackets(1000, '[');
  check_json_depth("[\"" + brackets + "\", \"\\\"" + brackets + "\", \"\\\\\"]", "a.json");
  EXPECT_THAT(
      error_of(ErrorKind::bad_data, [&] { check_json_depth("\"\\\\\"" + brackets, "a.json"); }),
      HasSubstr("nest deeper"));
}

TEST(JsonText, ErrorsLoseTheNumberOfTheLibrary) {
  EXPECT_EQ(describe_json_error("[json.exception.out_of_range.403] key 'a' not found"),
            "key 'a' not found");
  EXPECT_EQ(describe_json_error("[1] is wrong"), "[1] is wrong");
}

// A JSON pointer writes / and ~ of a key as ~1 and ~0.
TEST(Differences, NameKeysAsTheyAre) {
  EXPECT_THAT(describe_differences(R"({"inputs": {"./p~8": 1}, "seed": 2})",
                                   R"({"inputs": {"./p~8": 3}, "seed": 2})"),
              testing::ElementsAre("inputs../p~8: recorded 1, now 3"));
}

TEST(Differences, ArePutIntoTextsThatAreObjects) {
  EXPECT_THAT(
      describe_differences(R"({"text": "{\"a\": [1, 2], \"b\": 3}", "more": "{"})",
                           R"({"text": "{\"a\": [1, 7], \"b\": 3}", "more": "[]"})"),
      testing::ElementsAre(R"(more: recorded "{", now "[]")", "text.a.1: recorded 2, now 7"));
  EXPECT_THAT(describe_differences(R"({"text": "{}"})", R"({"text": "{ }"})"),
              testing::ElementsAre(R"(text: recorded "{}", now "{ }")"));
}

}  // namespace
}  // namespace armwright
