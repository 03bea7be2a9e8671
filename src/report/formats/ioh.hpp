// Runs in the JSON format of IOHprofiler, version 2 of its analyzer logger (Doerr, Wang, Ye, van
// Rijn, Bäck 2018, "IOHprofiler: a benchmarking and profiling tool for iterative optimization
// heuristics", arXiv:1810.05281; de Nobel et al. 2024, "IOHexperimenter", Evolutionary Computation
// 32(3)).
//
//   LABEL/IOHprofiler_fN_PROBLEM.json              one root folder a label; N: problems by name,
//   from 1 LABEL/data_fN_PROBLEM/IOHprofiler_fN_DIMd.dat  of each run a header, then a row at each
//                                                  improvement and one at the last evaluation
//
// raw_y is the objective of that evaluation, of several their weighted sum; `inf` if the evaluation
// is not feasible. Metrics that do not exist are `None`. In JSON, which knows no infinity, the
// largest double stands for the best of a run that found nothing feasible. The names of the
// variables, which the format has no place for, are the experiment attribute "variables".
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "report/formats/run_traces.hpp"

namespace armwright {

void write_ioh(const Survey& survey, const std::filesystem::path& folder);

// A run as it stands in the .dat file, and the names of its columns before x0, x1, ...
std::vector<std::string> make_ioh_columns(const TraceNames& names);
std::string make_ioh_rows(const RunTrace& trace);

}  // namespace armwright
