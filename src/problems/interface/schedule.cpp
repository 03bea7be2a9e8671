#include "problems/interface/schedule.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "base/text.hpp"

namespace armwright {
namespace {

constexpr int kLargestEta = 1000;
constexpr double kLargestMargin = 1e6;

constexpr std::array kScheduleKinds = {std::pair{"fixed", Schedule::Kind::fixed},
                                       std::pair{"fresh", Schedule::Kind::fresh},
                                       std::pair{"coevolution", Schedule::Kind::coevolution}};
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
  const auto count = parse_integer(text);
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

std::optional<Schedule::Kind> find_schedule_kind(std::string_view name) {
  return find_kind(kScheduleKinds, name);
}

std::string get_training_set(const std::string& set, const Schedule& schedule) {
  return schedule.kind == Schedule::Kind::coevolution ? "coevolved" + set.substr(set.find('/'))
                                                      : set;
}

std::optional<Schedule> read_schedule(std::string_view text) {
  const auto parts = split(text, ':');
  if (parts.size() != 2) {
    return std::nullopt;
  }
  const auto kind = find_schedule_kind(parts[0]);
  const auto cases = read_count(parts[1], 1, kMostCases);
  return kind && cases ? std::optional(Schedule{*kind, *cases}) : std::nullopt;
}

std::string to_text(const Schedule& schedule) {
  return fmt::format("{}:{}", to_string(schedule.kind), schedule.cases);
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

Schedule read_schedule_table(const ConfigTable& table) {
  Schedule schedule;
  schedule.kind =
      *find_schedule_kind(table.get_choice("kind", list_names(kScheduleKinds), "fixed"));
  const bool bred = schedule.kind == Schedule::Kind::coevolution;
  const int least = bred ? kFewestBredCases : 1;
  schedule.cases = static_cast<int>(bred ? table.get_integer("cases", least, kMostCases)
                                         : table.get_integer_or("cases", 1, least, kMostCases));
  return schedule;
}

Racing read_racing_table(const ConfigTable& table) {
  Racing racing;
  racing.kind =
      *find_kind(kRacingKinds, table.get_choice("kind", list_names(kRacingKinds), "none"));
  // Each key is read only for the kind that uses it. The configuration refuses keys that were not
  // read, so a key without effect is an error.
  if (racing.kind == Racing::Kind::halving) {
    racing.first_cases =
        static_cast<int>(table.get_integer_or("first_cases", racing.first_cases, 1, kMostCases));
    racing.eta = static_cast<int>(table.get_integer_or("eta", racing.eta, 2, kLargestEta));
  } else if (racing.kind == Racing::Kind::abandonment) {
    racing.margin =
        table.get_number_or("margin", racing.margin, {.lower = 1, .upper = kLargestMargin});
    racing.chunk_cases =
        static_cast<int>(table.get_integer_or("chunk_cases", racing.chunk_cases, 1, kMostCases));
  }
  return racing;
}

}  // namespace armwright
