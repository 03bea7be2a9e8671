#include "optimizers/plugins/plugin_library.hpp"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <fstream>

#include "base/error.hpp"
#include "base/hash.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "optimizers/test_problems.hpp"
#include "problems/analytic/analytic.hpp"
#include "study/contract/contract_checks.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

std::string plugin(const std::string& name) {
  return std::string(ARMWRIGHT_TEST_PLUGINS) + "/lib" + name + ".so";
}

// Every test ends with no child left.
class PluginLibrary : public testing::Test {
 protected:
  void TearDown() override {
    EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1);
    EXPECT_EQ(errno, ECHILD);
    unsetenv("ARMWRIGHT_TEST_PLUGIN");
    unsetenv("ARMWRIGHT_PLUGINS");
    std::filesystem::remove_all(folder_);
  }

  static std::string refusal_of(const std::string& file,
                                const ProcessLimits& limits = {.silence_s = 20}) {
    try {
      load_library_plugin(file, "", limits);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::bad_data);
      return error.what();
    }
    return "no refusal";
  }

  std::string write(const std::string& name, const std::string& content) {
    std::filesystem::create_directories(folder_);
    std::ofstream(folder_ / name) << content;
    return folder_ / name;
  }

  void run(const std::string& name, std::vector<std::string> assignments, std::uint64_t seed = 1) {
    const OptimizerRow row = load_optimizer(name);
    row.make(Options::parse(row.name, row.options, assignments))->minimize(evaluator_, seed);
  }

  std::string failure_of(std::vector<std::string> assignments) {
    try {
      run(plugin("misbehaving"), std::move(assignments));
    } catch (const OptimizerFailure& failure) {
      return failure.what();
    }
    return "no failure";
  }

  std::unique_ptr<Problem> problem_ = make_analytic("sphere", 3);
  MemoryEvaluator evaluator_{*problem_, {.budget = 200}};
  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("armwright-plugins-" + std::to_string(getpid()));
};

TEST_F(PluginLibrary, ADescriptionBecomesARow) {
  const OptimizerRow row = load_optimizer(plugin("good"));
  EXPECT_EQ(row.name, plugin("good"));
  EXPECT_EQ(row.short_name, "pattern");
  EXPECT_EQ(load_optimizer("multistart:" + row.name).short_name, "multistart:pattern");
  EXPECT_THAT(row.summary, StartsWith("Steps along one variable"));
  EXPECT_THAT(row.source, StartsWith("Hooke, Jeeves 1961"));
  EXPECT_TRUE(row.capabilities.bounds && row.capabilities.stochastic && row.capabilities.local);
  EXPECT_FALSE(row.capabilities.batch || row.capabilities.generations || row.capabilities.paced);
  std::vector<std::string> names;
  for (const OptionSpec& option : row.options) {
    names.push_back(option.name);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"step", "sweeps", "shuffle", "start", "isolate",
                                             "silence_s", "memory_mib", "log"}));
  EXPECT_EQ(row.options[0].upper, 1);
  EXPECT_EQ(row.options[1].fallback, OptionValue(std::int64_t{1000}));
  EXPECT_EQ(row.options[3].choices, (std::vector<std::string>{"start", "middle"}));
  std::ifstream file(plugin("good"), std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  EXPECT_EQ(row.input_hashes,
            (std::map<std::string, std::string>{{"libgood.so", calc_sha256_hex(bytes)}}));
}

TEST_F(PluginLibrary, ItsRunIsTheSameInAProcessOfItsOwnAndHere) {
  run(plugin("good"), {});
  EXPECT_EQ(evaluator_.trace().size(), 200u);
  EXPECT_LT(evaluator_.best().value(), 1e-3);
  EXPECT_EQ(evaluator_.trace().front().asked[0], problem_->description().variables[0].start);
  for (const char* isolate : {"isolate=true", "isolate=false"}) {
    MemoryEvaluator again(*problem_, {.budget = 200});
    const OptimizerRow row = load_optimizer(plugin("good"));
    row.make(Options::parse(row.name, row.options, std::vector<std::string>{isolate}))
        ->minimize(again, 1);
    EXPECT_EQ(again.trace(), evaluator_.trace()) << isolate;
  }
}

// Two weighted objectives, f and 10 f, and residuals.
class Weighted : public ResidualProblem {
 public:
  Weighted()
      : ResidualProblem(
            {{"x", "", -5, 5, 1}, {"y", "", -5, 5, 2}, {"z", "", -5, 5, 3}},
            [](std::span<const double> x) { return std::vector<double>(x.begin(), x.end()); }) {
    description_.objectives = {{"f", "m"}, {"g", "N"}};
    description_.objective_weights = {2, 0.5};
  }
  Evaluation aggregate(std::span<const double> x,
                       std::span<const CaseOutcome> outcomes) const override {
    Evaluation evaluation = ResidualProblem::aggregate(x, outcomes);
    evaluation.objectives.push_back(10 * evaluation.objectives[0]);
    return evaluation;
  }
};

