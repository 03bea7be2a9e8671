// armwright identify: finds a robot's plant in logs of its motion.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/file.hpp"
#include "base/text.hpp"
#include "base/toml_text.hpp"
#include "cli/identification/identification_commands.hpp"
#include "cli/identification/plant_run.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/terminal.hpp"
#include "cli/views/identification_view.hpp"
#include "cli/views/result_view.hpp"
#include "problems/config/config_files.hpp"
#include "problems/identification/identification_problem.hpp"
#include "study/run/run_folder.hpp"

namespace armwright {
namespace {

constexpr const char* kIdentifyExamples = R"(Examples:
  armwright identify a.csv b.csv --robot my.urdf --validate c.csv
  armwright identify run.mcap --robot my.urdf --fit friction,armature,payload
  armwright identify log.csv --robot my.urdf --column position_1=q1 --column time=t --unit position=deg
  armwright identify log.csv --robot my.urdf --gear-ratio joint_1=101 --sign joint_3=-1
  armwright identify a.csv --robot my.urdf --out plant
  armwright optimize --robot my.urdf --plant plant/plant.toml

The logs are read, checked, filtered below --cutoff without phase, and differentiated. The parameters start at those of
linear least squares on the inverse dynamics; then the optimizer searches (default: ceres:lm). The folder gets
plant.toml, which robots take as their plant, and identification.json with intervals, correlations and residuals;
'armwright show' prints them again, and 'armwright report' makes a page with the arm moving as recorded.
Logs of --validate are held back: they only judge. docs/identification.md explains formats, groups and figures.)";

// Beside the shipped problems, which have logs of their own.
constexpr const char* kIdentifyProblem = "problems/_identify.toml";
constexpr const char* kIdentifyOptimizer = "ceres:lm";

struct IdentifyOptions : PlantRunOptions {
  std::vector<std::string> logs, held_back, columns, units, ratios, signs;
  std::string joints, topic, cutoff;
};

std::string write_files(const std::vector<std::string>& files) {
  std::vector<std::string> absolute;
  for (const std::string& file : files) {
    absolute.push_back(std::filesystem::absolute(file).lexically_normal().string());
  }
  return write_list(absolute);
}

// Turns the flags into settings of [identification].
void add_settings(IdentifyOptions& options) {
  constexpr const char* kTable = "identification";
  const auto add_list = [&](const char* key, const std::vector<std::string>& words) {
    if (!words.empty()) {
      options.add_setting(kTable, key, key, write_list(words));
    }
  };
  options.add_setting(kTable, "logs", "logs", write_files(options.logs));
  if (!options.held_back.empty()) {
    options.add_setting(kTable, "validate", "validate", write_files(options.held_back));
  }
  add_list("columns", options.columns);
  add_list("units", options.units);
  add_list("gear_ratios", options.ratios);
  add_list("signs", options.signs);
  options.add_shared_settings(kTable);
  options.add_setting(kTable, "joints", options.joints, write_list(split(options.joints, ',')));
  options.add_setting(kTable, "topic", options.topic, quote_toml(options.topic));
  options.add_setting(kTable, "cutoff_hz", options.cutoff, options.cutoff);
}

int run_identify(IdentifyOptions options, Session& session) {
  add_settings(options);
  options.problem = (find_config_folder() / kIdentifyProblem).string();
  if (options.optimizer.empty() && options.opt.empty()) {
    options.optimizer = kIdentifyOptimizer;
    options.opt = {"derivatives=exact", "transform=none"};
  }
  const RunRequest request = options.make_request(session);
  const IdentificationProblem& problem = *find_identification(*request.plan.problem.problem);
  const auto result = options.execute(request, problem.parameters().size(), problem.notes(),
                                      "no set of parameters", session);
  if (!result) {
    return end_stopped(session, request.command_line);
  }
  const std::string report =
      read_file(request.folder / kIdentificationFile, kIdentificationLimit_bytes);
  if (options.json) {
    write_stdout(report);
    return get_result_code(*result);
  }
  const Style style = make_style(Stream::out, session.color);
  write_stdout(describe_identification(nlohmann::json::parse(report), request.folder, style));
  return get_result_code(*result);
}

}  // namespace

void add_identify(CLI::App& app, Session& session) {
  auto options = std::make_shared<IdentifyOptions>();
  CLI::App* command = add_command(app, session, "identify",
                                  "Find a robot's plant in logs of its motion", kIdentifyExamples);
  command
      ->add_option("LOG", options->logs,
                   "A CSV file, or a bag of ROS 2 (MCAP, sqlite3): times, joint positions and\n"
                   "efforts; several logs are fitted together")
      ->required();
  const auto add_list = [&](const char* flag, std::vector<std::string>& values, const char* words,
                            const char* type) {
    command->add_option(flag, values, words)->type_name(type)->allow_extra_args(false);
  };
  add_list("--validate", options->held_back,
           "A log that is held back and judges the fit; repeatable", "LOG");
  command
      ->add_option("--fit", options->fit,
                   "What is fitted: friction, stribeck, armature, payload, counterbalance,\n"
                   "counterbalance_slope, stiffness, delay, inertial (default: friction,armature)")
      ->type_name("GROUPS");
  add_list("--column", options->columns,
           "The log's column of a quantity, as in position_1=q1 or time=t; repeatable",
           "OURS=THEIRS");
  add_list("--unit", options->units, "The unit of a quantity, as in position=deg; repeatable",
           "QUANTITY=UNIT");
  add_list("--gear-ratio", options->ratios,
           "Motor angle per joint position, for logs with motor torques; repeatable",
           "JOINT=RATIO");
  add_list("--sign", options->signs,
           "A joint whose efforts have the other sign, JOINT=-1; repeatable", "JOINT=SIGN");
  command
      ->add_option("--joints", options->joints,
                   "The log's names of the robot's joints, in the robot's order")
      ->type_name("NAMES");
  command
      ->add_option("--topic", options->topic,
                   "The topic of a bag (default: the only one that fits)")
      ->type_name("NAME");
  command->add_option("--cutoff", options->cutoff, "Cut-off of the filter (default: 8)")
      ->type_name("HZ");
  command
      ->add_option("--payload", options->payload,
                   "The payload that the robot carried, as far as it is known")
      ->type_name("KG");
  command
      ->add_option("--payload-com", options->payload_com,
                   "Its centre of mass in the tip's frame (default: 0,0,0)")
      ->type_name("X,Y,Z");
  options->add_run_flags(*command, "results/ROBOT-plant-OPTIMIZER-seedN and what was set",
                         "identification.json");
  command->callback([options, &session] {
    session.shares_work = true;
    session.action = [options, &session] { return run_identify(*options, session); };
  });
}

}  // namespace armwright
