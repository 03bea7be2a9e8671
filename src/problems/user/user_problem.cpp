#include "problems/user/user_problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"
#include "problems/interface/add_outcome.hpp"
#include "problems/user/case_messages.hpp"
#include "problems/user/server_pool.hpp"
#include "process/json_message.hpp"
#include "process/stop_scope.hpp"

namespace armwright {
namespace {

// Larger than the objectives of designs that work, if the user gives no penalty. As for analytic
// functions, a model that is fitted through it keeps its digits.
constexpr double kUserPenalty = 1e12;

// A question has at most as many jobs as are answered in this time, so that all threads end together.
constexpr double kLongQuestion_s = 0.1;
constexpr double kMostJobs = 1000;  // of a question

// The squared residuals add up to the objective except for rounding.
constexpr double kResidualTolerance = 1e-6;

constexpr double kViolated = 1;  // the value of every constraint of a failed case with a penalty

// The numbers of a case, as CaseOutcome::metrics has them, one after the other. A failed case has
// none, or only this mark if it is a validation or test case.
constexpr double kJudgedFailure = 0;

class UserProblem final : public Problem {
 public:
  explicit UserProblem(UserProgram program)
      : program_(std::move(program)),
        description_(make_description(program_.description)),
        pool_(program_.start) {}

  const ProblemDescription& description() const override { return description_; }

  BatchSize batch_size(CaseRole /*role*/) const override {
    // The granularity numbers the pairs of a batch, so it must be the same in every process.
    return {.granularity = 1,
            .largest = static_cast<std::size_t>(
                std::clamp(kLongQuestion_s / case_s_.load(), 1.0, kMostJobs))};
  }

  std::vector<CaseOutcome> simulate(std::span<const CaseJob> jobs) const override {
    std::vector<CaseOutcome> outcomes;
    while (!jobs.empty()) {
      const auto is_other = [&](const CaseJob& job) { return job.block != jobs.front().block; };
      const auto count =
          static_cast<std::size_t>(std::ranges::find_if(jobs, is_other) - jobs.begin());
      ask(jobs.first(count), outcomes);
      jobs = jobs.subspan(count);
    }
    return outcomes;
  }

  Evaluation aggregate(std::span<const double> x,
                       std::span<const CaseOutcome> outcomes) const override;
  std::optional<double> calc_lower_bound(std::span<const double> x,
                                         std::span<const CaseOutcome> outcomes,
                                         std::size_t cases) const override;

  ProblemWarnings& warnings() const { return warnings_; }
  const UserDescription& user_description() const { return program_.description; }
  void require_start() const {
    if (!program_.start) {
      throw Error(ErrorKind::usage,
                  fmt::format("problem '{}': {}", sanitize(program_.name), program_.why_not));
    }
  }
  Evaluation evaluate_answer(const CaseJob& job, CaseAnswer answer) const {
    const std::vector<CaseOutcome> outcomes = {make_outcome(job, std::move(answer))};
    return aggregate(job.x, outcomes);
  }

  std::vector<double> penalty_objectives() const override {
    std::vector<double> penalties;
    for (const UserObjective& objective : program_.description.objectives) {
      penalties.push_back(objective.penalty ? minimise(objective, *objective.penalty)
                                            : kUserPenalty);
    }
    return penalties;
  }

  CaseRecord record_case(std::span<const double> x, const CaseBlock& block,
                         std::uint64_t number) const override {
    if (!program_.description.has_records) {
      return {};
    }
    const CaseJob job{.x = x, .block = &block, .number = number};
    try {
      auto server = take_server();
      CaseRecord record = server->record(job);
      pool_.give_back(std::move(server));
      return record;
    } catch (const ServerFailure& failure) {
      await_work_stop();
      fail(fmt::format("it {}, asked for the record of a case", failure.what()));
    } catch (const ProtocolError& error) {
      fail(fmt::format("it {}", error.what()));
    }
  }

 private:
  static double minimise(const UserObjective& objective, double value) {
    return objective.is_maximised ? -value : value;
  }