TEST_F(PluginLibrary, InCAndCppItGetsWhatProgramsGet) {
  const Weighted problem;
  for (const char* name : {"late", "c_late"}) {
    for (const char* isolate : {"isolate=true", "isolate=false"}) {
      SCOPED_TRACE(std::string(name) + " " + isolate);
      MemoryEvaluator evaluator(problem, {.budget = 10});
      const OptimizerRow row = load_optimizer(plugin(name));
      EXPECT_TRUE(row.capabilities.residuals);
      EXPECT_EQ(row.requirements.variables, 2);
      row.make(Options::parse(row.name, row.options, std::vector<std::string>{isolate}))
          ->minimize(evaluator, 1);
      // At the start f is 1 + 4 + 9 = 14, and the weighted sum 2 * 14 + 0.5 * 140 = 98.
      EXPECT_EQ(evaluator.recommended(),
                (std::vector<std::vector<double>>{
                    {98, 98, 3}, {1, 14, 3}, {0, 1, 3}, {0, 0, 0}}));  // the last after the end
    }
  }
}

TEST_F(PluginLibrary, OneThatDeclaresThemSeesTheTypesOfVariables) {
  const OptimizerRow row = load_optimizer(plugin("typed"));
  EXPECT_TRUE(row.capabilities.integer && row.capabilities.categorical);
  const auto problem = make_contract_problems(row).back();
  MemoryEvaluator evaluator(*problem, {.budget = 10});
  row.make(Options::parse(row.name, row.options, {}))->minimize(evaluator, 1);
  EXPECT_EQ(evaluator.recommended(),
            (std::vector<std::vector<double>>{
                {2, 0, 4, 5}, {0, -5, 5, 0}, {1, -9, 30, 0}, {1, 1, 2000, 0}}));  // "thick" has 5
  EXPECT_EQ(evaluator.trace().at(0).asked, (std::vector<double>{1, -1.375, 21, 11}));
}

TEST_F(PluginLibrary, OneThatDoesNotDeclareThemSeesRealVariables) {
  const OptimizerRow row = load_optimizer(plugin("good"));
  const auto problem = make_contract_problems(row).back();
  MemoryEvaluator evaluator(*problem, {.budget = 100, .capabilities = row.capabilities});
  row.make(Options::parse(row.name, row.options, std::vector<std::string>{"start=middle"}))
      ->minimize(evaluator, 1);
  EXPECT_EQ(evaluator.trace().at(0).asked, (std::vector<double>{2, 0, 10.5, 1000.5}));
  EXPECT_EQ(evaluator.trace().at(0).evaluated, (std::vector<double>{2, 0, 11, 1001}));
}

TEST_F(PluginLibrary, OneOfVersionOneRunsAsItDid) {
  for (const std::string name : {"good", "c_plugin"}) {
    MemoryEvaluator evaluators[] = {{*problem_, {.budget = 200}}, {*problem_, {.budget = 200}}};
    for (const bool is_old : {false, true}) {
      const OptimizerRow row = load_optimizer(plugin(name + (is_old ? "_v1" : "")));
      EXPECT_FALSE(row.capabilities.residuals);
      EXPECT_EQ(row.requirements.variables, 1);
      row.make(Options::parse(row.name, row.options, {}))->minimize(evaluators[is_old], 1);
    }
    EXPECT_EQ(evaluators[1].trace().size(), 200u);
    EXPECT_EQ(evaluators[1].trace(), evaluators[0].trace());
  }
}

// Only a plugin that was built with the header of version 2.0 gets the weighted sum from
// Evaluator::operator(). The sum of this problem has its minimum where the first objective has its
// maximum.
TEST_F(PluginLibrary, OnlyANewOneSeesTheWeightedSum) {
  class Opposed : public Weighted {
   public:
    Opposed() { description_.objective_weights = {1, -0.2}; }  // f - 2 f
  };
  const Opposed problem;
  const auto last_of = [&](const std::string& name) {
    MemoryEvaluator evaluator(problem, {.budget = 60});
    const OptimizerRow row = load_optimizer(plugin(name));
    row.make(Options::parse(row.name, row.options, {}))->minimize(evaluator, 1);
    return evaluator.trace().back().score.objectives[0];
  };
  EXPECT_LT(last_of("good_v1"), 14);
  EXPECT_GT(last_of("good"), 14);
}

