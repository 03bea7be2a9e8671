// What identify prints, from a hand-written identification.json.
#include "cli/views/identification_view.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace armwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

json make_set(const std::string& log, double p) {
  return {{"logs", {log}},
          {"joints",
           {{{"joint", "joint_1"},
             {"unit", "N m"},
             {"deviation", 30.0},
             {"rms_before", 20.0},
             {"rms_after", 5.0},
             {"whiteness_p", p},
             {"independent_s", 0.4}}}},
          {"error_before", 0.6},
          {"error_after", 0.15}};
}

json make_identification() {
  return {{"doubts", {"the range ends\x1b[2J"}},
          {"undetermined", {"payload.z cannot be told"}},
          {"parameters",
           {{{"name", "payload.z"},
             {"unit", "m"},
             {"before", 0.0},
             {"value", 0.25},
             {"lower", -1.0},
             {"upper", 1.5},
             {"determined", false}}}},
          {"fitted", make_set("a.csv", 0.5)}};
}

TEST(IdentificationView, BeginsWithDoubtsThatAreSafeToPrint) {
  const std::string text =
      describe_identification(make_identification(), "results/x", Style(false));
  EXPECT_THAT(text, StartsWith("doubt: the range ends"));
  EXPECT_THAT(text, Not(HasSubstr("\x1b")));
}

TEST(IdentificationView, SaysWhatCannotBeToldAndHowLongResidualsRepeat) {
  json identification = make_identification();
  std::string text = describe_identification(identification, "results/x", Style(false));
  EXPECT_THAT(text, HasSubstr("-1 to 1.5"));
  EXPECT_THAT(text, HasSubstr("cannot be told"));
  EXPECT_THAT(text, HasSubstr("note: payload.z cannot be told"));
  EXPECT_THAT(text, HasSubstr("Fitted: a.csv"));
  EXPECT_THAT(text, HasSubstr("0.6 -> 0.15 (0.25 times)"));
  EXPECT_THAT(text, HasSubstr("white"));
  EXPECT_THAT(text, Not(HasSubstr("Held back")));
  EXPECT_THAT(text, HasSubstr("Files in results/x"));
  identification["held_back"] = make_set("b.csv", 0.01);
  text = describe_identification(identification, "results/x", Style(false));
  EXPECT_THAT(text, HasSubstr("Held back: b.csv"));
  EXPECT_THAT(text, HasSubstr("not white: they repeat over 0.4 s"));
}

TEST(IdentificationView, NumbersThatDoNotExistAreShownAsSuch) {
  json identification = make_identification();
  identification["fitted"]["error_after"] = nullptr;
  EXPECT_THAT(describe_identification(identification, "x", Style(false)), HasSubstr("0.6 -> nan"));
  identification.erase("parameters");
  EXPECT_THROW(describe_identification(identification, "x", Style(false)), json::exception);
}

}  // namespace
}  // namespace armwright
