// armwright verify: checks whether a design holds with other engines, time steps and masses, and on
// perturbed plants.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"
#include "cli/commands/commands.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/progress_bar.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/table.hpp"
#include "cli/terminal/terminal.hpp"
#include "cli/views/design_and_problem.hpp"
#include "cli/views/verification.hpp"
#include "problems/config/config_files.hpp"
#include "problems/config/design_file.hpp"
#include "problems/config/problem_readers.hpp"
#include "sim/engines/engine_table.hpp"
#include "study/verification/prepared_setting.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr std::uint64_t kUsualCases = 50;
constexpr std::uint64_t kIdentifiedCases =
    1000;  // of plants that an identification leaves possible
// Presets for robots whose plant's file has what an identification left uncertain.
constexpr std::string_view kIdentifiedPlants = "identified";

constexpr const char* kVerifyExamples = R"(Examples:
  armwright verify table-a10                       # a published design, on the problem it was made for
  armwright verify results/irb4600-auto-seed1/winner.toml --problem irb4600 --cases 200
  armwright verify table-a5 --set task.load_kg=5 --json
  armwright verify table-a1 --problem q1-complex --engines articulated --substeps 10 --cases 10000 \
      --perturbations none,friction,sensor,all

The command simulates the design in all combinations of: every engine of this build; 1, 2, 5 and 10 substeps of the
physics per control period (physics.substeps); and all masses and inertias of the arm at -10 %, 0 and +10 %
(robot.mass_scale). It also simulates the design in its own engine and time step on perturbed plants, that is, arms that
differ from the nominal one, with another plant for each case. It uses all shipped perturbations except those that
weaken motors or change gains. Then it changes the friction, the rotors and the elasticity of the joints. With
--perturbations, the named plants are combined with all engines and substeps. A robot whose plant was identified
(--plant) is also simulated on 1000 plants that the identification leaves possible, and at the corners of their
distribution. A list that is not given keeps its
default. Each setting is compared with the design's own setting, the problem as it is:

  holds   not more cases fail than in its own setting, and the median error is at most 1.1 times its own
  worse   not more cases fail than in its own setting, but the median error is larger than that
  fails   more cases fail, or the median error is more than 10 times its own or does not exist

Another plant gets as many substeps as its springs need, and so does any plant with the design's own substeps. A
setting that cannot be simulated has a row with the reason. It is no failure of the design.

A failure is a case with an error above 100 mm or without a number. For the first failure of each setting, the command
that simulates it again and writes its trajectory is printed. The exit code is 3 if any setting is worse or fails, or if
no other setting could be simulated.)";

struct VerifyOptions {
  std::string design;
  std::string problem;
  OverrideOptions overrides;
  CaseOptions cases;
  std::vector<std::string> engines, substeps, perturbations;
  std::string jobs;
  bool json = false;
  bool quiet = false;
};

struct VerifiedDesign {
  std::string design;
  std::string problem;
  ChosenCases cases;
  std::vector<VerifyRow> rows;       // the first is the design's own setting
  std::vector<ErrorSurvey> surveys;  // one per row
  std::vector<std::string> replays;  // one per row: the command for its first failure, or empty
  // One per row: the loads, if they are shares of the robot's mass.
  std::vector<std::optional<std::pair<double, double>>> loads_kg;
};

std::string describe_setting(const VerifySetting& setting) {
  return fmt::format("{}, {}, {}", setting.engine,
                     format_count(static_cast<unsigned long long>(setting.substeps), "substep"),
                     sanitize(describe_plant(setting)));
}

