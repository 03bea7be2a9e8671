// The rows of the exports give the expected running times that cocopp and IOHanalyzer have computed
// from them. The numbers and how they were made: tests/data/exports/running_times.json.

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/file.hpp"
#include "report/formats/formats.hpp"
#include "report/hand_made_traces.hpp"

namespace armwright {
namespace {

using nlohmann::json;

// Returns a run with the improvements [evaluation, objective], ..., and a large objective elsewhere.
RunTrace make_run(std::uint64_t evaluations, const json& improvements, std::size_t dimension) {
  RunTrace trace;
  trace.function.optimum = 0;
  trace.names.variables.assign(dimension, "x");
  trace.evaluations = TracedEvaluations([=](const TracedEvaluations::Visitor& visitor) {
    std::size_t next = 0;
    for (std::uint64_t number = 1; number <= evaluations; ++number) {
      TracedEvaluation evaluation;
      evaluation.number = number;
      evaluation.feasible = true;
      evaluation.objective = 1e9;
      if (next < improvements.size() && improvements[next][0] == number) {
        evaluation.objective = improvements[next++][1].get<double>();
      }
      evaluation.x.assign(dimension, 0.5);
      visitor(evaluation);
    }
  });
  return trace;
}

struct Hit {
  double evaluations = 0;  // to the target, or to the end
  bool reached = false;
};

// Returns when a column of a file's rows reaches the target. A row's first column is the number of
// the evaluation; lines that do not begin with a digit are headers.
Hit find_hit(const std::string& rows, std::size_t column, double target) {
  Hit hit;
  std::istringstream lines(rows);
  for (std::string line; std::getline(lines, line);) {
    if (std::isdigit(static_cast<unsigned char>(line[0])) == 0) {
      continue;
    }
    std::istringstream fields(line);
    double value = std::numeric_limits<double>::infinity();
    fields >> hit.evaluations;
    for (std::size_t i = 0; i < column; ++i) {
      fields >> value;
    }
    if (value <= target) {
      hit.reached = true;
      break;
    }
  }
  return hit;
}

// COCO's definition: the evaluations of all runs up to their hit or end, divided by the hits.
double calc_expected(const std::vector<Hit>& hits) {
  double spent = 0;
  double reached = 0;
  for (const Hit& hit : hits) {
    spent += hit.evaluations;
    reached += hit.reached ? 1 : 0;
  }
  return spent / reached;
}

TEST(ExpectedRunningTime, OfTheExportedRowsIsThatOfCocoppAndIohanalyzer) {
  const json oracle = json::parse(
      read_file(std::string(ARMWRIGHT_TEST_DATA) + "/exports/running_times.json", 1 << 20));
  std::size_t pairs = 0;
  for (const json& cell : oracle.at("cells")) {
    std::vector<RunTrace> runs;
    for (const json& run : cell.at("runs")) {
      runs.push_back(make_run(run.at("evaluations"), run.at("improvements"), cell.at("dimension")));
    }
    for (const json& time : cell.at("times")) {
      const double target = time.at("target");
      std::vector<Hit> coco;
      std::vector<Hit> ioh;
      for (const RunTrace& run : runs) {
        coco.push_back(find_hit(make_coco_run(run, {}).dat, 2, target));
        ioh.push_back(find_hit(make_ioh_rows(run), 1, target));
      }
      const std::string where = cell.at("problem").get<std::string>() + " " +
                                cell.at("optimizer").get<std::string>() + " " +
                                std::to_string(target);
      EXPECT_NEAR(calc_expected(coco), time.at("cocopp").get<double>(), 1e-3) << where;
      // IOHanalyzer charges a run without a hit with the evaluations of the longest run.
      double longest = 0;
      for (const RunTrace& run : runs) {
        longest = std::max(longest, static_cast<double>(run.evaluations.last()->number));
      }
      for (Hit& hit : ioh) {
        hit.evaluations = hit.reached ? hit.evaluations : longest;
      }
      EXPECT_NEAR(calc_expected(ioh), time.at("iohanalyzer").get<double>(), 1e-3) << where;
      ++pairs;
    }
  }
  EXPECT_GE(pairs, 20u);
}

}  // namespace
}  // namespace armwright
