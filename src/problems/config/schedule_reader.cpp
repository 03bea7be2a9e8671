// [schedule] and [racing]: how training cases are spent.
#include "problems/config/problem_readers.hpp"

namespace armwright {
namespace {

const Setting<std::string> kScheduleKind{
    "kind", schedule_kind_names, "fixed",
    "training cases; fixed: always the first ones; fresh: new ones for every generation; "
    "coevolution: cases bred against the designs; growing: the first ones, and more of them "
    "whenever "
    "progress is within the noise between cases"};
const Setting<int> kScheduleCases{
    "cases",
    {.lower = 1, .upper = kMostCases},
    Schedule{}.cases,
    "training cases per evaluation; for coevolution at least 4, without default; of growing the "
    "first number"};
const Setting<double> kScheduleFactor{"factor",
                                      {.lower = 1, .upper = kLargestFactor, .lower_open = true},
                                      Schedule{}.factor,
                                      "for growing: on the number of training cases"};
const Setting<int> kScheduleFixedCases{
    "fixed_cases",
    {.lower = 1, .upper = kMostCases},
    LoadedProblem{}.fixed_cases,
    "fixed training cases per evaluation for an optimizer without generations, if the kind needs "
    "generations"};

const Setting<std::string> kRacingKind{
    "kind", racing_kind_names, "none",
    "halving: candidates get their cases in rungs, and only the better ones go on; abandonment: "
    "candidates that are certain to be worse than the incumbent are given up"};
const Setting<int> kRacingFirstCases{"first_cases",
                                     {.lower = 1, .upper = kMostCases},
                                     Racing{}.first_cases,
                                     "for halving: cases of the first rung, for every candidate"};
const Setting<int> kRacingEta{"eta",
                              {.lower = 2, .upper = kLargestEta},
                              Racing{}.eta,
                              "for halving: one of this many candidates goes on to the next rung"};
const Setting<double> kRacingMargin{
    "margin",
    {.lower = 1, .upper = kLargestMargin},
    Racing{}.margin,
    "for abandonment: a candidate is given up above this many times the incumbent's error"};
const Setting<int> kRacingChunkCases{
    "chunk_cases",
    {.lower = 1, .upper = kMostCases},
    Racing{}.chunk_cases,
    "for abandonment: cases that are simulated between two decisions"};

}  // namespace

const SettingTable kScheduleSettings{
    .key = "schedule",
    .settings = {&kScheduleKind, &kScheduleCases, &kScheduleFactor, &kScheduleFixedCases}};
const SettingTable kRacingSettings{.key = "racing",
                                   .settings = {&kRacingKind, &kRacingFirstCases, &kRacingEta,
                                                &kRacingMargin, &kRacingChunkCases}};

void read_schedule_table(const ConfigTable& table, LoadedProblem& loaded) {
  loaded.schedule.kind = static_cast<Schedule::Kind>(table.get_choice(kScheduleKind));
  if (loaded.schedule.kind == Schedule::Kind::coevolution) {
    Setting<int> bred = kScheduleCases.within({.lower = kFewestBredCases, .upper = kMostCases});
    bred.fallback.reset();
    loaded.schedule.cases = table.get(bred);
  } else {
    loaded.schedule.cases = table.get(kScheduleCases);
  }
  if (loaded.schedule.kind == Schedule::Kind::growing) {
    loaded.schedule.factor = table.get(kScheduleFactor);
  }
  loaded.fixed_cases = table.get(kScheduleFixedCases);
}

Racing read_racing_table(const ConfigTable& table) {
  Racing racing;
  racing.kind = static_cast<Racing::Kind>(table.get_choice(kRacingKind));
  // Settings of another kind are not read and so refused, because they would change nothing.
  if (racing.kind == Racing::Kind::halving) {
    racing.first_cases = table.get(kRacingFirstCases);
    racing.eta = table.get(kRacingEta);
  } else if (racing.kind == Racing::Kind::abandonment) {
    racing.margin = table.get(kRacingMargin);
    racing.chunk_cases = table.get(kRacingChunkCases);
  }
  return racing;
}

void settle_one_case(const ConfigTable& table, LoadedProblem& loaded) {
  loaded.schedule = {Schedule::Kind::fixed, 1};
  loaded.fixed_cases = 1;
  table.settle(kScheduleKind, to_string(loaded.schedule.kind));
  table.settle(kScheduleCases, loaded.schedule.cases);
  table.settle(kScheduleFixedCases, loaded.fixed_cases);
}

}  // namespace armwright