std::string format_text(const VerifiedDesign& verified, const Style& style) {
  std::string text = style.bold(fmt::format(
      "{} on {}: the first {} of {}", sanitize(verified.design), sanitize(verified.problem),
      format_count(verified.cases.count, "case"), sanitize(verified.cases.set.name())));
  Table table({{"engine", false},
               {"substeps"},
               {"plant", false},
               {"mean mm"},
               {"median mm"},
               {"worst mm"},
               {"failures"},
               {"ratio"},
               {"verdict", false}});
  for (const VerifyRow& row : verified.rows) {
    const bool own = &row == &verified.rows.front();
    table.add_row({row.setting.engine, fmt::format("{}", row.setting.substeps),
                   sanitize(describe_plant(row.setting)), format_mm(row.summary.mean),
                   format_mm(row.summary.median), format_mm(row.summary.worst),
                   !row.fault.empty() ? "-"
                   : row.summary.cases == verified.cases.count
                       ? fmt::format("{}", row.summary.failures)
                       : fmt::format("{} of {}", row.summary.failures, row.summary.cases),
                   row.ratio ? format_significant(*row.ratio, 3) : "-",
                   own ? "its own setting" : to_string(row.verdict)});
  }
  text += "\n\n" + table.format(style) + "\n";
  for (const std::string& line :
       wrap_words(conclude(sanitize(verified.design), verified.rows), 100)) {
    text += line + "\n";
  }
  const auto add_lines = [&](const char* heading, const auto& describe) {
    for (std::size_t i = 0; i < verified.rows.size(); ++i) {
      if (const std::string words = describe(i); !words.empty()) {
        text += fmt::format("{}  {}: {}\n", std::exchange(heading, ""),
                            describe_setting(verified.rows[i].setting), words);
      }
    }
  };
  add_lines("\nLoads for this robot:\n", [&](std::size_t i) {
    const auto& load_kg = verified.loads_kg[i];
    return load_kg ? fmt::format("{:.4g} to {:.4g} kg", load_kg->first, load_kg->second) : "";
  });
  add_lines("\nSettings that could not be simulated:\n",
            [&](std::size_t i) { return sanitize(verified.rows[i].fault); });
  const char* title = "\nCommands that simulate the first failure of each setting again:\n";
  for (std::size_t i = 0; i < verified.rows.size(); ++i) {
    if (!verified.replays[i].empty()) {
      text += fmt::format("{}  {}: case {}\n    {}\n", std::exchange(title, ""),
                          describe_setting(verified.rows[i].setting),
                          verified.surveys[i].first_failure, sanitize(verified.replays[i]));
    }
  }
  return text;
}

// Returns nothing if no setting beside the design's own one was simulated.
std::optional<bool> holds(const VerifiedDesign& verified) {
  const std::span rows(verified.rows);
  const auto is_missing = [](const VerifyRow& row) { return row.verdict == Verdict::missing; };
  if (std::ranges::all_of(rows.subspan(1), is_missing)) {
    return {};
  }
  return std::ranges::none_of(rows, [](const VerifyRow& row) {
    return row.verdict == Verdict::worse || row.verdict == Verdict::fails;
  });
}

std::string format_json(const VerifiedDesign& verified) {
  json rows = json::array();
  for (std::size_t i = 0; i < verified.rows.size(); ++i) {
    const VerifyRow& row = verified.rows[i];
    const auto count = [&](std::size_t number) {
      return row.verdict == Verdict::missing ? json() : json(number);
    };
    json one = {{"engine", row.setting.engine},
                {"substeps", row.setting.substeps},
                {"mass_factor", row.setting.mass_factor},
                {"perturbation",
                 row.setting.perturbation.empty() ? "own" : sanitize(row.setting.perturbation)},
                {"own_setting", i == 0},
                {"mean_error_m", to_json_value(row.summary.mean)},
                {"median_error_m", to_json_value(row.summary.median)},
                {"worst_error_m", to_json_value(row.summary.worst)},
                {"cases", count(row.summary.cases)},
                {"failures", count(row.summary.failures)},
                {"without_number", count(row.summary.without_number)},
                {"median_ratio", to_json_value(row.ratio)},
                {"verdict", to_string(row.verdict)}};
    if (!row.fault.empty()) {
      one["reason"] = sanitize(row.fault);
    } else if (!verified.surveys[i].reason.empty()) {
      one["reason"] = sanitize(verified.surveys[i].reason);
    }
    if (const auto& load_kg = verified.loads_kg[i]) {
      one["load_kg"] = {load_kg->first, load_kg->second};
    }
    if (!verified.replays[i].empty()) {
      one["first_failure"] = verified.surveys[i].first_failure;
      one["replay"] = sanitize(verified.replays[i]);
    }
    rows.push_back(std::move(one));
  }
  const std::optional<bool> verdict = holds(verified);
  return json{{"design", sanitize(verified.design)},
              {"problem", sanitize(verified.problem)},
              {"test_set", sanitize(verified.cases.set.name())},
              {"cases", verified.cases.count},
              {"worse_ratio", kWorseRatio},
              {"fail_ratio", kFailRatio},
              {"rows", rows},
              {"holds", verdict ? json(*verdict) : json()},
              {"conclusion", conclude(sanitize(verified.design), verified.rows)}}
             .dump(1) +
         "\n";
}

