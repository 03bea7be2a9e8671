// run.h for C++17 authors: runs any optimizer on a problem of the program's own, with journal and
// resume. Header only; link with the target armwright::armwright.
//
//     Bowl bowl;  // derived from armwright::problem::Problem (problem.hpp)
//     armwright::run::Settings settings;
//     settings.optimizer = "cmaes";
//     settings.budget = 1000;
//     settings.folder = "results/mine";
//     const armwright::run::Outcome outcome = armwright::optimize(bowl, settings);
//
// In C++20: armwright::optimize(bowl, {.optimizer = "cmaes", .budget = 1000}).
//
// With jobs > 1 several threads call evaluate() at the same time, so it must not change the object
// without a lock. A run that was interrupted or killed continues with the same call.
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "armwright/problem.hpp"
#include "armwright/run.h"

namespace armwright::run {

// armwright refuses. The code is one of ARMWRIGHT_RUN_...
class RunError : public std::runtime_error {
 public:
  RunError(int code, const std::string& message) : std::runtime_error(message), code_(code) {}
  int code() const { return code_; }

 private:
  int code_;
};

// The phase, the cases done and all cases of the phase, and the best objective so far (NaN before
// the first one).
using Progress = armwright_run_progress;

// Empty texts stand for defaults.
struct Settings {
  std::string optimizer = "ga";
  std::int64_t budget = 10000;  // training cases
  std::uint64_t seed = 1;
  std::string folder = {};  // default: results/PROBLEM-OPTIMIZER-seedN and what was set
  unsigned jobs = 1;        // threads that call evaluate()
  std::vector<std::string> options = {};   // of the optimizer: "sigma=0.2"
  std::vector<std::string> settings = {};  // of the problem: "sets.test_cases=50"
  std::string schedule = {};               // "fixed:5"
  std::string racing = {};                 // "halving:4:2"
  double time_limit_s = 0;                 // 0: none
  // Called from any thread, often: returns true if the run must end early.
  std::function<bool()> must_stop = {};
  // Called from any thread, one call at a time.
  std::function<void(const Progress&)> on_progress = {};
  std::function<void(const std::string&)> on_message = {};
};

struct Outcome {
  std::string folder;
  bool is_finished = false;  // false: ended early; only the folder is set
  std::string end_reason = {};
  std::string failure = {};  // how the optimizer failed; empty if it did not
  std::uint64_t evaluations = 0;
  std::uint64_t failed_evaluations = 0;
  bool is_feasible = false;  // every constraint is met on every test case
  // The winner, empty if no evaluation had an objective. Its numbers are those on the test cases.
  std::vector<double> x = {};
  std::vector<double> objectives = {};
  std::vector<double> constraints = {};
};

// Holds the first exception of a callback, so that none crosses the border.
class Callbacks {
 public:
  explicit Callbacks(const Settings& settings) : settings_(settings) {}

  void connect(armwright_run_request& request) {
    request.context = this;
    request.must_stop = [](void* self) -> int {
      auto& all = *static_cast<Callbacks*>(self);
      return all.call([&] { return all.settings_.must_stop && all.settings_.must_stop(); }) ? 1 : 0;
    };
    request.on_progress = [](void* self, const armwright_run_progress* progress) {
      auto& all = *static_cast<Callbacks*>(self);
      all.call([&] {
        if (all.settings_.on_progress) {
          all.settings_.on_progress(*progress);
        }
        return false;
      });
    };
    request.on_message = [](void* self, const char* message) {
      auto& all = *static_cast<Callbacks*>(self);
      all.call([&] {
        if (all.settings_.on_message) {
          all.settings_.on_message(message);
        }
        return false;
      });
    };
  }
  void rethrow_held() const {
    if (held_) {
      std::rethrow_exception(held_);
    }
  }

 private:
  // Returns what `body` returns, or true, which stops the run, from its first exception on.
  template <typename Body>
  bool call(Body&& body) {
    try {
      return body() || has_thrown_;
    } catch (...) {
      if (!has_thrown_.exchange(true)) {
        held_ = std::current_exception();
      }
    }
    return true;
  }

  const Settings& settings_;
  std::atomic<bool> has_thrown_ = false;
  std::exception_ptr held_;
};

inline std::vector<const char*> list_texts(const std::vector<std::string>& texts) {
  std::vector<const char*> list;
  for (const std::string& text : texts) {
    list.push_back(text.c_str());
  }
  return list;
}

}  // namespace armwright::run

namespace armwright {

// Runs an optimizer, or resumes the run in the folder, or returns the outcome of a run that has
// ended. Throws RunError with armwright's message, and what a callback throws.
inline run::Outcome optimize(problem::Problem& problem, const run::Settings& settings = {}) {
  const problem::Exported exported(problem);
  const std::vector<const char*> options = run::list_texts(settings.options);
  const std::vector<const char*> overrides = run::list_texts(settings.settings);
  const auto or_null = [](const std::string& text) {
    return text.empty() ? nullptr : text.c_str();
  };
  armwright_run_request request{};
  request.struct_size = sizeof request;
  request.problem = exported.raw();
  request.optimizer = or_null(settings.optimizer);
  request.options = options.data();
  request.option_count = options.size();
  request.settings = overrides.data();
  request.setting_count = overrides.size();
  request.seed = settings.seed;
  request.budget = settings.budget;
  request.schedule = or_null(settings.schedule);
  request.racing = or_null(settings.racing);
  request.folder = or_null(settings.folder);
  request.jobs = settings.jobs;
  request.time_limit_s = settings.time_limit_s;
  run::Callbacks callbacks(settings);
  callbacks.connect(request);
  const armwright_run_result* raw = nullptr;
  std::vector<char> message(10000);
  const int code = armwright_run(&request, &raw, message.data(), message.size());
  const std::unique_ptr<const armwright_run_result, decltype(&armwright_free_result)> result(
      raw, &armwright_free_result);
  callbacks.rethrow_held();
  if (code != ARMWRIGHT_RUN_OK) {
    throw run::RunError(code, message.data());
  }
  run::Outcome outcome;
  outcome.folder = result->folder;
  outcome.is_finished = result->is_finished != 0;
  if (!outcome.is_finished) {
    return outcome;
  }
  outcome.end_reason = result->end_reason;
  outcome.failure = result->failure;
  outcome.evaluations = result->evaluations;
  outcome.failed_evaluations = result->failed_evaluations;
  if (result->has_winner != 0) {
    outcome.is_feasible = result->is_feasible != 0;
    outcome.x.assign(result->x, result->x + result->variable_count);
    outcome.objectives.assign(result->objectives, result->objectives + result->objective_count);
    outcome.constraints.assign(result->constraints, result->constraints + result->constraint_count);
  }
  return outcome;
}

}  // namespace armwright
