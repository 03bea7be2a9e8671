// Writes runs in the formats that other programs read.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "report/formats/run_traces.hpp"

namespace armwright {

struct FinishedArm;

// A row of the table of formats. A format has one of the two functions: `write` for all runs of a
// folder, `write_arm` for one run of an arm.
struct ExportFormat {
  std::string name;
  std::string title;  // one line
  void (*write)(const CollectedRuns& runs, const std::filesystem::path& folder) = nullptr;
  void (*write_arm)(const FinishedArm& arm, const std::filesystem::path& folder) = nullptr;
};

// Returns the table: csv, ioh, coco, json; ros2-control, urdf, datasheet.
std::span<const ExportFormat> export_formats();

// What export_runs() has written.
struct ExportSummary {
  std::filesystem::path folder;
  CollectedRuns collected;     // empty for the formats of one arm
  std::size_t unfinished = 0;  // cells that were left out
  // The next three are empty except for the formats of one arm.
  std::string winner;              // a description of the winner
  std::vector<std::string> files;  // the names of the files, sorted
  std::vector<std::string> warnings;
};

// Exports the runs in `folder` as `format` to the new folder `out`. An empty `out` stands for
// folder/export-FORMAT. Throws Error{usage} for an unknown format and if anything but an empty
// folder is at `out`; Error{io}; and what find_runs(), collect_runs(), load_finished_arm() and the
// formats throw. `force` writes a winner with faults, too (list_faults() in study/run/run_result.hpp).
ExportSummary export_runs(const std::filesystem::path& folder, std::string_view format,
                          std::filesystem::path out, bool force);

}  // namespace armwright
