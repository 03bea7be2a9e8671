#include "optimizers/interface/optimizer.hpp"

#include <gmock/gmock.h>

#include "base/expect_error.hpp"
#include "optimizers/interface/scalar_function.hpp"
#include "optimizers/table/optimizer_table.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;
using testing::UnorderedElementsAre;

const std::vector<OptionSpec> kSpecs = {
    {.name = "size", .description = "", .fallback = std::int64_t{35}, .lower = 2, .upper = 100},
    {.name = "rate", .description = "", .fallback = 0.25, .lower = 0, .upper = 1.5},
    {.name = "restart", .description = "", .fallback = false},
    {.name = "method",
     .description = "",
     .fallback = std::string("full"),
     .choices = {"full", "diagonal"}},
    {.name = "label", .description = "", .fallback = std::string()},
};

Options parse(std::vector<std::string> assignments) {
  return Options::parse("demo", kSpecs, assignments);
}

std::string refusal_of(const std::string& assignment) {
  return usage_error_of([&] { parse({assignment}); });
}

TEST(Options, WhatIsNotGivenHasItsDefault) {
  const Options options = parse({});
  EXPECT_EQ(options.get_integer("size"), 35);
  EXPECT_EQ(options.get_number("rate"), 0.25);
  EXPECT_FALSE(options.get_bool("restart"));
  EXPECT_EQ(options.get_text("method"), "full");
  EXPECT_EQ(options.values().size(), 5u);
}

TEST(Options, GivenValuesAreReadByTheirType) {
  const Options options =
      parse({"rate=1e-1", "size=2", "restart=true", "method=diagonal", "label=a=b, c"});
  EXPECT_EQ(options.get_integer("size"), 2);
  EXPECT_EQ(options.get_number("rate"), 0.1);
  EXPECT_TRUE(options.get_bool("restart"));
  EXPECT_EQ(options.get_text("method"), "diagonal");
  EXPECT_EQ(options.get_text("label"), "a=b, c");
}

TEST(Options, TheEndsOfARangeBelongToIt) {
  EXPECT_EQ(parse({"size=100"}).get_integer("size"), 100);
  EXPECT_EQ(parse({"rate=1.5"}).get_number("rate"), 1.5);
  EXPECT_EQ(parse({"rate=0"}).get_number("rate"), 0);
}

TEST(Options, UnknownNamesListTheValidOnes) {
  EXPECT_EQ(refusal_of("sise=3"),
            "optimizer 'demo': unknown option 'sise'; did you mean 'size'? "
            "Valid: size, rate, restart, method, label");
  EXPECT_EQ(usage_error_of([] { Options::parse("none", {}, std::vector<std::string>{"a=1"}); }),
            "optimizer 'none': unknown option 'a'. Valid: (none)");
}

TEST(Options, AMissingValueIsRefused) {
  EXPECT_EQ(refusal_of("size"), "optimizer 'demo': option 'size' has no value; write NAME=VALUE");
}

TEST(Options, DuplicatesAreRefused) {
  EXPECT_EQ(usage_error_of([] {
              parse({"size=3", "rate=1", "size=4"});
            }),
            "optimizer 'demo': option 'size' is given twice, as '3' and as '4'; give it once");
}

TEST(Options, WrongTypesAndRangesAreRefused) {
  for (const char* text : {"1", "101", "3.5", "3 ", "", "1e-1", "99999999999999999999"}) {
    EXPECT_EQ(refusal_of(std::string("size=") + text),
              "optimizer 'demo': option 'size' is '" + std::string(text) +
                  "'; it must be an integer between 2 and 100");
  }
  for (const char* text : {"-0.1", "1.6", "nan", "inf", "0,5", "half"}) {
    EXPECT_EQ(refusal_of(std::string("rate=") + text),
              "optimizer 'demo': option 'rate' is '" + std::string(text) +
                  "'; it must be a number between 0 and 1.5");
  }
  EXPECT_EQ(refusal_of("restart=yes"),
            "optimizer 'demo': option 'restart' is 'yes'; it must be true or false");
  EXPECT_EQ(refusal_of("method=fast"),
            "optimizer 'demo': option 'method' is 'fast'; it must be one of: full, diagonal");
}

TEST(Options, MessagesCarryNoControlCharacters) {
  EXPECT_EQ(refusal_of("method=\x1b[31m"),
            "optimizer 'demo': option 'method' is '?[31m'; it must be one of: full, diagonal");
}

TEST(OptionText, ReadsBackAsTheSameValue) {
  EXPECT_EQ(to_text(true), "true");
  EXPECT_EQ(to_text(false), "false");
  EXPECT_EQ(to_text(std::int64_t{-3}), "-3");
  EXPECT_EQ(to_text(0.1), "0.1");
  EXPECT_EQ(to_text(std::string("full")), "full");
}

TEST(Seed, FoldsWithoutLosingSmallOnes) {
  EXPECT_EQ(fold_seed(0), 0u);
  EXPECT_EQ(fold_seed(4294967295), 4294967295u);
  EXPECT_EQ(fold_seed((5ULL << 32) + 3), 5u ^ 3u);
}

TEST(OptimizerTable, HoldsTheBuiltInOptimizers) {
  EXPECT_THAT(optimizer_names(), testing::IsSupersetOf({"ga", "random"}));
  EXPECT_EQ(find_optimizer("random").name, "random");
  EXPECT_THAT(usage_error_of([] { find_optimizer("gaa"); }),
              testing::MatchesRegex("unknown optimizer 'gaa'; did you mean 'ga'\\? Valid: ga, .* "
                                    "more, which 'armwright list optimizers' lists"));
  for (const auto& [typed, name] : {std::pair{"CMA-ES", "cmaes"},
                                    {"Nelder-Mead", "nlopt:neldermead"},
                                    {"NLOPT:Cobyla", "nlopt:cobyla"},
                                    {"NSGA-2", "pagmo:nsga2"},
                                    {"BOBYQA", "nlopt:bobyqa"}}) {
    EXPECT_THAT(usage_error_of([&] { find_optimizer(typed); }),
                testing::HasSubstr("did you mean '" + std::string(name) + "'?"));
  }
}

TEST(OptimizerTable, AProgramOfTheUserNeedsExec) {
  for (const char* name : {"mine.py", "./mine.py", "python3 mine.py", "python3"}) {
    EXPECT_EQ(usage_error_of([&] { load_optimizer(name); }),
              std::string("unknown optimizer '") + name +
                  "'; a program of your own needs exec: before its command, as in --optimizer "
                  "\"exec:python3 mine.py\"");
  }
}

}  // namespace
}  // namespace armwright
