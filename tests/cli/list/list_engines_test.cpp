#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "base/expect_error.hpp"
#include "base/text.hpp"
#include "cli/list/list_views.hpp"
#include "problems/lanes_engine.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const std::string kBest = to_string(find_best_simd());

TEST(ListEngines, SaysWhatCanBeChosenHere) {
  const auto items = make_engine_kind(engines_with_lanes()).list();
  ASSERT_EQ(items.size(), 2U);
  EXPECT_EQ(items[0].name, "ode");
  EXPECT_THAT(items[0].summary, Not(HasSubstr("SIMD")));
  EXPECT_EQ(items[1].summary, "made up by a test; SIMD here: " +
                                  join(supported_simd_names(), ", ") + "; default " + kBest);
}

TEST(ListEngines, ExplainsOne) {
  const ListKind kind = make_engine_kind(engines_with_lanes());
  EXPECT_THAT(kind.explain("ode", Style(false)),
              AllOf(HasSubstr("ode: "), HasSubstr("it computes in double")));
  EXPECT_THAT(kind.explain("lanes", Style(false)),
              AllOf(HasSubstr("lanes: made up by a test"), HasSubstr("--simd LEVEL"),
                    HasSubstr("default " + kBest), HasSubstr("double, float")));
  EXPECT_THAT(usage_error_of([&] { kind.explain("lane", Style(false)); }),
              HasSubstr("unknown engine 'lane'; did you mean 'lanes'?"));
}

TEST(ListEngines, AsJson) {
  const json all = make_engine_kind(engines_with_lanes()).list_as_json();
  ASSERT_EQ(all.size(), 2U);
  EXPECT_TRUE(all[0].at("simd").is_null());
  EXPECT_EQ(all[0].at("precisions"), json({"double"}));
  EXPECT_EQ(all[1].at("simd").at("supported"), supported_simd_names());
  EXPECT_EQ(all[1].at("simd").at("chosen"), kBest);
  EXPECT_EQ(all[1].at("precisions"), json({"double", "float"}));
  EXPECT_EQ(make_engine_kind(engines_with_lanes()).explain_as_json("lanes"), all[1]);
}

TEST(ListEngines, TheRealOnesUnlessToldOtherwise) {
  const auto items = make_engine_kind().list();
  ASSERT_EQ(items.size(), engine_table().size());
  EXPECT_EQ(items.front().name, "ode");
}

}  // namespace
}  // namespace armwright
