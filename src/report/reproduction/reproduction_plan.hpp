// Plans a reproduction: the published designs of configs/designs on the problems they were made for
// and, for a whole one, the winners of its runs and a sweep.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "problems/config/design_file.hpp"
#include "problems/config/problem_loader.hpp"
#include "report/reproduction/reproduction_config.hpp"
#include "study/run/run_plan.hpp"

namespace armwright {

// A part with everything that its evaluation needs.
struct PlannedPart {
  ReproductionPart part;
  LoadedProblem problem;
  ArmDesign design;  // only of a shipped design
  std::uint64_t cases = 0;
};

// The user's request.
struct ReproductionRequest {
  std::string config = "thesis";       // a shipped reproduction or a file
  std::vector<std::string> tables;     // only these designs, as "A.10" or "table-a10"; empty: all
  std::optional<std::uint64_t> cases;  // per test set; empty: the number that each problem says
  std::vector<std::string> overrides;  // KEY=VALUE for every problem, such as engines
  bool whole = false;                  // also what `config` lists beyond the published designs
};

struct ReproductionPlan {
  ReproductionRequest request;
  std::vector<PlannedPart> parts;
  std::vector<RunPlan> runs;  // in the order in which the parts need them
};

// Loads and checks everything. With `tables`, a whole reproduction has only the parts that need
// nothing but these designs. Throws Error{usage} for an unknown table and for two parts with the
// same label, and what load_problem(), load_design() and load_reproduction_config() throw.
ReproductionPlan plan_reproduction(const ReproductionRequest& request);

// Returns a sorting key that puts A.5 before A.10: "table-a10" -> {"table-a", 10}.
std::pair<std::string, long long> get_natural_key(const std::string& name);
// Returns the name of a shipped design's table in the source: "table-a10" -> "A.10". Other names
// stay as they are.
std::string get_table_name(const std::string& design);

}  // namespace armwright