  std::unique_ptr<CaseServer> take_server(bool is_new = false) const {
    require_start();
    return pool_.take(is_new);
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorKind::bad_data,
                fmt::format("problem '{}': {}", sanitize(program_.name), what));
  }

  // Asks for the answers to jobs of one block, and appends an outcome per job. If the server fails
  // while it has several jobs, each job is asked for alone. If it crashes with one job, a new server
  // is asked once more, because the jobs before may have made it crash. So only the job that makes a
  // server fail is a failed case.
  void ask(std::span<const CaseJob> jobs, std::vector<CaseOutcome>& outcomes,
           bool is_new = false) const {
    auto server = take_server(is_new);
    std::vector<CaseAnswer> answers;
    try {
      const auto begin = std::chrono::steady_clock::now();
      server->answer(jobs, answers);
      learn_time(std::chrono::steady_clock::now() - begin, jobs.size());
      pool_.give_back(std::move(server));
      assert(answers.size() == jobs.size());
      for (std::size_t i = 0; i < jobs.size(); ++i) {
        outcomes.push_back(make_outcome(jobs[i], std::move(answers[i])));
      }
    } catch (const ServerFailure& failure) {
      server.reset();
      if (jobs.size() > 1) {
        if (failure.status() == EvaluationStatus::timed_out) {
          warnings_.add(
              "the program did not answer all cases of a question",
              fmt::format(
                  "; it sent {} of {} answers and then {}; each case is asked for again, alone{}",
                  answers.size(), jobs.size(), failure.what(), failure.details()));
        }
        for (const CaseJob& job : jobs) {
          ask({&job, 1}, outcomes);
        }
        return;
      }
      if (!is_new && failure.status() != EvaluationStatus::timed_out) {
        ask(jobs, outcomes, true);
        return;
      }
      await_work_stop();
      const std::string reason = fmt::format("the program {}", failure.what());
      warn(reason, failure.details());
      outcomes.push_back(make_failure(jobs.front(), failure.status(), reason));
    } catch (const ProtocolError& error) {
      throw BrokenProtocol(ErrorKind::bad_data, fmt::format("problem '{}': it {}",
                                                            sanitize(program_.name), error.what()));
    }
  }

  // Without details, a warning would repeat what the record of the case says.
  void warn(const std::string& reason, const std::string& details) const {
    if (!details.empty()) {
      warnings_.add(reason, details);
    }
  }

  // Results do not depend on the number of jobs per question, so a measured time may choose it.
  void learn_time(std::chrono::steady_clock::duration passed, std::size_t jobs) const {
    case_s_ =
        std::max(1e-9, std::chrono::duration<double>(passed).count() / static_cast<double>(jobs));
  }

  CaseOutcome make_outcome(const CaseJob& job, CaseAnswer answer) const {
    const UserDescription& described = program_.description;
    if (answer.status != EvaluationStatus::ok) {
      warn(answer.reason, answer.details);
      return make_failure(job, answer.status,
                          answer.reason.empty() ? "the program gives no reason" : answer.reason);
    }
    if (const std::string what = find_not_finite(answer); !what.empty()) {
      return make_failure(job, EvaluationStatus::failed, what);
    }
    CaseOutcome outcome;
    for (std::size_t i = 0; i < answer.objectives.size(); ++i) {
      outcome.metrics.push_back(minimise(described.objectives[i], answer.objectives[i]));
    }
    outcome.error = calc_scalar(description_, outcome.metrics);
    for (std::size_t i = 0; i < answer.constraints.size(); ++i) {
      const auto& limit = described.constraints[i].limit;
      outcome.metrics.push_back(limit ? answer.constraints[i] / *limit - 1 : answer.constraints[i]);
    }
    std::ranges::copy(answer.metrics, std::back_inserter(outcome.metrics));
    for (std::size_t i = 0; i < answer.objectives.size(); ++i) {
      if (described.objectives[i].is_maximised) {
        outcome.metrics.push_back(answer.objectives[i]);
      }
    }
    if (job.residuals && described.has_residuals) {
      check_residuals(answer);
      outcome.residuals = std::move(answer.residuals);
    }
    return outcome;
  }

