#include "study/compare/case_sets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>

#include "base/error.hpp"

namespace armwright {
namespace {

using Visitor = std::function<void(UsedSet& set, const std::vector<TestCase>& cases)>;

void visit_sets(const StudyPlan& plan, const Visitor& visit) {
  for (std::size_t p = 0; p < plan.problems.size(); ++p) {
    const StudyProblem& problem = plan.problems[p];
    const auto meet = [&](const char* role, const std::string& name, int count) {
      UsedSet set{problem.label, role, name, count, ""};
      std::vector<TestCase> cases;
      if (problem.loaded.tracking) {
        const TestSet source = problem.loaded.tracking->get_set(name);
        for (int i = 0; i < count; ++i) {
          cases.push_back(source.make_case(static_cast<std::uint64_t>(i)));
        }
        set.sha256 = calc_content_hash(cases);
      }
      visit(set, cases);
    };
    const CaseSets& sets = problem.loaded.sets;
    meet("test", sets.test, sets.test_cases);
    meet("validation", sets.validation, sets.validation_cases);
    for (int replicate = 1; replicate <= plan.replicates; ++replicate) {
      // Of fresh cases no more than the budget pays for.
      constexpr std::int64_t kMostHashed = 10'000;
      const auto cases = problem.schedule.fresh ? std::min(plan.budget, kMostHashed)
                                                : std::int64_t{problem.schedule.cases};
      meet("training", make_training_set_name(plan, {p, 0, replicate}), static_cast<int>(cases));
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
