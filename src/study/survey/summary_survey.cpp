// Compares the summaries in stored files (result.json, cell.json) with the values that they summarise,
// and files with their checksums.

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/bits.hpp"
#include "base/error.hpp"
#include "base/folder_checksums.hpp"
#include "base/text.hpp"
#include "study/run/json_values.hpp"
#include "study/survey/derived_survey.hpp"

namespace armwright {
namespace {

using nlohmann::json;

// Returns the path of the first value that both have and that differs.
std::string find_other_value(const json& recorded, const json& computed, const std::string& path) {
  if (recorded.is_object() && computed.is_object()) {
    for (const auto& [key, value] : recorded.items()) {
      if (!computed.contains(key)) {
        continue;
      }
      if (std::string found = find_other_value(
              value, computed[key], path.empty() ? key : fmt::format("{}.{}", path, key));
          !found.empty()) {
        return found;
      }
    }
    return "";
  }
  if (recorded.is_array() && computed.is_array() && recorded.size() == computed.size()) {
    for (std::size_t i = 0; i < recorded.size(); ++i) {
      if (std::string found =
              find_other_value(recorded[i], computed[i], fmt::format("{}[{}]", path, i));
          !found.empty()) {
        return found;
      }
    }
    return "";
  }
  return recorded == computed ? "" : path;
}

bool is_same_value(double a, double b) {
  return same_bits({&a, 1}, {&b, 1});
}

// Compares the winner's values. A study that judges along the run may have chosen another design
// than the run; then the value must be that of the last choice.
std::string find_winner_difference(const CellOutcome& cell, const RunResult& result) {
  const JudgedCandidate* winner = result.winner ? &result.judged[*result.winner] : nullptr;
  if (winner == nullptr ? cell.x.empty() : same_bits(cell.x, winner->candidate.x)) {
    if (winner == nullptr) {
      return std::isfinite(cell.value) ? "it has a value, and the run has no winner" : "";
    }
    // The study's tolerance decides whether a violated constraint counts, so both are possible then.
    const auto is_of = [&](double value, const Evaluation& evaluation) {
      const bool has_value = !evaluation.objectives.empty() && evaluation.failed_cases == 0;
      const bool may_fail = !has_value || calc_violation(evaluation.constraint_values) > 0;
      return (has_value && is_same_value(value, calc_target(result, evaluation))) ||
             (may_fail && is_same_value(value, std::numeric_limits<double>::infinity()));
    };
    const struct {
      const char* what;
      bool is_same;
    } checks[] = {
        {"value", is_of(cell.value, result.test)},
        {"validation_value", is_of(cell.validation_value, winner->validation)},
        {"violation", is_same_value(cell.violation, calc_violation(result.test.constraint_values))},
        {"objectives", same_bits(cell.objectives, result.test.objectives)},
        {"metrics", same_bits(cell.metrics, result.test.metrics)},
        {"test", summary_to_json(cell.errors) == summary_to_json(result.test_summary)},
    };
    for (const auto& [what, is_same] : checks) {
      if (!is_same) {
        return fmt::format("its {} is not that of the run's winner", what);
      }
    }
    return "";
  }
  return cell.choices.empty() || !is_same_value(cell.choices.back().value, cell.value)
             ? "its design is not the run's winner"
             : "";
}

}  // namespace

std::string find_summary_difference(const std::string& text, const RunResult& result) {
  const std::string place = find_other_value(json::parse(text), json::parse(to_json(result)), "");
  return place.empty() ? "" : fmt::format("its {} does not follow from its other values", place);
}

std::string find_cell_difference(const CellOutcome& cell, const RunResult& result,
                                 const std::filesystem::path& name) {
  const struct {
    const char* what;
    std::uint64_t here;
    std::uint64_t there;
  } counts[] = {
      {"evaluations", cell.evaluations, result.counts.evaluations},
      {"cases", cell.cases, result.counts.cases},
      {"evaluations outside the bounds", cell.clipped, result.counts.clipped},
      {"failed evaluations", cell.failed_evaluations, result.counts.failed},
  };
  for (const auto& [what, here, there] : counts) {
    if (here != there) {
      return fmt::format("it counts {} {}, and result.json {}", here, what, there);
    }
  }
  if (cell.end_reason != result.end_reason || cell.failure != result.failure) {
    return "its end is not that of result.json";
  }
  if (cell.optimizer_name != result.optimizer) {
    return fmt::format("its optimizer is {}, and that of result.json {}", cell.optimizer_name,
                       result.optimizer);
  }
  const auto place = std::filesystem::path("cells") / escape_name(cell.problem) /
                     escape_name(cell.optimizer) / fmt::format("r{:02}", cell.replicate);
  if (*name.begin() == "cells" && name != place) {
    return fmt::format("it is of another cell, {}", place.string());
  }
  return find_winner_difference(cell, result);
}

ChecksumSurvey survey_checksums(const std::filesystem::path& folder,
                                const std::vector<std::string>& expected) {
  ChecksumSurvey survey;
  try {
    const FolderChecksums checksums(folder);
    survey.is_there = checksums.is_there();
    survey.lines = checksums.lines();
    for (const auto& [name, sha256] : checksums.lines()) {
      std::error_code error;
      const auto status = std::filesystem::status(folder / name, error);
      if (!std::filesystem::exists(status)) {
        survey.missing.insert(name);
      } else if (std::filesystem::is_regular_file(status)) {
        std::string change = checksums.find_change(name);
        if (!change.empty()) {
          survey.changed.emplace(name, "it " + change);
        }
      }
    }
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::io) {
      throw;
    }
    survey.is_there = true;
    survey.fault = sanitize(error.what());
  }
  for (const std::string& name : expected) {
    if (!survey.lines.contains(name)) {
      survey.uncovered.push_back(name);
    }
  }
  return survey;
}

}  // namespace armwright
