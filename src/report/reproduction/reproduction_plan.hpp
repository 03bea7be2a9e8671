// What a reproduction computes: the published designs of configs/designs on the problems they were
// made for, and, of a whole one, the winners of what is optimized anew and a sweep. Each part is
// one design on the test set of one problem.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "problems/config/design_file.hpp"
#include "problems/config/problem_loader.hpp"
#include "study/run/run_plan.hpp"

namespace armwright {

struct ReproductionPart {
  enum class Kind { published, unpublished, anew, sweep };
  Kind kind = Kind::published;
  std::string label;   // one part each: "A.10 (E6)", "E1", "q4-speed 0.5"
  std::string design;  // a shipped one; empty if it is the winner of `run`
  std::string run;     // what is optimized anew: the name of its problem and of its folder
  std::string problem;
  std::vector<std::string> overrides;
  std::optional<double> published_error_m;
  std::optional<double> published_torque_n_m;
  std::string where;
  std::optional<double> value;  // of a sweep
};

struct PlannedPart {
  ReproductionPart part;
  LoadedProblem problem;
  ArmDesign design;  // of a shipped one
  std::uint64_t cases = 0;
};

struct ReproductionRequest {
  std::string config = "thesis";       // a shipped reproduction or a file: what a whole one has
  std::vector<std::string> tables;     // only these designs, as "A.10" or "table-a10"; empty: all
  std::optional<std::uint64_t> cases;  // of each test set; nothing: as many as the problem says
  std::vector<std::string> overrides;  // of every problem, as KEY=VALUE: engines
  bool whole = false;                  // more than the published designs
};

struct ReproductionPlan {
  ReproductionRequest request;
  std::vector<PlannedPart> parts;
  std::vector<RunPlan> runs;  // in the order in which the parts need them
};

// Everything is loaded and checked. Error{usage} for a table that does not exist and everything
// that load_problem and load_design refuse. With `tables`, of a whole one only what needs nothing
// but these designs.
ReproductionPlan plan_reproduction(const ReproductionRequest& request);

// "table-a10" -> {"table-a", 10}: so that A.5 comes before A.10.
std::pair<std::string, long long> get_natural_key(const std::string& name);
// What people call the table of a shipped design: "table-a10" is A.10.
std::string get_table_name(const std::string& design);

}  // namespace armwright
