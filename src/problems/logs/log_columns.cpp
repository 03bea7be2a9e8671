#include "problems/logs/log_columns.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"
#include "base/text.hpp"
#include "problems/logs/log_units.hpp"

namespace armwright {
namespace {

struct QuantityWord {
  std::string_view word;
  LogQuantity quantity;
  bool is_motor;
};

constexpr QuantityWord kWords[] = {
    {"position", LogQuantity::position, false},
    {"velocity", LogQuantity::velocity, false},
    {"effort", LogQuantity::effort, false},
    {"motor_torque", LogQuantity::effort, true},
    {"link_position", LogQuantity::link_position, false},
    {"reference", LogQuantity::reference, false},
};

constexpr const char* kOurNames =
    "time, position_N, velocity_N, effort_N, motor_torque_N, link_position_N and reference_N, "
    "where "
    "N is the number or the name of a joint";

constexpr std::size_t kLongestShown = 60;  // of a name that the user shall type

constexpr std::string_view kTimeWords[] = {"time", "timestamp"};

// Cuts "[deg]" or "(deg)" off the end of a column's name and returns "deg"; else returns "".
std::string cut_bracket(std::string& column) {
  for (const auto& [open, close] : {std::pair{'[', ']'}, std::pair{'(', ')'}}) {
    const std::size_t begin = column.rfind(open);
    if (column.ends_with(close) && begin != std::string::npos) {
      std::string unit = column.substr(begin + 1, column.size() - begin - 2);
      column.resize(begin);
      return unit;
    }
  }
  return "";
}

// Cuts the unit off the end of a normalized name: returns the name without it for each spelling.
template <typename Take>
bool try_suffixes(const std::string& name, const Take& take) {
  for (const LogUnit& unit : list_log_units()) {
    const std::string suffix = "_" + std::string(unit.spelling);
    if (name.ends_with(suffix) && take(name.substr(0, name.size() - suffix.size()), unit)) {
      return true;
    }
  }
  return false;
}

}  // namespace

LogColumns::LogColumns(const RobotModel& robot, const LogOptions& options)
    : robot_(robot), options_(options) {
  const auto fail = [](const std::string& message) { throw Error(ErrorKind::usage, message); };
  std::vector<std::string> names;
  for (const Joint& joint : robot.joints) {
    names.push_back(joint.name);
  }
  if (!options.joints.empty() && options.joints.size() != names.size()) {
    fail(fmt::format("--joints has {} names, but the robot has {} joints: {}",
                     options.joints.size(), names.size(), list_quoted(names)));
  }
  // The file's own names go before the robot's, which it may use for other joints.
  const auto count = static_cast<Eigen::Index>(names.size());
  for (Eigen::Index j = 0; j < count; ++j) {
    joints_.try_emplace(std::to_string(j + 1), j);
  }
  for (Eigen::Index j = 0; j < count; ++j) {
    joints_.try_emplace(normalize_name(file_name(j)), j);
  }
  for (Eigen::Index j = 0; j < count; ++j) {
    joints_.try_emplace(normalize_name(names[static_cast<std::size_t>(j)]), j);
  }
  const auto check_joint = [&](const char* option, const std::string& key) {
    if (!find_joint(normalize_name(key))) {
      fail(fmt::format("--{}: the robot has no joint {}; its joints are {}, or 1 to {}", option,
                       quote_name(key), list_quoted(names), names.size()));
    }
  };
  for (const auto& [key, ratio] : options.gear_ratios) {
    check_joint("gear-ratio", key);
  }
  for (const auto& [key, sign] : options.signs) {
    check_joint("sign", key);
  }
  const auto is_word = [](const std::string& key) {
    return key == "time" || std::ranges::find(kWords, key, &QuantityWord::word) != std::end(kWords);
  };
  for (const auto* keys : {&options.columns, &options.units}) {
    for (const auto& [key, value] : *keys) {
      if (!is_word(normalize_name(key)) && !read_meaning(normalize_name(key))) {
        fail(fmt::format("--{}: unknown name {}; the names are {} (joints: {})",
                         keys == &options.units ? "unit" : "column", quote_name(key), kOurNames,
                         list_quoted(names)));
      }
    }
  }
}

const std::string& LogColumns::file_name(Eigen::Index joint) const {
  const auto at = static_cast<std::size_t>(joint);
  return options_.joints.empty() ? robot_.joints[at].name : options_.joints[at];
}

std::optional<Eigen::Index> LogColumns::find_joint(std::string_view text) const {
  const auto found = joints_.find(text);
  return found == joints_.end() ? std::nullopt : std::optional(found->second);
}

std::optional<LogColumns::Meaning> LogColumns::read_meaning(std::string_view text) const {
  for (const QuantityWord& word : kWords) {
    const std::string front = std::string(word.word) + "_";
    const std::string back = "_" + std::string(word.word);
    std::optional<Eigen::Index> joint;
    if (text.starts_with(front)) {
      joint = find_joint(text.substr(front.size()));
    }
    if (!joint && text.ends_with(back)) {
      joint = find_joint(text.substr(0, text.size() - back.size()));
    }
    if (joint) {
      return Meaning{word.quantity, *joint, word.is_motor, ""};
    }
  }
  return std::nullopt;
}

std::optional<LogColumns::Meaning> LogColumns::guess_meaning(const std::string& column) const {
  std::string name = column;
  const std::string unit = cut_bracket(name);
  name = normalize_name(name);
  auto meaning = read_meaning(name);
  if (meaning) {
    meaning->unit = unit;
    return meaning;
  }
  if (unit.empty()) {
    try_suffixes(name, [&](const std::string& rest, const LogUnit& suffix) {
      meaning = read_meaning(rest);
      if (meaning) {
        meaning->unit = suffix.name;
      }
      return meaning.has_value();
    });
  }
  return meaning;
}

std::string LogColumns::find_unit(LogQuantity quantity, Eigen::Index joint) const {
  const JointKind kind = robot_.joints[static_cast<std::size_t>(joint)].kind;
  const auto find_for = [&](LogQuantity of) -> std::string {
    std::string general;
    for (const auto& [key, unit] : options_.units) {
      const auto meaning = read_meaning(normalize_name(key));
      if (meaning && meaning->quantity == of && meaning->joint == joint) {
        return unit;
      }
      // Degrees are meant for the joints that turn.
      const LogUnit* known = find_log_unit(unit);
      if (normalize_name(key) == kQuantityNames[static_cast<std::size_t>(of)] && known != nullptr &&
          known->kind == get_unit_kind(of, kind, false)) {
        general = unit;
      }
    }
    return general;
  };
  const std::string own = find_for(quantity);
  const bool is_position =
      quantity == LogQuantity::link_position || quantity == LogQuantity::reference;
  return own.empty() && is_position ? find_for(LogQuantity::position) : own;
}

const double* LogColumns::find_number(const std::map<std::string, double>& numbers,
                                      Eigen::Index joint) const {
  for (const auto& [key, number] : numbers) {
    if (find_joint(normalize_name(key)) == joint) {
      return &number;
    }
  }
  return nullptr;
}

double LogColumns::calc_factor(LogQuantity quantity, Eigen::Index joint, bool is_motor,
                               std::string_view unit, const std::string& column,
                               const std::string& where) const {
  const Joint& moved = robot_.joints[static_cast<std::size_t>(joint)];
  const UnitKind kind = get_unit_kind(quantity, moved.kind, is_motor);
  const std::string own = find_unit(quantity, joint);
  const std::string chosen = own.empty() ? std::string(unit) : own;
  double factor = 1;
  if (!chosen.empty()) {
    const LogUnit* known = find_log_unit(chosen);
    if (known == nullptr || known->kind != kind) {
      throw Error(
          ErrorKind::bad_data,
          fmt::format("{}: column {} is in {}, but joint {} {}; possible are {}; say it by "
                      "--unit {}_{}=UNIT",
                      where, quote_name(column), quote_name(chosen), quote_name(moved.name),
                      moved.kind == JointKind::revolute ? "turns" : "slides", list_unit_names(kind),
                      kQuantityNames[static_cast<std::size_t>(quantity)], joint + 1));
    }
    factor = known->factor;
  }
  if (quantity != LogQuantity::effort) {
    return factor;
  }
  if (is_motor) {
    const double* ratio = find_number(options_.gear_ratios, joint);
    if (ratio == nullptr) {
      throw Error(
          ErrorKind::bad_data,
          fmt::format("{}: column {} has the torque of the motor of joint {}; the effort at "
                      "the joint is this torque times the gear ratio, which is missing; give "
                      "it by --gear-ratio {}=RATIO (motor angle per joint position)",
                      where, quote_name(column), quote_name(moved.name), joint + 1));
    }
    factor *= *ratio;
  }
  const double* sign = find_number(options_.signs, joint);
  return sign == nullptr ? factor : factor * *sign;
}

std::size_t LogColumns::find_column(const std::vector<std::string>& header, const std::string& key,
                                    const std::string& where) const {
  const std::string& name = options_.columns.at(key);
  const auto found = std::ranges::find(header, name);
  if (found == header.end()) {
    const auto nearest = find_nearest(name, header);
    throw Error(
        ErrorKind::usage,
        fmt::format("{}: there is no column {}, which --column {} names{}; the columns are {}",
                    where, quote_name(name), key,
                    nearest ? fmt::format("; did you mean {}?", quote_name(*nearest)) : "",
                    list_quoted(header)));
  }
  if (std::find(found + 1, header.end(), name) != header.end()) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: there are two columns {}; rename one", where, quote_name(name)));
  }
  return static_cast<std::size_t>(found - header.begin());
}

