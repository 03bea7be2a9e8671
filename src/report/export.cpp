#include "report/export.hpp"

#include <algorithm>
#include <array>

#include "base/error.hpp"
#include "base/text.hpp"
#include "report/coco.hpp"
#include "report/export_folder.hpp"
#include "report/ioh.hpp"
#include "report/tables.hpp"

namespace armwright {

std::span<const ExportFormat> export_formats() {
  static const std::array<ExportFormat, 4> formats = {{
      {"csv", "tables: every run, every evaluation; designs and test cases", write_csv},
      {"ioh", "IOHprofiler's JSON, for IOHanalyzer", write_ioh},
      {"coco", "COCO's bbob-new2, for cocopp; at most 24 problems", write_coco},
      {"json", "all of it nested in one file, and the test cases", write_json},
  }};
  return formats;
}

ExportSummary export_runs(const std::filesystem::path& folder, std::string_view format,
                          std::filesystem::path out) {
  const auto formats = export_formats();
  const auto chosen = std::ranges::find(formats, format, &ExportFormat::name);
  if (chosen == formats.end()) {
    std::vector<std::string> names;
    std::ranges::transform(formats, std::back_inserter(names), &ExportFormat::name);
    throw Error(ErrorKind::usage, describe_unknown("--format", format, names));
  }
  FoundRuns found = find_runs(folder);
  if (out.empty()) {
    out = folder / ("export-" + chosen->name);
  }
  ExportFolder target(out);
  ExportSummary summary;
  summary.folder = std::move(out);
  summary.unfinished = found.unfinished;
  summary.survey = survey_runs(found.runs);
  chosen->write(summary.survey, target.path());
  target.put_in_place();
  return summary;
}

}  // namespace armwright
