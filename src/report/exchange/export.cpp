#include "report/exchange/export.hpp"

#include <algorithm>
#include <array>

#include "base/error.hpp"
#include "base/text.hpp"
#include "report/deliverables/deliverables.hpp"
#include "report/formats/export_files.hpp"
#include "report/formats/formats.hpp"

namespace armwright {

namespace {

void export_all(const std::filesystem::path& folder, const ExportFormat& format,
                ExportSummary& summary) {
  const FoundRuns found = find_runs(folder);
  PartialFolder target(check_export_folder(summary.folder));
  summary.unfinished = found.unfinished;
  summary.collected = collect_runs(found.runs);
  format.write(summary.collected, target.path());
  put_in_place(target);
}

void export_arm(const std::filesystem::path& folder, const ExportFormat& format, bool force,
                ExportSummary& summary) {
  const FinishedArm arm = load_finished_arm(folder, format.name, force);
  PartialFolder target(check_export_folder(summary.folder));
  format.write_arm(arm, target.path());
  put_in_place(target);
  summary.winner = arm.describe();
  summary.warnings = arm.warnings;
  for (const auto& entry : list_folder(summary.folder)) {
    summary.files.push_back(entry.filename().string());
  }
}

}  // namespace

std::span<const ExportFormat> export_formats() {
  static const std::array<ExportFormat, 7> formats = {{
      {"csv", "tables: every run, every evaluation; designs and test cases", write_csv},
      {"ioh", "IOHprofiler's JSON, for IOHanalyzer", write_ioh},
      {"coco", "COCO's bbob-new2, for cocopp, with a program that starts it", write_coco},
      {"json", "all of it nested in one file, and the test cases", write_json},
      {"ros2-control", "one arm: the winner's gains as parameters of ROS 2 controllers (YAML)",
       nullptr, write_ros2_control},
      {"urdf", "one arm: its URDF with the winner's effort limits", nullptr, write_urdf},
      {"datasheet", "one arm: design, results and limits on one page to print (HTML)", nullptr,
       write_datasheet},
  }};
  return formats;
}

ExportSummary export_runs(const std::filesystem::path& folder, std::string_view format,
                          std::filesystem::path out, bool force) {
  const auto formats = export_formats();
  const auto chosen = std::ranges::find(formats, format, &ExportFormat::name);
  if (chosen == formats.end()) {
    std::vector<std::string> names;
    std::ranges::transform(formats, std::back_inserter(names), &ExportFormat::name);
    throw Error(ErrorKind::usage, describe_unknown("--format", format, names));
  }
  ExportSummary summary;
  summary.folder = out.empty() ? folder / ("export-" + chosen->name) : std::move(out);
  if (chosen->write_arm != nullptr) {
    export_arm(folder, *chosen, force, summary);
  } else {
    export_all(folder, *chosen, summary);
  }
  return summary;
}

}  // namespace armwright
