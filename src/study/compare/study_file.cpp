// make_study_plan(): loads and checks what a study's file and flags name.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
#include "base/read_limit.hpp"
#include "base/text.hpp"
#include "base/toml_text.hpp"
#include "optimizers/plugins/recorded_optimizer.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "problems/config/config_files.hpp"
#include "problems/config/problem_loader.hpp"
#include "problems/user/user_problem.hpp"
#include "sim/simd/simd_level.hpp"
#include "study/compare/case_sets.hpp"
#include "study/compare/optimizer_labels.hpp"
#include "study/compare/optimizer_streams.hpp"
#include "study/compare/plugin_consent.hpp"
#include "study/compare/study_methods.hpp"
#include "study/compare/study_plan.hpp"
#include "study/compare/study_reader.hpp"

namespace armwright {
namespace {

constexpr std::size_t kMostNamed = 200;          // of problems, and of optimizers
constexpr std::uint64_t kMostCells = 1'000'000;  // problems x optimizers x replicates

// Refuses numbers that are each allowed, but together make a plan that takes hours to check and
// more memory than there is. It runs before anything is loaded.
void check_size(const RawPlan& raw, const StudyPlan& plan) {
  const auto refuse = [](std::string_view what, std::uint64_t count, std::uint64_t most) {
    throw Error(ErrorKind::usage, fmt::format("the study has {} {}; at most {} are possible: make "
                                              "several studies of it",
                                              count, what, most));
  };
  if (raw.problems.size() > kMostNamed) {
    refuse("problems", raw.problems.size(), kMostNamed);
  }
  if (raw.optimizers.size() > kMostNamed) {
    refuse("optimizers", raw.optimizers.size(), kMostNamed);
  }
  const std::uint64_t cells = std::uint64_t{raw.problems.size()} * raw.optimizers.size() *
                              static_cast<std::uint64_t>(plan.replicates);
  if (cells > kMostCells) {
    refuse("cells (problems x optimizers x replicates)", cells, kMostCells);
  }
}

std::string make_study_name(const StudyPlan& plan) {
  std::string name = "study";
  for (const StudyProblem& problem : plan.problems) {
    name += "-" + problem.label;
  }
  constexpr std::size_t kLongest = 80;
  return name.substr(0, kLongest);
}

// Sets the schedule that was asked for, else a fixed one: runs are compared in pairs, which need
// the same training cases for every optimizer. An optimizer without generations cannot have fresh
// cases. A function has no training cases and a program may have a few only, so own schedules have
// no meaning there.
void set_schedule(const std::optional<StudySchedule>& asked, StudyProblem& problem) {
  const LoadedProblem& loaded = problem.loaded;
  if (asked && std::holds_alternative<Schedule>(*asked)) {
    problem.schedule = std::get<Schedule>(*asked);
  } else if (asked && !loaded.function && loaded.sets.training_cases == 0) {
    problem.own_schedules = true;
    problem.schedule = kOwnWithoutGenerations;
  } else if (loaded.schedule.changes_cases()) {
    problem.schedule = {.kind = Schedule::Kind::fixed, .cases = loaded.fixed_cases};
  } else {
    problem.schedule = loaded.schedule;
  }
}

// Returns the error with the place of the entry of the study's file that causes it.
Error add_place(const std::string& place, const Error& error) {
  return place.empty() ? error : Error(error.kind(), fmt::format("{}: {}", place, error.what()));
}

// Loads a problem of the study. An error names its place. An error of its settings also names the
// problem, since the study's settings are for all problems.
LoadedProblem load_named_problem(const NamedProblem& named,
                                 const std::vector<std::string>& settings,
                                 const ProgramSource& programs) {
  try {
    return load_problem(named.name, settings, engine_table(), programs);
  } catch (const Error& error) {
    const std::string& label = named.label.empty() ? named.name : named.label;
    throw add_place(
        named.place,
        settings.empty()
            ? error
            : Error(error.kind(), fmt::format("problem {}: {}", sanitize(label), error.what())));
  }
}

void refuse_repeated(std::string_view what, std::span<const std::string> labels) {
  for (auto label = labels.begin(); label != labels.end(); ++label) {
    if (label->empty() || sanitize(*label) != *label) {
      throw Error(ErrorKind::usage,
                  fmt::format("{} label '{}' is not printable text", what, sanitize(*label)));
    }
    // A cell's folder has this name, and a name may have 255 bytes.
    constexpr std::size_t kLongestName = 250;
    if (escape_name(*label).size() > kLongestName) {
      throw Error(ErrorKind::usage,
                  fmt::format("{} label '{}...' is too long for the name of a folder: {} of {} "
                              "characters, of which others than letters, digits, _ - . count 3",
                              what, sanitize(label->substr(0, 40)), escape_name(*label).size(),
                              kLongestName));
    }
    if (std::find(labels.begin(), label, *label) != label) {
      throw Error(ErrorKind::usage,
                  fmt::format("two {}s of the study are called '{}'; give one of them another "
                              "label",
                              what, *label));
    }
  }
}

// Loads the problem on the SIMD level on which the plan was made, because "auto" may choose another
// one on this machine. Returns false if no level gives the recorded configuration.
bool load_as_recorded(const NamedProblem& named, StudyProblem& problem) {
  if (problem.loaded.tracking() == nullptr) {
    return false;
  }
  for (const std::string& level : supported_simd_names()) {
    std::vector<std::string> settings = problem.settings;
    settings.push_back("physics.simd=" + level);
    try {
      LoadedProblem loaded = load_problem(named.name, settings);
      if (calc_configuration_hash(loaded) == named.configuration_sha256) {
        problem.loaded = std::move(loaded);
        return true;
      }
    } catch (const Error&) {
      return false;  // the engine has no SIMD
    }
  }
  return false;
}

// Adds the description of a problem's program to the settings, so that the recorded plan can be read
// without the program.
void record_description(StudyProblem& problem) {
  const bool is_recorded = std::ranges::any_of(problem.settings, [&](const std::string& text) {
    return text.starts_with(kRecordedDescription);
  });
  const auto resolved = nlohmann::json::parse(problem.loaded.resolved_json);
  if (!is_recorded && resolved.contains("program")) {
    problem.settings.push_back(
        std::string(kRecordedDescription) +
        quote_toml(resolved.at("program").at("description").get<std::string>()));
  }
}

// With `reads_programs`, takes the files of programs as they are recorded, because they may be gone.
void load_problems(const RawPlan& raw, bool reads_programs, StudyPlan& plan) {
  std::vector<std::string> labels;
  for (const NamedProblem& named : raw.problems) {
    StudyProblem problem;
    problem.name = named.name;
    for (const auto* settings : {&raw.settings, &named.settings, &raw.last_settings}) {
      problem.settings.insert(problem.settings.end(), settings->begin(), settings->end());
    }
    problem.loaded = load_named_problem(named, problem.settings, plan.programs);
    if (problem.loaded.program.empty()) {  // kind = "external"
      require_server(*problem.loaded.problem);
    }
    record_description(problem);
    if (reads_programs && !problem.loaded.program.empty()) {
      problem.loaded.input_hashes = read_inputs(named.inputs);
    }
    problem.label = named.label.empty() ? problem.loaded.name : named.label;
    set_schedule(named.schedule ? named.schedule : raw.schedule, problem);
    std::string hash = calc_configuration_hash(problem.loaded);
    if (!named.configuration_sha256.empty() && named.configuration_sha256 != hash &&
        load_as_recorded(named, problem)) {
      hash = named.configuration_sha256;
    }
    if (!named.configuration_sha256.empty() && named.configuration_sha256 != hash) {
      throw Error(ErrorKind::usage,
                  fmt::format("problem '{}' is not the one that the plan was made with: its "
                              "configuration has the hash {}, the plan says {}. Take "
                              "configuration_sha256 out of the plan to use what is there now",
                              problem.label, hash, named.configuration_sha256));
    }
    labels.push_back(problem.label);
    plan.problems.push_back(std::move(problem));
  }
  if (plan.problems.empty()) {
    throw Error(ErrorKind::usage,
                "the study names no problem; give --problems A,B, or in its file "
                "problems = [\"A\", \"B\"] (armwright list problems)");
  }
  refuse_repeated("problem", labels);
}

// Returns whether only the file says what the optimizer is: it belongs to a program in Python, or it
// is a plugin that must not be started. A plugin that is gone is recognised by its recorded files.
bool is_known_by_record(const NamedOptimizer& named, bool reads_plugins) {
  if (is_host_name(named.name)) {
    return !named.description.empty();
  }
  const bool is_shipped = std::ranges::count(optimizer_names(), named.name) > 0;
  return reads_plugins && (is_plugin(named.name) || (!named.inputs.empty() && !is_shipped));
}

// Makes the row from the file alone.
OptimizerRow read_row(const NamedOptimizer& named) {
  OptimizerRow row = is_host_name(named.name)
                         ? read_host_row(named.name, named.description)
                         : read_recorded_plugin(named.name, named.description, named.options);
  if (named.description.empty() && !named.label.empty()) {
    row.name = named.label;  // a program's own name is not recorded, but it is the label
  }
  row.input_hashes = read_inputs(named.inputs);
  return row;
}

OptimizerRow find_row(const NamedOptimizer& named, std::span<const OptimizerRow> rows,
                      bool reads_plugins) {
  const auto row = std::ranges::find(rows, named.name, &OptimizerRow::name);
  if (row != rows.end()) {
    return *row;
  }
  if (is_known_by_record(named, reads_plugins)) {
    return read_row(named);
  }
  OptimizerRow loaded = load_optimizer(named.name);
  if (!named.description.empty() && loaded.description.empty()) {
    throw Error(ErrorKind::bad_data,
                fmt::format("optimizer '{}': its description is not needed; only that of a plugin "
                            "or of an optimizer in Python is recorded",
                            sanitize(named.name)));
  }
  return loaded;
}

StudyOptimizer load_study_optimizer(const NamedOptimizer& named,
                                    std::span<const OptimizerRow> rows = {},
                                    bool reads_plugins = false) {
  StudyOptimizer optimizer;
  optimizer.name = named.name;
  optimizer.label = named.label;
  optimizer.has_given_label = !named.label.empty();
  optimizer.options = named.options;
  optimizer.baseline = named.baseline;
  try {
    optimizer.row = find_row(named, rows, reads_plugins);
    optimizer.parsed = Options::parse(optimizer.row.name, optimizer.row.options, named.options);
    if (!reads_plugins) {
      optimizer.row.input_hashes.merge(optimizer.row.make(optimizer.parsed)->list_inputs());
    }
  } catch (const Error& error) {
    throw add_place(named.place, error);
  }
  optimizer.schedule = named.schedule;
  optimizer.settings = named.settings;
  optimizer.own_schedule = named.own_schedule.value_or(choose_own_schedule(optimizer.row));
  optimizer.stream = named.stream;
  return optimizer;
}

void load_optimizers(const RawPlan& raw, std::span<const OptimizerRow> rows, bool reads_plugins,
                     StudyPlan& plan) {
  if (raw.optimizers.empty()) {
    throw Error(ErrorKind::usage,
                "the study names no optimizer; give --optimizers A,B, or in its file "
                "optimizers = [\"A\", \"B\"] (armwright list optimizers)");
  }
  bool has_start = false, has_random = false, has_local = false;
  for (const NamedOptimizer& named : raw.optimizers) {
    plan.optimizers.push_back(load_study_optimizer(named, rows, reads_plugins));
    const OptimizerRow& row = plan.optimizers.back().row;
    has_start = has_start || row.name == kStartBaseline;
    has_random = has_random || row.name == kRandomBaseline;
    has_local = has_local || row.capabilities.local;
  }
  const auto add = [&](std::string_view name) {
    try {
      plan.optimizers.push_back(
          load_study_optimizer({.name = std::string(name), .baseline = true}));
    } catch (const Error& error) {
      throw Error(error.kind(),
                  fmt::format("{} (it stands in every comparison as a baseline; name another local "
                              "search, or leave the baselines out: --no-baselines, or baselines = "
                              "false)",
                              error.what()));
    }
  };
  // A recorded plan lists its baselines. What a plugin is may not be recorded.
  const bool lists_baselines = raw.is_recorded && reads_plugins;
  if (plan.baselines && !raw.is_recorded && !has_start) {
    add(kStartBaseline);
  }
  if (plan.baselines && !lists_baselines && !has_random) {
    add(kRandomBaseline);
  }
  if (plan.baselines && !lists_baselines && !has_local) {
    add(kLocalBaseline);
  }
  choose_labels(plan);
  std::vector<std::string> labels;
  for (const StudyOptimizer& optimizer : plan.optimizers) {
    labels.push_back(optimizer.label);
  }
  refuse_repeated("optimizer", labels);
}

void check_budget(const StudyPlan& plan, const Cell& cell) {
  const int cases = get_schedule(plan, cell).cases;
  if (plan.budget < cases) {
    throw Error(ErrorKind::usage,
                fmt::format("a budget of {} cases does not pay for one evaluation on {}{}, which "
                            "takes {}",
                            plan.budget, plan.problems[cell.problem].label,
                            plan.optimizers[cell.optimizer].schedule
                                ? " by " + plan.optimizers[cell.optimizer].label
                                : "",
                            cases));
  }
}

// `makes` is false for commands that only read: they load no library of an optimizer.
void check_cells(const StudyPlan& plan, bool makes) {
  const auto changing = std::ranges::find_if(
      plan.problems, [](const StudyProblem& problem) { return problem.schedule.changes_cases(); });
  std::vector<std::string> without_generations;
  for (const StudyOptimizer& optimizer : plan.optimizers) {
    if (changing != plan.problems.end() && !optimizer.schedule &&
        !takes_schedule(optimizer.row, changing->schedule)) {
      without_generations.push_back(optimizer.label);
    }
  }
  if (!without_generations.empty()) {
    throw Error(
        ErrorKind::usage,
        fmt::format("schedule {} gives every generation new training cases, so only optimizers "
                    "with generations can be compared on it, and these have none: {}. Use "
                    "schedule own ({} for optimizers with generations, {} for the others) or "
                    "fixed:K for all, give these a schedule of their own{}",
                    to_string(changing->schedule.kind), join(without_generations, ", "),
                    to_text(kOwnWithGenerations), to_text(kOwnWithoutGenerations),
                    plan.baselines ? ", or take the baselines out (--no-baselines)" : ""));
  }
  for (const Cell& cell : list_cells(plan)) {
    if (cell.replicate == 1) {
      check_budget(plan, cell);
      const RunPlan run = make_run_plan(plan, cell);
      check_plan(run);
      if (makes) {
        run.optimizer.make(run.options)->check_problem(run.problem.problem->description());
      }
    }
  }
}

}  // namespace

void check_plan_hash(const std::filesystem::path& path) {
  constexpr std::size_t kLimit_bytes = std::size_t{16} << 20;
  constexpr std::string_view kKey = "plan_sha256 = \"";
  const std::string text = read_file(path, kLimit_bytes);
  const std::size_t end = text.find('\n');
  if (!text.starts_with(kKey) || end == std::string::npos) {
    return;
  }
  const std::string hash = calc_sha256_hex(text.substr(end + 1));
  if (text.substr(kKey.size(), hash.size()) != hash) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: is a resolved plan that somebody has changed: its hash is not "
                            "plan_sha256. As a plan of your own, without that line and under "
                            "another name, it can be what you like",
                            path.string()));
  }
}

