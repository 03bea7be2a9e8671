// armwright verify: does a design hold under other engines, time steps and masses?

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "base/text.hpp"
#include "cli/arguments.hpp"
#include "cli/design_evaluation.hpp"
#include "cli/format.hpp"
#include "cli/json.hpp"
#include "cli/progress_bar.hpp"
#include "cli/session.hpp"
#include "cli/signals.hpp"
#include "cli/table.hpp"
#include "cli/terminal.hpp"
#include "cli/verification.hpp"
#include "problems/design_file.hpp"
#include "sim/physics_engine.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr std::uint64_t kUsualCases = 50;

constexpr const char* kExamples = R"(Examples:
  armwright verify table-a10                       # a published design, on the problem it was made for
  armwright verify results/q1-complex-ga-seed1/winner.toml --problem q1-complex --cases 200
  armwright verify table-a5 --set task.load_kg=5 --json

The design is simulated in every engine that is built in, with 1, 2, 5 and 10 substeps of the physics in a control
period (physics.substeps), and with all masses and inertias of the arm at -10 %, 0 and +10 % (robot.mass_scale), in
all combinations. Each is compared with the design's own setting, the problem as it is:

  holds   no more cases fail, and the median error is at most 1.1 times its own
  worse   no more cases fail, but the median error is larger than that
  fails   more cases fail, or the median error is more than 10 times its own or does not exist

A failure is a case with an error above 100 mm or none at all. The exit code is 3 if something does not hold.)";

struct VerifyOptions {
  std::string design;
  std::string problem;
  OverrideOptions overrides;
  CaseOptions cases;
  JobsOption jobs;
  bool json = false;
  bool quiet = false;
};

struct VerifiedDesign {
  std::string design;
  std::string problem;
  ChosenCases cases;
  std::vector<VerifyRow> rows;       // the first is the design's own setting
  std::vector<std::string> reasons;  // one a row: why its first case without a number has none
};

VerifySetting get_own_setting(const TrackingProblem& problem) {
  return {problem.config().engines.judging_name, problem.config().task.physics.substeps, 1};
}

std::string format_mass(double factor) {
  return factor == 1 ? "0 %" : fmt::format("{:+.0f} %", 100 * (factor - 1));
}

std::string format_text(const VerifiedDesign& verified, const Style& style) {
  std::string text = style.bold(fmt::format(
      "{} on {}: the first {} of {}", sanitize(verified.design), sanitize(verified.problem),
      format_count(verified.cases.count, "case"), sanitize(verified.cases.set.name())));
  Table table({{"engine", false},
               {"substeps"},
               {"masses"},
               {"mean mm"},
               {"median mm"},
               {"worst mm"},
               {"failures"},
               {"ratio"},
               {"verdict", false}});
  for (const VerifyRow& row : verified.rows) {
    const bool own = &row == &verified.rows.front();
    table.add_row({row.setting.engine, fmt::format("{}", row.setting.substeps),
                   format_mass(row.setting.mass_factor), format_mm(row.summary.mean),
                   format_mm(row.summary.median), format_mm(row.summary.worst),
                   fmt::format("{}", row.summary.failures),
                   row.ratio ? format_significant(*row.ratio, 3) : "-",
                   own ? "its own setting" : to_string(row.verdict)});
  }
  text += "\n\n" + table.format(style) + "\n";
  for (const std::string& line :
       wrap_words(conclude(sanitize(verified.design), verified.rows), 100)) {
    text += line + "\n";
  }
  return text;
}

bool holds(const VerifiedDesign& verified) {
  return std::ranges::all_of(verified.rows,
                             [](const VerifyRow& row) { return row.verdict == Verdict::holds; });
}

std::string format_json(const VerifiedDesign& verified) {
  json rows = json::array();
  for (std::size_t i = 0; i < verified.rows.size(); ++i) {
    const VerifyRow& row = verified.rows[i];
    json one = {{"engine", row.setting.engine},
                {"substeps", row.setting.substeps},
                {"mass_factor", row.setting.mass_factor},
                {"own_setting", i == 0},
                {"mean_error_m", to_json_value(row.summary.mean)},
                {"median_error_m", to_json_value(row.summary.median)},
                {"worst_error_m", to_json_value(row.summary.worst)},
                {"failures", row.summary.failures},
                {"without_number", row.summary.without_number},
                {"median_ratio", to_json_value(row.ratio)},
                {"verdict", to_string(row.verdict)}};
    if (!verified.reasons[i].empty()) {
      one["reason"] = sanitize(verified.reasons[i]);
    }
    rows.push_back(std::move(one));
  }
  return json{{"design", sanitize(verified.design)},
              {"problem", sanitize(verified.problem)},
              {"test_set", sanitize(verified.cases.set.name())},
              {"cases", verified.cases.count},
              {"worse_ratio", kWorseRatio},
              {"fail_ratio", kFailRatio},
              {"rows", rows},
              {"holds", holds(verified)},
              {"conclusion", conclude(sanitize(verified.design), verified.rows)}}
             .dump(1) +
         "\n";
}

