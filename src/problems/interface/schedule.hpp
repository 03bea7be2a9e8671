// The schedule and the racing of training. The schedule chooses the training cases that a candidate
// is evaluated on. Racing ends the evaluation of bad candidates before they have had all cases.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace armwright {

// The largest number of cases of a schedule, of a set, and of one evaluation of a given design.
inline constexpr std::int64_t kMostCases = 1'000'000;

// The choice of the training cases. K is the number of cases per candidate.
struct Schedule {
  enum class Kind : std::uint8_t {
    fixed,        // always the first K cases of the training set
    fresh,        // the next K cases for every generation
    coevolution,  // K cases that are bred against the designs, generation by generation
    growing,      // the first K cases; K grows from time to time (study/run/case_growth.hpp)
  };
  // Returns true if the cases change along the run. Then not all objectives can be compared.
  bool changes_cases() const { return kind != Kind::fixed; }
  // Returns true if each generation has its own cases. Then objectives of different generations
  // cannot be compared.
  bool renews_cases() const { return kind == Kind::fresh || kind == Kind::coevolution; }

  Kind kind = Kind::fixed;
  int cases = 1;      // K; of growing the first one
  double factor = 2;  // of growing, on K
};

inline constexpr double kLargestFactor = 1000;

// The smallest K of coevolution. Breeding needs two parents and room for a child.
inline constexpr int kFewestBredCases = 4;

// The racing of candidates (docs/racing.md). The budget counts the cases that were simulated.
struct Racing {
  enum class Kind : std::uint8_t {
    none,         // every candidate is evaluated on all K cases
    halving,      // only the best 1/eta of a batch get eta times as many cases, rung by rung
    abandonment,  // a candidate ends once its objective is certain to exceed the incumbent's
  };
  Kind kind = Kind::none;
  int first_cases = 1;  // halving: the number of cases of the first rung
  int eta = 2;          // halving
  double margin = 1;    // abandonment: multiplies the incumbent's objective before the comparison
  int chunk_cases = 4;  // abandonment: the number of cases between two comparisons
};

inline constexpr int kLargestEta = 1000;
inline constexpr double kLargestMargin = 1e6;

const char* to_string(Schedule::Kind kind);
const char* to_string(Racing::Kind kind);
std::vector<std::string> schedule_kind_names();  // in the order of the enum
std::vector<std::string> racing_kind_names();    // in the order of the enum
// Returns nothing for an unknown name.
std::optional<Schedule::Kind> find_schedule_kind(std::string_view name);

// Returns the name of the set that the training cases come from. Bred cases are "coevolved/ID"
// instead of "train/ID".
std::string get_training_set(const std::string& set, const Schedule& schedule);

// Reads "fresh:K", "fixed:K", "coevolution:K", "growing:K" or "growing:K:FACTOR". Returns nothing for
// any other text.
std::optional<Schedule> read_schedule(std::string_view text);
std::string to_text(const Schedule& schedule);
inline constexpr std::string_view kScheduleForms =
    "fresh:K (the next K training cases for every generation), fixed:K (always the first K), "
    "coevolution:K (K that are bred against the designs) or growing:K:FACTOR (the first K, and "
    "FACTOR times as many whenever progress is within the noise between cases), K from 1 to "
    "1000000, FACTOR above 1 and at most 1000";

// Reads "none", "halving[:FIRST_CASES[:ETA]]" or "abandonment[:MARGIN[:CHUNK_CASES]]". Returns
// nothing for any other text.
std::optional<Racing> read_racing(std::string_view text);
std::string to_text(const Racing& racing);
inline constexpr std::string_view kRacingForms =
    "none, halving:FIRST_CASES:ETA (whole numbers >= 1 and >= 2) or abandonment:MARGIN:CHUNK_CASES "
    "(a number >= 1 and a whole number >= 1); the defaults of the numbers are 1, 2, 1 and 4";

}  // namespace armwright
