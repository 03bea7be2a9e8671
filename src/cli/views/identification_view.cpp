#include "cli/views/identification_view.hpp"

#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "base/text.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/table.hpp"

namespace armwright {
namespace {

using nlohmann::json;

// JSON has no infinite numbers and no NaN: they are null.
double get_number(const json& object, const char* key) {
  const json& value = object.at(key);
  return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

std::string get_text(const json& object, const char* key) {
  return sanitize(object.at(key).get<std::string>());
}

// Returns the paths of logs as a user types them here: those in the current folder are relative.
std::string name_logs(const json& logs) {
  std::string names;
  for (const auto& log : logs.get<std::vector<std::string>>()) {
    const std::filesystem::path near =
        std::filesystem::path(log).lexically_proximate(std::filesystem::current_path());
    names += (names.empty() ? "" : ", ") + (near.string().starts_with("..") ? log : near.string());
  }
  return sanitize(names);
}

std::string describe_set(const json& set, const std::string& title, const Style& style) {
  Table table({{"joint", false},
               {"torque itself"},
               {"before"},
               {"after"},
               {"unit", false},
               {"residuals", false}});
  for (const json& joint : set.at("joints")) {
    table.add_row({get_text(joint, "joint"), format_significant(get_number(joint, "deviation"), 4),
                   format_significant(get_number(joint, "rms_before"), 4),
                   format_significant(get_number(joint, "rms_after"), 4), get_text(joint, "unit"),
                   get_number(joint, "whiteness_p") < 0.05
                       ? fmt::format("not white: they repeat over {:.2g} s",
                                     get_number(joint, "independent_s"))
                       : "white"});
  }
  const double before = get_number(set, "error_before");
  const double after = get_number(set, "error_after");
  return "\n" + style.bold(fmt::format("{}: {}", title, name_logs(set.at("logs")))) + "\n" +
         table.format(style, 2) +
         fmt::format("  mean error, in deviations of the torque: {:.4g} -> {:.4g} ({:.3g} times)\n",
                     before, after, after / before);
}

std::string describe_state(const json& parameter) {
  if (!parameter.at("determined").get<bool>()) {
    return "cannot be told";
  }
  return get_number(parameter, "lower") <= 0 && get_number(parameter, "upper") >= 0 ? "may be 0"
                                                                                    : "";
}

std::string describe_parameters(const json& parameters, const Style& style) {
  Table table({{"parameter", false},
               {"before"},
               {"value"},
               {"95 % interval"},
               {"unit", false},
               {"", false}});
  for (const json& parameter : parameters) {
    table.add_row({get_text(parameter, "name"),
                   format_significant(get_number(parameter, "before"), 4),
                   format_significant(get_number(parameter, "value"), 5),
                   fmt::format("{:.4g} to {:.4g}", get_number(parameter, "lower"),
                               get_number(parameter, "upper")),
                   get_text(parameter, "unit"), describe_state(parameter)});
  }
  return table.format(style, 0);
}

}  // namespace

std::string describe_identification(const json& identification, const std::filesystem::path& folder,
                                    const Style& style) {
  std::string text;
  for (const json& doubt : identification.at("doubts")) {
    text += style.bold("doubt: ") + sanitize(doubt.get<std::string>()) + "\n";
  }
  text += describe_parameters(identification.at("parameters"), style);
  for (const json& sentence : identification.at("undetermined")) {
    text += "note: " + sanitize(sentence.get<std::string>()) + "\n";
  }
  text += describe_set(identification.at("fitted"), "Fitted", style);
  if (identification.contains("held_back")) {
    text += describe_set(identification["held_back"], "Held back", style);
  }
  return text + "\n" + style.bold("Files in " + sanitize(folder.string())) +
         "\n  plant.toml           the robot's plant, with what is uncertain (--plant)\n"
         "  identification.json  parameters, intervals, correlations, efforts and residuals\n";
}

}  // namespace armwright
