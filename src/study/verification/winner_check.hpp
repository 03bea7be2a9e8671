// The short check of a run's winner: a few test cases in a few other settings (list_check_settings()).
// It judges absolutely. With the mean errors e of a setting and e_0 of the own setting on the same
// cases (m), a setting
//   fails     if a case fails (its error exceeds kFailureError_m, or it has no number), otherwise
//   is worse  if e > L
//   works     if e <= L
// where L is the problem's own limit of the error (objective.error_limit_m), or without one
//   L = max(3 e_0, q r)
// with q the step of the encoder that the check supposes (rad; the preset `sensor`) and r the reach
// (m), the sum of the distances between the joints and the tip. Below q r no such arm shows a
// difference. The sag of the robot's own springs is in e_0; no setting of the check adds springs.
// Another engine is also worse if |e - e_0| > 0.05 e_0: the engines agree better (docs/engines.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "study/run/run.hpp"
#include "study/verification/prepared_setting.hpp"

namespace armwright {

inline constexpr std::uint64_t kCheckCases = 10;  // the first ones of the test set
// Another engine gets more cases, but at most so many physics steps, since ODE is slow.
inline constexpr std::uint64_t kEngineCases = 20;
inline constexpr double kEngineSteps = 80'000;
inline constexpr double kEngineAgreement = 0.05;  // of the mean error
inline constexpr double kWorksRatio = 3;          // of e to e_0, as far as the error counts

// One setting. `ratio` is that of the mean errors, and `name` says in words what is different:
// "2 physics steps per control period".
struct CheckedSetting : VerifyRow {
  std::string name;
};

struct WinnerCheck {
  std::string test_set;
  ErrorSummary own;  // of the winner on the same cases in its own setting
  double limit_m = 0;
  std::vector<CheckedSetting> settings;
};

// Returns the limit L above. `tolerance_m` is the problem's own limit of the error; 0: none.
double calc_check_limit_m(std::optional<double> own_mean_m, double floor_m, double tolerance_m);
// Returns `fails`, `worse` or `holds`.
Verdict judge_absolutely(const ErrorSummary& summary, double limit_m);
// Likewise for another engine. `own_m` is e_0.
Verdict judge_engine(const ErrorSummary& summary, double limit_m, std::optional<double> own_m);

// Returns the name of a setting, which follows "with".
std::string name_setting(const VerifySetting& setting, const VerifySetting& own);
// Returns "works", "3.2 times its own error", "error 6 % smaller" (in another engine, within the
// limit), "fails in 10 of 10 cases" or "not simulated".
std::string describe_outcome(const CheckedSetting& checked, double limit_m);

// Returns the name of a checked setting without control characters, with its number of cases if that
// is not the check's: "engine ode, 3 cases".
std::string name_row(const CheckedSetting& checked, const WinnerCheck& check);
// Returns the conditions under which the winner is not shown to work: "a coarse and late sensor
// (fails in 2 of 10 cases), engine ode, 2 cases (not simulated)". Empty if there are none. Another
// engine whose error is within the limit is none.
std::string list_weaknesses(const WinnerCheck& check);

// Checks the winner of a run that has ended, and writes check.json into its folder, unless the file
// is there. Does nothing without an arm or a winner, and warns if this process may only read the
// folder. `load` makes the problems of the settings. The result does not depend on `request.jobs`.
// Returns false if stopped; nothing is written then. Throws Error{busy} if another process writes
// the folder, and Error{io}.
bool check_winner(const RunRequest& request, const RunResult& result, const ProblemLoader& load,
                  StopSignal& stop, RunObserver& observer);

// Returns the recorded check of the run in a folder; nothing if its winner was not checked. Throws
// Error{bad_data} if the file is damaged, and Error{io}.
std::optional<WinnerCheck> load_check(const std::filesystem::path& folder);

// The text of check.json.
std::string to_json(const WinnerCheck& check);
// Throws Error{bad_data} if the text of `file` is not a check that armwright wrote.
WinnerCheck parse_check(const std::string& json, const std::filesystem::path& file);

}  // namespace armwright