TEST_F(PluginLibrary, SeedAndOptionsReachIt) {
  const auto first_points = [&](std::vector<std::string> assignments, std::uint64_t seed) {
    MemoryEvaluator evaluator(*problem_, {.budget = 20});
    const OptimizerRow row = load_optimizer(plugin("good"));
    row.make(Options::parse(row.name, row.options, assignments))->minimize(evaluator, seed);
    return evaluator.trace();
  };
  EXPECT_NE(first_points({}, 1), first_points({}, 4));
  EXPECT_EQ(first_points({"shuffle=false"}, 1), first_points({"shuffle=false"}, 4));
  EXPECT_NE(first_points({"step=0.1"}, 1), first_points({}, 1));
  EXPECT_EQ(first_points({"sweeps=1"}, 1).size(), 7u);
  const DecisionVariable& first = problem_->description().variables[0];
  EXPECT_EQ(first_points({"start=middle"}, 1)[0].asked[0], 0.5 * (first.lower + first.upper));
}

TEST_F(PluginLibrary, WithoutDeclaredBoundsPointsOutsideAreClipped) {
  run(plugin("c_plugin"), {});
  EXPECT_EQ(evaluator_.trace().size(), 200u);
  EXPECT_EQ(evaluator_.batch_sizes().front(), 10u);
  EXPECT_TRUE(evaluator_.trace().back().score.clipped);
}

TEST_F(PluginLibrary, WhatIsNoPluginIsRefused) {
  EXPECT_THAT(refusal_of("/nowhere/libx.so"),
              StartsWith("/nowhere/libx.so: there is no such file"));
  EXPECT_THAT(refusal_of(write("empty.so", "")),
              AllOf(HasSubstr("is no shared library that can be opened"), HasSubstr("too short")));
  EXPECT_THAT(refusal_of(write("text.so", std::string(5000, 'x'))),
              HasSubstr("invalid ELF header"));
  EXPECT_THAT(refusal_of(plugin("no_symbol")),
              HasSubstr("exports no function 'armwright_plugin'; a plugin defines"));
  EXPECT_THAT(refusal_of(std::string(ARMWRIGHT_TEST_LIBRARIES) + "/libmixed.so"),
              HasSubstr("is a problem and no optimizer; name it as the problem"));
}

TEST_F(PluginLibrary, ImplausibleDescriptionsAreRefused) {
  const std::vector<std::pair<const char*, const char*>> cases = {
      {"null", "armwright_plugin() returned NULL"},
      {"abi", "is built for version 99 of the plugin interface, and this armwright has version 1"},
      {"size", "has 8 bytes"},
      {"no_name", "its name is NULL"},
      {"bad_name", "its name is 'two words'"},
      {"no_minimize", "has no function minimize"},
      {"capabilities", "bits 0x80000000"},
      {"no_options", "says that it has 2 options, and points to none"},
      {"twice", "option 'rate', which there is already"},
      {"ours", "every plugin has isolate, silence_s, memory_mib, log"},
      {"range", "option 'rate': its default is 2, its range from 0 to 1"},
      {"type", "option 'rate': its type is 12"},
      {"integer", "option 'rate': 0.5 is no integer"},
      {"choice", "option 'kind': its default 'one' is not among its choices: two"},
      {"crash", "while it was opened, it was killed by signal 11"},
      {"exit", "while it was opened, it ended its process with exit code 0"},
  };
  for (const auto& [how, message] : cases) {
    setenv("ARMWRIGHT_TEST_PLUGIN", how, 1);
    EXPECT_THAT(refusal_of(plugin("unloadable")),
                AllOf(StartsWith(plugin("unloadable") + ": "), HasSubstr(message)));
  }
  setenv("ARMWRIGHT_TEST_PLUGIN", "hang", 1);
  EXPECT_THAT(refusal_of(plugin("unloadable"), {.silence_s = 0.3}),
              AllOf(HasSubstr("was silent"), Not(HasSubstr("silence_s"))));
  unsetenv("ARMWRIGHT_TEST_PLUGIN");
  EXPECT_EQ(refusal_of(plugin("unloadable")), "no refusal");
}

TEST_F(PluginLibrary, MisbehaviourCostsTheRunAndNotTheProgram) {
  const std::vector<std::pair<const char*, const char*>> cases = {
      {"throw", "threw an exception (out of ideas) after 2 evaluations; what it had asked for"},
      {"fail", "failed with code 7 (the matrix is singular) after 2 evaluations"},
      {"exit", "ended its process with exit code 3"},
      {"segfault", "was killed by signal 11 (Segmentation fault) after 2 evaluations"},
      {"nan", "asked for a point (evaluation 3) with "},
      {"outside", "though it declares that it keeps to the bounds"},
      {"undeclared", "asked for option 'hwo', which it has not declared"},
  };
  for (const auto& [how, message] : cases) {
    EXPECT_THAT(
        failure_of({std::string("how=") + how}),
        AllOf(StartsWith("optimizer '" + plugin("misbehaving") + "' "), HasSubstr(message)));
  }
  EXPECT_THAT(failure_of({"how=loop", "silence_s=0.3"}),
              AllOf(HasSubstr("was silent for more than 0.3"), HasSubstr("(option silence_s)")));
  EXPECT_THAT(failure_of({"how=allocate", "memory_mib=64"}), HasSubstr("memory"));
}

