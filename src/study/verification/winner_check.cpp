#include "study/verification/winner_check.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/folder_checksums.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "problems/config/problem_readers.hpp"
#include "sim/engines/engine_table.hpp"
#include "study/run/json_values.hpp"
#include "study/run/run_folder.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr int kCheckFormat = 1;
constexpr std::size_t kWinnerCheckLimit_bytes = std::size_t{1} << 20;
constexpr Verdict kCheckVerdicts[] = {Verdict::holds, Verdict::worse, Verdict::fails,
                                      Verdict::missing};

// Returns q r.
double calc_floor_m(const TrackingConfig& config) {
  const Perturbation sensor =
      load_perturbation(kSensorPreset, {config.robot, config.start, config.fitted_plant});
  double reach_m = config.robot.tip_pose.translation().norm();
  for (std::size_t i = 1; i < config.robot.joints.size(); ++i) {
    reach_m += config.robot.joints[i].origin.translation().norm();
  }
  return sensor.quantisation_rad * reach_m;
}

std::optional<double> calc_mean_ratio(const ErrorSummary& summary, const ErrorSummary& own) {
  return summary.mean && own.mean && *own.mean > 0 ? std::optional(*summary.mean / *own.mean)
                                                   : std::nullopt;
}

json checked_to_json(const CheckedSetting& checked) {
  json j = {{"name", checked.name},
            {"engine", checked.setting.engine},
            {"substeps", checked.setting.substeps},
            {"mass_factor", checked.setting.mass_factor},
            {"perturbation", checked.setting.perturbation},
            {"verdict", to_string(checked.verdict)},
            {"ratio", optional_to_json(checked.ratio)},
            {"summary", summary_to_json(checked.summary)}};
  if (!checked.fault.empty()) {
    j["reason"] = checked.fault;
  }
  return j;
}

CheckedSetting checked_from_json(const json& j) {
  CheckedSetting checked;
  checked.name = j.at("name");
  checked.setting = {j.at("engine"), whole_from_json<int>(j.at("substeps")), j.at("mass_factor"),
                     j.at("perturbation")};
  const auto verdict = std::ranges::find(kCheckVerdicts, j.at("verdict").get<std::string>(),
                                         [](Verdict one) { return std::string(to_string(one)); });
  if (verdict == std::end(kCheckVerdicts)) {
    throw std::runtime_error("a verdict is unknown");
  }
  checked.verdict = *verdict;
  checked.ratio = optional_from_json(j.at("ratio"));
  checked.summary = summary_from_json(j.at("summary"));
  checked.fault = j.value("reason", std::string());
  return checked;
}

// Returns nothing if stopped.
std::optional<WinnerCheck> make_winner_check(const LoadedProblem& problem, const RunResult& result,
                                             const ProblemLoader& load, unsigned jobs,
                                             StopSignal& stop, RunObserver& observer) {
  const TrackingProblem& arm = *problem.tracking();
  const TrackingConfig& config = arm.config();
  const ArmDesign design = arm.make_design(result.judged[*result.winner].candidate.x);
  const std::span errors(result.test.case_errors);
  const auto summarize_own = [&](std::uint64_t cases) {
    return summarize(errors.first(std::min<std::size_t>(errors.size(), cases)), kFailureError_m);
  };
  WinnerCheck check{
      .test_set = result.test_set, .own = summarize_own(kCheckCases), .limit_m = 0, .settings = {}};
  check.limit_m =
      calc_check_limit_m(check.own.mean, calc_floor_m(config), config.objective.error_limit_m);
  const VerifySetting own = get_own_setting(arm);
  const double steps = calc_case_duration_s(config, arm.make_task(design)) /
                       config.task.control_period_s * own.substeps;
  const auto engine_cases =
      std::clamp<std::uint64_t>(static_cast<std::uint64_t>(kEngineSteps / steps), 2, kEngineCases);
  const auto settings = list_check_settings(own, engine_names());
  const auto count_cases = [&](const VerifySetting& setting) {
    return summarize_own(setting.engine == own.engine ? kCheckCases : engine_cases).cases;
  };
  Progress progress;
  for (const VerifySetting& setting : settings) {
    progress.total += count_cases(setting);
  }
  for (const VerifySetting& setting : settings) {
    const ChosenCases cases{.set = arm.get_set(problem.sets.test), .count = count_cases(setting)};
    const ErrorSummary own_summary = summarize_own(cases.count);
    PreparedSetting prepared = prepare_setting(setting, problem, load, false);
    const auto survey =
        survey_setting(prepared, design, cases, jobs, stop, observer, progress, false);
    if (!survey && prepared.fault.empty()) {
      return std::nullopt;
    }
    progress.done += cases.count;
    CheckedSetting& checked = check.settings.emplace_back();
    checked.setting = prepared.setting;
    checked.name = name_setting(setting, own);
    if (survey) {
      checked.summary = survey->summary;
      checked.ratio = calc_mean_ratio(survey->summary, own_summary);
      checked.verdict = setting.engine == own.engine
                            ? judge_absolutely(survey->summary, check.limit_m)
                            : judge_engine(survey->summary, check.limit_m, own_summary.mean);
      checked.fault = survey->reason;
    } else {
      checked.verdict = Verdict::missing;
      checked.fault = prepared.fault;
    }
  }
  return check;
}

bool is_within(const CheckedSetting& checked, double limit_m) {
  return checked.summary.mean && *checked.summary.mean <= limit_m;
}

}  // namespace

double calc_check_limit_m(std::optional<double> own_mean_m, double floor_m, double tolerance_m) {
  return tolerance_m > 0 ? tolerance_m : std::max(kWorksRatio * own_mean_m.value_or(0), floor_m);
}