  // Returns a text that names the first number that is not finite; empty if all are.
  std::string find_not_finite(const CaseAnswer& answer) const {
    const UserDescription& described = program_.description;
    const auto name = [](const char* kind, const Quantity& quantity) {
      return fmt::format("its {} '{}' is not a finite number", kind, quantity.name);
    };
    for (std::size_t i = 0; i < answer.objectives.size(); ++i) {
      if (!std::isfinite(answer.objectives[i])) {
        return name("objective", described.objectives[i].quantity);
      }
    }
    for (std::size_t i = 0; i < answer.constraints.size(); ++i) {
      if (!std::isfinite(answer.constraints[i])) {
        return name("constraint", described.constraints[i].quantity);
      }
    }
    for (std::size_t i = 0; i < answer.metrics.size(); ++i) {
      if (!std::isfinite(answer.metrics[i])) {
        return name("metric", described.metrics[i]);
      }
    }
    return std::ranges::all_of(answer.residuals, [](double r) { return std::isfinite(r); })
               ? ""
               : "one of its residuals is not finite";
  }

  void check_residuals(const CaseAnswer& answer) const {
    double sum = 0;
    for (const double residual : answer.residuals) {
      sum += residual * residual;
    }
    const double objective = answer.objectives.front();
    if (std::abs(sum - objective) > kResidualTolerance * std::max(std::abs(objective), sum)) {
      fail(
          fmt::format("it answered with the objective {} and with residuals whose squares add up "
                      "to {}; both must be the same",
                      format_exact(objective), format_exact(sum)));
    }
  }

  CaseOutcome make_failure(const CaseJob& job, EvaluationStatus status, std::string reason) const {
    CaseOutcome outcome;
    outcome.status = status;
    outcome.reason = std::move(reason);
    outcome.has_error = false;
    if (job.block->role != CaseRole::training) {
      outcome.metrics = {kJudgedFailure};
    } else if (has_penalty()) {
      outcome.has_error = true;
      outcome.metrics = penalty_objectives();
      outcome.error = calc_scalar(description_, outcome.metrics);
      outcome.metrics.resize(outcome.metrics.size() + description_.constraints.size(), kViolated);
    }
    return outcome;
  }

  bool has_penalty() const { return program_.description.objectives.front().penalty.has_value(); }