// The problem again, under another setting.
LoadedProblem load_variant(const DesignFile& design, const VerifyOptions& options,
                           const VerifySetting& setting, double own_mass_scale) {
  std::vector<std::string> overrides = options.overrides.get();
  overrides.push_back("physics.engine=" + setting.engine);
  overrides.push_back("physics.judging_engine=" + setting.engine);
  // Designs are judged in double, and only some engines have a SIMD level.
  overrides.push_back("physics.precision=double");
  if (!find_engine(setting.engine).simd) {
    overrides.push_back("physics.simd=auto");
  }
  overrides.push_back(fmt::format("physics.substeps={}", setting.substeps));
  overrides.push_back("robot.mass_scale=" + format_exact(own_mass_scale * setting.mass_factor));
  return load_its_problem(design, options.problem, std::move(overrides), true);
}

std::string find_reason(const DesignEvaluation& evaluation) {
  for (const TrackingResult& result : evaluation.results) {
    if (result.status != SimulationStatus::ok) {
      return result.reason;
    }
  }
  return "";
}

int run_verify(const VerifyOptions& options, Session& session) {
  const unsigned jobs = options.jobs.get();
  const DesignFile design = load_design(options.design);
  const LoadedProblem base =
      load_its_problem(design, options.problem, options.overrides.get(), options.quiet);
  const TrackingProblem& tracking = require_tracking(base);
  tracking.check_design(design.design);
  ChosenCases cases = choose_cases(base, options.cases);
  if (options.cases.cases.empty()) {
    cases.count = std::min(cases.count, kUsualCases);
  }
  const auto settings = list_verify_settings(get_own_setting(tracking), engine_names());
  // All settings are validated before the first is simulated.
  std::vector<LoadedProblem> problems;
  for (const VerifySetting& setting : settings) {
    problems.push_back(load_variant(design, options, setting, tracking.config().mass_scale));
  }

  catch_signals(session.stop);
  ProgressBar bar(options.quiet, {"error", "m"});
  VerifiedDesign verified{design.name, base.name, cases, {}, {}};
  BarShare share{0, cases.count * settings.size()};
  for (std::size_t i = 0; i < settings.size(); ++i) {
    const auto evaluation = evaluate_with_progress(*problems[i].tracking, design.design, cases,
                                                   jobs, session.stop, bar, share);
    problems[i] = {};  // its targets are of no use to the next
    if (!evaluation) {
      bar.clear();
      write_message(fmt::format("{}; nothing was written", describe_stop(session.stop.reason())));
      return get_stop_code(session.stop.reason());
    }
    share.done_before += cases.count;
    const ErrorSummary& own =
        verified.rows.empty() ? evaluation->summary : verified.rows.front().summary;
    verified.rows.push_back(judge_setting(settings[i], evaluation->summary, own));
    verified.reasons.push_back(find_reason(*evaluation));
  }
  bar.clear();
  write_stdout(options.json ? format_json(verified)
                            : format_text(verified, make_style(Stream::out, session.color)));
  return holds(verified) ? exit_code::kDone : exit_code::kFailed;
}

}  // namespace

void add_verify(CLI::App& app, Session& session) {
  auto options = std::make_shared<VerifyOptions>();
  CLI::App* command = add_command(
      app, session, "verify",
      "Try whether a design holds under other engines, time steps and masses", kExamples);
  add_design_argument(*command, options->design);
  command
      ->add_option("--problem,-p", options->problem,
                   "Robot, task and physics that are its own setting (default: what the design\n"
                   "was published for)")
      ->type_name("PROBLEM");
  options->overrides.add_to(*command);
  options->cases.add_to(*command);
  options->jobs.add_to(*command);
  command->add_flag("--json", options->json, "Print everything as JSON")->group("Output");
  command->add_flag("--quiet,-q", options->quiet, "No progress")->group("Output");
  command->callback([options, &session] {
    session.action = [options, &session] { return run_verify(*options, session); };
  });
}

}  // namespace armwright
