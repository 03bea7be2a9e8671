#include "problems/interface/schedule.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "base/text.hpp"

namespace armwright {
namespace {

constexpr std::array kScheduleKinds = {std::pair{"fixed", Schedule::Kind::fixed},
                                       std::pair{"fresh", Schedule::Kind::fresh},
                                       std::pair{"coevolution", Schedule::Kind::coevolution},
                                       std::pair{"growing", Schedule::Kind::growing}};
constexpr std::array kRacingKinds = {std::pair{"none", Racing::Kind::none},
                                     std::pair{"halving", Racing::Kind::halving},
                                     std::pair{"abandonment", Racing::Kind::abandonment}};

template <class Rows>
std::vector<std::string> list_names(const Rows& rows) {
  std::vector<std::string> names;
  for (const auto& row : rows) {
    names.emplace_back(row.first);
  }
  return names;
}

template <class Rows>
auto find_kind(const Rows& rows, std::string_view name)
    -> std::optional<decltype(rows.front().second)> {
  for (const auto& row : rows) {
    if (row.first == name) {
      return row.second;
    }
  }
  return std::nullopt;
}

template <class Rows, class Kind>
const char* find_name(const Rows& rows, Kind kind) {
  return rows[static_cast<std::size_t>(kind)].first;
}

std::optional<int> read_count(std::string_view text, std::int64_t least, std::int64_t most) {
  const auto count = parse_count(text);
  return count && *count >= least && *count <= most ? std::optional(static_cast<int>(*count))
                                                    : std::nullopt;
}

}  // namespace

const char* to_string(Schedule::Kind kind) {
  return find_name(kScheduleKinds, kind);
}

const char* to_string(Racing::Kind kind) {
  return find_name(kRacingKinds, kind);
}

std::vector<std::string> schedule_kind_names() {
  return list_names(kScheduleKinds);
}

std::vector<std::string> racing_kind_names() {
  return list_names(kRacingKinds);
}

std::optional<Schedule::Kind> find_schedule_kind(std::string_view name) {
  return find_kind(kScheduleKinds, name);
}

std::string get_training_set(const std::string& set, const Schedule& schedule) {
  return schedule.kind == Schedule::Kind::coevolution ? "coevolved" + set.substr(set.find('/'))
                                                      : set;
}

std::optional<Schedule> read_schedule(std::string_view text) {
  const auto parts = split(text, ':');
  const auto kind = find_schedule_kind(parts[0]);
  const auto cases = parts.size() < 2 ? std::nullopt : read_count(parts[1], 1, kMostCases);
  if (!kind || !cases || parts.size() > (*kind == Schedule::Kind::growing ? 3U : 2U)) {
    return std::nullopt;
  }
  Schedule schedule = {*kind, *cases};
  if (parts.size() == 3) {
    const auto factor = parse_finite(parts[2]);
    if (!factor || !(*factor > 1 && *factor <= kLargestFactor)) {
      return std::nullopt;
    }
    schedule.factor = *factor;
  }
  return schedule;
}

std::string to_text(const Schedule& schedule) {
  std::string text = fmt::format("{}:{}", to_string(schedule.kind), schedule.cases);
  return schedule.kind == Schedule::Kind::growing ? text + ":" + format_exact(schedule.factor)
                                                  : text;
}

std::optional<Racing> read_racing(std::string_view text) {
  const auto parts = split(text, ':');
  const auto kind = find_kind(kRacingKinds, parts[0]);
  if (!kind || parts.size() > (*kind == Racing::Kind::none ? 1U : 3U)) {
    return std::nullopt;
  }
  Racing racing;
  racing.kind = *kind;
  if (*kind == Racing::Kind::halving) {
    const auto first = parts.size() > 1 ? read_count(parts[1], 1, kMostCases) : racing.first_cases;
    const auto eta = parts.size() > 2 ? read_count(parts[2], 2, kLargestEta) : racing.eta;
    if (!first || !eta) {
      return std::nullopt;
    }
    racing.first_cases = *first;
    racing.eta = *eta;
  } else if (*kind == Racing::Kind::abandonment) {
    const auto margin = parts.size() > 1 ? parse_finite(parts[1]) : racing.margin;
    const auto chunk = parts.size() > 2 ? read_count(parts[2], 1, kMostCases) : racing.chunk_cases;
    if (!margin || !(*margin >= 1 && *margin <= kLargestMargin) || !chunk) {
      return std::nullopt;
    }
    racing.margin = *margin;
    racing.chunk_cases = *chunk;
  }
  return racing;
}

std::string to_text(const Racing& racing) {
  switch (racing.kind) {
    case Racing::Kind::none:
      break;
    case Racing::Kind::halving:
      return fmt::format("halving:{}:{}", racing.first_cases, racing.eta);
    case Racing::Kind::abandonment:
      return fmt::format("abandonment:{}:{}", format_exact(racing.margin), racing.chunk_cases);
  }
  return "none";
}

}  // namespace armwright
