#include "study/matrix/chunks.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <numeric>

namespace armwright {
namespace {

double measure_case_s(const StudyPlan& plan, const StudyProblem& problem, CaseRole role,
                      const std::string& set) {
  const bool is_program = !problem.loaded.program.empty();
  if (is_program && !plan.programs.may_simulate) {
    return 0;
  }
  // A case of a user's program may take long.
  const std::size_t cases = is_program ? 1 : 32;
  const std::vector<double> x = list_starts(problem.loaded.problem->description().variables);
  CaseBlock block{role, set, std::vector<std::uint64_t>(cases)};
  std::iota(block.numbers.begin(), block.numbers.end(), std::uint64_t{0});
  const auto measure_s = [&] {
    const auto start = std::chrono::steady_clock::now();
    problem.loaded.problem->evaluate(x, block);
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    return taken.count() / static_cast<double>(cases);
  };
  // The first time generates the cases, which are kept, or starts the program. It counts only if
  // that hardly matters.
  constexpr double kSlow_s = 10;  // programs that load much start within seconds
  const double first_s = measure_s();
  return is_program && first_s > kSlow_s ? first_s : measure_s();
}

std::vector<Chunk> cut_chunks(std::span<const Cell> cells, std::span<const double> durations_s,
                              double least_s) {
  std::vector<Chunk> chunks;
  Chunk open;
  for (const Cell& cell : cells) {
    open.cells.push_back(cell);
    open.expected_s += durations_s[cell.problem];
    if (open.expected_s >= least_s) {
      chunks.push_back(std::move(open));
      open = {};
    }
  }
  if (!open.cells.empty() && chunks.empty()) {
    chunks.push_back(std::move(open));
  } else if (!open.cells.empty()) {  // too short for a chunk of its own
    Chunk& last = chunks.back();
    last.cells.insert(last.cells.end(), open.cells.begin(), open.cells.end());
    last.expected_s += open.expected_s;
  }
  return chunks;
}

}  // namespace

std::vector<double> measure_cell_durations_s(const StudyPlan& plan) {
  constexpr double kOverhead_s = 0.03;  // for files and for starting a process
  std::vector<double> durations_s;
  for (const StudyProblem& problem : plan.problems) {
    StudyPlan one = plan;
    one.problems = {problem};
    const StudyCost cost = calc_cost(one);
    const CaseSets& sets = problem.loaded.sets;
    const double training_s = measure_case_s(plan, problem, CaseRole::training, sets.training);
    // The cases of a user's program may take long, and those of all sets are alike.
    const double judged_s = problem.loaded.program.empty()
                                ? measure_case_s(plan, problem, CaseRole::test, sets.test)
                                : training_s;
    const double all_s = static_cast<double>(cost.training) * training_s +
                         static_cast<double>(cost.validation + cost.test) * judged_s;
    durations_s.push_back(kOverhead_s + all_s / static_cast<double>(cost.cells));
  }
  return durations_s;
}

double estimate_cell_memory_mib(const StudyPlan& plan) {
  constexpr double kProgram_mib = 96;
  constexpr double kTargets_mib = 128;  // the cache of test cases, which only arms fill
  constexpr double kEvaluation_mib = 32.0 / (1 << 20);
  const bool has_arm = std::ranges::any_of(plan.problems, [](const StudyProblem& problem) {
    return problem.loaded.tracking() != nullptr;
  });
  int fewest_cases = plan.problems.front().schedule.cases;
  for (const Cell& cell : list_cells(plan)) {
    fewest_cases = std::min(fewest_cases, get_schedule(plan, cell).cases);
  }
  const double evaluations =
      static_cast<double>(plan.budget) / static_cast<double>(std::max(1, fewest_cases));
  return kProgram_mib + (has_arm ? kTargets_mib : 0) + kEvaluation_mib * evaluations;
}

std::vector<Chunk> plan_chunks(std::span<const Cell> cells, std::span<const double> durations_s,
                               double least_s, std::size_t most) {
  double total_s = 0;
  for (const Cell& cell : cells) {
    total_s += durations_s[cell.problem];
  }
  // If every chunk takes at least the whole time / `most`, there are at most `most` chunks.
  return cut_chunks(cells, durations_s, std::max(least_s, total_s / static_cast<double>(most)));
}

}  // namespace armwright