Verdict judge_absolutely(const ErrorSummary& summary, double limit_m) {
  return summary.failures > 0 || !summary.mean ? Verdict::fails
         : *summary.mean > limit_m             ? Verdict::worse
                                               : Verdict::holds;
}

Verdict judge_engine(const ErrorSummary& summary, double limit_m, std::optional<double> own_m) {
  const Verdict verdict = judge_absolutely(summary, limit_m);
  return verdict == Verdict::holds && own_m &&
                 std::abs(*summary.mean - *own_m) > kEngineAgreement * *own_m
             ? Verdict::worse
             : verdict;
}

std::string name_setting(const VerifySetting& setting, const VerifySetting& own) {
  if (setting.engine != own.engine) {
    return "engine " + setting.engine;
  }
  if (setting.perturbation != own.perturbation) {
    return setting.perturbation == kFrictionPreset ? "friction in the joints"
           : setting.perturbation == kSensorPreset ? "a coarse and late sensor"
                                                   : describe_plant(setting);
  }
  return setting.mass_factor != own.mass_factor
             ? describe_plant(setting)
             : fmt::format("{} physics steps per control period", setting.substeps);
}

std::string describe_outcome(const CheckedSetting& checked, double limit_m) {
  switch (checked.verdict) {
    case Verdict::holds:
      return "works";
    case Verdict::worse:
      if (checked.ratio && is_within(checked, limit_m)) {
        return fmt::format("error {:.0f} % {}", 100 * std::abs(*checked.ratio - 1),
                           *checked.ratio < 1 ? "smaller" : "larger");
      }
      return checked.ratio ? fmt::format("{:.{}f} times its own error", *checked.ratio,
                                         *checked.ratio < 2    ? 2
                                         : *checked.ratio < 10 ? 1
                                                               : 0)
                           : "error above the limit";
    case Verdict::fails:
      return fmt::format("fails in {} of {} cases", checked.summary.failures,
                         checked.summary.cases);
    case Verdict::missing:
      break;
  }
  return to_string(checked.verdict);
}

std::string name_row(const CheckedSetting& checked, const WinnerCheck& check) {
  const bool has_other_cases =
      checked.verdict != Verdict::missing && checked.summary.cases != check.own.cases;
  return sanitize(checked.name) + (has_other_cases
                                       ? fmt::format(", {} case{}", checked.summary.cases,
                                                     checked.summary.cases == 1 ? "" : "s")
                                       : "");
}

std::string list_weaknesses(const WinnerCheck& check) {
  std::vector<std::string> weak;
  for (const Verdict verdict : {Verdict::fails, Verdict::worse, Verdict::missing}) {
    for (const CheckedSetting& checked : check.settings) {
      if (checked.verdict == verdict &&
          !(verdict == Verdict::worse && is_within(checked, check.limit_m))) {
        weak.push_back(fmt::format("{} ({})", name_row(checked, check),
                                   describe_outcome(checked, check.limit_m)));
      }
    }
  }
  return join(weak, ", ");
}

bool check_winner(const RunRequest& request, const RunResult& result, const ProblemLoader& load,
                  StopSignal& stop, RunObserver& observer) {
  const bool is_there = path_exists(request.folder / kCheckFile) &&
                        FolderChecksums(request.folder).covers(kCheckFile);
  if (request.plan.problem.tracking() == nullptr || !result.winner || is_there) {
    return true;
  }
  const Folder folder(request.folder);
  std::optional<RunLock> lock;
  try {
    lock.emplace(folder);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::io || ::access(request.folder.c_str(), W_OK) == 0) {
      throw;
    }
    observer.on_message(
        fmt::format("warning: the winner is not checked, because its folder cannot "
                    "be written ({})",
                    error.what()));
    return true;
  }
  const auto check =
      make_winner_check(request.plan.problem, result, load, request.jobs, stop, observer);
  if (!check) {
    return false;
  }
  write_file_atomically(folder, kCheckFile, to_json(*check));
  cover_run(folder, result.failure.empty());
  return true;
}

std::optional<WinnerCheck> load_check(const std::filesystem::path& folder) {
  const auto file = folder / kCheckFile;
  if (!path_exists(file)) {
    return std::nullopt;
  }
  return parse_check(read_checked_file(file, kWinnerCheckLimit_bytes), file);
}

std::string to_json(const WinnerCheck& check) {
  json settings = json::array();
  for (const CheckedSetting& checked : check.settings) {
    settings.push_back(checked_to_json(checked));
  }
  return json{{"format", kCheckFormat},
              {"test_set", check.test_set},
              {"own", summary_to_json(check.own)},
              {"limit_m", check.limit_m},
              {"settings", settings}}
             .dump(1) +
         "\n";
}

WinnerCheck parse_check(const std::string& text, const std::filesystem::path& file) {
  check_json_depth(text, file.string());
  try {
    const json j = json::parse(text);
    if (j.at("format") != kCheckFormat) {
      throw std::runtime_error("its format is not the one this version reads");
    }
    WinnerCheck check{.test_set = j.at("test_set"),
                      .own = summary_from_json(j.at("own")),
                      .limit_m = j.at("limit_m"),
                      .settings = {}};
    for (const json& setting : j.at("settings")) {
      check.settings.push_back(checked_from_json(setting));
    }
    return check;
  } catch (const std::exception& error) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: is not a check that armwright wrote ({}). Remove it; the command "
                            "that began the run makes it again",
                            sanitize(file.string()), describe_json_error(error.what())));
  }
}

}  // namespace armwright
