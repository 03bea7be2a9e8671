// Runs in the data format "bbob-new2" of COCO (Hansen, Auger, Ros, Mersmann, Tušar, Brockhoff 2021,
// "COCO: a platform for comparing continuous optimizers in a black-box setting", Optimization
// Methods and Software 36(1)), as cocopp reads it. The suite is called 'sbox-cost', the one of
// cocopp's that needs no reference data of its own.
//
//   LABEL/bbobexp_fN.info                          N: problems by name, from 1 to at most 24
//   LABEL/data_fN/bbobexp_fN_DIMd.dat              a row where a level of the objective is reached
//   LABEL/data_fN/bbobexp_fN_DIMd.tdat             a row at certain numbers of evaluations
//   LABEL/data_fN/bbobexp_fN_DIMd.{rdat,mdat}      headers only: no restarts and recommendations
//
// The optimum is unknown: Fref, the best feasible objective of all exported runs on the problem,
// stands in its place (0 if nothing was feasible). An evaluation that is not feasible counts as
// 1e10, or as the next power of ten above all that are, in both fitness columns. With constraints,
// evaluations of g are counted as those of f, and the column of g-values has a digit for each.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "report/formats/run_traces.hpp"

namespace armwright {

void write_coco(const Survey& survey, const std::filesystem::path& folder);

// Whether a difference to the reference reaches a new level 10^(k/20), of which the least is 1e-8.
// The first one always does.
class LevelTrigger {
 public:
  bool reaches(double difference);

 private:
  std::optional<int> level_;  // k
};

// Whether an evaluation's number, asked for in rising order, is the whole part of 10^(k/20), or
// 1, 2 or 5 times 10^j times the dimension.
class EvaluationTrigger {
 public:
  explicit EvaluationTrigger(std::size_t dimension) : dimension_(dimension) {}
  bool matches(std::uint64_t evaluation);

 private:
  std::uint64_t dimension_;
  int power_ = 0;  // k
};

// One digit a constraint: 0 for a met one, then 1 up to 1e-7, 2 up to 1e-6, ..., 8 up to 1, 9
// above.
std::string format_constraint_digits(std::span<const double> constraint_values);

// What is known only from all runs on the problem.
struct CocoScale {
  double reference = 0;      // Fref
  double infeasible = 1e10;  // what stands for the objective of evaluations that are not feasible
  std::size_t constraints = 0;
};
CocoScale make_coco_scale(const ProblemRuns& problem);

struct CocoRun {
  std::string header;  // the line above the rows in all files
  std::string dat;     // rows
  std::string tdat;
  std::string summary;  // "1:200|3.1e-03": replicate, evaluations and best - Fref
};
CocoRun make_coco_run(const RunTrace& trace, const CocoScale& scale);

}  // namespace armwright
