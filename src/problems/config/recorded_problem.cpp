// Problems that are loaded again from the record of a run.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/json_text.hpp"
#include "base/read_limit.hpp"
#include "base/text.hpp"
#include "base/toml_text.hpp"
#include "problems/config/problem_readers.hpp"
#include "sim/proposal/drive_proposal.hpp"

namespace armwright {
namespace {

// Returns a JSON value as TOML in one line.
std::string write_toml(const nlohmann::json& value) {
  const auto write_scalar = [](const nlohmann::json& scalar) {
    return scalar.is_string() ? quote_toml(scalar.get<std::string>()) : scalar.dump();
  };
  std::vector<std::string> parts;
  if (value.is_array()) {
    for (const nlohmann::json& element : value) {
      parts.push_back(write_toml(element));
    }
    return "[" + join(parts, ", ") + "]";
  }
  if (value.is_object()) {
    for (const auto& [key, element] : value.items()) {
      parts.push_back(write_scalar(key) + " = " + write_toml(element));
    }
    return "{" + join(parts, ", ") + "}";
  }
  return write_scalar(value);
}

// Gives keys their present names, where they were renamed after the run.
void rename_old_keys(nlohmann::json& resolved) {
  if (resolved.contains("task") && resolved.at("task").contains("control_period_s")) {
    nlohmann::json& task = resolved.at("task");
    resolved["control"]["period_s"] = task.at("control_period_s");
    task.erase("control_period_s");
  }
}

// Gives keys that version 1.0 did not have the value that says what it did.
void add_old_values(nlohmann::json& resolved) {
  if (resolved.value("kind", "") != "tracking") {
    return;
  }
  if (resolved.contains("robot") && !resolved["task"].contains("solver")) {
    resolved["task"]["solver"] = "scalar";
  }
  if (resolved.contains("robot") && !resolved["training"].contains("failure_rule")) {
    resolved["training"]["failure_rule"] = "thesis";
  }
  if (resolved.contains("robot") && resolved["robot"].value("propose", false) &&
      !resolved["control"].contains("period_s")) {
    resolved["control"]["period_s"] = *kControlPeriod.fallback;
  }
  if (resolved.contains("variables") &&
      resolved["variables"].value("start", "") == kProposedStart &&
      !resolved["variables"].contains("start_bandwidth_rad_per_s")) {
    resolved["variables"]["start_bandwidth_rad_per_s"] = kStartOfVersion1;
  }
}

}  // namespace

std::vector<std::string> list_proposals(nlohmann::json resolved) {
  add_old_values(resolved);
  const std::pair<const char*, std::vector<const char*>> proposed[] = {
      {"task",
       {"orientation", "tool_axis", "tool_rpy_rad", "home", "distance_limit_m", "speed_m_per_s",
        "floor_m"}},
      {"workspace", {"centre_m", "radius_m", "shortest_move_m", "normal"}},
      {"control", {"period_s"}},
      {"physics", {"substeps"}},
      {"variables", {"start_bandwidth_rad_per_s"}}};
  const bool proposes = resolved.contains("robot") && resolved.at("robot").value("propose", false);
  std::vector<std::string> settings;
  for (const auto& [table, keys] : proposed) {
    // A start may be proposed for any robot.
    if (!resolved.contains(table) || (!proposes && table != std::string_view("variables"))) {
      continue;
    }
    for (const char* key : keys) {
      if (resolved.at(table).contains(key)) {
        settings.push_back(
            fmt::format("{}.{}={}", table, key, write_toml(resolved.at(table).at(key))));
      }
    }
  }
  return settings;
}

LoadedProblem load_recorded_problem(const std::string& resolved_json, const std::string& name,
                                    const std::filesystem::path& beside) {
  const ReadStep step(fmt::format("the recorded problem {}", sanitize(name)));
  check_json_depth(resolved_json, name);
  nlohmann::json resolved;
  std::string toml;
  std::vector<double> start;
  try {
    resolved = nlohmann::json::parse(resolved_json);
    if (resolved.contains("replicate")) {
      start = resolved.at("replicate").at("start").get<std::vector<double>>();
      resolved.erase("replicate");
    }
    rename_old_keys(resolved);
    add_old_values(resolved);
    for (const auto& [key, value] : resolved.items()) {
      toml += write_toml(key) + " = " + write_toml(value) + "\n";
    }
  } catch (const nlohmann::json::exception& error) {
    throw Error(ErrorKind::bad_data,
                fmt::format("the recorded configuration of {} is not what armwright wrote ({})",
                            sanitize(name), describe_json_error(error.what())));
  }
  const auto path = beside / (name + ".toml");
  LoadedProblem loaded =
      read_problem(ConfigTable::parse(problem_settings(), toml, path.string()), path,
                   engine_table(), {.may_describe = false, .may_simulate = false});
  if (!start.empty()) {
    if (start.size() != loaded.problem->description().variables.size()) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("the recorded configuration of {} has {} start values for {} "
                              "variables",
                              sanitize(name), start.size(),
                              loaded.problem->description().variables.size()));
    }
    // The recorded instance is that of the replicate.
    loaded = make_replicate(loaded, 1, loaded.sets.training, start);
  }
  return loaded;
}

}  // namespace armwright
