#include "optimizers/plugins/plugin_process.hpp"

#include <dirent.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

#include "base/expect_error.hpp"
#include "base/hash.hpp"
#include "base/temporary_folder.hpp"
#include "optimizers/plugins/plugin_messages.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "problems/analytic/analytic.hpp"
#include "process/command_words.hpp"
#include "process/line_process.hpp"
#include "study/contract/contract_checks.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

std::string script(const std::string& name) {
  return std::string(ARMWRIGHT_TEST_DATA) + "/../plugins/" + name;
}

std::string faulty(const std::string& fault) {
  return "exec:python3 " + script("faulty.py") + " " + fault;
}

const std::string kGood = "exec:python3 '" + script("good.py") + "'";

int count_descriptors() {
  int count = 0;
  DIR* folder = opendir("/proc/self/fd");
  while (readdir(folder) != nullptr) {
    ++count;
  }
  closedir(folder);
  return count;
}

// Zombies too.
bool has_children() {
  siginfo_t info;
  return waitid(P_ALL, 0, &info, WEXITED | WNOHANG | WNOWAIT) == 0;
}

std::string read_text(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

void minimize(const std::string& command, Evaluator& evaluator, std::uint64_t seed = 1,
              const std::vector<std::string>& options = {}) {
  const OptimizerRow row = load_optimizer(command);
  row.make(Options::parse(row.name, row.options, options))->minimize(evaluator, seed);
}

// Nothing is left behind, whatever happened.
class PluginProcess : public testing::Test {
 protected:
  void TearDown() override {
    EXPECT_EQ(count_descriptors(), descriptors_);
    EXPECT_FALSE(has_children());
  }

  MemoryEvaluator run(const std::string& command, const MemoryEvaluatorSettings& settings,
                      std::uint64_t seed = 1, const std::vector<std::string>& options = {}) const {
    MemoryEvaluator evaluator(*problem_, settings);
    minimize(command, evaluator, seed, options);
    return evaluator;
  }

  std::string failure_of(const std::string& fault, const std::vector<std::string>& options = {}) {
    MemoryEvaluator evaluator(*problem_, {.budget = 1000000});
    try {
      minimize(faulty(fault), evaluator, 1, options);
    } catch (const OptimizerFailure& failure) {
      const std::string text = failure.what();
      EXPECT_THAT(text,
                  AllOf(HasSubstr("optimizer 'faulty' (exec:python3 "), HasSubstr("evaluation")));
      return text;
    }
    ADD_FAILURE() << "no OptimizerFailure";
    return "";
  }

  std::string refusal_of(const std::string& fault) {
    return error_of(ErrorKind::bad_data, [&] { load_optimizer(faulty(fault)); });
  }

  const Problem& problem() const { return *problem_; }

 private:
  int descriptors_ = count_descriptors();
  std::unique_ptr<Problem> problem_ = make_analytic("sphere", 3);
};

TEST_F(PluginProcess, TheRowIsWhatThePluginSaysOfItself) {
  const OptimizerRow row = load_optimizer(kGood);
  EXPECT_EQ(row.name, "lcg");
  EXPECT_EQ(row.summary, "Points of a linear congruential generator");
  EXPECT_EQ(row.source, "Press et al. 1992, Numerical Recipes");
  EXPECT_TRUE(row.capabilities.bounds && row.capabilities.batch && row.capabilities.stochastic &&
              row.capabilities.generations && row.capabilities.sampling);
  EXPECT_FALSE(row.capabilities.constraints || row.capabilities.multi_objective ||
               row.capabilities.noisy || row.capabilities.residuals || row.capabilities.local ||
               row.capabilities.paced);
  std::vector<std::string> names;
  std::ranges::transform(row.options, std::back_inserter(names), &OptionSpec::name);
  EXPECT_THAT(names,
              ElementsAre("batch", "share", "kind", "flag", "silence_s", "memory_mib", "log"));
  EXPECT_EQ(row.options[0].fallback, OptionValue(std::int64_t{5}));
  EXPECT_EQ(row.options[1].fallback, OptionValue(0.5));
  EXPECT_THAT(row.options[2].choices, ElementsAre("a", "b"));
  EXPECT_EQ(row.options[3].fallback, OptionValue(false));
  EXPECT_THAT(
      row.input_hashes,
      ElementsAre(std::pair(script("good.py"), calc_sha256_hex(read_text(script("good.py"))))));
}

TEST_F(PluginProcess, AsksForThePointsOfItsAlgorithmToTheLastBit) {
  const MemoryEvaluator evaluator = run(kGood, {.budget = 58}, 12345, {"batch=8"});
  ASSERT_EQ(evaluator.trace().size(), 58u);
  std::uint32_t state = 12345;
  for (std::size_t k = 0; k < evaluator.trace().size(); ++k) {
    std::vector<double> expected;
    for (const DecisionVariable& v : problem().description().variables) {
      if (k == 0) {
        expected.push_back(v.start);
        continue;
      }
      state = 1664525u * state + 1013904223u;
      expected.push_back(v.lower + state / 4294967296.0 * (v.upper - v.lower));
    }
    ASSERT_EQ(evaluator.trace()[k].asked, expected) << "evaluation " << k;
  }
  EXPECT_THAT(evaluator.batch_sizes(), ElementsAre(1, 8, 8, 8, 8, 8, 8, 8, 8));
  EXPECT_EQ(evaluator.generations(), 9);
  EXPECT_EQ(evaluator.calls_after_stop(), 0);
}

TEST_F(PluginProcess, SeesTheTypesOfVariablesThatItDeclares) {
  const TemporaryFolder folder;
  const auto find_seen = [&](const std::string& capabilities) {
    const std::string command = "exec:python3 '" + script("typed.py") + "' bounds " + capabilities;
    const OptimizerRow row = load_optimizer(command);
    const auto problem = make_contract_problems(row).back();
    MemoryEvaluator evaluator(*problem, {.budget = 5, .capabilities = row.capabilities});
    minimize(command, evaluator, 1, {"log=" + (folder / "log").string()});
    EXPECT_EQ(evaluator.trace().size(), 1u);
    return read_text(folder / "log");
  };
  EXPECT_THAT(find_seen("integer categorical"),
              HasSubstr("oil category 0.0 4.0 ['thin', 'light', 'medium', 'heavy', 'thick']\n"
                        "gain None -5.0 5.0 None\nteeth integer -9.0 30.0 None\n"
                        "turns integer 1.0 2000.0 None\n"));
  EXPECT_THAT(find_seen("integer"), HasSubstr("oil integer 0.0 4.0 None\n"));
  EXPECT_THAT(find_seen(""), HasSubstr("oil None -0.5 4.5 None\ngain None -5.0 5.0 None\n"
                                       "teeth None -9.5 30.5 None\nturns None 0.5 2000.5 None\n"));
}

TEST_F(PluginProcess, TheSameSeedGivesTheSameTraceAndAnotherSeedAnother) {
  const auto first = run(kGood, {.budget = 100}, 3).trace();
  EXPECT_EQ(run(kGood, {.budget = 100}, 3).trace(), first);
  EXPECT_NE(run(kGood, {.budget = 100}, 4).trace(), first);
}

TEST_F(PluginProcess, RecommendsTheBestPointWithItsBitsUnchanged) {
  const MemoryEvaluator evaluator = run(kGood, {.budget = 60, .fail_every = 3});
  ASSERT_EQ(evaluator.recommended().size(), 1u);
  const auto best = std::ranges::find_if(evaluator.trace(), [&](const auto& entry) {
    return entry.score.objectives[0] == *evaluator.best();
  });
  EXPECT_EQ(evaluator.recommended()[0], best->asked);
}

TEST_F(PluginProcess, AStoppedEvaluatorStartsNothing) {
  EXPECT_TRUE(run(kGood, {.budget = 0}).trace().empty());
}

TEST_F(PluginProcess, WhatTheEvaluatorThrowsComesOutUnchanged) {
  MemoryEvaluator evaluator(problem(), {.budget = 100, .throw_at = 30});
  try {
    minimize(kGood, evaluator);
    ADD_FAILURE() << "nothing was thrown";
  } catch (const OptimizerFailure&) {
    ADD_FAILURE() << "the evaluator's exception became another";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "the evaluator is broken");
  }
}

