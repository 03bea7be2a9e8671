// armwright check-plugin: checks whether an optimizer keeps the optimizer contract.

#include <CLI/CLI.hpp>

#include "cli/commands/commands.hpp"
#include "cli/commands/contract_report.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/session.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "study/contract/contract.hpp"

namespace armwright {
namespace {

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

int run_check_plugin(const CheckPluginOptions& options, Session& session) {
  const OptimizerRow row = load_optimizer(options.optimizer);
  const Options checked = Options::parse(row.name, row.options, options.opt);
  std::vector<NamedCheck> checks;
  for (const ContractCheck& check : contract_checks()) {
    checks.push_back(
        {check.name, check.promise, [&] { return run_contract_check(check, row, checked); }});
  }
  return report_contract({"optimizer", row.name, row.summary}, checks, options.json, session);
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
