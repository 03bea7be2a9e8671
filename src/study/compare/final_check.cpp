#include "study/compare/final_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/bits.hpp"
#include "base/error.hpp"
#include "base/file.hpp"
#include "study/case_runner.hpp"
#include "study/compare/escape.hpp"
#include "study/json_values.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr std::size_t kCheckLimit_bytes = std::size_t{1} << 20;

// The replicate whose winner is best on the validation set; nothing if none has one.
const CellOutcome* find_best(std::span<const CellOutcome> cells, const std::string& problem,
                             const std::string& optimizer) {
  const CellOutcome* best = nullptr;
  for (const CellOutcome& cell : cells) {
    if (cell.problem == problem && cell.optimizer == optimizer && !cell.x.empty() &&
        (best == nullptr || cell.validation_value < best->validation_value)) {
      best = &cell;
    }
  }
  return best;
}

std::optional<FinalCheck> load_check(const std::filesystem::path& file, const StudyPlan& plan,
                                     const CellOutcome& cell) {
  if (!std::filesystem::exists(file)) {
    return std::nullopt;
  }
  try {
    const json j = json::parse(read_file(file, kCheckLimit_bytes));
    if (j.at("engine") != plan.final_engine ||
        !same_bits(j.at("x").get<std::vector<double>>(), cell.x)) {
      return std::nullopt;  // of an earlier, smaller plan
    }
    return FinalCheck{cell.replicate, plan.final_engine, value_from_json(j.at("value")),
                      summary_from_json(j.at("test"))};
  } catch (const json::exception& error) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: is not what armwright wrote ({}); remove it, and the same command "
                            "makes it again",
                            file.string(), error.what()));
  }
}

void save_check(const std::filesystem::path& file, const FinalCheck& check,
                const CellOutcome& cell) {
  make_folder(file.parent_path());
  const json j = {{"engine", check.engine},
                  {"replicate", check.replicate},
                  {"x", cell.x},
                  {"value", value_to_json(check.value)},
                  {"test", summary_to_json(check.errors)}};
  write_file_atomically(file, j.dump(1) + "\n");
}

// The problem as it is, but judged on the final engine.
LoadedProblem load_on_engine(const StudyProblem& problem, const std::string& engine) {
  std::vector<std::string> settings;
  for (const std::string& setting : problem.settings) {
    if (!setting.starts_with("physics.engine") && !setting.starts_with("physics.judging_engine") &&
        !setting.starts_with("physics.precision") && !setting.starts_with("physics.simd")) {
      settings.push_back(setting);
    }
  }
  settings.push_back("physics.engine=" + engine);
  return load_problem(problem.name, settings);
}

}  // namespace

bool add_final_checks(const StudyPlan& plan, const std::filesystem::path& study, unsigned jobs,
                      StopSignal& stop, RunObserver& observer, StudyResult& result) {
  if (plan.final_engine.empty()) {
    return true;
  }
  Progress progress;
  progress.phase = Progress::Phase::test;
  for (const StudyProblem& problem : plan.problems) {
    progress.total +=
        problem.loaded.tracking
            ? plan.optimizers.size() * static_cast<std::size_t>(problem.loaded.sets.test_cases)
            : 0;
  }
  ThreadPool pool(jobs);
  for (std::size_t p = 0; p < plan.problems.size(); ++p) {
    const StudyProblem& problem = plan.problems[p];
    if (!problem.loaded.tracking) {
      continue;
    }
    const LoadedProblem judged = load_on_engine(problem, plan.final_engine);
    const ProblemDescription& description = judged.problem->description();
    CaseRunner runner(*judged.problem, pool, stop);
    CaseBlock block{CaseRole::test, judged.sets.test,
                    std::vector<std::uint64_t>(static_cast<std::size_t>(judged.sets.test_cases))};
    std::iota(block.numbers.begin(), block.numbers.end(), std::uint64_t{0});
    for (std::size_t o = 0; o < plan.optimizers.size(); ++o) {
      const std::string& optimizer = plan.optimizers[o].label;
      observer.on_progress(progress);
      progress.done += block.numbers.size();
      const CellOutcome* best = find_best(result.cells, problem.label, optimizer);
      if (best == nullptr) {
        continue;
      }
      const auto file =
          study / "final" / escape_name(problem.label) / (escape_name(optimizer) + ".json");
      auto& check = result.problems[p].optimizers[o].final_check;
      check = load_check(file, plan, *best);
      if (check) {
        progress.replayed += block.numbers.size();
        continue;
      }
      Evaluation evaluation;
      const std::span<const double> x = best->x;
      runner.run({&x, 1}, block, false,
                 [&](std::size_t, Evaluation done) { evaluation = std::move(done); });
      if (stop.requested()) {
        return false;
      }
      check =
          FinalCheck{best->replicate, plan.final_engine, calc_test_value(description, evaluation),
                     summarize(evaluation.case_errors, kFailureError_m)};
      save_check(file, *check, *best);
    }
  }
  return true;
}

}  // namespace armwright
