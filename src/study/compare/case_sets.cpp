#include "study/compare/case_sets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <numeric>
#include <span>

#include "base/error.hpp"
#include "study/run/case_breeder.hpp"

namespace armwright {
namespace {

using Visitor = std::function<void(UsedSet& set, const std::vector<TestCase>& cases)>;

// Returns the schedules of a problem's cells: for every kind the one with the most cases.
std::vector<Schedule> list_schedules(const StudyPlan& plan, std::size_t problem) {
  std::map<Schedule::Kind, Schedule> largest;
  for (std::size_t o = 0; o < plan.optimizers.size(); ++o) {
    const Schedule schedule = get_schedule(plan, {problem, o, 1});
    Schedule& one = largest.try_emplace(schedule.kind, schedule).first->second;
    one.cases = std::max(one.cases, schedule.cases);
  }
  std::vector<Schedule> schedules;
  for (const auto& [kind, schedule] : largest) {
    schedules.push_back(schedule);
  }
  return schedules;
}

// Returns the number of cases of a replicate's training set. All methods use its beginning.
std::int64_t count_training_cases(const StudyPlan& plan, std::span<const Schedule> schedules) {
  std::int64_t cases = 0;
  for (const Schedule& schedule : schedules) {
    // Fresh and growing cases: at most as many as the budget pays for.
    constexpr std::int64_t kMostHashed = 10'000;
    if (schedule.kind == Schedule::Kind::fresh || schedule.kind == Schedule::Kind::growing) {
      cases = std::max(cases, std::min(plan.budget, kMostHashed));
    } else if (schedule.kind == Schedule::Kind::fixed) {
      cases = std::max(cases, std::int64_t{schedule.cases});
    }
  }
  return cases;
}

// Limits the number of cases: all are generated and hashed before any cell runs.
void check_count(const StudyPlan& plan) {
  constexpr std::int64_t kMostCompared = 1'000'000;
  std::int64_t count = 0;
  for (std::size_t p = 0; p < plan.problems.size(); ++p) {
    const LoadedProblem& problem = plan.problems[p].loaded;
    if (problem.tracking()) {
      count += std::int64_t{problem.sets.test_cases} + problem.sets.validation_cases +
               plan.replicates * count_training_cases(plan, list_schedules(plan, p));
    }
  }
  if (count > kMostCompared) {
    throw Error(ErrorKind::usage,
                fmt::format("the sets of all problems and replicates have {} test cases; at most "
                            "{} are possible. Lower replicates, sets.test_cases, "
                            "sets.validation_cases or the schedule's cases",
                            count, kMostCompared));
  }
}

void visit_sets(const StudyPlan& plan, const Visitor& visit) {
  for (std::size_t p = 0; p < plan.problems.size(); ++p) {
    const StudyProblem& problem = plan.problems[p];
    const auto visit_numbers = [&](const char* role, const std::string& name,
                                   std::span<const std::uint64_t> numbers) {
      UsedSet set{problem.label, role, name, static_cast<int>(numbers.size()), ""};
      std::vector<TestCase> cases;
      if (problem.loaded.tracking()) {
        const TestSet source = problem.loaded.tracking()->get_set(name);
        for (const std::uint64_t number : numbers) {
          cases.push_back(source.make_case(number));
        }
        set.sha256 = calc_content_hash(cases);
      }
      visit(set, cases);
    };
    const auto visit_first = [&](const char* role, const std::string& name, int count) {
      std::vector<std::uint64_t> numbers(static_cast<std::size_t>(count));
      std::iota(numbers.begin(), numbers.end(), std::uint64_t{0});
      visit_numbers(role, name, numbers);
    };
    const CaseSets& sets = problem.loaded.sets;
    visit_first("test", sets.test, sets.test_cases);
    visit_first("validation", sets.validation, sets.validation_cases);
    for (int replicate = 1; replicate <= plan.replicates; ++replicate) {
      const std::string name = make_training_set_name(plan, {p, 0, replicate});
      const auto schedules = list_schedules(plan, p);
      const std::int64_t cases = count_training_cases(plan, schedules);
      if (cases > 0) {
        visit_first("training", name, static_cast<int>(cases));
      }
      for (const Schedule& schedule : schedules) {
        if (schedule.kind == Schedule::Kind::coevolution) {
          // The cases that breeding will produce are unknown, but they come from a separate space.
          const std::string bred = get_training_set(name, schedule);
          visit_numbers("training", bred, CaseBreeder(bred, schedule.cases).genomes());
        }
      }
    }
  }
}

}  // namespace

std::vector<UsedSet> list_used_sets(const StudyPlan& plan) {
  std::vector<UsedSet> sets;
  visit_sets(plan, [&](UsedSet& set, const std::vector<TestCase>&) { sets.push_back(set); });
  return sets;
}

void check_sets_are_disjoint(const StudyPlan& plan) {
  check_count(plan);
  std::map<std::pair<std::string, std::string>, std::string> owner;  // (problem, case) -> set
  visit_sets(plan, [&](UsedSet& set, const std::vector<TestCase>& cases) {
    for (const TestCase& one : cases) {
      const auto [found, is_new] =
          owner.try_emplace({set.problem, calc_content_hash({&one, 1})}, set.name);
      if (!is_new && found->second != set.name) {
        throw Error(ErrorKind::usage,
                    fmt::format("problem {}: a test case is in both {} and {}; sets of a "
                                "comparison have no case in common",
                                set.problem, found->second, set.name));
      }
    }
  });
}

}  // namespace armwright