TEST_F(PluginProcess, WhoDoesNotStopIsKilledAfterASecond) {
  for (const char* fault : {"never-stops", "sleeps-when-stopped", "fails-when-stopped"}) {
    const MemoryEvaluator evaluator = run(faulty(fault), {.budget = 20});
    EXPECT_EQ(evaluator.trace().size(), 20u) << fault;
    EXPECT_EQ(evaluator.calls_after_stop(), 0) << fault;
  }
}

TEST_F(PluginProcess, AStopWhileItThinksIsNoticed) {
  // Stopped by the clock, as time limits and Ctrl-C do it, not by an evaluation.
  class Impatient : public MemoryEvaluator {
   public:
    using MemoryEvaluator::MemoryEvaluator;
    bool stopped() const override {
      return MemoryEvaluator::stopped() || (!trace().empty() && ++looks_ > 5);
    }

   private:
    mutable int looks_ = 0;
  };
  Impatient evaluator(problem(), {.budget = 1000});
  minimize(faulty("silent"), evaluator);
  EXPECT_EQ(evaluator.trace().size(), 1u);
}

TEST_F(PluginProcess, EveryFaultIsNamed) {
  EXPECT_THAT(failure_of("silent", {"silence_s=2"}),
              HasSubstr("silent for 2 s (option silence_s)"));
  EXPECT_THAT(failure_of("drip", {"silence_s=2"}),
              HasSubstr("has begun a line and not ended it within 2 s"));
  EXPECT_THAT(failure_of("exit"),
              AllOf(HasSubstr("after 1 evaluation: "), HasSubstr("ended with exit code 3")));
  EXPECT_THAT(failure_of("no-done"), HasSubstr("ended with exit code 0"));
  EXPECT_THAT(failure_of("exit-after-done"), HasSubstr("ended with exit code 3 after it was done"));
  EXPECT_THAT(failure_of("crash"), HasSubstr("killed by signal 11 (Segmentation fault)"));
  EXPECT_THAT(failure_of("closed", {"silence_s=2"}), HasSubstr("closed its standard output"));
  EXPECT_THAT(failure_of("memory", {"memory_mib=100"}),
              AllOf(HasSubstr("MiB of memory"), HasSubstr("100 MiB are allowed")));
  EXPECT_THAT(failure_of("two-faces"), HasSubstr("describes itself differently"));
}

