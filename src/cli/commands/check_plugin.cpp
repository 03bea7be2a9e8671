// armwright check-plugin: checks whether an optimizer keeps the optimizer contract.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "base/text.hpp"
#include "cli/commands/commands.hpp"
#include "cli/list/list_views.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/table.hpp"
#include "cli/terminal/terminal.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "study/contract/contract.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr const char* kCheckPluginExamples = R"(Examples:
  armwright check-plugin ./libmine.so
  armwright check-plugin 'exec:python3 mine.py'
  armwright check-plugin nlopt:sbplx --opt restarts=0

Runs the optimizer on functions with known properties. Prints for each promise of the optimizer contract whether the
optimizer keeps it. The exit code is 0 if it keeps all promises, 3 if it breaks one.)";

struct CheckPluginOptions {
  std::string optimizer;
  std::vector<std::string> opt;
  bool json = false;
};

const char* to_string(ContractOutcome outcome) {
  switch (outcome) {
    case ContractOutcome::held:
      return "held";
    case ContractOutcome::broken:
      return "BROKEN";
    case ContractOutcome::exempt:
      return "exempt";
  }
  return "?";
}

int run_check_plugin(const CheckPluginOptions& options, Session& session) {
  const OptimizerRow row = load_optimizer(options.optimizer);
  const Options checked = Options::parse(row.name, row.options, options.opt);
  const Style style = make_style(Stream::out, session.color);
  Table table({{"promise", false}, {"", false}, {"why", false}});
  json findings = json::array();
  int broken = 0;
  for (const ContractCheck& check : contract_checks()) {
    if (!options.json) {
      write_message(fmt::format("{}: {} ...", check.name, check.promise));
    }
    const ContractFinding finding = run_contract_check(check, row, checked);
    broken += finding.outcome == ContractOutcome::broken ? 1 : 0;
    table.add_row({check.promise, to_string(finding.outcome), sanitize(finding.detail)});
    findings.push_back({{"check", check.name},
                        {"promise", check.promise},
                        {"outcome", to_string(finding.outcome)},
                        {"detail", sanitize(finding.detail)}});
  }
  if (options.json) {
    write_stdout(json{{"optimizer", row.name}, {"broken", broken}, {"checks", findings}}.dump(1) +
                 "\n");
  } else {
    write_stdout(format_title(style, sanitize(row.name), sanitize(row.summary)) +
                 table.format(style, 2) +
                 (broken == 0 ? "It keeps every promise.\n"
                              : style.red(fmt::format("{} of {} promises are broken.\n", broken,
                                                      contract_checks().size()))));
  }
  return broken == 0 ? exit_code::kDone : exit_code::kFailed;
}

}  // namespace

void add_check_plugin(CLI::App& app, Session& session) {
  auto options = std::make_shared<CheckPluginOptions>();
  CLI::App* command = add_command(
      app, session, "check-plugin",
      "Check whether an optimizer keeps the promises of every optimizer", kCheckPluginExamples);
  command
      ->add_option("OPTIMIZER", options->optimizer,
                   "A name, a shared library (./libmine.so) or a process ('exec:COMMAND')")
      ->required();
  command->add_option("--opt", options->opt, "An option of the optimizer, as KEY=VALUE; repeatable")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  command->add_flag("--json", options->json, "Print the findings as JSON")->group("Output");
  command->callback([options, &session] {
    session.action = [options, &session] { return run_check_plugin(*options, session); };
  });
}

}  // namespace armwright
