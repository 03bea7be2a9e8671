// Computes what a plan says, and keeps it in a folder if there is one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report/reproduction/reproduction_plan.hpp"
#include "report/reproduction/reproduction_record.hpp"
#include "study/run/run.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {

struct ReproductionWork {
  std::string program = "armwright";  // as the runs' manifests are to name it
  unsigned jobs = 1;
  ReproductionFolder* folder = nullptr;  // null: nothing is kept; a plan with runs needs one
};

// One result a part, in the plan's order; nothing if it was stopped: the folder then has all that
// was finished, and the same call goes on from there. The problems of the plan are let go of.
std::optional<std::vector<PartResult>> execute_reproduction(ReproductionPlan& plan,
                                                            const ReproductionWork& work,
                                                            StopSignal& stop,
                                                            RunObserver& observer);

// The words that make one run of it, or go on with it, beside `program`.
std::vector<std::string> make_run_words(const std::string& program, const RunPlan& run,
                                        const std::filesystem::path& folder);

}  // namespace armwright
