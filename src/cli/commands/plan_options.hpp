// The flags that make the plan of one run, for the commands that run or ask an optimizer.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "cli/terminal/arguments.hpp"
#include "study/run/run_plan.hpp"

namespace armwright {

struct PlanOptions {
  std::string problem;
  std::string optimizer;
  std::vector<std::string> opt;
  std::string seed = "1";
  std::string budget;
  std::string schedule;
  std::string racing;
  OverrideOptions overrides;
  std::string validation_cases;

  // Adds --optimizer, --opt, --seed and --budget.
  void add_to(CLI::App& command);
  std::vector<std::string> get_overrides() const;
  std::string get_problem() const;
  // Throws Error{usage} for a value that is not possible, and what loading a problem throws.
  RunPlan make_plan() const;
};

}  // namespace armwright