// Returns the command that simulates one case again and writes its trajectory.
std::string make_replay(const VerifyOptions& options, std::span<const std::string> overrides,
                        std::uint64_t number) {
  std::vector<std::string> words = {"armwright", "evaluate", options.design};
  const auto add = [&](const std::string& flag, const std::string& value) {
    if (!value.empty()) {
      words.insert(words.end(), {flag, value});
    }
  };
  add("--problem", options.overrides.choose_problem(options.problem));
  add("--test-set", options.cases.test_set);
  add("--test-cases", options.cases.test_cases);
  for (const std::string& assignment : overrides) {
    add("--set", assignment);
  }
  add("--cases", "1");
  add("--trajectory-case", fmt::format("{}", number));
  add("--trajectory", fmt::format("case-{}.csv", number));
  return quote_command(words);
}

// Returns the presets that a design should hold with, without those for training only, and then the
// other plants that suit the robot.
std::vector<std::string> list_usual_plants(const TrackingConfig& config) {
  std::vector<std::string> plants;
  for (const std::string& name : list_configs("perturbations")) {
    if (!config.fitted_plant && name.starts_with(kIdentifiedPlants)) {
      continue;
    }
    if (!load_perturbation(name, {config.robot, config.start, config.fitted_plant})
             .changes_design()) {
      plants.push_back(name);
    }
  }
  for (const OtherPlant& other : other_plants()) {
    if (other.suits(config.robot)) {
      plants.push_back(other.name);
    }
  }
  return plants;
}

// Throws Error if a plant that the user named does not suit the robot or cannot be read.
void check_plant(const std::string& name, const TrackingConfig& config) {
  if (const OtherPlant* other = find_other_plant(name)) {
    if (!other->suits(config.robot)) {
      throw Error(ErrorKind::usage, fmt::format("--perturbations has '{}': {}", name, other->lack));
    }
  } else if (std::ranges::find(kUsualPlants, name) == kUsualPlants.end()) {
    load_perturbation(name, {config.robot, config.start, config.fitted_plant});
  }
}

VerifyMatrix choose_matrix(const VerifyOptions& options, const VerifySetting& own,
                           const TrackingConfig& config) {
  VerifyMatrix matrix{engine_names(), kUsualSubsteps, kUsualPlants, {}};
  matrix.substeps.push_back(own.substeps);
  if (!options.engines.empty()) {
    for (const std::string& name : options.engines) {
      find_engine(name);
    }
    matrix.engines = options.engines;
  }
  if (!options.substeps.empty()) {
    matrix.substeps.clear();
    for (const std::string& text : options.substeps) {
      matrix.substeps.push_back(
          static_cast<int>(parse_count("--substeps", text, 1, kMostSubsteps)));
    }
  }
  if (options.perturbations.empty()) {
    matrix.own_plants = list_usual_plants(config);
    return matrix;
  }
  std::vector<std::string> known = list_configs("perturbations");
  known.insert(known.begin(), kUsualPlants.begin(), kUsualPlants.end());
  for (const OtherPlant& other : other_plants()) {
    known.push_back(other.name);
  }
  for (const std::string& name : options.perturbations) {
    const bool is_path = name.find('/') != std::string::npos || name.ends_with(".toml");
    if (!is_path && std::ranges::find(known, name) == known.end()) {
      throw Error(ErrorKind::usage,
                  describe_unknown("perturbation", name, known) + " (or the path of a .toml file)");
    }
    check_plant(name, config);
  }
  matrix.plants = options.perturbations;
  return matrix;
}

