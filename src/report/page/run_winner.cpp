// Makes the parts of a run's page that show its winner without an arm: constraints, metrics, signals
// and files; and of any run the variables that matter.

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>

#include "base/base64.hpp"
#include "base/folder.hpp"
#include "base/folder_checksums.hpp"
#include "base/text.hpp"
#include "report/evidence/page_json.hpp"
#include "report/page/run_parts.hpp"
#include "study/analysis/importance.hpp"
#include "study/run/run_folder.hpp"
#include "study/run/winner_record.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using namespace std::string_view_literals;

constexpr std::size_t kMostReasons = 50;
constexpr std::size_t kReasonLimit_bytes = 500;
constexpr std::size_t kWinnerRecordLimit_bytes = std::size_t{1} << 30;
constexpr std::size_t kFilesLimit_bytes = std::size_t{16} << 20;  // for all files of a winner

// Returns the type of an image by its first bytes, "text/csv" by the name, or an empty text. The
// page shows only these types.
std::string find_media_type(const std::string& name, std::string_view bytes) {
  if (bytes.starts_with("\x89PNG\r\n\x1a\n"sv)) {
    return "image/png";
  }
  if (bytes.starts_with("\xff\xd8\xff"sv)) {
    return "image/jpeg";
  }
  constexpr std::size_t kHead_bytes = 1000;
  const std::string_view head = bytes.substr(0, kHead_bytes);
  if (head.starts_with("<svg") ||
      (head.starts_with("<?xml") && head.find("<svg") != std::string_view::npos)) {
    return "image/svg+xml";
  }
  const bool is_text = head.find('\0') == std::string_view::npos;
  return name.ends_with(".csv") && is_text ? "text/csv" : "";
}

}  // namespace

json make_limits(const RecordedRun& run) {
  json list = json::array();
  if (!run.result || !run.result->winner) {
    return list;
  }
  const RunResult& result = *run.result;
  for (std::size_t i = 0; i < result.constraints.size(); ++i) {
    // Without limits a constraint is g, which must not exceed 0.
    const bool has_limit = i < result.limits.size();
    const double limit = has_limit ? result.limits[i].value : 0;
    json& row =
        list.emplace_back(json{{"quantity", run.make_quantity(has_limit ? result.limits[i].quantity
                                                                        : result.constraints[i])},
                               {"limit", limit},
                               {"value", nullptr},
                               {"is_met", nullptr}});
    if (i < result.test.constraint_values.size()) {
      const double g = result.test.constraint_values[i];
      row["value"] = finite_or_null(has_limit ? (1 + g) * limit : g);
      row["is_met"] = g <= 0;
    }
  }
  return list;
}

json make_metrics(const RecordedRun& run) {
  json list = json::array();
  if (!run.result || !run.result->winner || run.has_arm()) {
    return list;
  }
  const std::vector<Quantity> metrics = run.describe().metrics;
  const RunResult& result = *run.result;
  for (std::size_t i = 0; i < std::min(result.metric_names.size(), result.test.metrics.size());
       ++i) {
    const std::string unit = i < metrics.size() ? metrics[i].unit : "";
    list.push_back({{"quantity", run.make_quantity({result.metric_names[i], unit})},
                    {"value", finite_or_null(result.test.metrics[i])}});
  }
  return list;
}

json make_failure_reasons(const RecordedRun& run) {
  std::map<std::string, std::uint64_t> counts;
  for (const EvaluationRecord& record : run.journal.training) {
    const Evaluation& evaluation = record.evaluation;
    if (evaluation.status != EvaluationStatus::ok &&
        evaluation.status != EvaluationStatus::abandoned) {
      const std::string& reason =
          evaluation.reason.empty() ? to_string(evaluation.status) : evaluation.reason;
      ++counts[sanitize(reason.substr(0, kReasonLimit_bytes))];
    }
  }
  std::vector<std::pair<std::string, std::uint64_t>> sorted(counts.begin(), counts.end());
  std::ranges::stable_sort(sorted, std::greater{}, &std::pair<std::string, std::uint64_t>::second);
  json list = json::array();
  for (std::size_t i = 0; i < std::min(sorted.size(), kMostReasons); ++i) {
    list.push_back({{"reason", sorted[i].first}, {"count", sorted[i].second}});
  }
  return list;
}

json make_importance(const RecordedRun& run) {
  if (!run.result || !run.problem || run.is_identification()) {
    return nullptr;
  }
  return json::parse(to_json(calc_importance(run.folder, run.problem->problem->description())));
}

void add_winner_record(const RecordedRun& run, json& page, std::vector<std::string>& notes) {
  const FolderChecksums checksums(run.folder);
  std::size_t left_bytes = kFilesLimit_bytes;
  for (const auto& [name, hash] : checksums.lines()) {
    const bool is_record = name == kWinnerRecord;
    if (!is_record && !name.starts_with(kWinnerFiles)) {
      continue;
    }
    if (!path_exists(run.folder / name)) {
      notes.push_back(fmt::format("{} is missing; the command that began the run makes it again.",
                                  sanitize(name)));
      continue;
    }
    const std::string bytes = checksums.read(name, kWinnerRecordLimit_bytes);
    if (bytes.size() > left_bytes) {
      notes.push_back(
          fmt::format("{} is left out, because the winner's files have more than {} MiB together.",
                      sanitize(name), kFilesLimit_bytes >> 20));
      continue;
    }
    left_bytes -= bytes.size();
    if (is_record) {
      page["record"] = bytes;
      continue;
    }
    const std::string type = find_media_type(name, bytes);
    const bool is_csv = type == "text/csv";
    const std::vector<std::uint8_t> octets(bytes.begin(), bytes.end());
    page["files"].push_back({{"name", name.substr(std::string_view(kWinnerFiles).size())},
                             {"bytes", bytes.size()},
                             {"type", type},
                             {"text", is_csv ? json(bytes) : json(nullptr)},
                             {"base64", is_csv ? "" : to_base64(octets)}});
  }
}

}  // namespace armwright
