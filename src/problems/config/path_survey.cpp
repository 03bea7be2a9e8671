#include "problems/config/path_survey.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <utility>

#include "base/error.hpp"
#include "base/read_limit.hpp"
#include "base/text.hpp"
#include "sim/tracking/path_check.hpp"

namespace armwright {
namespace {

constexpr std::uint64_t kCasesOfSet = 4;

struct Found {
  PathFault fault;
  std::string set;
  std::uint64_t number = 0;
};

// The worst fault per joint and kind, over all cases.
class Findings {
 public:
  void add(const PathFault& fault, const std::string& set, std::uint64_t number) {
    const auto key = std::pair(fault.joint, fault.kind);
    const auto [place, is_new] = worst_.try_emplace(key, Found{fault, set, number});
    const auto excess = [](const PathFault& one) { return std::abs(one.value - one.limit); };
    if (!is_new && excess(fault) > excess(place->second.fault)) {
      place->second = {fault, set, number};
    }
  }
  std::vector<std::string> describe_all(const RobotModel& robot) const {
    std::vector<std::string> lines;
    for (const auto& [key, found] : worst_) {
      lines.push_back(
          fmt::format("case {} of {}, {}", found.number, found.set, describe(found.fault, robot)));
    }
    return lines;
  }

 private:
  std::map<std::pair<std::size_t, PathFault::Kind>, Found> worst_;
};

}  // namespace

std::vector<std::string> check_paths(const LoadedProblem& problem) {
  if (problem.tracking() == nullptr) {
    return {};
  }
  const ReadStep step(fmt::format("the paths of problem '{}'", sanitize(problem.name)));
  const TrackingSetup& setup = problem.tracking()->setup();
  std::vector<std::string> lines;
  for (const UrdfRepair& repair : setup.robot().reading.repairs) {
    lines.push_back("robot: repaired: " + repair.what);
  }
  for (const std::string& note : setup.robot().notes) {
    lines.push_back("robot: " + note);
  }
  const LimitPolicy policy = setup.task().limits;
  if (policy == LimitPolicy::ignore) {
    return lines;
  }
  // With "warn", tables are made without an error, so that the survey can report every fault.
  TrackingTask task = setup.task();
  task.limits = LimitPolicy::warn;
  const TrackingSetup looking(problem.tracking()->config().robot, task);
  Findings findings;
  std::uint64_t looked_at = 0;
  std::uint64_t faulty = 0;
  const bool is_path = problem.tracking()->config().path.has_value();
  for (const std::string& name :
       {problem.sets.training, problem.sets.validation, problem.sets.test}) {
    const TestSet set = problem.tracking()->get_set(name);
    std::vector<TestCase> cases;
    for (std::uint64_t number = 0; number < (is_path ? 1 : kCasesOfSet); ++number) {
      cases.push_back(set.make_case(number));
    }
    const std::vector<TargetTable> tables = looking.make_targets(cases);
    for (std::uint64_t number = 0; number < tables.size(); ++number) {
      const TargetTable& table = tables[number];
      ++looked_at;
      if (!table.unreachable.empty()) {
        ++faulty;
        lines.push_back(fmt::format("case {} of {}, {}", number, name, table.unreachable));
        continue;
      }
      const std::vector<PathFault> faults = find_path_faults(looking, table);
      faulty += faults.empty() ? 0 : 1;
      for (const PathFault& fault : faults) {
        findings.add(fault, name, number);
      }
    }
    if (is_path) {
      break;  // every set has the same path
    }
  }
  for (std::string& line : findings.describe_all(setup.robot())) {
    lines.push_back(std::move(line));
  }
  if (faulty == 0) {
    return lines;
  }
  const std::string summary = fmt::format(
      "{} of {} paths looked at ask for more than the arm's joints can do", faulty, looked_at);
  if (policy == LimitPolicy::enforce) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}; lower task.speed_m_per_s, set another workspace or path, or set "
                            "task.limits to \"warn\" to simulate it all the same:\n  {}",
                            summary, join(lines, "\n  ")));
  }
  lines.push_back(summary + "; they are simulated all the same (task.limits = \"warn\")");
  return lines;
}

}  // namespace armwright
