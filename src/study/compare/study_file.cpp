// make_study_plan(): from a file, flags, or both.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
#include "base/text.hpp"
#include "optimizers/plugins/host_optimizer.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "problems/config/config_files.hpp"
#include "sim/simd/simd_level.hpp"
#include "study/compare/case_sets.hpp"
#include "study/compare/escape.hpp"
#include "study/compare/study_methods.hpp"
#include "study/compare/study_plan.hpp"

namespace armwright {
namespace {

constexpr std::int64_t kMostBudget = 1'000'000'000'000;
constexpr int kMostReplicates = 10'000;
constexpr int kMostSelected = 10'000;
constexpr int kMostCheckpoints = 1000;
constexpr std::size_t kMostNamed = 200;          // problems, and optimizers
constexpr std::uint64_t kMostCells = 1'000'000;  // problems x optimizers x replicates

struct NamedOptimizer {
  std::string name;
  std::string label;
  std::vector<std::string> options;
  bool baseline = false;  // a resolved plan says so
  std::optional<Schedule> schedule;
  std::vector<std::string> settings;
  // A resolved plan has these of a foreign optimizer.
  std::string description = {};
  std::vector<std::string> inputs = {};  // "NAME HASH"
};

struct NamedProblem {
  std::string name;
  std::string label;
  std::vector<std::string> settings;
  std::optional<Schedule> schedule;
  std::string configuration_sha256;  // as recorded by a resolved plan; empty: not known
};

// What file and flags say, before it is looked up.
struct RawPlan {
  std::vector<NamedProblem> problems;
  std::vector<NamedOptimizer> optimizers;
  std::vector<std::string> settings;       // of every problem, under its own
  std::vector<std::string> last_settings;  // over its own
  std::optional<Schedule> schedule;
};

std::vector<std::string> get_strings_or_none(const ConfigTable& table, std::string_view key) {
  return table.has(key) ? table.get_strings(key) : std::vector<std::string>{};
}

std::optional<Schedule> read_schedule_key(const ConfigTable& table) {
  if (!table.has("schedule")) {
    return std::nullopt;
  }
  const auto schedule = read_schedule(table.get_string("schedule"));
  if (!schedule) {
    table.refuse("schedule", fmt::format("it must be {}", kScheduleForms));
  }
  return schedule;
}

// Keys that would give one optimizer more than another.
void refuse_privileges(const ConfigTable& table) {
  for (const char* key : {"budget", "replicates", "seed", "start_spread", "sets"}) {
    if (table.has(key)) {
      table.refuse(key,
                   "it is the same for every optimizer of a comparison: it belongs to the top "
                   "of the file");
    }
  }
}

RawPlan read_file_plan(const ConfigTable& table, StudyPlan& plan) {
  RawPlan raw;
  plan.title = table.get_string("title", "");
  table.get_string("description", "");
  plan.name = table.get_string("name", "");
  table.get_string("plan_sha256", "");  // check_plan_hash() has looked at the text
  plan.seed = static_cast<std::uint64_t>(
      table.get_integer_or("seed", 1, 0, std::numeric_limits<std::int64_t>::max()));
  plan.replicates =
      static_cast<int>(table.get_integer_or("replicates", plan.replicates, 1, kMostReplicates));
  plan.budget = table.get_integer_or("budget", 0, 1, kMostBudget);
  plan.start_spread =
      table.get_number_or("start_spread", plan.start_spread, {.lower = 0, .upper = 2});
  plan.checkpoints =
      static_cast<int>(table.get_integer_or("checkpoints", plan.checkpoints, 1, kMostCheckpoints));
  plan.first_checkpoint =
      table.get_integer_or("first_checkpoint", plan.first_checkpoint, 1, kMostBudget);
  plan.constraint_tolerance = table.get_number_or("constraint_tolerance", plan.constraint_tolerance,
                                                  {.lower = 0, .upper = 1});
  plan.final_engine = table.get_string("final_engine", "");
  plan.baselines = table.get_bool_or("baselines", true);
  const ConfigTable selection = table.get_table_or_empty("selection");
  plan.selection.last =
      static_cast<int>(selection.get_integer_or("last", plan.selection.last, 1, kMostSelected));
  plan.selection.best =
      static_cast<int>(selection.get_integer_or("best", plan.selection.best, 0, kMostSelected));
  plan.judge_along = selection.get_bool_or("along", false);
  read_targets(table, plan);
  raw.schedule = read_schedule_key(table);
  raw.settings = get_strings_or_none(table, "set");
  for (const std::string& name : get_strings_or_none(table, "problems")) {
    raw.problems.push_back({name, "", {}, {}, ""});
  }
  for (const ConfigTable& problem : table.get_tables_or_empty("problem")) {
    raw.problems.push_back({problem.get_string("name"), problem.get_string("label", ""),
                            get_strings_or_none(problem, "set"), read_schedule_key(problem),
                            problem.get_string("configuration_sha256", "")});
    for (const char* key : {"training_set", "validation_set", "test_set"}) {
      problem.get_string(key, "");  // of a resolved plan: they follow from the rest
    }
  }
  for (const std::string& name : get_strings_or_none(table, "optimizers")) {
    raw.optimizers.push_back({name, "", {}, false, {}, {}});
  }
  for (const ConfigTable& optimizer : table.get_tables_or_empty("optimizer")) {
    refuse_privileges(optimizer);
    raw.optimizers.push_back(
        {optimizer.get_string("name"), optimizer.get_string("label", ""),
         get_strings_or_none(optimizer, "options"), optimizer.get_bool_or("baseline", false),
         read_schedule_key(optimizer), read_method_settings(optimizer),
         optimizer.get_string("description", ""), get_strings_or_none(optimizer, "inputs")});
  }
  table.refuse_unknown();
  return raw;
}

// Numbers that are each allowed, but together make a plan that takes hours to check and more memory
// than there is. Before anything is loaded.
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

// Only the same cases for all make a pair: of fresh ones, optimizers without generations see none.
Schedule choose_study_schedule(const LoadedProblem& problem, const std::optional<Schedule>& asked) {
  if (asked) {
    return *asked;
  }
  return problem.schedule.changes_cases()
             ? Schedule{.kind = Schedule::Kind::fixed, .cases = problem.fixed_cases}
             : problem.schedule;
}

void refuse_repeated(std::string_view what, std::span<const std::string> labels) {
  for (auto label = labels.begin(); label != labels.end(); ++label) {
    if (label->empty() || sanitize(*label) != *label) {
      throw Error(ErrorKind::usage,
                  fmt::format("{} label '{}' is not printable text", what, sanitize(*label)));
    }
    // A cell's folder is named after it, and names may have 255 bytes.
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

// A plan made where "auto" came to another SIMD level is the same plan on that level, if this
// machine has it. False if none of its levels gives what is recorded.
bool load_on_recorded_simd(const NamedProblem& named, StudyProblem& problem) {
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
      return false;  // of a function, or its engine has no SIMD
    }
  }
  return false;
}

void load_problems(const RawPlan& raw, StudyPlan& plan) {
  std::vector<std::string> labels;
  for (const NamedProblem& named : raw.problems) {
    StudyProblem problem;
    problem.name = named.name;
    for (const auto* settings : {&raw.settings, &named.settings, &raw.last_settings}) {
      problem.settings.insert(problem.settings.end(), settings->begin(), settings->end());
    }
    problem.loaded = load_problem(named.name, problem.settings);
    problem.label = named.label.empty() ? problem.loaded.name : named.label;
    problem.schedule =
        choose_study_schedule(problem.loaded, named.schedule ? named.schedule : raw.schedule);
    std::string hash = calc_configuration_hash(problem.loaded);
    if (!named.configuration_sha256.empty() && named.configuration_sha256 != hash &&
        load_on_recorded_simd(named, problem)) {
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

OptimizerRow find_row(const NamedOptimizer& named, std::span<const OptimizerRow> rows) {
  const auto row = std::ranges::find(rows, named.name, &OptimizerRow::name);
  if (row != rows.end()) {
    return *row;
  }
  if (named.description.empty()) {
    return load_optimizer(named.name);  // what it reads says what its inputs are
  }
  OptimizerRow recorded = read_foreign_row(named.name, named.description);
  for (const std::string& input : named.inputs) {
    const std::size_t blank = std::min(input.rfind(' '), input.size());
    recorded.input_hashes[input.substr(0, blank)] = input.substr(std::min(blank + 1, input.size()));
  }
  return recorded;
}

StudyOptimizer load_study_optimizer(const NamedOptimizer& named,
                                    std::span<const OptimizerRow> rows = {}) {
  StudyOptimizer optimizer;
  optimizer.name = named.name;
  optimizer.label = named.label.empty() ? named.name : named.label;
  optimizer.options = named.options;
  optimizer.baseline = named.baseline;
  optimizer.row = find_row(named, rows);
  optimizer.parsed = Options::parse(optimizer.row.name, optimizer.row.options, named.options);
  optimizer.schedule = named.schedule;
  optimizer.settings = named.settings;
  return optimizer;
}

void load_optimizers(const RawPlan& raw, std::span<const OptimizerRow> rows, StudyPlan& plan) {
  if (raw.optimizers.empty()) {
    throw Error(ErrorKind::usage,
                "the study names no optimizer; give --optimizers A,B, or in its file "
                "optimizers = [\"A\", \"B\"] (armwright list optimizers)");
  }
  bool has_random = false, has_local = false;
  for (const NamedOptimizer& named : raw.optimizers) {
    plan.optimizers.push_back(load_study_optimizer(named, rows));
    const OptimizerRow& row = plan.optimizers.back().row;
    has_random = has_random || row.name == kRandomBaseline;
    has_local = has_local || row.capabilities.local;
  }
  const auto add = [&](std::string_view name) {
    try {
      plan.optimizers.push_back(load_study_optimizer({std::string(name), "", {}, true, {}, {}}));
    } catch (const Error& error) {
      throw Error(error.kind(),
                  fmt::format("{} (it stands in every comparison as a baseline; name another local "
                              "search, or leave the baselines out: --no-baselines, or baselines = "
                              "false)",
                              error.what()));
    }
  };
  if (plan.baselines && !has_random) {
    add(kRandomBaseline);
  }
  if (plan.baselines && !has_local) {
    add(kLocalBaseline);
  }
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

void check_cells(const StudyPlan& plan) {
  std::vector<std::string> without_generations;
  for (const StudyOptimizer& optimizer : plan.optimizers) {
    if (!optimizer.row.capabilities.generations && !optimizer.schedule) {
      without_generations.push_back(optimizer.label);
    }
  }
  const auto changing = std::ranges::find_if(
      plan.problems, [](const StudyProblem& problem) { return problem.schedule.changes_cases(); });
  if (changing != plan.problems.end() && !without_generations.empty()) {
    throw Error(
        ErrorKind::usage,
        fmt::format("schedule {} gives every generation new training cases, so only optimizers "
                    "with generations can be compared on it, and these have none: {}. Use "
                    "schedule fixed:K for all, give these a schedule of their own{}",
                    to_string(changing->schedule.kind), join(without_generations, ", "),
                    plan.baselines ? ", or take the baselines out (--no-baselines)" : ""));
  }
  for (const Cell& cell : list_cells(plan)) {
    if (cell.replicate == 1) {
      check_budget(plan, cell);
      const RunPlan run = make_run_plan(plan, cell);
      check_plan(run);
      run.optimizer.make(run.options)->check_problem(run.problem.problem->description());
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
  for (const ConfigTable& table : ConfigTable::load(recorded).get_tables_or_empty("optimizer")) {
    const std::string label = table.get_string("label");
    if (table.get_bool_or("baseline", false) &&
        std::ranges::find(plan.optimizers, label, &StudyOptimizer::label) ==
            plan.optimizers.end()) {
      plan.optimizers.push_back(load_study_optimizer(
          {table.get_string("name"), label, table.get_strings("options"), true, {}, {}}));
    }
  }
}

std::string read_study_title(const std::string& file) {
  return ConfigTable::load(resolve_config("studies", file)).get_string("title", "");
}

std::vector<AskedKey> ask_study_keys(const ConfigTable& table) {
  StudyPlan plan;
  read_file_plan(table, plan);
  return table.asked();
}

StudyPlan make_study_plan(const StudyRequest& request) {
  StudyPlan plan;
  RawPlan raw;
  if (!request.file.empty()) {
    const auto path = resolve_config("studies", request.file);
    raw = read_file_plan(ConfigTable::load(path), plan);
    check_plan_hash(path);
    if (plan.name.empty()) {
      plan.name = path.stem().string();
    }
  }
  if (!request.problems.empty()) {
    raw.problems.clear();
    for (const std::string& name : request.problems) {
      raw.problems.push_back({name, "", {}, {}, ""});
    }
  }
  if (!request.optimizers.empty()) {
    raw.optimizers.clear();
    for (const std::string& name : request.optimizers) {
      raw.optimizers.push_back({name, "", {}, false, {}, {}});
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
  load_problems(raw, plan);
  if (plan.budget == 0) {
    throw Error(ErrorKind::usage,
                "the study names no budget; give --budget CASES or budget = CASES: how many "
                "training cases every optimizer may simulate on a problem");
  }
  load_optimizers(raw, request.rows, plan);
  load_methods(plan);
  check_targets(plan);
  if (plan.name.empty()) {
    plan.name = make_study_name(plan);
  }
  if (!plan.final_engine.empty()) {
    find_engine(plan.final_engine);
  }
  for (const StudyProblem& problem : plan.problems) {
    if (plan.start_spread == 0 && !problem.loaded.tracking()) {
      throw Error(ErrorKind::usage,
                  fmt::format("start_spread is 0, and {} has no training cases: the replicates of "
                              "a deterministic optimizer would all be the same run; it must be "
                              "above 0 there",
                              problem.label));
    }
  }
  check_cells(plan);
  check_sets_are_disjoint(plan);
  return plan;
}

}  // namespace armwright
