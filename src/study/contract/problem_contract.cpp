#include "study/contract/problem_contract.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <tuple>
#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"
#include "problems/user/user_problem.hpp"
#include "study/contract/contract_checks.hpp"
#include "study/contract/problem_specimen.hpp"

namespace armwright {
namespace {

constexpr int kParallelRounds = 3;
constexpr int kTimedRounds = 5;           // an odd number, for the median
constexpr std::size_t kTimedBatch = 100;  // as in the benchmark of overhead

ContractFinding make_finding(std::string fault) {
  return fault.empty() ? ContractFinding{} : make_broken(std::move(fault));
}

constexpr const char* kNotDeterministic = "it declares that its answers vary (deterministic)";

ContractFinding check_description(const ProblemTrial& trial) {
  const LoadedProblem first = trial.load();
  const LoadedProblem second = trial.load();
  return make_finding(first.resolved_json == second.resolved_json
                          ? ""
                          : "it described itself in two ways when it was started twice");
}

ContractFinding check_start(const ProblemTrial& trial) {
  const Specimen specimen(trial);
  const Question question{specimen.get_start(), 0};
  const CaseOutcome outcome = specimen.ask({&question, 1}).front();
  return make_finding(
      outcome.status == EvaluationStatus::ok ? "" : specimen.describe_failure(question, outcome));
}

// A user's problem may answer that a design cannot be simulated. It must not crash on one.
ContractFinding check_bounds(const ProblemTrial& trial) {
  const Specimen specimen(trial);
  const std::vector<Question> corners = specimen.make_corners();
  const std::vector<CaseOutcome> outcomes = specimen.ask(corners);
  std::size_t failed = 0;
  std::string first;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const CaseOutcome& outcome = outcomes[i];
    if (outcome.status == EvaluationStatus::ok) {
      continue;
    }
    if (is_fault_of_program(outcome)) {
      return make_broken(specimen.describe_failure(corners[i], outcome));
    }
    if (failed++ == 0) {
      first = fmt::format("{}: {}", specimen.describe(corners[i]), outcome.reason);
    }
  }
  ContractFinding finding;
  if (failed > 0) {
    finding.detail = fmt::format(
        "{} of {} designs at the bounds fail, as the problem says itself; "
        "the first: {}",
        failed, corners.size(), first);
  }
  return finding;
}

ContractFinding check_finite(const ProblemTrial& trial) {
  const Specimen specimen(trial);
  const std::vector<Question> questions = specimen.make_questions();
  const std::vector<CaseOutcome> outcomes = specimen.ask(questions);
  for (std::size_t i = 0; i < questions.size(); ++i) {
    if (is_fault_of_program(outcomes[i])) {
      return make_broken(specimen.describe_failure(questions[i], outcomes[i]));
    }
  }
  return {};
}

ContractFinding check_repeatable(const ProblemTrial& trial) {
  const Specimen specimen(trial);
  if (!specimen.loaded().is_deterministic) {
    return make_exempt(kNotDeterministic);
  }
  const std::vector<Question> questions = specimen.make_questions();
  const auto first = specimen.ask(questions);
  return make_finding(specimen.compare(questions, first, specimen.ask(questions),
                                       " when the same questions were asked again"));
}

ContractFinding check_fresh(const ProblemTrial& trial) {
  const Specimen specimen(trial);
  if (!specimen.loaded().is_deterministic) {
    return make_exempt(kNotDeterministic);
  }
  const std::vector<Question> questions = specimen.make_questions();
  const auto first = specimen.ask(questions);
  return make_finding(specimen.compare(questions, first, Specimen(trial).ask(questions),
                                       " in a process that was started anew"));
}

ContractFinding check_order(const ProblemTrial& trial) {
  const Specimen specimen(trial);
  if (!specimen.loaded().is_deterministic) {
    return make_exempt(kNotDeterministic);
  }
  std::vector<Question> questions = specimen.make_questions();
  auto first = specimen.ask(questions);
  std::ranges::reverse(questions);
  std::ranges::reverse(first);
  return make_finding(specimen.compare(questions, first, Specimen(trial).ask(questions),
                                       " when the cases came in another order"));
}

ContractFinding check_batch(const ProblemTrial& trial) {
  const Specimen specimen(trial);
  if (!specimen.loaded().is_deterministic) {
    return make_exempt(kNotDeterministic);
  }
  const std::vector<Question> questions = specimen.make_questions();
  const auto first = specimen.ask(questions);
  return make_finding(specimen.compare(questions, first, Specimen(trial).ask_singly(questions),
                                       " when each was asked alone"));
}

ContractFinding check_parallel(const ProblemTrial& trial) {
  const Specimen specimen(trial);
  if (!specimen.loaded().is_deterministic) {
    return make_exempt(kNotDeterministic);
  }
  if (trial.jobs < 2) {
    return make_exempt("it was tried with --jobs 1");
  }
  const std::vector<Question> questions = specimen.make_questions();
  const auto first = specimen.ask(questions);
  // Each thread has a process of its own, which has started before the others begin.
  std::vector<std::unique_ptr<Specimen>> specimens;
  for (unsigned job = 0; job < trial.jobs; ++job) {
    specimens.push_back(std::make_unique<Specimen>(trial));
    specimens.back()->ask({questions.data(), 1});
  }
  std::vector<std::string> faults(trial.jobs);
  std::vector<std::exception_ptr> errors(trial.jobs);
  std::vector<std::thread> threads;
  for (unsigned job = 0; job < trial.jobs; ++job) {
    threads.emplace_back([&, job] {
      try {
        for (int round = 0; round < kParallelRounds && faults[job].empty(); ++round) {
          faults[job] = specimen.compare(questions, first, specimens[job]->ask_singly(questions),
                                         fmt::format(" with {} processes at work", trial.jobs));
        }
      } catch (...) {
        errors[job] = std::current_exception();
      }
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  for (unsigned job = 0; job < trial.jobs; ++job) {
    if (errors[job]) {
      std::rethrow_exception(errors[job]);
    }
    if (!faults[job].empty()) {
      return make_broken(faults[job]);
    }
  }
  return {};
}

ContractFinding check_residuals(const ProblemTrial& trial) {
  const Specimen specimen(trial);
  if (!specimen.description().has_residuals) {
    return make_exempt("it has no residuals");
  }
  const std::vector<Question> questions = specimen.make_questions();
  const auto outcomes = specimen.ask(questions, true);  // the problem itself checks the sums
  std::size_t count = 0;
  for (std::size_t i = 0; i < questions.size(); ++i) {
    if (outcomes[i].status != EvaluationStatus::ok) {
      continue;
    }
    const std::size_t here = outcomes[i].residuals.size();
    if (here == 0 || (count > 0 && here != count)) {
      return make_broken(fmt::format("{}: there are {} residuals{}",
                                     specimen.describe(questions[i]), here,
                                     count > 0 ? fmt::format(", and {} before", count) : ""));
    }
    count = here;
  }
  return {};
}

// Returns the processes that this process has started.
std::set<pid_t> list_children() {
  std::set<pid_t> children;
  for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream list(thread.path() / "children");
    for (pid_t child = 0; list >> child;) {
      children.insert(child);
    }
  }
  return children;
}

ContractFinding check_kill(const ProblemTrial& trial) {
  const Specimen specimen(trial);
  if (!specimen.is_user_problem()) {
    return make_exempt("it has no process of its own");
  }
  if (!specimen.loaded().is_deterministic) {
    return make_exempt(kNotDeterministic);
  }
  const std::vector<Question> questions = specimen.make_questions();
  const std::set<pid_t> others = list_children();
  const auto begin = std::chrono::steady_clock::now();
  const auto first = specimen.ask(questions);
  const auto half = (std::chrono::steady_clock::now() - begin) / 2;
  std::exception_ptr error;
  std::thread asking([&] {
    try {
      specimen.ask(questions);  // some of these cases fail
    } catch (...) {
      error = std::current_exception();
    }
  });
  std::this_thread::sleep_for(half);
  for (const pid_t child : list_children()) {
    if (!others.contains(child)) {
      kill(child, SIGKILL);
    }
  }
  asking.join();
  if (error) {
    std::rethrow_exception(error);
  }
  // A process that was killed while it had no question is noticed by the next question.
  specimen.ask({questions.data(), 1});
  return make_finding(specimen.compare(questions, first, specimen.ask(questions),
                                       " after its process had been killed"));
}

ContractFinding check_sets(const ProblemTrial& trial) {
  const Specimen specimen(trial);
  const std::vector<double> start = specimen.get_start();
  for (const auto& [role, set] :
       {std::pair{CaseRole::validation, specimen.loaded().sets.validation},
        std::pair{CaseRole::test, specimen.loaded().sets.test}}) {
    const CaseBlock block{role, set, {0}};
    const CaseJob job{.x = start, .block = &block};
    const CaseOutcome outcome = specimen.problem().simulate({&job, 1}).front();
    if (is_fault_of_program(outcome)) {
      return make_broken(specimen.describe_failure(fmt::format("case 0 of {}", set), outcome));
    }
  }
  return {};
}

ContractFinding check_record(const ProblemTrial& trial) {
  const Specimen specimen(trial);
  const CaseBlock block{CaseRole::test, specimen.loaded().sets.test, {0}};
  const CaseRecord record = specimen.problem().record_case(specimen.get_start(), block, 0);
  if (record.series.empty() && record.files.empty()) {
    return make_exempt("it records nothing");
  }
  ContractFinding finding;
  finding.detail = fmt::format("{} signals of {} values, {} files", record.series.size(),
                               record.abscissa_values.size(), record.files.size());
  return finding;
}

ContractFinding check_recorded(const ProblemTrial& trial) {
  const LoadedProblem loaded = trial.load();
  const LoadedProblem recorded =
      load_recorded_problem(loaded.resolved_json, loaded.name, std::filesystem::current_path());
  return make_finding(recorded.resolved_json == loaded.resolved_json
                          ? ""
                          : "its record is read as another problem");
}

double measure_thread_cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Returns the medians of the time per case on the clock, and of the time that this thread computes.
std::pair<double, double> measure_case_us(const Specimen& specimen, std::size_t batch) {
  const std::vector<Question> some = specimen.make_questions();
  std::vector<Question> questions;
  for (std::size_t i = 0; i < batch; ++i) {
    questions.push_back(some[i % some.size()]);
  }
  std::vector<double> clock;
  std::vector<double> cpu;
  for (int round = 0; round < kTimedRounds; ++round) {
    const auto begin = std::chrono::steady_clock::now();
    const double cpu_begin_s = measure_thread_cpu_s();
    specimen.ask(questions);
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
    cpu.push_back(1e6 * (measure_thread_cpu_s() - cpu_begin_s) / static_cast<double>(batch));
    clock.push_back(1e6 * passed.count() / static_cast<double>(batch));
  }
  std::ranges::sort(clock);
  std::ranges::sort(cpu);
  return {clock[kTimedRounds / 2], cpu[kTimedRounds / 2]};
}

ContractFinding check_time(const ProblemTrial& trial) {
  constexpr double kSlow_us = 5e4;  // batches of slower cases would only take long
  const Specimen specimen(trial);
  const std::vector<Question> questions = specimen.make_questions();
  specimen.ask({questions.data(), 1});  // starts it
  const auto [alone_us, alone_cpu_us] = measure_case_us(specimen, 1);
  const bool has_batch = alone_us < kSlow_us;
  const auto [batch_us, batch_cpu_us] =
      has_batch ? measure_case_us(specimen, kTimedBatch) : std::pair{alone_us, alone_cpu_us};
  ContractFinding finding;
  finding.detail = fmt::format("one case takes {:.0f} us", alone_us);
  if (has_batch) {
    finding.detail += fmt::format(", or {:.0f} us in batches of {}", batch_us, kTimedBatch);
  }
  if (specimen.is_user_problem()) {
    finding.detail += fmt::format("; of it, armwright computes {:.0f} us{}", alone_cpu_us,
                                  has_batch ? fmt::format(" and {:.0f} us", batch_cpu_us) : "");
  }
  finding.detail += " (medians)";
  return finding;
}

}  // namespace

const std::vector<ProblemCheck>& problem_checks() {
  constexpr const char* kState =
      "keep nothing from one case for the next: no global variables, caches or files that change "
      "answers; begin random numbers with the seed of the case";
  static const std::vector<ProblemCheck> checks = {
      {"Description", "describes itself, each time in the same way",
       "correct the field that the message names; a description must not depend on time or chance",
       check_description},
      {"Recorded", "its record is read without starting it",
       "describe the problem with fixed numbers only", check_recorded},
      {"Start", "simulates the start", "choose a start that works, or correct the program",
       check_start},
      {"Bounds", "survives designs at the bounds, and every word",
       "answer {\"status\": \"diverged\", \"reason\": ...} for a design that cannot be simulated, "
       "or "
       "narrow the bounds",
       check_bounds},
      {"Finite", "answers with finite numbers",
       "answer {\"status\": \"diverged\", \"reason\": ...} in place of NaN and infinity",
       check_finite},
      {"Sets", "simulates validation and test cases",
       "make cases of the roles validation and test as of training", check_sets},
      {"Repeatable", "same design and case, same answer", kState, check_repeatable},
      {"Fresh", "the same answer in a new process",
       "begin random numbers with the seed of the case; do not use the time, the process number or "
       "the order of sets and directories",
       check_fresh},
      {"Order", "answers do not depend on the order of the cases", kState, check_order},
      {"Batch", "answers do not depend on what is asked together", kState, check_batch},
      {"Parallel", "several processes do not disturb each other",
       "give each process files of its own, in a new temporary folder", check_parallel},
      {"Residuals", "the squares of the residuals add up to the objective",
       "answer with the same number of residuals each time, and with the sum of their squares as "
       "the objective",
       check_residuals},
      {"Kill", "killed and started again, gives the same answers",
       "leave no lock and no half-written file behind that a new process trips over", check_kill},
      {"Record", "what it records can be read", "correct the message \"record\"", check_record},
      {"Time", "time per case", "see the message", check_time},
  };
  return checks;
}

ContractFinding run_problem_check(const ProblemCheck& check, const ProblemTrial& trial) {
  ContractFinding finding;
  const char* advice = check.advice;
  try {
    finding = check.run(trial);
  } catch (const BrokenProtocol& error) {
    finding = make_broken(error.what());
    finding.ends = true;
    advice =
        "correct this answer (docs/problem-protocol.md); the promises that follow are checked "
        "after that";
  } catch (const std::exception& error) {
    finding = make_broken(error.what());
  }
  if (finding.outcome == ContractOutcome::broken) {
    finding.detail += fmt::format(". To do: {}", advice);
  }
  return finding;
}

}  // namespace armwright
