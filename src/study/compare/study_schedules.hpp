// The key `schedule` of a study and of its problems: one schedule for all optimizers, or "own".
// With "own" every optimizer gets the schedule that suits it, and all have the same budget.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "optimizers/interface/optimizer.hpp"
#include "problems/interface/schedule.hpp"

namespace armwright {

// The value "own".
struct OwnSchedules {};
using StudySchedule = std::variant<Schedule, OwnSchedules>;

inline constexpr std::string_view kOwnSchedules = "own";
// "own" gives this schedule to optimizers that declare generations ...
inline constexpr Schedule kOwnWithGenerations{.kind = Schedule::Kind::fresh, .cases = 1};
// ... and this one to all others.
inline constexpr Schedule kOwnWithoutGenerations{.kind = Schedule::Kind::fixed, .cases = 5};

// Reads "own" or what read_schedule() reads. Returns nothing for any other text.
std::optional<StudySchedule> read_study_schedule(std::string_view text);
// Returns what read_study_schedule() reads, for messages.
std::string describe_study_schedules();

// Returns the schedule that "own" gives to the optimizer.
Schedule choose_own_schedule(const OptimizerRow& row);

}  // namespace armwright
