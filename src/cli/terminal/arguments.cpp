#include "cli/terminal/arguments.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <iterator>
#include <thread>
#include <utility>

#include "base/error.hpp"
#include "base/folder.hpp"
#include "base/text.hpp"
#include "base/toml_text.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/terminal.hpp"
#include "problems/config/config_files.hpp"
#include "sim/engines/engine_table.hpp"
#include "sim/robot/mesh_finder.hpp"
#include "sim/tracking/physics_engine.hpp"
#include "study/executor/mpi_transport.hpp"
#include "study/run/run_folder.hpp"
#include "study/run/run_plan.hpp"

namespace armwright {
namespace {

constexpr std::int64_t kMostJobs = 1024;

[[noreturn]] void refuse(std::string_view flag, std::string_view text, std::string_view allowed) {
  throw Error(ErrorKind::usage,
              fmt::format("{} is '{}'; it must be {}", flag, sanitize(text), allowed));
}

}  // namespace

std::int64_t parse_count(std::string_view flag, std::string_view text, std::int64_t lower,
                         std::int64_t upper) {
  const auto value = parse_count(text);
  if (!value || *value < lower || *value > upper) {
    refuse(flag, text,
           fmt::format("an integer from {} to {}{}", lower, upper,
                       value ? "" : "; 1e3, 10k and 2M are integers too"));
  }
  return *value;
}

double parse_duration_s(std::string_view flag, std::string_view text) {
  constexpr double kLongest_s = 1e9;
  double unit_s = 1;
  std::string_view number = text;
  if (!text.empty() && std::string_view("smh").find(text.back()) != std::string_view::npos) {
    unit_s = text.back() == 's' ? 1 : text.back() == 'm' ? 60 : 3600;
    number.remove_suffix(1);
  }
  const auto value = parse_finite(number);
  if (!value || *value <= 0 || *value * unit_s > kLongest_s) {
    refuse(flag, text, "a time above 0: seconds (90 or 90s), minutes (10m) or hours (2h)");
  }
  return *value * unit_s;
}

ReadLimit parse_read_limit(std::string_view text) {
  constexpr const char* kFlag = "--read-limit (ARMWRIGHT_READ_LIMIT)";
  constexpr double kMost_bytes = 1e18;
  constexpr std::pair<std::string_view, double> kUnits[] = {
      {"KiB", 1024.0}, {"MiB", 1024.0 * 1024}, {"GiB", 1024.0 * 1024 * 1024}};
  ReadLimit limit;
  for (const std::string& part : split(text, ',')) {
    const auto unit =
        std::ranges::find_if(kUnits, [&](const auto& one) { return part.ends_with(one.first); });
    if (unit == std::end(kUnits)) {
      limit.time_s = parse_duration_s(kFlag, part);
      continue;
    }
    const auto number =
        parse_finite(std::string_view(part).substr(0, part.size() - unit->first.size()));
    if (!number || *number <= 0 || *number * unit->second > kMost_bytes) {
      refuse(kFlag, part, "a memory above 0 with its unit: 512MiB or 4GiB");
    }
    limit.memory_bytes = static_cast<std::uint64_t>(*number * unit->second);
  }
  return limit;
}

Schedule parse_schedule(std::string_view text) {
  const auto schedule = read_schedule(text);
  if (!schedule) {
    refuse("--schedule", text, kScheduleForms);
  }
  return *schedule;
}

Racing parse_racing(std::string_view text) {
  const auto racing = read_racing(text);
  if (!racing) {
    refuse("--racing", text, kRacingForms);
  }
  return *racing;
}

CLI::App* add_command(CLI::App& parent, Session& session, const std::string& name,
                      const std::string& description, const std::string& examples) {
  CLI::App* command = parent.add_subcommand(name, description);
  command->add_option("--color", session.color, "When to use colour: auto, always or never")
      ->type_name("WHEN")
      ->group("Output");
  command
      ->add_option("--read-limit", session.read_limit,
                   "Processor time and memory that reading a problem, a study, a design or test\n"
                   "cases may take (default: " +
                       to_string(ReadLimit{}) + "); give one of them or both")
      ->type_name("TIME,MEMORY")
      ->envname("ARMWRIGHT_READ_LIMIT");
  command->footer(examples + std::string(kSeeExitCodes));
  return command;
}

void add_jobs_flag(CLI::App& command, std::string& jobs, const std::string& fallback) {
  command
      .add_option("--jobs,-j", jobs,
                  fmt::format("Threads that simulate; the results do not depend on it\n"
                              "(default: {})",
                              fallback))
      ->type_name("N")
      ->envname("ARMWRIGHT_JOBS");
}

unsigned parse_jobs(std::string_view text) {
  if (text.empty()) {
    const auto place = find_rank_place();
    return place ? count_rank_cores(*place) : std::max(1U, std::thread::hardware_concurrency());
  }
  return static_cast<unsigned>(parse_count("--jobs (ARMWRIGHT_JOBS)", text, 1, kMostJobs));
}

unsigned parse_jobs_or_one(std::string_view text) {
  return text.empty() ? 1 : parse_jobs(text);
}

void add_time_limit_flag(CLI::App& command, std::string& time_limit) {
  command
      .add_option("--time-limit", time_limit,
                  "Stop after this time, so that the command can be resumed: 90, 90s, 10m, 2h")
      ->type_name("DURATION");
}

void apply_time_limit(std::string_view time_limit, StopSignal& stop) {
  if (!time_limit.empty()) {
    const std::chrono::duration<double> limit(parse_duration_s("--time-limit", time_limit));
    stop.set_deadline(StopSignal::Clock::now() +
                      std::chrono::duration_cast<StopSignal::Clock::duration>(limit));
  }
}

void add_trust_flag(CLI::App& command, bool& trust) {
  command.add_flag("--trust", trust,
                   "Run the plugins that the study names, although you did not start it on this\n"
                   "machine; a plugin has all rights that you have");
}

std::function<bool(const std::string& question)> make_asker(bool trust) {
  return [trust](const std::string& question) { return trust || ask_on_terminal(question); };
}

void FolderOptions::add_to(CLI::App& command, const std::string& what,
                           const std::string& fallback) {
  command.add_option("--out", out, fmt::format("The {}'s folder (default: {})", what, fallback))
      ->type_name("FOLDER")
      ->group("Output");
  command
      .add_flag(
          "--new", another,
          fmt::format("Begin a new {} if the folder exists: FOLDER-002, FOLDER-003, ...", what))
      ->group("Output");
}

std::filesystem::path FolderOptions::choose(const std::string& name) const {
  if (out.empty()) {
    return choose_run_folder("results", name, another);
  }
  auto path = std::filesystem::path(out).lexically_normal();
  if (!path.has_filename()) {
    path = path.parent_path();  // "results/mine/"
  }
  return choose_run_folder(path.parent_path(), path.filename().string(), another);
}

void add_design_argument(CLI::App& command, std::string& design) {
  command
      .add_option(
          "DESIGN", design,
          "A design file, the name of a shipped design (armwright list designs), or \"start\"\n"
          "for the design from which the problem's optimization starts")
      ->required();
}

void EngineFlags::add_to(CLI::App& command, bool with_training) {
  trains = with_training;
  command
      .add_option("--engine", engine,
                  trains
                      ? "Physics engine, the same as --set physics.engine=NAME\n"
                        "(armwright list engines; default: the problem's)"
                      : "Physics engine (armwright list engines; default: the problem's judging\n"
                        "engine)")
      ->type_name("NAME");
  if (trains) {
    command
        .add_option("--judging-engine", judging_engine,
                    "Engine for the validation and test sets, the same as\n"
                    "--set physics.judging_engine=NAME (default: the engine of training)")
        ->type_name("NAME");
    command
        .add_option("--precision", precision,
                    "double (default) or float, which is faster and used in training only; for\n"
                    "engines with SIMD, the same as --set physics.precision=NAME")
        ->type_name("NAME");
  }
  command
      .add_option("--simd", simd,
                  "Instruction set of engines with SIMD; the last digits of results depend on\n"
                  "it; the same as --set physics.simd=LEVEL (default: auto, the best of this\n"
                  "machine)")
      ->type_name("LEVEL");
}

std::vector<std::string> EngineFlags::get() const {
  std::vector<std::string> overrides;
  const auto add = [&](std::string_view key, std::string_view what, const std::string& value,
                       const std::vector<std::string>& valid) {
    if (value.empty()) {
      return;
    }
    if (std::ranges::find(valid, value) == valid.end()) {
      throw Error(ErrorKind::usage, describe_unknown(what, value, valid));
    }
    overrides.push_back(fmt::format("physics.{}={}", key, value));
  };
  std::vector<std::string> levels = simd_names();
  levels.insert(levels.begin(), "auto");
  add("engine", "engine", engine, engine_names());
  add("judging_engine", "engine", trains ? judging_engine : engine, engine_names());
  add("precision", "precision", precision, precision_names());
  add("simd", "SIMD level", simd, levels);
  return overrides;
}

std::string_view get_override_key(std::string_view assignment) {
  constexpr std::string_view kBlanks = " \t";
  std::string_view key = assignment.substr(0, assignment.find('='));
  key.remove_prefix(std::min(key.size(), key.find_first_not_of(kBlanks)));
  return key.substr(0, key.find_last_not_of(kBlanks) + 1);
}

std::vector<std::string> replace_overrides(std::vector<std::string> own,
                                           const std::vector<std::string>& changes) {
  std::erase_if(own, [&](const std::string& text) {
    return std::ranges::find(changes, get_override_key(text), get_override_key) != changes.end();
  });
  std::ranges::copy(changes, std::back_inserter(own));
  return own;
}

void add_robot_flags(CLI::App& command, std::string& base, std::string& tip,
                     std::vector<std::string>& packages, bool has_set) {
  const auto name_setting = [has_set](const char* setting) {
    return has_set ? fmt::format("; the same as\n--set {}", setting) : "";
  };
  command
      .add_option("--base", base,
                  "The link at which the arm begins (default: the robot's root)" +
                      name_setting("robot.base=LINK"))
      ->type_name("LINK");
  command
      .add_option("--tip", tip,
                  "The link whose frame is the tool centre point (default: the end of the\n"
                  "chain that is clearly the tool)" +
                      name_setting("robot.tip=LINK"))
      ->type_name("LINK");
  command
      .add_option("--package", packages,
                  "The folder of a package that the robot's file names in package:// paths;\n"
                  "repeatable" +
                      name_setting("'robot.packages=[\"NAME=DIR\"]'"))
      ->type_name("NAME=DIR")
      ->allow_extra_args(false);
}

std::vector<std::string> make_absolute_packages(std::span<const std::string> packages) {
  std::vector<std::string> absolute;
  for (const std::string& text : packages) {
    const auto package = parse_package(text);
    if (!package) {
      refuse("--package", text, "NAME=DIR, a package's name and its folder");
    }
    if (!folder_exists(package->second)) {
      refuse("--package", text, "NAME=DIR with a folder that exists");
    }
    absolute.push_back(
        fmt::format("{}={}", package->first, std::filesystem::absolute(package->second).string()));
  }
  return absolute;
}

void OverrideOptions::add_to(CLI::App& command, bool with_training) {
  command
      .add_option("--set", set,
                  "Change a setting of the problem, as in task.speed_m_per_s=2; repeatable.\n"
                  "'armwright list problems NAME' shows the problem's settings, and\n"
                  "'armwright list settings' explains them")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  engines.add_to(command, with_training);
  command
      .add_option(
          "--robot", robot,
          "An arm of your own, a URDF or MJCF file, or a shipped one (armwright list robots);\n"
          "the same as --set robot.urdf=FILE. Without a problem, the problem is 'robot'")
      ->type_name("FILE");
  command
      .add_option("--plant", plant,
                  "The file of the robot's plant, as armwright identify writes it; the same as\n"
                  "--set robot.plant=FILE")
      ->type_name("FILE");
  add_robot_flags(command, base, tip, packages, true);
}

std::vector<std::string> OverrideOptions::list_flag_overrides() const {
  std::vector<std::string> overrides = engines.get();
  if (!robot.empty()) {
    // The path is absolute, so that a report of the run can be made from any folder.
    const std::filesystem::path file = resolve_config("robots", robot);
    overrides.push_back("robot.urdf=" + quote_toml(std::filesystem::absolute(file).string()));
  }
  if (!plant.empty()) {
    const std::filesystem::path file = resolve_config("plants", plant);
    overrides.push_back("robot.plant=" + quote_toml(std::filesystem::absolute(file).string()));
  }
  if (!base.empty()) {
    overrides.push_back("robot.base=" + quote_toml(base));
  }
  if (!tip.empty()) {
    overrides.push_back("robot.tip=" + quote_toml(tip));
  }
  if (!packages.empty()) {
    std::vector<std::string> texts = make_absolute_packages(packages);
    std::ranges::transform(texts, texts.begin(), [](const auto& text) { return quote_toml(text); });
    overrides.push_back(fmt::format("robot.packages=[{}]", join(texts, ",")));
  }
  return overrides;
}

std::vector<std::string> OverrideOptions::get() const {
  std::vector<std::string> overrides = set;
  for (std::string& flag : list_flag_overrides()) {
    const std::string_view key = get_override_key(flag);
    const auto same = std::ranges::find(set, key, get_override_key);
    if (same != set.end()) {
      throw Error(ErrorKind::usage,
                  fmt::format("--set {} is contradicted or repeated by a flag that means --set {}; "
                              "give only one of them",
                              sanitize(*same), flag));
    }
    overrides.push_back(std::move(flag));
  }
  return overrides;
}

std::string OverrideOptions::choose_problem(const std::string& typed) const {
  return typed.empty() && !robot.empty() ? "robot" : typed;
}

void CaseOptions::add_to(CLI::App& command) {
  auto* set = command
                  .add_option("--test-set", test_set,
                              "Generated test set; 2 means test/2 (default: the problem's)")
                  ->type_name("ID");
  command
      .add_option("--test-cases", test_cases,
                  "Test cases from a file: JSON {\"cases\": [[[x,y,z], ...], ...]} in\n"
                  "metres, or CSV case,point,x_m,y_m,z_m")
      ->type_name("FILE")
      ->excludes(set);
  command
      .add_option("--cases", cases,
                  "Use the first N cases (default: the problem's number of test cases, or all\n"
                  "cases of the file)")
      ->type_name("N");
}

}  // namespace armwright
