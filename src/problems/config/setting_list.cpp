#include "problems/config/setting_list.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "base/error.hpp"
#include "problems/config/config_files.hpp"
#include "problems/config/design_file.hpp"
#include "problems/config/problem_tables.hpp"
#include "problems/config/setting_descriptions.hpp"

namespace armwright {
namespace {

// A shipped problem and changes to it, so that what is read only beside other keys is read as well.
struct Specimen {
  const char* problem;
  std::vector<std::string> overrides;
};

std::vector<Specimen> list_specimens() {
  const std::string requirements =
      R"(requirement=[{quantity="overshoot",limit_relative=0.1},{quantity="rise_time",limit_s=0.01},)"
      R"({quantity="settling_time",limit_s=0.1,band_m=0.001},{quantity="tip_error",limit_m=0.1},)"
      R"({quantity="peak_torque",joint="joint_1",limit_n_m=1e6},)"
      R"({quantity="joint_speed",limit_rad_per_s=100},{quantity="energy",limit_j=1e9}])";
  const std::string path =
      "path.point=[{position_m=[1.4,0,0.9],rpy_rad=[0,0,0]},"
      "{position_m=[1.4,0.2,0.9],rpy_rad=[0,0,0]}]";
  return {
      {"q1-complex",
       {requirements, "racing.kind=halving", "workspace.normal=[0,0,1]", "task.home=[0,0,0,0]",
        "task.tool_rpy_rad=[0,0,0]", "task.tool_axis=[0,0,1]", "variables.task=[\"speed\"]",
        "variables.joint=[{name=\"joint_1\",optimize=[\"p\"]}]", "control.controller=pid",
        "objective.energy_weight=1", "objective.energy_scale_j=1", "objective.duration_weight=1",
        "objective.duration_scale_s=1", "objective.statistic=cvar", "perturbation.load_kg=[0,1]",
        "perturbation.viscous_friction_n_m_s_per_rad=[1,1,1,1]",
        "perturbation.coulomb_friction_n_m=[1,1,1,1]"}},
      {"q2-torque", {"racing.kind=abandonment"}},
      {"q2-error", {"path.kind=line", "path.from_m=[1.4,0,0.9]", "path.to_m=[1.4,0.2,0.9]"}},
      {"q2-e6",
       {"path.kind=circle", "path.centre_m=[1.4,0,0.9]", "path.normal=[1,0,0]", "path.radius_m=0.1",
        "path.start=[0,1,0]"}},
      {"robot",
       {"robot.propose=false", "variables.start=proposed", "path.kind=points", path,
        "task.orientation=pose"}},
      {"q3-load", {"path.kind=file", "path.file=absent.csv"}},
      {"q4-speed", {}},
      {"sphere", {}},
  };
}

std::vector<AskedKey> ask(const Specimen& specimen) {
  const auto path = resolve_config("problems", specimen.problem);
  std::optional<ConfigTable> read;
  const auto read_table = [&](std::span<const std::string> overrides) {
    const ConfigTable table = ConfigTable::load(path, overrides);
    if (!read) {
      read = table;
    }
    return table;
  };
  try {
    load_problem_tables(path, read_table, specimen.overrides, engine_table());
  } catch (const Error&) {
    // A specimen may be refused, as one whose file is nowhere: what was asked until then counts.
  }
  return read->asked();
}

// A design of one joint under the controller, with every key that may be left out.
std::vector<AskedKey> ask_design(const ControllerRow& controller) {
  DesignFile design;
  design.design.controller = controller.name;
  design.design.speed_m_per_s = 1;
  design.joint_names = {"joint"};
  JointDrive drive;
  drive.gains.assign(controller.gains.size(), 1);
  design.design.joints = {drive};
  const ConfigTable table =
      ConfigTable::parse(to_toml(design) +
                             "[[published]]\nlabel = \"\"\nproblem = \"\"\nset = []\n"
                             "error_m = 1\ntotal_torque_n_m = 1\n",
                         "a design");
  read_design(table, "");
  return table.asked();
}

void add_once(const std::string& text, std::vector<std::string>& texts) {
  if (!text.empty() && std::ranges::count(texts, text) == 0) {
    texts.push_back(text);
  }
}

bool is_table(const AskedKey& key) {
  return key.allowed.starts_with("a table") || key.allowed.starts_with("an array of tables");
}

bool is_described(const std::string& path, std::span<const SettingWords> words) {
  return std::ranges::find(words, path, &SettingWords::path) != words.end();
}

}  // namespace

std::string get_key_unit(std::string_view path) {
  // Longer ones first: each ends like the next shorter one.
  constexpr std::pair<std::string_view, std::string_view> kUnits[] = {
      {"_n_m_s_per_rad", "N m s/rad"},
      {"_n_m_per_kg", "N m/kg"},
      {"_m_per_s2", "m/s^2"},
      {"_rad_per_s", "rad/s"},
      {"_kg_per_m3", "kg/m^3"},
      {"_m_per_s", "m/s"},
      {"_n_m", "N m"},
      {"_rad", "rad"},
      {"_kg", "kg"},
      {"_m", "m"},
      {"_n", "N"},
      {"_s", "s"},
      {"_j", "J"},
  };
  for (const auto& [suffix, unit] : kUnits) {
    if (path.ends_with(suffix)) {
      return std::string(unit);
    }
  }
  return "";
}

std::vector<Setting> make_settings(std::span<const std::vector<AskedKey>> documents,
                                   std::span<const SettingWords> words) {
  std::map<std::string, Setting> settings;
  for (const std::vector<AskedKey>& document : documents) {
    for (const AskedKey& key : document) {
      if (is_table(key)) {
        continue;
      }
      if (key.allowed.empty() && !is_described(key.path, words)) {
        continue;  // asked for so that it can be refused, or a table
      }
      Setting& setting = settings[key.path];
      setting.path = key.path;
      add_once(key.allowed, setting.allowed);
      add_once(key.fallback, setting.fallbacks);
    }
  }
  // In the order of the words; what has none comes last.
  std::vector<Setting> all;
  for (const SettingWords& one : words) {
    const auto found = settings.find(one.path);
    if (found != settings.end()) {
      all.push_back(std::move(found->second));
      all.back().meaning = one.meaning;
      settings.erase(found);
    }
  }
  for (auto& [path, setting] : settings) {
    all.push_back(std::move(setting));
  }
  for (Setting& setting : all) {
    setting.unit = get_key_unit(setting.path);
  }
  return all;
}

std::vector<Setting> list_problem_settings() {
  std::vector<std::vector<AskedKey>> documents;
  std::ranges::transform(list_specimens(), std::back_inserter(documents), ask);
  return make_settings(documents, problem_setting_words());
}

std::vector<Setting> list_design_settings() {
  std::vector<SettingWords> words = design_setting_words();
  std::vector<std::vector<AskedKey>> documents;
  for (const ControllerRow& controller : controller_table()) {
    documents.push_back(ask_design(controller));
    for (const controllers::Gain& gain : controller.gains) {
      const std::string path = std::string("joint[].") + gain.key;
      const auto found = std::ranges::find(words, path, &SettingWords::path);
      if (found == words.end()) {
        words.push_back({path, "gain of controller " + controller.name});
      } else {
        found->meaning += ", " + controller.name;
      }
    }
  }
  std::vector<Setting> settings = make_settings(documents, words);
  for (const ControllerRow& controller : controller_table()) {
    for (const controllers::Gain& gain : controller.gains) {
      std::ranges::find(settings, std::string("joint[].") + gain.key, &Setting::path)->unit =
          gain.unit;
    }
  }
  return settings;
}

}  // namespace armwright
