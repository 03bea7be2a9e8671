// armwright as a library of another program: the public headers and libarmwright alone.
#include "armwright/run.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "armwright/plugin.hpp"  // both may be used in one program

namespace {

using armwright::problem::Answer;
using armwright::problem::Case;
using armwright::problem::Description;
using armwright::problem::Point;
using armwright::run::Outcome;
using armwright::run::RunError;
using armwright::run::Settings;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// A bowl whose minimum is at (1, 2), with a limit that holds there.
class Bowl : public armwright::problem::Problem {
 public:
  Description describe() const override {
    Description all;
    all.name = "bowl";
    all.variables = {armwright::problem::real("a", "m", -5, 5),
                     armwright::problem::real("b", "m", -5, 5)};
    all.objectives = {{"height", "m", is_maximised, 1, is_maximised ? -1000.0 : 1000.0}};
    all.constraints = {{"reach", "m", 10}};
    return all;
  }
  Answer evaluate(const Point& x, const Case& /*one*/) override {
    ++evaluations;
    if (x[0] > 4) {
      throw std::runtime_error("too far");
    }
    const double value = (x[0] - 1) * (x[0] - 1) + (x[1] - 2) * (x[1] - 2);
    Answer answer(is_maximised ? -value : value);
    answer.constraints = {std::abs(x[0])};
    if (has_wrong_count) {
      answer.metrics = {1};
    }
    return answer;
  }

  bool is_maximised = false;
  bool has_wrong_count = false;
  std::atomic<int> evaluations = 0;
};

class LibraryRun : public testing::Test {
 protected:
  ~LibraryRun() override { std::filesystem::remove_all(folder_); }