std::optional<std::size_t> LogColumns::find_time(const std::vector<std::string>& header,
                                                 const std::string& where, double& factor_s) const {
  std::optional<std::size_t> time;
  std::string unit;
  const auto is_time = [](const std::string& name) {
    return std::ranges::find(kTimeWords, name) != std::end(kTimeWords);
  };
  const bool is_mapped = options_.columns.contains("time");
  const std::size_t mapped = is_mapped ? find_column(header, "time", where) : 0;
  for (std::size_t i = 0; i < header.size(); ++i) {
    if (is_mapped && i != mapped) {
      continue;
    }
    std::string name = header[i];
    std::string found = cut_bracket(name);
    name = normalize_name(name);
    bool fits = is_time(name) || is_mapped;
    if (found.empty()) {
      try_suffixes(name, [&](const std::string& rest, const LogUnit& suffix) {
        if (suffix.kind == UnitKind::time && (is_mapped || is_time(rest))) {
          fits = true;
          found = suffix.name;
          return true;
        }
        return false;
      });
    }
    if (fits && time) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("{}: the columns {} and {} both look like the time; say which it "
                              "is, for example by --column time={}",
                              where, quote_name(header[*time]), quote_name(header[i]),
                              sanitize(header[*time].substr(0, kLongestShown))));
    }
    if (fits) {
      time = i;
      unit = found;
    }
  }
  const auto own = options_.units.find("time");
  if (own != options_.units.end()) {
    unit = own->second;
  }
  if (time && !unit.empty()) {
    const LogUnit* known = find_log_unit(unit);
    if (known == nullptr || known->kind != UnitKind::time) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("{}: column {} is in {}, which is no unit of time; possible are {}; "
                              "say it by --unit time=UNIT",
                              where, quote_name(header[*time]), quote_name(unit),
                              list_unit_names(UnitKind::time)));
    }
    factor_s = known->factor;
  }
  return time;
}

