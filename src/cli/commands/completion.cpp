// armwright completion: prints the script with which a shell completes commands.

#include "cli/manual/completion.hpp"

#include <CLI/CLI.hpp>
#include <memory>

#include "base/build_info.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "cli/commands/commands.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/terminal.hpp"

namespace armwright {
namespace {

constexpr const char* kCompletionExamples = R"(Examples:
  source <(armwright completion bash)              # for this shell; in ~/.bashrc for all shells
  armwright completion bash > ~/.local/share/bash-completion/completions/armwright

The script completes commands and flags, the names of problems, optimizers, robots, engines, designs and studies, files
and folders. The Debian package installs it where bash finds it if the package bash-completion is installed.)";

int run_completion(const CLI::App& app, const std::string& shell) {
  const std::vector<std::string> shells = {"bash"};
  if (shell != shells.front()) {
    throw Error(ErrorKind::usage, describe_unknown("shell", shell, shells));
  }
  write_stdout(make_bash_completion(describe_command(app), get_version()));
  return exit_code::kDone;
}

}  // namespace

void add_completion(CLI::App& app, Session& session) {
  auto shell = std::make_shared<std::string>();
  CLI::App* command =
      add_command(app, session, "completion",
                  "Print the script with which a shell completes commands", kCompletionExamples);
  command->add_option("SHELL", *shell, "The shell: bash")->required();
  command->callback([shell, &app, &session] {
    session.action = [shell, &app] { return run_completion(app, *shell); };
  });
}

}  // namespace armwright