TEST_F(PluginLibrary, ItIsHeldToItsWordHereToo) {
  EXPECT_THAT(failure_of({"how=outside", "isolate=false"}),
              HasSubstr("asked in evaluation 3 for "));
  EXPECT_THAT(failure_of({"how=nan", "isolate=false"}), HasSubstr("which is not a finite number"));
  EXPECT_THAT(failure_of({"how=fail", "isolate=false"}), HasSubstr("failed with code 7"));
  EXPECT_THAT(failure_of({"how=throw", "isolate=false"}), HasSubstr("out of ideas"));
  EXPECT_THAT(failure_of({"how=undeclared", "isolate=false"}), HasSubstr("'hwo'"));
}

TEST_F(PluginLibrary, TheLogIsOpenedByTheRunAndLeavesNoneOfAnEarlierOne) {
  const std::string earlier = write("optimizer.log", "of an earlier run");
  const std::filesystem::path wanted = folder_ / "wanted.log";
  const OptimizerRow row = load_optimizer(plugin("misbehaving"));
  const auto optimizer = row.make(Options::parse(
      row.name, row.options, std::vector<std::string>{"how=fail", "log=" + wanted.string()}));
  optimizer->log_to(earlier);
  EXPECT_FALSE(std::filesystem::exists(earlier));
  EXPECT_FALSE(std::filesystem::exists(wanted));
  EXPECT_THROW(optimizer->minimize(evaluator_, 1), OptimizerFailure);
  EXPECT_GT(std::filesystem::file_size(wanted), 0u);
}

TEST_F(PluginLibrary, APluginThatIgnoresTheEndIsStopped) {
  EXPECT_EQ(failure_of({"how=endless"}), "no failure");
  EXPECT_EQ(evaluator_.trace().size(), 200u);
}

TEST_F(PluginLibrary, TheEvaluatorsExceptionsComeOutUnchanged) {
  const OptimizerRow row = load_optimizer(plugin("good"));
  for (const char* isolate : {"isolate=true", "isolate=false"}) {
    MemoryEvaluator broken(*problem_, {.budget = 10, .throw_at = 2});
    const auto optimizer =
        row.make(Options::parse(row.name, row.options, std::vector<std::string>{isolate}));
    try {
      optimizer->minimize(broken, 1);
      FAIL() << "nothing came out";
    } catch (const OptimizerFailure&) {
      FAIL() << "taken for the optimizer's";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "the evaluator is broken");
    }
  }
}

TEST_F(PluginLibrary, AFileThatHasChangedSinceIsNotCalled) {
  const std::string copy = write("copy.so", "");
  std::filesystem::copy_file(plugin("good"), copy,
                             std::filesystem::copy_options::overwrite_existing);
  const OptimizerRow row = load_optimizer(copy);
  std::ofstream(copy, std::ios::app) << "x";
  try {
    row.make(Options::parse(row.name, row.options, {}))->minimize(evaluator_, 1);
    FAIL() << "it was called";
  } catch (const OptimizerFailure& failure) {
    EXPECT_THAT(failure.what(), HasSubstr("no longer the file"));
  }
}

TEST_F(PluginLibrary, NamesAreLookedForOnThePluginPath) {
  const std::string folders = "/nowhere::" + std::string(ARMWRIGHT_TEST_PLUGINS);
  setenv("ARMWRIGHT_PLUGINS", folders.c_str(), 1);
  EXPECT_EQ(load_optimizer("good").name, "good");
  EXPECT_THAT(load_optimizer("good").summary, StartsWith("Steps along one variable"));
  EXPECT_EQ(load_optimizer("libgood").name, "libgood");
  EXPECT_THAT(load_optimizer("ga").summary, testing::Not(HasSubstr("Steps along")));
  unsetenv("ARMWRIGHT_PLUGINS");
  for (const char* name : {"good", "gaa"}) {
    try {
      load_optimizer(name);
      FAIL() << name << " was found";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      EXPECT_THAT(error.what(), StartsWith("unknown optimizer '" + std::string(name) + "'"));
    }
  }
}

}  // namespace
}  // namespace armwright
