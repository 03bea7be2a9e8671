// armwright list: lists problems, optimizers and so on, and explains one of them.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"
#include "cli/commands/commands.hpp"
#include "cli/list/list_views.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/table.hpp"
#include "cli/terminal/terminal.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr const char* kListExamples = R"(Examples:
  armwright list problems                          # the problems that can be optimized
  armwright list problems q1-complex               # its variables, bounds and settings (for --set)
  armwright list optimizers ga                     # its capabilities and its options (for --opt)
  armwright list optimizers ga --markdown          # the same as a page of docs/optimizers
  armwright list settings task.rest_s              # a key of the configuration: unit, range, default, meaning
  armwright list controllers pi2d                  # its formula, and its gains (for variables.optimize)
  armwright list designs --json
  armwright list designs --names | head -1         # only the names, for scripts
  armwright list studies q1                        # a study: its optimizers, its problems and its cost
  armwright list robots my.urdf                    # the arm in a file: chain, masses, limits, picture, repairs
  armwright list robots my.urdf --write mended.urdf   # the same arm as a file that needs no repair

Terms: a problem is a robot with a task, or a function, that an optimizer minimises. A design is the result: the gains
and effort limits of all joints. An engine simulates the physics. A signal describes how the target moves between two
points. A controller computes efforts from joint errors.)";

struct ListOptions {
  std::string kind;
  std::string name;
  bool json = false;
  bool markdown = false;
  bool names = false;
  RobotRequest robot;
};

ListKind find_kind(const std::string& name, const std::string& program, const RobotRequest& robot) {
  for (const ListKind& kind : list_kinds(program, robot)) {
    if (kind.name == name) {
      return kind;
    }
  }
  throw Error(ErrorKind::usage, describe_unknown("kind", name, list_kind_names()));
}

std::string format_names(const ListKind& kind) {
  std::string text;
  for (const ListItem& item : kind.list()) {
    text += item.unavailable.empty() ? sanitize(item.name) + "\n" : "";
  }
  return text;
}

json list_as_json(const ListKind& kind) {
  if (kind.list_as_json) {
    return kind.list_as_json();
  }
  json list = json::array();
  for (const ListItem& item : kind.list()) {
    list.push_back({{"name", sanitize(item.name)}, {"summary", sanitize(item.summary)}});
  }
  return list;
}

// Returns why the items marked with a star are unavailable: for each reason, the names.
std::string explain_unavailable(const std::vector<ListItem>& items, int width) {
  std::vector<std::pair<std::string, std::vector<std::string>>> reasons;
  for (const ListItem& item : items) {
    if (item.unavailable.empty()) {
      continue;
    }
    const std::string reason = sanitize(item.unavailable);
    if (std::ranges::count(reasons, reason, [](const auto& one) { return one.first; }) == 0) {
      reasons.push_back({reason, {}});
    }
    std::ranges::find(reasons, reason, [](const auto& one) {
      return one.first;
    })->second.push_back(sanitize(item.name));
  }
  if (reasons.empty()) {
    return "";
  }
  std::string text = "\n* not available here:\n";
  for (const auto& [reason, names] : reasons) {
    for (const std::string& line : wrap_words(join(names, ", ") + ": " + reason, width - 2)) {
      text += "  " + line + "\n";
    }
  }
  return text;
}

std::string format_list(const ListKind& kind, const Style& style) {
  const std::vector<ListItem> items = kind.list();
  // In a pipe, each row is one line, for grep.
  const int width = is_terminal(Stream::out) ? get_width(Stream::out) : kUnlimited;
  Table table({{kind.name, false}, {"", false, true}});
  for (const ListItem& item : items) {
    table.add_row(
        {sanitize(item.name) + (item.unavailable.empty() ? "" : " *"), sanitize(item.summary)});
  }
  const std::string hint =
      fmt::format("\n'armwright list {} NAME' explains one of them.\n", kind.name);
  return table.format(style, 0, width) + explain_unavailable(items, get_text_width(Stream::out)) +
         (is_terminal(Stream::out) ? hint : "");
}

// Refuses flags of robots for another kind, and without a robot.
void check_robot_flags(const ListOptions& options) {
  const RobotRequest& robot = options.robot;
  const std::string_view flag = !robot.base.empty()       ? "--base"
                                : !robot.tip.empty()      ? "--tip"
                                : !robot.packages.empty() ? "--package"
                                : !robot.write.empty()    ? "--write"
                                                          : "";
  if (!flag.empty() && (options.kind != "robots" || options.name.empty())) {
    throw Error(ErrorKind::usage,
                fmt::format("{} is for one robot; name it: list robots FILE {} ...", flag, flag));
  }
}

int run_list(const ListOptions& options, const Session& session) {
  check_robot_flags(options);
  RobotRequest robot = options.robot;
  robot.packages = make_absolute_packages(robot.packages);
  const ListKind kind = find_kind(options.kind, session.command_line.front(), robot);
  const Style style = make_style(Stream::out, session.color);
  if (options.names) {
    if (options.json || options.markdown || !options.name.empty()) {
      throw Error(
          ErrorKind::usage,
          "--names prints only the names of a kind; leave out NAME, --json and --markdown, or "
          "leave out --names");
    }
    write_stdout(format_names(kind));
    return exit_code::kDone;
  }
  if (options.markdown) {
    if (options.json) {
      throw Error(ErrorKind::usage, "--json and --markdown are two formats; choose one");
    }
    if (!kind.explain_as_markdown) {
      throw Error(ErrorKind::usage,
                  fmt::format("--markdown works for problems, optimizers and settings, not for {}; "
                              "--json works for all kinds",
                              kind.name));
    }
    write_stdout(kind.explain_as_markdown(options.name));
    return exit_code::kDone;
  }
  if (!options.name.empty()) {
    write_stdout(options.json ? kind.explain_as_json(options.name).dump(1) + "\n"
                              : kind.explain(options.name, style));
    return exit_code::kDone;
  }
  write_stdout(options.json ? list_as_json(kind).dump(1) + "\n" : format_list(kind, style));
  return exit_code::kDone;
}

}  // namespace

void add_list(CLI::App& app, Session& session) {
  auto options = std::make_shared<ListOptions>();
  CLI::App* command =
      add_command(app, session, "list", "List problems, optimizers, robots, engines, designs, ...",
                  kListExamples);
  command->add_option("KIND", options->kind, join(list_kind_names(), ", "))->required();
  command->add_option("NAME", options->name, "The item to explain");
  command->add_flag("--json", options->json, "Print as JSON")->group("Output");
  command
      ->add_flag("--names", options->names,
                 "Print only the names of the items that can be used here, one per line")
      ->group("Output");
  command
      ->add_flag("--markdown", options->markdown,
                 "Print a page of documentation (problems, optimizers, settings)")
      ->group("Output");
  add_robot_flags(*command, options->robot.base, options->robot.tip, options->robot.packages,
                  false);
  command
      ->add_option("--write", options->robot.write,
                   "Write the robot's file without its blemishes: the same arm, which needs no\n"
                   "repair")
      ->type_name("FILE")
      ->group("Output");
  command->callback([options, &session] {
    session.action = [options, &session] { return run_list(*options, session); };
  });
}

}  // namespace armwright
