// The kind "settings": all keys of the files of problems, studies and designs.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"
#include "cli/list/list_views.hpp"
#include "cli/terminal/markdown.hpp"
#include "problems/config/design_file.hpp"
#include "problems/config/plant_file.hpp"
#include "problems/config/problem_loader.hpp"
#include "study/compare/study_plan.hpp"

namespace armwright {
namespace {

using nlohmann::json;

// One kind of configuration file.
struct SettingFile {
  SettingFile(std::string name, std::string lines, const SettingTable& table)
      : prefix(table.listed_as.value()),
        title(std::move(name)),
        words(std::move(lines)),
        settings(list_settings(table)) {}

  std::string prefix;  // of the names; empty for problems, whose keys are those of --set
  std::string title;
  std::string words;  // Markdown
  std::vector<ListedSetting> settings;
};

std::vector<SettingFile> list_setting_files() {
  return {
      {"Problems",
       "`configs/problems/NAME.toml`, or a file of your own. `--set KEY=VALUE` changes a setting "
       "on the command line. `extends = \"NAME\"` starts from another problem and changes it; NAME "
       "is a file beside this one or a shipped problem.",
       problem_settings()},
      {"Studies",
       "`configs/studies/NAME.toml`, or a file of your own, for `armwright compare` "
       "([comparing.md](../comparing.md)). `extends` works as in problems.",
       study_settings()},
      {"Designs",
       "`configs/designs/NAME.toml`, or the `winner.toml` of a run. The controller determines "
       "which gains there are.",
       design_settings()},
      {"Plants",
       "`NAME.plant.toml` beside `NAME.urdf`, or a file that `robot.plant` names "
       "([robots.md](../robots.md)). A table `[joint.NAME]` describes the joint NAME of the URDF.",
       plant_settings()},
  };
}

std::vector<ListItem> list_known_settings() {
  std::vector<ListItem> items;
  for (const SettingFile& file : list_setting_files()) {
    for (const ListedSetting& setting : file.settings) {
      items.push_back({file.prefix + setting.path, setting.setting->meaning});
    }
  }
  return items;
}

// Suggests the names that contain the typed text, for example a key without its unit, or else the
// nearest name.
std::string suggest(const std::string& typed, const std::vector<std::string>& names) {
  constexpr std::size_t kMostSuggested = 5;
  std::vector<std::string> holding;
  std::ranges::copy_if(names, std::back_inserter(holding), [&](const std::string& name) {
    return name.find(typed) != std::string::npos;
  });
  if (const auto nearest = find_nearest(typed, names); holding.empty() && nearest) {
    holding.push_back(*nearest);
  }
  if (holding.empty() || holding.size() > kMostSuggested) {
    return ".";
  }
  return fmt::format("; did you mean '{}'?", join(holding, "' or '"));
}

const AnySetting& find_setting(const std::string& name) {
  std::vector<std::string> names;
  for (const SettingFile& file : list_setting_files()) {
    for (const ListedSetting& setting : file.settings) {
      names.push_back(file.prefix + setting.path);
      if (names.back() == name) {
        return *setting.setting;
      }
    }
  }
  throw Error(ErrorKind::usage,
              fmt::format("unknown setting '{}'{} 'armwright list settings' shows all {}",
                          sanitize(name), suggest(name, names), names.size()));
}

std::string explain_setting(const std::string& name, const Style& style) {
  const AnySetting& setting = find_setting(name);
  std::string text = format_title(style, name, setting.meaning) + "\n";
  if (!setting.unit.empty()) {
    text += fmt::format("  unit     {}\n", setting.unit);
  }
  text += fmt::format("  allowed  {}\n", setting.describe_allowed());
  if (!setting.default_text.empty()) {
    text += fmt::format("  default  {}\n", setting.default_text);
  }
  return text;
}

json to_json(const std::string& name, const AnySetting& setting) {
  json defaults = json::array();
  if (!setting.default_text.empty()) {
    defaults.push_back(setting.default_text);
  }
  return {{"name", name},
          {"unit", setting.unit},
          {"allowed", json::array({setting.describe_allowed()})},
          {"default", defaults},
          {"meaning", setting.meaning}};
}

json list_settings_as_json() {
  json all = json::array();
  for (const SettingFile& file : list_setting_files()) {
    for (const ListedSetting& setting : file.settings) {
      all.push_back(to_json(file.prefix + setting.path, *setting.setting));
    }
  }
  return all;
}

// Returns what is allowed in few words, for a narrow column of a table.
std::string shorten_allowed(const AnySetting& setting) {
  constexpr std::pair<std::string_view, std::string_view> kShorter[] = {
      {"an array, each element of it a finite number", "numbers, each"},
      {"one of these strings: ", ""},
      {"an array of strings", "list of texts"},
      {"a finite number", "number"},
      {"an integer", "integer"},
      {"a string", "text"},
  };
  std::string text = setting.describe_allowed();
  for (const auto& [longer, shorter] : kShorter) {
    if (text.starts_with(longer)) {
      return text.replace(0, longer.size(), shorter);
    }
  }
  return text;
}

// "task.speed_m_per_s" -> "[task]"; "requirement[].use" -> "[[requirement]]"; "" at the top.
std::string get_table_heading(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  if (dot == std::string::npos) {
    return "";
  }
  const std::string table = path.substr(0, dot);
  return table.ends_with("[]") ? "[[" + table.substr(0, table.size() - 2) + "]]"
                               : "[" + table + "]";
}

std::string format_row(const AnySetting& setting) {
  return fmt::format("| {} | {} | {} | {} | {} |\n", format_code(setting.key),
                     escape_markdown(setting.meaning), escape_markdown(shorten_allowed(setting)),
                     escape_markdown(setting.unit),
                     setting.default_text.empty() ? "" : format_code(setting.default_text));
}

// Returns one table of Markdown per table of the file.
std::string format_tables(const std::vector<ListedSetting>& settings) {
  std::string text, heading = "none yet";
  for (const ListedSetting& setting : settings) {
    if (const std::string own = get_table_heading(setting.path); own != heading) {
      heading = own;
      text += (heading.empty() ? "\n" : fmt::format("\n### `{}`\n\n", heading)) +
              "| key | meaning | allowed | unit | default |\n|---|---|---|---|---|\n";
    }
    text += format_row(*setting.setting);
  }
  return text;
}

std::string format_setting_page(const std::string& name) {
  if (!name.empty()) {
    throw Error(ErrorKind::usage, "the page of settings contains all settings; leave out the name");
  }
  std::string text = fmt::format(
      "{}# Settings\n\n"
      "All keys of the configuration files, as `armwright list settings` prints them. Units are "
      "SI, and a key's name ends with its unit. A key without a default is required, unless its "
      "meaning says what its absence means. Unknown keys are refused, and the nearest valid key is "
      "suggested. In `--set`, a key is named with its table: `task.speed_m_per_s`. An integer may "
      "also be written `1e3`, `\"10k\"` or `\"2M\"`, in `--set` without the quotes.\n",
      kGeneratedPage);
  for (const SettingFile& file : list_setting_files()) {
    text += fmt::format("\n## {}\n\n{}\n", file.title, file.words) + format_tables(file.settings);
  }
  return text;
}

}  // namespace

ListKind make_setting_kind() {
  return {
      .name = "settings",
      .list = list_known_settings,
      .explain = explain_setting,
      .explain_as_json = [](const std::string& name) { return to_json(name, find_setting(name)); },
      .list_as_json = list_settings_as_json,
      .explain_as_markdown = format_setting_page};
}

}  // namespace armwright