  UserProgram program_;
  ProblemDescription description_;
  mutable ServerPool pool_;
  mutable ProblemWarnings warnings_;
  mutable std::atomic<double> case_s_ = kLongQuestion_s;  // of the last question
};

Evaluation UserProblem::aggregate(std::span<const double> /*x*/,
                                  std::span<const CaseOutcome> outcomes) const {
  const std::size_t objectives = description_.objectives.size();
  const std::size_t constraints = description_.constraints.size();
  const std::size_t metrics = description_.metrics.size();
  Evaluation evaluation;
  std::vector<double> sums(objectives);
  std::vector<double> worst(objectives + constraints, -std::numeric_limits<double>::infinity());
  std::vector<double> metric_sums(metrics);
  std::size_t counted = 0;  // with objectives
  std::size_t good = 0;     // of these, not failed
  bool has_failed_training = false;
  for (const CaseOutcome& outcome : outcomes) {
    if (!add_outcome(outcome, evaluation)) {
      has_failed_training |= outcome.metrics.empty();
      continue;
    }
    ++counted;
    for (std::size_t i = 0; i < objectives + constraints; ++i) {
      worst[i] = std::max(worst[i], outcome.metrics[i]);
    }
    for (std::size_t i = 0; i < objectives; ++i) {
      sums[i] += outcome.metrics[i];
    }
    if (outcome.status == EvaluationStatus::ok) {
      ++good;
      for (std::size_t i = 0; i < metrics; ++i) {
        metric_sums[i] += outcome.metrics[objectives + constraints + i];
      }
    }
  }
  // A mean over the cases that did not fail would reward designs that fail on hard cases.
  if (good == 0 || has_failed_training) {
    return evaluation;
  }
  const auto count = static_cast<double>(counted);
  for (std::size_t i = 0; i < objectives; ++i) {
    evaluation.objectives.push_back(program_.description.takes_worst_case ? worst[i]
                                                                          : sums[i] / count);
  }
  evaluation.constraint_values.assign(worst.begin() + static_cast<std::ptrdiff_t>(objectives),
                                      worst.end());
  for (const double sum : metric_sums) {
    evaluation.metrics.push_back(sum / static_cast<double>(good));
  }
  if (evaluation.status == EvaluationStatus::ok) {
    for (const CaseOutcome& outcome : outcomes) {
      for (const double residual : outcome.residuals) {
        evaluation.residuals.push_back(residual / std::sqrt(count));
      }
    }
  }
  return evaluation;
}

std::optional<double> UserProblem::calc_lower_bound(std::span<const double> /*x*/,
                                                    std::span<const CaseOutcome> outcomes,
                                                    std::size_t cases) const {
  const UserDescription& described = program_.description;
  std::vector<double> combined;
  for (std::size_t i = 0; i < described.objectives.size(); ++i) {
    const UserObjective& objective = described.objectives[i];
    if (!objective.bound) {
      return std::nullopt;
    }
    const double bound = minimise(objective, *objective.bound);
    double sum = 0;
    double worst = bound;
    std::size_t known = 0;
    for (const CaseOutcome& outcome : outcomes) {
      if (outcome.has_error) {
        sum += outcome.metrics[i];
        worst = std::max(worst, outcome.metrics[i]);
        ++known;
      }
    }
    combined.push_back(described.takes_worst_case
                           ? worst
                           : (sum + bound * static_cast<double>(cases - known)) /
                                 static_cast<double>(cases));
  }
  return calc_scalar(description_, combined);
}

}  // namespace

void ProblemWarnings::add(const std::string& reason, const std::string& details) {
  constexpr std::size_t kMostWarnings = 5;
  const std::lock_guard lock(mutex_);
  if (told_.size() < kMostWarnings && told_.insert(reason).second) {
    waiting_.push_back(reason + details);
  }
}

std::vector<std::string> ProblemWarnings::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(waiting_, {});
}

void ProblemWarnings::forget() {
  const std::lock_guard lock(mutex_);
  told_.clear();
  waiting_.clear();
}

// A program may give any reason, but reasons with these beginnings are made in this folder. The exit
// code is how a command answers that a design fails.
bool is_fault_of_program(const CaseOutcome& outcome) {
  const auto begins = [&](std::string_view text) { return outcome.reason.starts_with(text); };
  return outcome.status == EvaluationStatus::timed_out ||
         (outcome.status == EvaluationStatus::failed &&
          (begins("the program ") || begins("its ") || begins("one of its residuals ") ||
           (begins("the command ") && !begins("the command ended with exit code "))));
}

std::shared_ptr<const Problem> make_user_problem(UserProgram program) {
  return std::make_shared<UserProblem>(std::move(program));
}

namespace {

// Returns the user's problem that this problem is or wraps; null for others.
const UserProblem* find_user_problem(const Problem& problem) {
  const auto* wrapper = dynamic_cast<const WrappedProblem*>(&problem);
  return wrapper != nullptr ? find_user_problem(wrapper->inner())
                            : dynamic_cast<const UserProblem*>(&problem);
}

}  // namespace

const UserDescription* find_user_description(const Problem& problem) {
  const UserProblem* user = find_user_problem(problem);
  return user == nullptr ? nullptr : &user->user_description();
}

ProblemWarnings* find_warnings(const Problem& problem) {
  const UserProblem* user = find_user_problem(problem);
  return user == nullptr ? nullptr : &user->warnings();
}

void require_server(const Problem& problem) {
  if (const UserProblem* user = find_user_problem(problem)) {
    user->require_start();
  }
}

Evaluation make_evaluation(const Problem& problem, const CaseJob& job, CaseAnswer answer) {
  const UserProblem* user = find_user_problem(problem);
  assert(user != nullptr);
  return user->evaluate_answer(job, std::move(answer));
}

}  // namespace armwright
