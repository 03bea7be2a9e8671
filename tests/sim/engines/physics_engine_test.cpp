#include "sim/tracking/physics_engine.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "base/expect_error.hpp"
#include "sim/engines/engine_table.hpp"
#include "sim/simd/simd_level.hpp"

namespace armwright {
namespace {

// A row of an engine with lanes, for tests that only choose an engine.
EngineRow make_row_with_simd() {
  return {"lanes", "of a test", true, nullptr};
}

TEST(SimdLevel, NamesReadBack) {
  EXPECT_EQ(simd_names(), (std::vector<std::string>{"scalar", "sse2", "avx2", "avx512"}));
  for (const std::string& name : simd_names()) {
    EXPECT_EQ(to_string(parse_simd(name)), name);
  }
  EXPECT_THAT(usage_error_of([] { parse_simd("avx"); }),
              testing::HasSubstr("unknown SIMD level 'avx'; did you mean 'avx2'?"));
}

TEST(SimdLevel, TheBestIsTheLastOfThoseThatAreSupported) {
  ::unsetenv("ARMWRIGHT_SIMD");  // a user may ask for less
  const auto supported = supported_simd_names();
  EXPECT_EQ(supported.front(), "scalar");
  EXPECT_EQ(supported.back(), to_string(find_best_simd()));
  for (const std::string& name : simd_names()) {
    EXPECT_EQ(is_supported(parse_simd(name)),
              std::find(supported.begin(), supported.end(), name) != supported.end())
        << name;
  }
#if defined(__x86_64__)
  EXPECT_TRUE(is_supported(SimdLevel::sse2));
#else
  EXPECT_EQ(supported, std::vector<std::string>{"scalar"});
#endif
}

TEST(SimdLevel, TheEnvironmentMayAskForLess) {
  ::setenv("ARMWRIGHT_SIMD", "scalar", 1);
  EXPECT_EQ(find_best_simd(), SimdLevel::scalar);
  ::setenv("ARMWRIGHT_SIMD", "avx512", 1);  // above what this CPU may support
  EXPECT_TRUE(is_supported(find_best_simd()));
  ::setenv("ARMWRIGHT_SIMD", "avx", 1);
  EXPECT_THAT(usage_error_of([] { find_best_simd(); }),
              testing::HasSubstr("unknown SIMD level in ARMWRIGHT_SIMD 'avx'; did you mean"));
  ::setenv("ARMWRIGHT_SIMD", "", 1);
  EXPECT_EQ(to_string(find_best_simd()), supported_simd_names().back());
  ::unsetenv("ARMWRIGHT_SIMD");
}

TEST(EngineOptions, PrecisionsReadBack) {
  EXPECT_EQ(precision_names(), (std::vector<std::string>{"double", "float"}));
  EXPECT_EQ(parse_precision("double"), Precision::double_);
  EXPECT_EQ(parse_precision("float"), Precision::single);
  EXPECT_THAT(usage_error_of([] { parse_precision("half"); }),
              testing::HasSubstr("unknown precision 'half'"));
}

TEST(EngineOptions, OdeTakesOneJobAtATimeAndHasNothingToChoose) {
  const BatchSize size = make_engine("ode")->batch_size();
  EXPECT_EQ(size.granularity, 1U);
  EXPECT_EQ(size.largest, 1U);
  EXPECT_FALSE(resolve_options(find_engine("ode"), {}).simd.has_value());
  const auto make_ode = [](EngineOptions options) {
    return usage_error_of([&] { make_engine("ode", options); });
  };
  EXPECT_THAT(
      make_ode({.precision = Precision::single, .simd = {}}),
      testing::HasSubstr("precision is 'float', but engine 'ode' always computes in double"));
  EXPECT_THAT(make_ode({.precision = Precision::double_, .simd = SimdLevel::scalar}),
              testing::HasSubstr("SIMD level is 'scalar', but engine 'ode' has none to choose"));
  EXPECT_THAT(usage_error_of([] { make_engine("odd"); }),
              testing::HasSubstr("unknown engine 'odd'; did you mean 'ode'?"));
}

TEST(EngineOptions, AnEngineWithSimdGetsTheBestLevelUnlessToldOtherwise) {
  EXPECT_EQ(resolve_options(make_row_with_simd(), {}).simd, find_best_simd());
  const EngineOptions chosen = resolve_options(
      make_row_with_simd(), {.precision = Precision::single, .simd = SimdLevel::scalar});
  EXPECT_EQ(chosen.simd, SimdLevel::scalar);
  EXPECT_EQ(chosen.precision, Precision::single);
}

TEST(EngineOptions, ALevelThatTheCpuLacksIsRefusedWithThosePossible) {
  if (supported_simd_names().size() == simd_names().size()) {
    GTEST_SKIP() << "this CPU has every level";
  }
  const EngineOptions options{.precision = Precision::double_, .simd = SimdLevel::avx512};
  EXPECT_THAT(
      usage_error_of([&] { resolve_options(make_row_with_simd(), options); }),
      testing::HasSubstr("SIMD level is 'avx512', which this CPU lacks; possible here: scalar"));
}

}  // namespace
}  // namespace armwright
