// How test cases are spent in training: which ones a candidate is evaluated on (the schedule), and
// whether candidates that do badly are told so before they have had all of them (racing).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace armwright {

// That a schedule, a set or one design's judgement may have.
inline constexpr std::int64_t kMostCases = 1'000'000;

struct Schedule {
  enum class Kind : std::uint8_t {
    fixed,        // the first K of the training set, always
    fresh,        // the next K for every generation
    coevolution,  // K that are bred against the designs, generation by generation
  };
  // Generations meet cases of their own, and their objectives do not compare.
  bool changes_cases() const { return kind != Kind::fixed; }

  Kind kind = Kind::fixed;
  int cases = 1;  // K
};

// Breeding takes two parents and a place for a child.
inline constexpr int kFewestBredCases = 4;

// Racing (docs/racing.md). What is charged to the budget are the cases that were simulated.
struct Racing {
  enum class Kind : std::uint8_t {
    none,         // every candidate has all K cases
    halving,      // of a batch, only the better 1/eta go on to eta times as many cases
    abandonment,  // a candidate is given up once its objective is certain to exceed the incumbent's
  };
  Kind kind = Kind::none;
  int first_cases = 1;  // halving: cases of the first rung
  int eta = 2;          // halving
  double margin = 1;    // abandonment: what may exceed the incumbent's, as a factor
  int chunk_cases = 4;  // abandonment: simulated between two questions whether it is worth going on
};

inline constexpr int kLargestEta = 1000;
inline constexpr double kLargestMargin = 1e6;

const char* to_string(Schedule::Kind kind);
const char* to_string(Racing::Kind kind);
std::vector<std::string> schedule_kind_names();  // in the order of the enum
std::vector<std::string> racing_kind_names();    // in the order of the enum
std::optional<Schedule::Kind> find_schedule_kind(std::string_view name);

// Where the training cases of this set come from: bred ones are "coevolved/ID" instead of
// "train/ID".
std::string get_training_set(const std::string& set, const Schedule& schedule);

// "fresh:K", "fixed:K" or "coevolution:K"; nothing if the text is none of them.
std::optional<Schedule> read_schedule(std::string_view text);
std::string to_text(const Schedule& schedule);
inline constexpr std::string_view kScheduleForms =
    "fresh:K (the next K training cases for every generation), fixed:K (always the first K) or "
    "coevolution:K (K that are bred against the designs), K from 1 to 1000000";

// "none", "halving[:FIRST_CASES[:ETA]]" or "abandonment[:MARGIN[:CHUNK_CASES]]"; nothing if the
// text is none of them.
std::optional<Racing> read_racing(std::string_view text);
std::string to_text(const Racing& racing);
inline constexpr std::string_view kRacingForms =
    "none, halving:FIRST_CASES:ETA (whole numbers >= 1 and >= 2) or abandonment:MARGIN:CHUNK_CASES "
    "(a number >= 1 and a whole number >= 1); what is left out has its default: 1, 2, 1, 4";

}  // namespace armwright