void keep_baselines(const std::filesystem::path& recorded, StudyPlan& plan) {
  for (const NamedOptimizer& optimizer : read_recorded_optimizers(recorded)) {
    if (optimizer.baseline && !needs_consent(optimizer) &&
        std::ranges::find(plan.optimizers, optimizer.label, &StudyOptimizer::label) ==
            plan.optimizers.end()) {
      plan.optimizers.push_back(load_study_optimizer(optimizer));
    }
  }
}

void keep_simd_levels(const std::filesystem::path& recorded, StudyPlan& plan) {
  StudyPlan ignored;
  const RawPlan raw = read_study_file(recorded, ignored);
  for (StudyProblem& problem : plan.problems) {
    const auto found = std::ranges::find(raw.problems, problem.label, &NamedProblem::label);
    if (found != raw.problems.end() &&
        found->configuration_sha256 != calc_configuration_hash(problem.loaded)) {
      NamedProblem named = *found;
      named.name = problem.name;
      load_as_recorded(named, problem);
    }
  }
  load_methods(plan);
}

StudyPlan make_study_plan(const StudyRequest& request) {
  const ReadStep step(fmt::format("the study '{}'", sanitize(request.file)));
  StudyPlan plan;
  RawPlan raw;
  bool reads_plugins = request.plugins == PluginUse::read;
  plan.programs.hosts = request.hosts;
  plan.programs.may_describe = request.plugins != PluginUse::read || request.is_rank;
  std::filesystem::path record;          // the folder of the file
  std::vector<NamedOptimizer> recorded;  // the optimizers that the user did not name
  if (!request.file.empty()) {
    const auto path = resolve_config("studies", request.file);
    raw = read_study_file(path, plan);
    check_plan_hash(path);
    // Plugins that the user names in `optimizers` need no consent. A file of the user's own is run
    // as a script is.
    const bool is_of_record = raw.is_recorded || is_record_of_study(path);
    plan.programs.may_describe &= !(is_of_record && request.problems.empty());
    plan.programs.may_simulate =
        plan.programs.may_describe || request.plugins != PluginUse::preview;
    if (is_of_record && request.optimizers.empty()) {
      reads_plugins = request.plugins != PluginUse::run;
      recorded = raw.optimizers;
    }
    record = path.has_parent_path() ? path.parent_path() : ".";
    if (plan.name.empty()) {
      plan.name = path.stem().string();
    }
  }
  if (!request.problems.empty()) {
    raw.problems.clear();
    for (const std::string& name : request.problems) {
      raw.problems.push_back({.name = name});
    }
  }
  if (!request.optimizers.empty()) {
    raw.optimizers.clear();
    raw.is_recorded = false;
    for (const std::string& name : request.optimizers) {
      raw.optimizers.push_back({.name = name});
    }
  }
  raw.last_settings = request.settings;
  if (request.schedule) {
    raw.schedule = request.schedule;
  }
  plan.seed = request.seed.value_or(plan.seed);
  plan.replicates = request.replicates.value_or(plan.replicates);
  plan.budget = request.budget.value_or(plan.budget);
  plan.baselines = plan.baselines && request.baselines;
  check_size(raw, plan);
  const bool reads_programs = !plan.programs.may_describe && request.plugins != PluginUse::run;
  load_problems(raw, reads_programs, plan);
  if (!plan.programs.may_describe) {
    std::ranges::move(list_programs(plan.problems), std::back_inserter(recorded));
  }
  if (request.plugins == PluginUse::run) {
    require_consent(record, recorded, request.ask);
  }
  if (plan.budget == 0) {
    throw Error(ErrorKind::usage,
                "the study names no budget; give --budget CASES or budget = CASES: how many "
                "training cases every optimizer may simulate on a problem");
  }
  load_optimizers(raw, request.rows, reads_plugins, plan);
  name_streams(plan);
  load_methods(plan);
  check_targets(plan);
  if (plan.name.empty()) {
    plan.name = make_study_name(plan);
  }
  if (!plan.final_engine.empty()) {
    find_engine(plan.final_engine);
  }
  for (const StudyProblem& problem : plan.problems) {
    if (plan.start_spread == 0 && problem.loaded.problem->description().has_single_case) {
      throw Error(ErrorKind::usage,
                  fmt::format("start_spread is 0, and {} has no training cases: the replicates of "
                              "a deterministic optimizer would all be the same run; it must be "
                              "above 0 there",
                              problem.label));
    }
  }
  check_cells(plan, !reads_plugins);
  check_sets_are_disjoint(plan);
  return plan;
}

}  // namespace armwright
