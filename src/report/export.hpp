// Writes runs in the formats that other programs read.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "report/run_traces.hpp"

namespace armwright {

struct ExportFormat {
  std::string name;
  std::string title;  // one line
  void (*write)(const Survey& survey, const std::filesystem::path& folder);
};

// csv, ioh, coco, json
std::span<const ExportFormat> export_formats();

struct ExportSummary {
  std::filesystem::path folder;
  Survey survey;
  std::size_t unfinished = 0;  // cells that were left out
};

// The runs in `folder` as `format` in the new folder `out`, or, if that is empty, in
// folder/export-FORMAT. Error{usage} for an unknown format, if anything is at `out` already, and
// what find_runs(), survey_runs() and the formats refuse.
ExportSummary export_runs(const std::filesystem::path& folder, std::string_view format,
                          std::filesystem::path out);

}  // namespace armwright
