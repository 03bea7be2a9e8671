// armwright check-problem: checks whether a problem keeps the problem contract.

#include <CLI/CLI.hpp>

#include "base/error.hpp"
#include "cli/commands/commands.hpp"
#include "cli/commands/contract_report.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/session.hpp"
#include "problems/user/user_problem.hpp"
#include "study/contract/problem_contract.hpp"

namespace armwright {
namespace {

constexpr const char* kCheckProblemExamples = R"(Examples:
  armwright check-problem 'exec:python3 motor.py'
  armwright check-problem filter.toml --jobs 4     # four cases at the same time
  armwright check-problem ./build/libmine.so --cases 10

Simulates a few designs again and again: in other orders, alone, in new processes, at the bounds, and after a kill.
Prints for each promise of a problem whether it is kept, and what to do if not. The exit code is 0 if the problem keeps
all promises, 3 if it breaks one.)";

struct CheckProblemOptions {
  std::string problem;
  OverrideOptions overrides;
  std::string cases = "2";
  std::string jobs = "2";
  bool json = false;
};

int run_check_problem(const CheckProblemOptions& options, Session& session) {
  constexpr std::int64_t kMostChecked = 1000;
  const ProblemTrial trial{
      .load = [&] { return load_problem(options.problem, options.overrides.get()); },
      .cases = static_cast<std::size_t>(parse_count("--cases", options.cases, 1, kMostChecked)),
      .jobs = parse_jobs(options.jobs)};
  CheckedThing thing{"problem", options.problem, "a problem that cannot be read"};
  std::vector<NamedCheck> checks;
  for (const ProblemCheck& check : problem_checks()) {
    checks.push_back({check.name, check.promise, [&] { return run_problem_check(check, trial); }});
  }
  try {
    const LoadedProblem problem = trial.load();
    thing.name = problem.name;
    thing.summary = problem.title;
    require_server(*problem.problem);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::bad_data) {
      throw;
    }
    checks.resize(1);  // the first check says what is wrong with the description
  }
  return report_contract(thing, checks, options.json, session);
}

}  // namespace

void add_check_problem(CLI::App& app, Session& session) {
  auto options = std::make_shared<CheckProblemOptions>();
  CLI::App* command = add_command(app, session, "check-problem",
                                  "Check whether a problem keeps the promises of every problem",
                                  kCheckProblemExamples);
  command
      ->add_option("PROBLEM", options->problem,
                   "A problem file, a process ('exec:COMMAND') or a shared library (./libmine.so)")
      ->required();
  command->add_option("--cases", options->cases, "Training cases per design (default: 2)")
      ->type_name("N");
  add_jobs_flag(*command, options->jobs, "2");
  command
      ->add_option("--set", options->overrides.set,
                   "A setting of the problem, as KEY=VALUE; repeatable")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  command->add_flag("--json", options->json, "Print the findings as JSON")->group("Output");
  command->callback([options, &session] {
    session.action = [options, &session] { return run_check_problem(*options, session); };
  });
}

}  // namespace armwright
