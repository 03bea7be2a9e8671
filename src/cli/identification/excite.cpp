// armwright excite: proposes a motion from whose recording a robot's plant can be told.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "base/toml_text.hpp"
#include "cli/identification/identification_commands.hpp"
#include "cli/identification/plant_run.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/table.hpp"
#include "cli/terminal/terminal.hpp"
#include "cli/views/result_view.hpp"
#include "problems/config/plant_file.hpp"
#include "problems/identification/excitation_problem.hpp"
#include "study/identification/excitation_report.hpp"

namespace armwright {
namespace {

constexpr const char* kExciteExamples = R"(Examples:
  armwright excite --robot my.urdf
  armwright excite --robot my.urdf --fit friction,armature,payload --payload 5
  armwright excite --robot my.urdf --duration 30 --set excitation.floor_m=0
  armwright excite --robot my.urdf --simulate guess.toml
  armwright identify log.csv --robot my.urdf

Each joint follows a Fourier series whose coefficients are optimized so that a recording tells the parameters of --fit.
The motion begins and ends at rest and keeps within the robot's limits; collisions are not checked, so simulate it first
or watch it at low speed. The folder gets motion.csv and trajectory.yaml, a JointTrajectory of ROS 2.
--simulate writes the log that a robot with another plant would record, with noise: identify shows what it makes of it.
docs/identification.md explains the figures.)";

constexpr const char* kExciteProblem = "excite";
constexpr double kLowestRate_hz = 10, kHighestRate_hz = 10000;

struct ExciteOptions : PlantRunOptions {
  std::string duration, harmonics, criterion, simulated;
  std::string rate = "100", noise_seed = "1";
};

// Turns the flags into settings.
void set_excitation(ExciteOptions& options) {
  constexpr const char* kTable = "excitation";
  options.add_shared_settings(kTable);
  options.add_setting(kTable, "duration_s", options.duration, options.duration);
  options.add_setting(kTable, "harmonics", options.harmonics, options.harmonics);
  options.add_setting(kTable, "criterion", options.criterion, quote_toml(options.criterion));
}

double read_rate(const std::string& text) {
  const auto rate_hz = parse_finite(text);
  if (!rate_hz || *rate_hz < kLowestRate_hz || *rate_hz > kHighestRate_hz) {
    throw Error(ErrorKind::usage,
                fmt::format("--rate is '{}'; it must be a number from {:g} to {:g}", sanitize(text),
                            kLowestRate_hz, kHighestRate_hz));
  }
  return *rate_hz;
}

std::string describe_share(double share) {
  return fmt::format("{:.0f} %", 100 * share);
}

std::string describe_limits(const ExcitationProblem& problem, const AssessedMotion& motion,
                            const Style& style) {
  const ExcitationConfig& config = problem.config();
  const bool has_accelerations = motion.accelerations.size() > 0;
  std::vector<Column> columns = {{"joint", false}, {"range"}, {"speed"}, {"effort"}};
  if (has_accelerations) {
    columns.push_back({"acceleration"});
  }
  Table table(columns);
  for (std::size_t i = 0; i < config.robot.joint_count(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    std::vector<std::string> row = {
        sanitize(config.robot.joints[i].name), describe_share(motion.positions[at]),
        describe_share(motion.speeds[at]), describe_share(motion.efforts_share[at])};
    if (has_accelerations) {
      row.push_back(describe_share(motion.accelerations[at]));
    }
    table.add_row(std::move(row));
  }
  std::string text = "\n" +
                     style.bold(fmt::format(
                         "Shares of the limits (allowed: {}, {}, {}), checked at {} moments",
                         describe_share(config.position_share), describe_share(config.speed_share),
                         describe_share(config.effort_share), motion.times_s.size())) +
                     "\n" + table.format(style, 2);
  if (config.floor_m) {
    text += fmt::format("  The arm stays {:.3g} m above the floor or more.\n", -motion.depth_m);
  }
  if (config.clearance) {
    text += fmt::format("  The links stay {:.3g} m away from obstacles or more.\n", motion.gap_m);
  }
  return text;
}

std::string describe_expected(const ExcitationProblem& problem, const AssessedMotion& motion,
                              double rate_hz, const Style& style) {
  Table table({{"parameter", false},
               {"now"},
               {"standard error"},
               {"unit", false},
               {"relative"},
               {"", false}});
  for (const ExpectedParameter& parameter : list_expected(problem, motion)) {
    table.add_row({sanitize(parameter.name), format_significant(parameter.value, 4),
                   format_significant(parameter.standard_error, 3), parameter.unit,
                   parameter.value == 0 ? "-"
                                        : fmt::format("{:.2g} %", 100 * parameter.standard_error /
                                                                      std::abs(parameter.value)),
                   parameter.is_told ? "" : "only in combinations"});
  }
  return "\n" +
         style.bold(
             fmt::format("What a recording at {:g} Hz would tell, with noise of {:g} % of each "
                         "joint's efforts",
                         rate_hz, 100 * kEffortNoise)) +
         "\n" + table.format(style, 2);
}

std::string describe_files(const ExciteOptions& options, const ExcitationProblem& problem,
                           const std::filesystem::path& folder, const std::string& log,
                           const Style& style) {
  std::string flags =
      " --robot " + (options.overrides.robot.empty() ? "FILE" : options.overrides.robot);
  std::string groups = options.fit;
  if (!groups.empty()) {
    flags += " --fit " + groups;
  }
  if (problem.config().robot.payload && !options.payload.empty()) {
    flags += " --payload " + options.payload;
    flags += options.payload_com.empty() ? "" : " --payload-com " + options.payload_com;
  }
  std::string text =
      "\n" + style.bold("Files in " + sanitize(folder.string())) +
      "\n  motion.csv         times, positions, velocities, accelerations, expected "
      "efforts\n"
      "  trajectory.yaml    the same for ROS 2, a trajectory_msgs/msg/JointTrajectory\n"
      "  excitation.json    shares of limits, what a recording would tell\n";
  if (!log.empty()) {
    text += fmt::format("  {:<18} what a robot with that plant would record\n", log);
  }
  text += "\n" + style.bold("Next") + "\n";
  text +=
      "  Run the motion on the robot, slowly at first: collisions were not checked. Record "
      "positions and efforts; then\n";
  return text + "  armwright identify " +
         (log.empty() ? "LOG" : sanitize((folder / log).string())) + sanitize(flags) + "\n";
}

int run_excite(ExciteOptions options, Session& session) {
  set_excitation(options);
  options.problem = kExciteProblem;
  const double rate_hz = read_rate(options.rate);
  const auto noise_seed = static_cast<std::uint64_t>(
      parse_count("--noise-seed", options.noise_seed, 0, std::numeric_limits<std::int64_t>::max()));
  const RunRequest request = options.make_request(session);
  const auto* problem = dynamic_cast<const ExcitationProblem*>(request.plan.problem.problem.get());
  const ExcitationConfig& config = problem->config();
  RobotModel real = config.robot;
  if (!options.simulated.empty()) {
    load_plant(options.simulated, real);
  }
  const auto result =
      options.execute(request, problem->parameters().size(), {}, "no motion", session);
  if (!result) {
    return end_stopped(session, request.command_line);
  }
  std::vector<double> x = result->judged[*result->winner].candidate.x;
  const double factor = problem->shrink_to_limits(x);
  if (factor == 0) {
    throw Error(ErrorKind::bad_data,
                fmt::format("the best motion in {} breaks a limit, and smaller amplitudes do not "
                            "mend it; give a larger --budget, or allow less: "
                            "excitation.effort_share, excitation.position_share",
                            sanitize(request.folder.string())));
  }
  const AssessedMotion before =
      problem->assess_finely(list_starts(problem->description().variables));
  const AssessedMotion checked = problem->assess_finely(x);
  const AssessedMotion motion = problem->assess(x, count_samples(*problem, rate_hz));
  std::string log;
  write_file_atomically(request.folder / "motion.csv", write_motion(*problem, motion));
  write_file_atomically(request.folder / "trajectory.yaml", write_trajectory(*problem, x));
  if (!options.simulated.empty()) {
    log = fmt::format("simulated-{}.csv", noise_seed);
    write_file_atomically(request.folder / log,
                          write_simulated_log(real, config.gravity_m_per_s2, motion, noise_seed));
  }
  const std::string report = to_json(*problem, before, motion, factor);
  write_file_atomically(request.folder / "excitation.json", report);
  if (options.json) {
    write_stdout(report);
    return get_result_code(*result);
  }
  const Style style = make_style(Stream::out, session.color);
  std::string text = fmt::format("condition number of what the motion tells: {} before, {} now\n",
                                 format_significant(before.condition, 4),
                                 format_significant(checked.condition, 4));
  if (factor < 1) {
    text += fmt::format(
        "Amplitudes were multiplied by {:.2f}, so that the limits also hold between the moments "
        "that "
        "the optimization looked at.\n",
        factor);
  }
  write_stdout(text + describe_limits(*problem, checked, style) +
               describe_expected(*problem, motion, rate_hz, style) +
               describe_files(options, *problem, request.folder, log, style));
  return get_result_code(*result);
}

}  // namespace

void add_excite(CLI::App& app, Session& session) {
  auto options = std::make_shared<ExciteOptions>();
  CLI::App* command = add_command(
      app, session, "excite", "Propose a motion from whose recording a robot's plant can be told",
      kExciteExamples);
  command
      ->add_option("--fit", options->fit,
                   "What shall be fitted to the recording, as for identify\n"
                   "(default: friction,armature)")
      ->type_name("GROUPS");
  command->add_option("--duration", options->duration, "Of the motion (default: 20)")
      ->type_name("SECONDS");
  command->add_option("--harmonics", options->harmonics, "Of the Fourier series (default: 5)")
      ->type_name("N");
  command
      ->add_option("--criterion", options->criterion,
                   "What is optimized: condition or d-optimal (default: d-optimal)")
      ->type_name("NAME");
  command->add_option("--rate", options->rate, "Rows per second of motion.csv (default: 100)")
      ->type_name("HZ");
  command
      ->add_option("--payload", options->payload, "The payload that the robot will carry, roughly")
      ->type_name("KG");
  command
      ->add_option("--payload-com", options->payload_com,
                   "Its centre of mass in the tip's frame (default: 0,0,0)")
      ->type_name("X,Y,Z");
  command
      ->add_option("--simulate", options->simulated,
                   "Also write what a robot with this plant would record")
      ->type_name("FILE");
  command->add_option("--noise-seed", options->noise_seed, "Seed of that log's noise (default: 1)")
      ->type_name("N");
  options->add_run_flags(*command, "results/ROBOT-motion-OPTIMIZER-seedN and what was set",
                         "excitation.json");
  command->callback([options, &session] {
    session.shares_work = true;
    session.action = [options, &session] { return run_excite(*options, session); };
  });
}

}  // namespace armwright
