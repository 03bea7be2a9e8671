#include "cli/terminal/arguments.hpp"

#include <gmock/gmock.h>

#include "base/expect_error.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

OverrideOptions make_options(bool trains = true) {
  OverrideOptions options;
  options.engines.trains = trains;
  return options;
}

TEST(OverrideOptions, EngineFlagsAreShortForSettings) {
  OverrideOptions options = make_options();
  EXPECT_THAT(options.get(), IsEmpty());
  options.set = {"task.load_kg=3"};
  options.engines.engine = "ode";
  options.engines.judging_engine = "ode";
  options.engines.precision = "float";
  options.engines.simd = "avx2";
  EXPECT_THAT(options.get(),
              ElementsAre("task.load_kg=3", "physics.engine=ode", "physics.judging_engine=ode",
                          "physics.precision=float", "physics.simd=avx2"));
  options.engines = {};
  options.engines.trains = true;
  options.engines.simd = "auto";
  EXPECT_THAT(options.get(), ElementsAre("task.load_kg=3", "physics.simd=auto"));
}

// Without training, --engine replaces the judging engine of the problem.
TEST(OverrideOptions, WithoutTrainingTheEngineIsTheOneThatJudges) {
  OverrideOptions options = make_options(false);
  options.engines.engine = "ode";
  EXPECT_THAT(options.get(), ElementsAre("physics.engine=ode", "physics.judging_engine=ode"));
}

TEST(OverrideOptions, UnknownNamesAreRefusedWithTheNearest) {
  const auto refuse = [](std::string EngineFlags::*flag, const std::string& value) {
    OverrideOptions options = make_options();
    options.engines.*flag = value;
    return usage_error_of([&] { options.get(); });
  };
  EXPECT_THAT(refuse(&EngineFlags::engine, "od"),
              HasSubstr("unknown engine 'od'; did you mean 'ode'?"));
  EXPECT_THAT(refuse(&EngineFlags::judging_engine, "od"), HasSubstr("unknown engine 'od'"));
  EXPECT_THAT(refuse(&EngineFlags::precision, "flota"),
              HasSubstr("unknown precision 'flota'; did you mean 'float'?"));
  EXPECT_THAT(refuse(&EngineFlags::simd, "avx-2"),
              AllOf(HasSubstr("unknown SIMD level 'avx-2'; did you mean 'avx2'?"),
                    HasSubstr("auto, scalar")));
}

TEST(OverrideOptions, AFlagAndASettingOfTheSameKeyContradictEachOther) {
  for (const bool trains : {true, false}) {
    OverrideOptions options = make_options(trains);
    options.set = {"task.load_kg=3", " physics.engine =ode"};
    options.engines.simd = "scalar";
    EXPECT_THAT(options.get(), testing::SizeIs(3));
    options.engines.engine = "ode";
    EXPECT_THAT(usage_error_of([&] { options.get(); }),
                AllOf(HasSubstr("--set  physics.engine =ode"),
                      HasSubstr("means --set physics.engine=ode"), HasSubstr("only one")));
  }
  OverrideOptions judged = make_options(false);
  judged.set = {"physics.judging_engine=ode"};
  judged.engines.engine = "ode";
  EXPECT_THAT(usage_error_of([&] { judged.get(); }), HasSubstr("--set physics.judging_engine=ode"));
}

TEST(OverrideKey, IsWhatStandsBeforeTheEqualsSign) {
  EXPECT_EQ(get_override_key("a.b=c=d"), "a.b");
  EXPECT_EQ(get_override_key("\t a.b  = c"), "a.b");
  EXPECT_EQ(get_override_key("a"), "a");
  EXPECT_EQ(get_override_key("=a"), "");
  EXPECT_EQ(get_override_key("  "), "");
}

TEST(ReadLimitFlag, TakesATimeAMemoryOrBoth) {
  EXPECT_EQ(to_string(parse_read_limit("60s,4GiB")), "60s,4GiB");
  EXPECT_EQ(to_string(parse_read_limit("512MiB,2m")), "120s,512MiB");
  EXPECT_EQ(to_string(parse_read_limit("90")), "90s,1GiB");
  EXPECT_EQ(to_string(parse_read_limit("1.5GiB")), "10s,1.5GiB");
  for (const std::string wrong : {"", "-1s", "0GiB", "4GB", "1s;1GiB", "nanGiB"}) {
    EXPECT_THAT(error_of(ErrorKind::usage, [&] { parse_read_limit(wrong); }),
                HasSubstr("--read-limit (ARMWRIGHT_READ_LIMIT) is '"))
        << wrong;
  }
}

}  // namespace
}  // namespace armwright
