#include "optimizers/plugins/recorded_optimizer.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "base/expect_error.hpp"
#include "optimizers/table/optimizer_table.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;

std::string get_library(const std::string& name) {
  return std::string(ARMWRIGHT_TEST_PLUGINS) + "/lib" + name + ".so";
}

// The options that every plugin has are armwright's own and are not recorded.
void expect_same(const OptimizerRow& recorded, const OptimizerRow& loaded) {
  EXPECT_EQ(recorded.name, loaded.name);
  EXPECT_EQ(recorded.summary, loaded.summary);
  EXPECT_EQ(recorded.source, loaded.source);
  EXPECT_EQ(recorded.description, loaded.description);
  EXPECT_EQ(recorded.requirements.variables, loaded.requirements.variables);
  EXPECT_EQ(recorded.capabilities.local, loaded.capabilities.local);
  EXPECT_EQ(recorded.capabilities.generations, loaded.capabilities.generations);
  EXPECT_EQ(recorded.capabilities.batch, loaded.capabilities.batch);
  std::size_t found = 0;
  for (const OptionSpec& spec : loaded.options) {
    const auto same = std::ranges::find(recorded.options, spec.name, &OptionSpec::name);
    if (same == recorded.options.end()) {
      EXPECT_FALSE(spec.changes_result) << spec.name;
      continue;
    }
    ++found;
    EXPECT_EQ(same->fallback, spec.fallback) << spec.name;
    EXPECT_EQ(same->lower, spec.lower) << spec.name;
    EXPECT_EQ(same->upper, spec.upper) << spec.name;
    EXPECT_EQ(same->choices, spec.choices) << spec.name;
  }
  EXPECT_EQ(found, recorded.options.size());
}

TEST(RecordedOptimizers, APluginIsReadAsItWasLoaded) {
  for (const std::string& name :
       {get_library("good"), "multistart:" + get_library("good"),
        "exec:python3 " + std::string(ARMWRIGHT_TEST_DATA) + "/../plugins/good.py"}) {
    const OptimizerRow loaded = load_optimizer(name);
    ASSERT_NE(loaded.description, "") << name;
    expect_same(read_recorded_plugin(name, loaded.description, {}), loaded);
    EXPECT_TRUE(is_plugin(name)) << name;
  }
  EXPECT_FALSE(is_plugin("ga"));
  EXPECT_FALSE(is_plugin("multistart:nlopt:cobyla"));
  EXPECT_FALSE(is_plugin("python:mine"));
}

TEST(RecordedOptimizers, NamesThatAreNoneAreRefused) {
  EXPECT_THAT(usage_error_of([] { read_recorded_plugin("exec:\x1b[2J", "", {}); }),
              HasSubstr("is not printable UTF-8"));
  std::string deep;
  for (int i = 0; i < 100'000; ++i) {
    deep += "multistart:";
  }
  EXPECT_THAT(usage_error_of([&] { read_recorded_plugin(deep + "x.so", "{}", {}); }),
              HasSubstr("'multistart:' is given twice"));
  EXPECT_THAT(usage_error_of([&] { load_optimizer(deep + "x.so"); }),
              HasSubstr("'multistart:' is given twice"));
}

}  // namespace
}  // namespace armwright
