// All that determines a run's result: problem, optimizer with its options, seed, budget, schedule,
// and how the winner is chosen.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "optimizers/interface/optimizer.hpp"
#include "problems/config/problem_loader.hpp"

namespace armwright {

// Which of a run's designs are judged on the validation set; the best of them there is the winner
// and meets the test set.
struct Selection {
  int last = 40;  // the last N different incumbents (cases that change: bests of generations
                  // and recommendations)
  int best = 5;   // and the N with the best training objective
};

struct RunPlan {
  LoadedProblem problem;
  OptimizerRow optimizer;
  Options options;
  std::uint64_t seed = 1;
  std::int64_t budget = 0;  // simulated training cases
  Schedule schedule;
  Racing racing;
  Selection selection;
};

// The problem's own schedule; where that changes its cases and the optimizer has no generations,
// the first `fixed_cases` cases for every candidate.
Schedule choose_schedule(const LoadedProblem& problem, const OptimizerRow& optimizer);

// Whether the optimizer gets residuals; for others they are neither made nor recorded.
bool wants_residuals(const OptimizerRow& optimizer);

// Whether candidates race at all under an optimizer: residuals are of all cases or of no use, and a
// batch is a field of competitors only where it is a generation or a sample; the points of a
// difference quotient are none.
bool can_race(const OptimizerRow& optimizer, Racing::Kind kind);
// Why racing changes nothing; empty if it does, or if there is none.
std::string explain_no_race(const OptimizerRow& optimizer, const Racing& racing,
                            const Schedule& schedule);

// Checks what no single part can: optimizer against schedule and problem. Throws Error{usage}.
void check_plan(const RunPlan& plan);

// The plan as JSON text with sorted keys; equal texts give bit-identical runs on the same machine
// and version.
std::string to_json(const RunPlan& plan);

// "q1-complex-ga-seed1"
std::string make_run_name(const RunPlan& plan);

}  // namespace armwright
