#include "study/compare/study_schedules.hpp"

#include <fmt/format.h>

namespace armwright {

std::optional<StudySchedule> read_study_schedule(std::string_view text) {
  if (text == kOwnSchedules) {
    return OwnSchedules{};
  }
  const auto schedule = read_schedule(text);
  return schedule ? std::optional<StudySchedule>(*schedule) : std::nullopt;
}

std::string describe_study_schedules() {
  return fmt::format("{}, or {} ({} for every optimizer that has generations, {} for the others)",
                     kScheduleForms, kOwnSchedules, to_text(kOwnWithGenerations),
                     to_text(kOwnWithoutGenerations));
}

Schedule choose_own_schedule(const OptimizerRow& row) {
  return row.capabilities.generations ? kOwnWithGenerations : kOwnWithoutGenerations;
}

}  // namespace armwright