TEST_F(PluginProcess, EveryBadMessageIsNamed) {
  EXPECT_THAT(failure_of("not-json"),
              AllOf(HasSubstr("not JSON: 'iteration 1: ?[31mfine?[0m yyy"), HasSubstr("yyy'...")));
  EXPECT_THAT(failure_of("no-type"), HasSubstr("no object with a \"type\": '[1, 2]'"));
  EXPECT_THAT(failure_of("unknown-type"), HasSubstr("unknown type 'tell'"));
  EXPECT_THAT(failure_of("deep"), HasSubstr("nested more than 16 deep: '{\"type\""));
  EXPECT_THAT(failure_of("length"),
              HasSubstr("point 2 of 2 of 2 coordinates; the problem has 3 variables"));
  EXPECT_THAT(failure_of("nan"), HasSubstr("JSON knows no NaN"));
  EXPECT_THAT(failure_of("null"), AllOf(HasSubstr("coordinate 1 ("), HasSubstr("is 'null'")));
  EXPECT_THAT(failure_of("huge-number"), HasSubstr("not JSON"));
  EXPECT_THAT(failure_of("outside"),
              AllOf(HasSubstr("\"bounds\""), HasSubstr("is 1000000, outside")));
  EXPECT_THAT(failure_of("no-points"), HasSubstr("asked for no points"));
  EXPECT_THAT(failure_of("recommend-length"), HasSubstr("a recommended point of 1 coordinates"));
  EXPECT_THAT(failure_of("chatter"), HasSubstr("recommendations without a question"));
  EXPECT_THAT(failure_of("long-line"), HasSubstr("a line of more than 64 MiB"));
}

