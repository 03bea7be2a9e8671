// armwright new-plugin and new-problem: create the files of a new optimizer or problem.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <filesystem>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "cli/commands/commands.hpp"
#include "cli/manual/plugin_templates.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/terminal.hpp"
#include "optimizers/interface/optimizer.hpp"
#include "optimizers/table/optimizer_table.hpp"

namespace armwright {
namespace {

constexpr const char* kNewPluginExamples = R"(Examples:
  armwright new-plugin mine                        # in C++
  armwright new-plugin --language python mine
  cd mine && ./test.sh                             # builds, checks and runs it

The command writes a folder of that name with a working optimizer, its build files and a test. Nothing is overwritten.)";

constexpr const char* kNewProblemExamples = R"(Examples:
  armwright new-problem mine                       # a program in Python
  armwright new-problem --language command mine    # a problem file that runs a command per case
  cd mine && ./test.sh                             # checks every promise and optimizes it

The command writes a folder of that name with a working problem and a test. Nothing is overwritten.)";

struct NewPluginOptions {
  const TemplateKind* kind = nullptr;
  std::string name;
  std::string language;
};

// Throws Error{usage} if the name cannot be used. It names a file, a class, a CMake target and the
// optimizer.
void check_name(const std::string& name) {
  constexpr std::size_t kLongestName = 64;
  const auto is_allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || c == '_' || (c >= '0' && c <= '9');
  };
  if (name.empty() || name.size() > kLongestName || !(name[0] >= 'a' && name[0] <= 'z') ||
      !std::ranges::all_of(name, is_allowed)) {
    throw Error(ErrorKind::usage,
                fmt::format("NAME is '{}'; it must begin with a lower-case letter and go on with "
                            "at most 63 lower-case letters, digits and underscores",
                            sanitize(name)));
  }
  // Names of targets that CMake reserves, and the build folder.
  const std::vector<std::string> reserved = {"all",  "build",   "clean",   "edit_cache",
                                             "help", "install", "package", "rebuild_cache",
                                             "test", "plugin",  "m"};
  const auto shipped = optimizer_names();
  if (std::ranges::count(reserved, name) + std::ranges::count(shipped, name) > 0) {
    throw Error(ErrorKind::usage,
                fmt::format("NAME is '{}', which CMake or a shipped optimizer uses already; choose "
                            "another name",
                            name));
  }
}

int run_new_plugin(const NewPluginOptions& options) {
  check_name(options.name);
  const auto languages = list_languages(*options.kind);
  if (std::ranges::count(languages, options.language) == 0) {
    throw Error(ErrorKind::usage, describe_unknown("--language", options.language, languages));
  }
  const std::filesystem::path folder = options.name;
  std::error_code ignored;
  if (std::filesystem::exists(std::filesystem::symlink_status(folder, ignored))) {
    throw Error(ErrorKind::usage,
                fmt::format("'{}' exists already and is not overwritten; choose another name, or "
                            "move it away",
                            folder.string()));
  }
  make_folder(folder);
  std::string text;
  for (const PluginFile& file : make_files(*options.kind, options.language, options.name)) {
    const std::filesystem::path path = folder / file.name;
    write_file_atomically(path, file.content);
    if (file.is_program) {
      using std::filesystem::perms;
      std::error_code error;
      std::filesystem::permissions(path, perms::owner_exec | perms::group_exec | perms::others_exec,
                                   std::filesystem::perm_options::add, error);
      if (error) {
        fail_io(path, "make it a program", error.value());
      }
    }
    text += path.string() + "\n";
  }
  write_stdout(text);
  write_message(fmt::format("next: cd {} && ./test.sh", folder.string()));
  return exit_code::kDone;
}

// Adds a command that creates the files of one kind of plugin. `thing` is what its NAME names.
void add_new(CLI::App& app, Session& session, const TemplateKind& kind, const char* name,
             const char* summary, const char* thing, const char* examples) {
  auto options = std::make_shared<NewPluginOptions>();
  options->kind = &kind;
  options->language = list_languages(kind).front();
  CLI::App* command = add_command(app, session, name, summary, examples);
  command
      ->add_option("NAME", options->name,
                   fmt::format("The name of the {} and of its folder", thing))
      ->required();
  command
      ->add_option(
          "--language,-l", options->language,
          fmt::format("{} (default: {})", join(list_languages(kind), ", "), options->language))
      ->type_name("LANGUAGE");
  command->callback(
      [options, &session] { session.action = [options] { return run_new_plugin(*options); }; });
}

}  // namespace

void add_new_plugin(CLI::App& app, Session& session) {
  add_new(app, session, kPluginTemplates, "new-plugin",
          "Create the files of an optimizer of your own", "optimizer", kNewPluginExamples);
}

void add_new_problem(CLI::App& app, Session& session) {
  add_new(app, session, kProblemTemplates, "new-problem",
          "Create the files of a problem of your own", "problem", kNewProblemExamples);
}

}  // namespace armwright