  Settings make_settings(const std::string& name) const {
    Settings settings;
    settings.optimizer = "cmaes";
    settings.budget = 600;
    settings.folder = folder_ / name;
    return settings;
  }
  std::string read(const std::string& name) const {
    std::ifstream file(folder_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  // Returns the message of the RunError that a run with these settings throws.
  std::string get_refusal(const Settings& settings, int code) {
    try {
      armwright::optimize(bowl_, settings);
    } catch (const RunError& error) {
      EXPECT_EQ(error.code(), code);
      return error.what();
    }
    return "no RunError";
  }

  std::filesystem::path folder_ = std::filesystem::temp_directory_path() /
                                  ("armwright-library-test-" + std::to_string(getpid()));
  Bowl bowl_;
};

TEST_F(LibraryRun, ReturnsTheWinner) {
  const Outcome outcome = armwright::optimize(bowl_, make_settings("a"));
  EXPECT_TRUE(outcome.is_finished);
  EXPECT_EQ(outcome.folder, folder_ / "a");
  EXPECT_TRUE(outcome.is_feasible);
  // 600 evaluations of a quadratic function of two variables reach far less than 1e-6.
  EXPECT_THAT(outcome.x, ElementsAre(DoubleNear(1, 1e-3), DoubleNear(2, 1e-3)));
  EXPECT_THAT(outcome.objectives, ElementsAre(DoubleNear(0, 1e-6)));
  EXPECT_THAT(outcome.constraints, ElementsAre(DoubleNear(std::abs(outcome.x[0]), 1e-12)));
  EXPECT_THAT(read("a/manifest.json"), HasSubstr("host:bowl"));
}

TEST_F(LibraryRun, AMaximisedObjectiveKeepsItsDirection) {
  bowl_.is_maximised = true;
  const Outcome outcome = armwright::optimize(bowl_, make_settings("a"));
  EXPECT_LE(outcome.objectives.at(0), 0);
  EXPECT_GT(outcome.objectives.at(0), -1e-6);
}

TEST_F(LibraryRun, ThreadsAndEarlyEndsDoNotChangeTheResult) {
  armwright::optimize(bowl_, make_settings("whole"));
  Settings settings = make_settings("resumed");
  settings.jobs = 3;
  const int before = bowl_.evaluations;
  settings.must_stop = [&] { return bowl_.evaluations > before + 100; };
  const Outcome stopped = armwright::optimize(bowl_, settings);
  EXPECT_FALSE(stopped.is_finished);
  EXPECT_THAT(stopped.x, IsEmpty());
  settings.must_stop = {};
  EXPECT_TRUE(armwright::optimize(bowl_, settings).is_finished);
  EXPECT_EQ(read("whole/result.json"), read("resumed/result.json"));
  const int after = bowl_.evaluations;
  armwright::optimize(bowl_, settings);  // a finished run is only read
  EXPECT_EQ(bowl_.evaluations, after);
}

TEST_F(LibraryRun, ACallbackHearsOfTheRunAndItsExceptionEndsIt) {
  Settings settings = make_settings("a");
  double done = 0;
  settings.on_progress = [&](const armwright::run::Progress& progress) {
    done = std::max(done, static_cast<double>(progress.done));
  };
  armwright::optimize(bowl_, settings);
  EXPECT_EQ(done, 600);
  settings.folder = folder_ / "b";
  settings.on_progress = [](const armwright::run::Progress& /*progress*/) {
    throw std::logic_error("of the callback");
  };
  EXPECT_THROW(armwright::optimize(bowl_, settings), std::logic_error);
}

TEST_F(LibraryRun, RefusesWithTheMessagesOfTheCommandLine) {
  Settings settings = make_settings("a");
  settings.optimizer = "cmas";
  EXPECT_THAT(get_refusal(settings, ARMWRIGHT_RUN_USAGE), HasSubstr("did you mean 'cmaes'?"));
  settings = make_settings("a");
  settings.options = {"sigma=-1"};
  EXPECT_THAT(get_refusal(settings, ARMWRIGHT_RUN_USAGE), HasSubstr("sigma"));
  settings = make_settings("a");
  settings.schedule = "sometimes";
  EXPECT_THAT(get_refusal(settings, ARMWRIGHT_RUN_USAGE),
              HasSubstr("the schedule is 'sometimes'; it must be"));
  settings = make_settings("a");
  settings.budget = -1;
  EXPECT_THAT(get_refusal(settings, ARMWRIGHT_RUN_USAGE), HasSubstr("the budget is -1"));
  for (const double limit_s : {-1.0, std::nan(""), HUGE_VAL}) {
    settings = make_settings("a");
    settings.time_limit_s = limit_s;
    EXPECT_THAT(get_refusal(settings, ARMWRIGHT_RUN_USAGE),
                HasSubstr("; it must be from 0, which stands for no limit, to 1000000000"));
  }
  settings = make_settings("a");
  settings.settings = {"sets.tests=3"};
  EXPECT_THAT(get_refusal(settings, ARMWRIGHT_RUN_USAGE), HasSubstr("sets.tests"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a"));
}

TEST_F(LibraryRun, RefusesARunOfAnotherProblem) {
  armwright::optimize(bowl_, make_settings("a"));
  bowl_.is_maximised = true;
  EXPECT_THAT(get_refusal(make_settings("a"), ARMWRIGHT_RUN_USAGE),
              HasSubstr("holds a run with another configuration"));
}

TEST_F(LibraryRun, AnAnswerThatBreaksTheContractEndsTheRun) {
  bowl_.has_wrong_count = true;
  EXPECT_THAT(get_refusal(make_settings("a"), ARMWRIGHT_RUN_BAD_DATA),
              HasSubstr("it answered with 1 metrics; its description has 0"));
}

TEST_F(LibraryRun, ExceptionsOfTheProblemAreFailedCases) {
  Settings settings = make_settings("a");
  settings.optimizer = "random";
  const Outcome outcome = armwright::optimize(bowl_, settings);
  // One tenth of the box fails. The chance that none of 600 uniform points lies there is 1e-27.
  EXPECT_GT(outcome.failed_evaluations, 0u);
  EXPECT_TRUE(outcome.is_finished);
}

TEST(LibraryRunInC, RefusesRequestsThatAreNone) {
  char message[200];
  EXPECT_EQ(armwright_run(nullptr, nullptr, message, sizeof message), ARMWRIGHT_RUN_USAGE);
  const armwright_run_result* result = nullptr;
  EXPECT_EQ(armwright_run(nullptr, &result, message, sizeof message), ARMWRIGHT_RUN_USAGE);
  EXPECT_THAT(message, HasSubstr("the request is NULL"));
  armwright_run_request request{};
  request.struct_size = sizeof request;
  EXPECT_EQ(armwright_run(&request, &result, message, sizeof message), ARMWRIGHT_RUN_USAGE);
  EXPECT_THAT(message, HasSubstr("the problem of this program"));
  EXPECT_EQ(result, nullptr);
  armwright_free_result(nullptr);
}

}  // namespace
