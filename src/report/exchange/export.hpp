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

// Of all runs of a folder, or of one run of an arm: one of the two is there.
struct ExportFormat {
  std::string name;
  std::string title;  // one line
  void (*write)(const Survey& survey, const std::filesystem::path& folder) = nullptr;
  void (*write_arm)(const FinishedArm& arm, const std::filesystem::path& folder) = nullptr;
};

// csv, ioh, coco, json; ros2-control, urdf, datasheet
std::span<const ExportFormat> export_formats();

struct ExportSummary {
  std::filesystem::path folder;
  Survey survey;
  std::size_t unfinished = 0;  // cells that were left out
  // Of an arm: whose winner it is, and the files that were written. Empty for all other formats.
  std::string winner;
  std::vector<std::string> files;
};

// The runs in `folder` as `format` in the new folder `out`, or, if that is empty, in
// folder/export-FORMAT. Error{usage} for an unknown format, if anything is at `out` already, and
// what find_runs(), survey_runs(), load_finished_arm() and the formats refuse.
ExportSummary export_runs(const std::filesystem::path& folder, std::string_view format,
                          std::filesystem::path out);

}  // namespace armwright