int run_verify(const VerifyOptions& options, Session& session) {
  const unsigned jobs = parse_jobs(options.jobs);
  const std::string named = options.overrides.choose_problem(options.problem);
  const auto [design, base] =
      load_design_and_problem(options.design, named, options.overrides.get(), options.quiet);
  const TrackingProblem& tracking = require_tracking(base);
  tracking.check_design(design.design);
  ChosenCases cases = choose_cases(base, options.cases);
  if (options.cases.cases.empty()) {
    cases.count = std::min(cases.count, kUsualCases);
  }
  const VerifySetting own_setting = get_own_setting(tracking);
  // All settings are validated before the first is simulated.
  std::vector<PreparedSetting> prepared;
  const std::vector<std::string> own_overrides = options.overrides.get();
  const ProblemLoader load = [&, &file = design](const std::vector<std::string>& changes) {
    return load_problem_of_design(file, named, replace_overrides(own_overrides, changes), true);
  };
  for (const VerifySetting& setting :
       list_verify_settings(own_setting, choose_matrix(options, own_setting, tracking.config()))) {
    PreparedSetting one = prepare_setting(setting, base, load, prepared.empty());
    // Springs can give two settings the same substeps.
    if (std::ranges::find(prepared, one.setting, &PreparedSetting::setting) == prepared.end()) {
      prepared.push_back(std::move(one));
    }
  }

  catch_signals(session.stop);
  ProgressBar bar(options.quiet, {"error", "m"});
  VerifiedDesign verified{design.name, base.name, cases, {}, {}, {}, {}};
  Progress progress;
  // Returns the cases of a setting: more of identified plants, as each case has another one.
  const auto get_cases = [&](const VerifySetting& setting) {
    ChosenCases its = cases;
    if (options.cases.cases.empty() && setting.perturbation.starts_with(kIdentifiedPlants)) {
      its.count = kIdentifiedCases;
    }
    return its;
  };
  for (const PreparedSetting& one : prepared) {
    progress.total += get_cases(one.setting).count;
  }
  for (std::size_t i = 0; i < prepared.size(); ++i) {
    PreparedSetting& one = prepared[i];
    verified.loads_kg.emplace_back();
    if (one.problem) {
      const Perturbation& plants = one.problem->tracking()->config().perturbation;
      verified.loads_kg.back() = plants.load_share ? plants.load_kg : std::nullopt;
    }
    std::optional<ErrorSurvey> survey = survey_setting(one, design.design, get_cases(one.setting),
                                                       jobs, session.stop, bar, progress, i == 0);
    one.problem.reset();  // frees its target tables
    if (!survey && one.fault.empty()) {
      bar.clear();
      write_message(fmt::format("{}; nothing was written", describe_stop(session.stop.reason())));
      return get_stop_code(session.stop.reason());
    }
    progress.done += get_cases(one.setting).count;
    if (!survey) {
      verified.rows.push_back(make_missing_row(one.setting, one.fault));
      verified.replays.emplace_back();
      verified.surveys.emplace_back();
      continue;
    }
    const ErrorSummary& own =
        verified.rows.empty() ? survey->summary : verified.rows.front().summary;
    verified.rows.push_back(judge_setting(one.setting, survey->summary, own));
    verified.replays.push_back(survey->summary.failures == 0
                                   ? ""
                                   : make_replay(options,
                                                 replace_overrides(own_overrides, one.changes),
                                                 survey->first_failure));
    verified.surveys.push_back(std::move(*survey));
  }
  bar.clear();
  write_stdout(options.json ? format_json(verified)
                            : format_text(verified, make_style(Stream::out, session.color)));
  const bool has_others = verified.rows.size() > 1;
  return holds(verified).value_or(!has_others) ? exit_code::kDone : exit_code::kFailed;
}

}  // namespace

void add_verify(CLI::App& app, Session& session) {
  auto options = std::make_shared<VerifyOptions>();
  CLI::App* command = add_command(
      app, session, "verify",
      "Check whether a design holds with other engines, time steps and masses, and on perturbed\n"
      "plants",
      kVerifyExamples);
  add_design_argument(*command, options->design);
  command
      ->add_option("--problem,-p", options->problem,
                   "The problem that is the design's own setting (default: the one that the\n"
                   "design was published for, or 'robot' with --robot; otherwise required)")
      ->type_name("PROBLEM");
  options->overrides.add_to(*command);
  options->cases.add_to(*command);
  command
      ->add_option("--engines", options->engines,
                   "Engines to try, separated by commas (default: all engines of this build)")
      ->delimiter(',')
      ->type_name("NAMES");
  command
      ->add_option("--substeps", options->substeps,
                   "Substeps per control period to try (default: 1,2,5,10 and the problem's)")
      ->delimiter(',')
      ->type_name("NUMBERS");
  command
      ->add_option(
          "--perturbations", options->perturbations,
          "Plants to try: none; lighter and heavier (all masses -10 and +10 %); a shipped\n"
          "perturbation (docs/robust.md: masses-10, load-0-40, friction, sensor, ripple, all\n"
          "(these five together), weak); the path of such a file; or another plant: "
          "more-friction,\n"
          "lighter-rotors, heavier-rotors, added-rotors, softer, elastic, elastic-rotors\n"
          "(docs/verify.md; default: none, lighter, heavier, all shipped perturbations except "
          "weak,\n"
          "and the other plants that suit the robot)")
      ->delimiter(',')
      ->type_name("NAMES");
  add_jobs_flag(*command, options->jobs);
  command->add_flag("--json", options->json, "Print everything as JSON")->group("Output");
  command->add_flag("--quiet,-q", options->quiet, "Show no progress")->group("Output");
  command->callback([options, &session] {
    session.action = [options, &session] { return run_verify(*options, session); };
  });
}

}  // namespace armwright
