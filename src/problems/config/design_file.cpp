#include "problems/config/design_file.hpp"

#include <fmt/format.h>

#include "base/text.hpp"
#include "problems/config/config_files.hpp"

namespace armwright {
namespace {

// Of a link, as much as any arm would want.
constexpr Range kScale{.lower = 0.01, .upper = 100};

std::string quote(std::string_view text) {
  std::string quoted = "\"";
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"' || c == '\\') {
      quoted += '\\';
    }
    const auto code = static_cast<unsigned char>(c);
    const auto next = static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : '\0');
    if (code < 0x20 || code == 0x7F) {
      quoted += fmt::format("\\u{:04X}", code);
    } else if (code == 0xC2 && next >= 0x80 && next < 0xA0) {  // the other control characters
      quoted += fmt::format("\\u{:04X}", next);
      ++i;
    } else {
      quoted += c;
    }
  }
  return sanitize(quoted) + '"';
}

PublishedResult read_published(const ConfigTable& table) {
  PublishedResult published;
  published.label = table.get_string("label");
  published.problem = table.get_string("problem");
  if (table.has("set")) {
    published.overrides = table.get_strings("set");
  }
  const Range positive{.lower = 0, .lower_open = true};
  if (table.has("error_m")) {
    published.error_m = table.get_number("error_m", positive);
  }
  if (table.has("total_torque_n_m")) {
    published.total_torque_n_m = table.get_number("total_torque_n_m", positive);
  }
  published.where = table.get_string("where", "");
  return published;
}

}  // namespace

DesignFile load_design(std::string_view name_or_path) {
  const auto path = resolve_config("designs", name_or_path);
  return read_design(ConfigTable::load(path), path.stem().string());
}

DesignFile read_design(const ConfigTable& table, const std::string& name) {
  DesignFile file;
  file.name = table.get_string("name", name);
  file.title = table.get_string("title", "");
  file.source = table.get_string("source", "");
  file.design.controller = table.get_choice("controller", controller_names(), "pid");
  if (table.has("speed_m_per_s")) {
    file.design.speed_m_per_s = table.get_number("speed_m_per_s", {.lower = 0.01, .upper = 100});
  }
  const ControllerRow& controller = find_controller(file.design.controller);
  for (const ConfigTable& joint : table.get_tables("joint")) {
    file.joint_names.push_back(joint.get_string("name", ""));
    // Every key is known before one is missed: a hint at a mistyped one then never names a right
    // one.
    for (const controllers::Gain& gain : controller.gains) {
      joint.has(gain.key);
    }
    joint.has("effort_min_n_m");
    joint.has("effort_max_n_m");
    joint.has("length_scale");
    joint.has("section_scale");
    JointDrive drive;
    for (const controllers::Gain& gain : controller.gains) {
      drive.gains.push_back(
          joint.get_number(gain.key, gain.any_sign ? Range{} : Range{.lower = 0}));
    }
    drive.limits.min = joint.get_number("effort_min_n_m", {.upper = 0});
    drive.limits.max = joint.get_number("effort_max_n_m", {.lower = 0});
    drive.length_scale = joint.get_number_or("length_scale", 1, kScale);
    drive.section_scale = joint.get_number_or("section_scale", 1, kScale);
    file.design.joints.push_back(std::move(drive));
  }
  if (file.design.joints.empty()) {
    table.refuse("joint", "a design must have at least one joint, [[joint]]");
  }
  for (const ConfigTable& published : table.get_tables_or_empty("published")) {
    file.published.push_back(read_published(published));
  }
  table.refuse_unknown();
  return file;
}

std::string to_toml(const DesignFile& file) {
  const ControllerRow& controller = find_controller(file.design.controller);
  std::string text =
      fmt::format("name = {}\ntitle = {}\nsource = {}\ncontroller = {}\n", quote(file.name),
                  quote(file.title), quote(file.source), quote(file.design.controller));
  if (file.design.speed_m_per_s) {
    text += fmt::format("speed_m_per_s = {}\n", format_exact(*file.design.speed_m_per_s));
  }
  for (std::size_t i = 0; i < file.design.joints.size(); ++i) {
    const JointDrive& joint = file.design.joints[i];
    text += fmt::format("\n[[joint]]\nname = {}\n", quote(file.joint_names.at(i)));
    for (std::size_t g = 0; g < controller.gains.size(); ++g) {
      text += fmt::format("{} = {}\n", controller.gains[g].key, format_exact(joint.gains.at(g)));
    }
    text += fmt::format("effort_min_n_m = {}\neffort_max_n_m = {}\n",
                        format_exact(joint.limits.min), format_exact(joint.limits.max));
    if (joint.length_scale != 1) {
      text += fmt::format("length_scale = {}\n", format_exact(joint.length_scale));
    }
    if (joint.section_scale != 1) {
      text += fmt::format("section_scale = {}\n", format_exact(joint.section_scale));
    }
  }
  return text;
}

}  // namespace armwright