TEST_F(PluginProcess, WhoAsksWithoutReadingAnswersIsGivenUp) {
  EXPECT_THAT(failure_of("deaf", {"silence_s=2"}), HasSubstr("has not read its input for 2 s"));
}

TEST_F(PluginProcess, TheTimeForItsDescriptionIsNoOption) {
  const TemporaryFolder folder;
  const std::string command = faulty("late " + (folder / "mark").string()).substr(5);
  const OptimizerRow row = load_process_plugin(command, 3);
  MemoryEvaluator evaluator(problem(), {.budget = 10});
  try {
    row.make(Options::parse(row.name, row.options, {}))->minimize(evaluator, 1);
    ADD_FAILURE() << "no OptimizerFailure";
  } catch (const OptimizerFailure& failure) {
    EXPECT_THAT(failure.what(), AllOf(HasSubstr("silent for 3 s, asked to describe itself"),
                                      Not(HasSubstr("silence_s"))));
  }
}

TEST_F(PluginProcess, WhatItStartedIsKilledWithIt) {
  const TemporaryFolder folder;
  const std::string file = (folder / "pid").string();
  EXPECT_THAT(failure_of("children " + file), HasSubstr("exit code 5"));
  const pid_t child = std::stoi(read_text(file));
  // Killed, it is init's to reap; until then it is a zombie. The signal needs a moment.
  const auto is_dead = [&] {
    const std::string status = read_text("/proc/" + std::to_string(child) + "/stat");
    return status.empty() || status.find(") Z") != std::string::npos ||
           status.find(") X") != std::string::npos;
  };
  for (int i = 0; i < 1000 && !is_dead(); ++i) {
    usleep(10000);
  }
  EXPECT_TRUE(is_dead());
}

TEST_F(PluginProcess, TheLogTakesItsStandardError) {
  const TemporaryFolder folder;
  run(faulty("notes"), {.budget = 20}, 1, {"log=" + (folder / "log").string()});
  EXPECT_EQ(read_text(folder / "log"), "a note\n");
  MemoryEvaluator evaluator(problem(), {.budget = 20});
  EXPECT_THAT(
      error_of(ErrorKind::io, [&] { minimize(faulty("notes"), evaluator, 1, {"log=/none/log"}); }),
      HasSubstr("/none/log"));
}

TEST_F(PluginProcess, TheLogIsOpenedByTheRunAndLeavesNoneOfAnEarlierOne) {
  const TemporaryFolder folder;
  const std::filesystem::path wanted = folder / "log";
  const OptimizerRow row = load_optimizer(faulty("notes"));
  const auto optimizer = row.make(
      Options::parse(row.name, row.options, std::vector<std::string>{"log=" + wanted.string()}));
  EXPECT_FALSE(std::filesystem::exists(wanted));
  std::ofstream(folder / "optimizer.log") << "of an earlier run";
  optimizer->log_to(folder / "optimizer.log");
  EXPECT_FALSE(std::filesystem::exists(folder / "optimizer.log"));
  EXPECT_FALSE(std::filesystem::exists(wanted));
  MemoryEvaluator evaluator(problem(), {.budget = 20});
  optimizer->minimize(evaluator, 1);
  EXPECT_EQ(read_text(wanted), "a note\n");
}