LogLayout LogColumns::match(const std::vector<std::string>& header,
                            const std::string& where) const {
  LogLayout layout;
  std::vector<bool> is_used(header.size());
  const auto time = find_time(header, where, layout.time_factor_s);
  if (time) {
    layout.time = *time;
    layout.time_name = header[*time];
    is_used[*time] = true;
  }
  // The place of the column and its unit, for each of kWords and each joint.
  struct Found {
    std::size_t place;
    std::string unit;
  };
  const std::size_t joints = robot_.joint_count();
  std::vector<std::optional<Found>> found(std::size(kWords) * joints);
  const auto at = [&](const Meaning& meaning) -> std::optional<Found>& {
    const auto* word = std::ranges::find_if(kWords, [&](const QuantityWord& row) {
      return row.quantity == meaning.quantity && row.is_motor == meaning.is_motor;
    });
    return found[static_cast<std::size_t>(word - kWords) * joints +
                 static_cast<std::size_t>(meaning.joint)];
  };
  for (const auto& [key, column] : options_.columns) {
    const auto meaning = read_meaning(normalize_name(key));
    if (normalize_name(key) == "time") {
      continue;
    }
    if (!meaning) {
      throw Error(
          ErrorKind::usage,
          fmt::format("--column {}={}: {} has a column per joint, so the name needs a joint, "
                      "such as {}_1",
                      key, column, where, key));
    }
    const std::size_t place = find_column(header, key, where);
    if (is_used[place]) {
      throw Error(ErrorKind::usage, fmt::format("--column {}={}: this column stands for something "
                                                "else already",
                                                key, column));
    }
    std::string name = header[place];
    std::string unit = cut_bracket(name);
    if (unit.empty()) {
      try_suffixes(normalize_name(name), [&](const std::string&, const LogUnit& suffix) {
        const JointKind kind = robot_.joints[static_cast<std::size_t>(meaning->joint)].kind;
        if (suffix.kind != get_unit_kind(meaning->quantity, kind, meaning->is_motor)) {
          return false;
        }
        unit = suffix.name;
        return true;
      });
    }
    at(*meaning) = Found{place, unit};
    is_used[place] = true;
  }
  for (std::size_t i = 0; i < header.size(); ++i) {
    const auto meaning = is_used[i] ? std::nullopt : guess_meaning(header[i]);
    if (!meaning) {
      continue;
    }
    std::optional<Found>& place = at(*meaning);
    const auto* word = std::ranges::find_if(kWords, [&](const QuantityWord& row) {
      return row.quantity == meaning->quantity && row.is_motor == meaning->is_motor;
    });
    const std::string key = fmt::format("{}_{}", word->word, meaning->joint + 1);
    if (!place) {
      place = Found{i, meaning->unit};
    } else if (!is_used[place->place]) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("{}: the columns {} and {} both look like {}; say which it is, for "
                              "example by --column {}={}",
                              where, quote_name(header[place->place]), quote_name(header[i]), key,
                              key, sanitize(header[place->place].substr(0, kLongestShown))));
    }
  }
  std::vector<std::string> missing;
  if (!time) {
    missing.emplace_back("time");
  }
  for (const QuantityWord& word : kWords) {
    for (std::size_t j = 0; j < joints; ++j) {
      const auto joint = static_cast<Eigen::Index>(j);
      const auto& own = at({word.quantity, joint, word.is_motor, ""});
      const bool has_effort = at({LogQuantity::effort, joint, false, ""}).has_value();
      const bool has_motor = at({LogQuantity::effort, joint, true, ""}).has_value();
      const bool is_needed = word.quantity == LogQuantity::position ||
                             (word.quantity == LogQuantity::effort && !word.is_motor && !has_motor);
      if (!own && is_needed) {
        missing.push_back(fmt::format("{}_{}", word.word, j + 1));
      }
      if (!own || (word.is_motor && has_effort)) {
        continue;
      }
      layout.columns.push_back({header[own->place], word.quantity, joint, 1, {}});
      layout.places.push_back(own->place);
      layout.columns.back().factor =
          calc_factor(word.quantity, joint, word.is_motor, own->unit, header[own->place], where);
    }
  }
  if (!missing.empty()) {
    constexpr std::size_t kMostShown = 4;
    std::string flags;
    for (std::size_t i = 0; i < std::min(missing.size(), kMostShown); ++i) {
      flags += fmt::format(" --column {}=COLUMN", missing[i]);
    }
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: there is no column for {}; the columns are {}; say which is "
                            "which by{}{}",
                            where, list_quoted(missing), list_quoted(header), flags,
                            missing.size() > kMostShown ? " ..." : ""));
  }
  return layout;
}

}  // namespace armwright
