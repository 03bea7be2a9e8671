// Writes and reads cell.json.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "study/compare/cell.hpp"
#include "study/run/json_values.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr int kCellFormat = 1;

json count_to_json(const std::optional<std::uint64_t>& number) {
  return number ? json(*number) : json();
}

std::optional<std::uint64_t> count_from_json(const json& j) {
  return j.is_null() ? std::nullopt : std::optional(whole_from_json(j));
}

json points_to_json(std::span<const CurvePoint> points) {
  json list = json::array();
  for (const CurvePoint& point : points) {
    list.push_back({point.budget, value_to_json(point.value), count_to_json(point.failures)});
  }
  return list;
}

std::vector<CurvePoint> points_from_json(const json& list) {
  std::vector<CurvePoint> points;
  for (const json& point : list) {
    points.push_back({whole_from_json<std::int64_t>(point.at(0)), value_from_json(point.at(1)),
                      point.size() > 2 ? count_from_json(point.at(2)) : std::nullopt});
  }
  return points;
}

}  // namespace

std::string to_json(const CellOutcome& outcome) {
  json j = {
      {"format", kCellFormat},
      {"problem", outcome.problem},
      {"label", outcome.optimizer},
      {"optimizer", outcome.optimizer_name},
      {"replicate", outcome.replicate},
      {"configuration_sha256", outcome.configuration_sha256},
      {"end_reason", outcome.end_reason},
      {"failure", outcome.failure},
      {"evaluations", outcome.evaluations},
      {"cases", outcome.cases},
      {"clipped", outcome.clipped},
      {"failed_evaluations", outcome.failed_evaluations},
      {"x", outcome.x},
      {"validation_value", value_to_json(outcome.validation_value)},
      {"value", value_to_json(outcome.value)},
      {"violation", outcome.violation},
      {"test", summary_to_json(outcome.errors)},
      {"objectives", outcome.objectives},
      {"metrics", outcome.metrics},
      {"start_value", value_to_json(outcome.start_value)},
      {"start_failures", count_to_json(outcome.start_failures)},
      {"curve", points_to_json(outcome.curve)},
      {"choices", points_to_json(outcome.choices)},
      {"front", outcome.front},
      {"trace", points_to_json(outcome.trace)},
  };
  return j.dump(1) + "\n";
}

CellOutcome parse_cell(const std::string& text, const std::filesystem::path& file) {
  check_json_depth(text, file.string());
  try {
    const json j = json::parse(text);
    if (j.at("format") != kCellFormat) {
      throw std::runtime_error("its format is not the one this version reads");
    }
    CellOutcome outcome;
    outcome.problem = j.at("problem");
    outcome.optimizer = j.at("label");
    outcome.optimizer_name = j.at("optimizer");
    outcome.replicate = whole_from_json<int>(j.at("replicate"));
    outcome.configuration_sha256 = j.at("configuration_sha256");
    outcome.end_reason = j.at("end_reason");
    outcome.failure = j.at("failure");
    outcome.evaluations = whole_from_json(j.at("evaluations"));
    outcome.cases = whole_from_json(j.at("cases"));
    outcome.clipped = whole_from_json(j.at("clipped"));
    outcome.failed_evaluations = whole_from_json(j.at("failed_evaluations"));
    outcome.x = j.at("x").get<std::vector<double>>();
    outcome.validation_value = value_from_json(j.at("validation_value"));
    outcome.value = value_from_json(j.at("value"));
    outcome.violation = j.at("violation");
    outcome.errors = summary_from_json(j.at("test"));
    outcome.objectives = j.at("objectives").get<std::vector<double>>();
    outcome.metrics = j.at("metrics").get<std::vector<double>>();
    outcome.start_value = value_from_json(j.at("start_value"));
    outcome.start_failures = count_from_json(j.value("start_failures", json()));
    outcome.curve = points_from_json(j.at("curve"));
    outcome.choices = points_from_json(j.value("choices", json::array()));
    outcome.trace = points_from_json(j.at("trace"));
    outcome.front = j.at("front").get<std::vector<std::vector<double>>>();
    return outcome;
  } catch (const std::exception& error) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: is not a cell that armwright wrote ({}); remove it, and the same "
                            "command makes it again from the journal beside it",
                            file.string(), sanitize(error.what())));
  }
}

}  // namespace armwright