TEST_F(PluginProcess, ABadDescriptionIsRefused) {
  EXPECT_THAT(refusal_of("protocol"), AllOf(HasSubstr("version '7'"), HasSubstr("version 1")));
  EXPECT_THAT(refusal_of("capability"), HasSubstr("unknown capability 'bonds'; did you mean"));
  EXPECT_THAT(refusal_of("shipped-name"), HasSubstr("calls itself 'ga'"));
  EXPECT_THAT(refusal_of("bad-name"), HasSubstr("named '../x'"));
  EXPECT_THAT(refusal_of("own-option"), HasSubstr("option 'log'; every process has one"));
  EXPECT_THAT(refusal_of("option-range"), HasSubstr("outside its range 5 to 9"));
  EXPECT_THAT(refusal_of("no-range"), HasSubstr("option 'k' without \"lower\""));
  const auto refusal_of_option = [this](const std::string& json) {
    return refusal_of("option '{\"name\": \"k\", " + json + "}'");
  };
  EXPECT_THAT(refusal_of_option(R"("default": 18446744073709551615, "lower": -1, "upper": 1e20)"),
              HasSubstr("option 'k' whose \"default\" is '18446744073709551615', not an integer"));
  EXPECT_THAT(refusal_of_option(R"("default": 3, "lower": 0.5, "upper": 9)"),
              HasSubstr("option 'k' whose \"lower\" is '0.5', not an integer up to 2^53"));
  EXPECT_THAT(refusal_of_option(R"("default": 3, "lower": 0, "upper": 1e300)"),
              HasSubstr("option 'k' whose \"upper\" is '1e+300', not an integer"));
  EXPECT_THAT(refusal_of_option(R"("default": "a", "choices": {"x": "a"})"),
              HasSubstr("\"choices\" are '{\"x\":\"a\"}', not a list of texts"));
  EXPECT_THAT(refusal_of_option(R"("default": "a", "choices": "a")"),
              HasSubstr("\"choices\" are '\"a\"', not a list of texts"));
  EXPECT_THAT(refusal_of_option(R"("default": "a", "choices": ["a", 1])"),
              HasSubstr("a choice that is no text: '1'"));
  EXPECT_THAT(refusal_of("greeting"), HasSubstr("'Hello, world'"));
  EXPECT_THAT(refusal_of("deep-greeting"), HasSubstr("nested more than 16 deep"));
  EXPECT_THAT(refusal_of("early-exit"), HasSubstr("ended with exit code 4 before it described"));
}

TEST_F(PluginProcess, ACommandThatIsNoneIsRefused) {
  EXPECT_THAT(usage_error_of([] { load_optimizer("exec:no-such-program-here a"); }),
              AllOf(HasSubstr("'no-such-program-here'"), HasSubstr("No such file")));
  EXPECT_THAT(usage_error_of([] { load_optimizer("exec:"); }), HasSubstr("names no program"));
  EXPECT_THAT(usage_error_of([] { load_optimizer("exec:python3 'x"); }), HasSubstr("not closed"));
}

TEST(PluginMessages, AScoreSaysItsStatusAsTheProtocolHasIt) {
  const std::vector<std::pair<EvaluationStatus, std::string>> names = {
      {EvaluationStatus::ok, "ok"},
      {EvaluationStatus::diverged, "diverged"},
      {EvaluationStatus::unreachable, "unreachable"},
      {EvaluationStatus::timed_out, "timed_out"},
      {EvaluationStatus::failed, "failed"}};
  for (const auto& [status, name] : names) {
    Score score;
    score.status = status;
    EXPECT_THAT(make_tell({{score}}, 1, false, false), HasSubstr("\"status\":\"" + name + "\""));
  }
}

TEST(SplitCommand, FollowsTheShell) {
  EXPECT_THAT(split_command("a  b\tc ", "optimizer"), ElementsAre("a", "b", "c"));
  EXPECT_THAT(split_command(R"(a 'b "c\' "d '\"e" f\ g)", "optimizer"),
              ElementsAre("a", "b \"c\\", "d '\"e", "f g"));
  EXPECT_THAT(split_command(R"(a"b c"'d' "" '$HOME' "\n")", "optimizer"),
              ElementsAre("ab cd", "", "$HOME", "\\n"));
}

}  // namespace
}  // namespace armwright
