// armwright manual: prints the manual pages of all commands. They contain the texts of --help.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>

#include "base/build_info.hpp"
#include "base/error.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "cli/commands/commands.hpp"
#include "cli/manual/command_definition.hpp"
#include "cli/manual/manual_formats.hpp"
#include "cli/manual/manual_page.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/terminal.hpp"

namespace armwright {
namespace {

constexpr const char* kManualExamples = R"(Examples:
  armwright manual                                 # the page of the program: commands, exit codes, files
  armwright manual optimize                        # the page of one command
  armwright manual testset export | less
  armwright manual --format man --out man          # all pages for man: man -l man/armwright-optimize.1
  armwright manual --format markdown               # all commands on one page, as docs/reference/commands.md

The Debian package installs the pages: 'man armwright' and 'man armwright-optimize' show them.)";

constexpr const char* kMarkdownFile = "commands.md";

struct ManualOptions {
  std::vector<std::string> command;
  std::string format = "text";
  std::string out;
};

std::string format_page(const ManualPage& page, const std::string& format, const Style& style,
                        int width) {
  return format == "man"        ? to_roff(page, get_version(), get_release_date())
         : format == "markdown" ? to_markdown(page)
                                : to_text(page, style, width);
}

std::vector<ManualPage> make_all_pages(const CommandDefinition& program) {
  std::vector<ManualPage> pages;
  for (const CommandDefinition* command : list_all_commands(program)) {
    pages.push_back(make_manual_page(*command, program));
  }
  return pages;
}

// Writes each page to a file of its own. With Markdown, writes all pages to one file.
int write_pages(const CommandDefinition& program, const ManualOptions& options) {
  constexpr int kFileWidth = 80;  // lines of a text file
  const std::filesystem::path folder = options.out;
  make_folder(folder);
  const std::vector<ManualPage> pages = make_all_pages(program);
  std::string names;
  const auto write = [&](const std::string& name, const std::string& text) {
    write_file_atomically(folder / name, text);
    names += (folder / name).string() + "\n";
  };
  if (options.format == "markdown") {
    write(kMarkdownFile, to_markdown_reference(pages));
  } else {
    for (const ManualPage& page : pages) {
      write(page.name + (options.format == "man" ? ".1" : ".txt"),
            format_page(page, options.format, Style(false), kFileWidth));
    }
  }
  write_stdout(names);
  return exit_code::kDone;
}

int run_manual(const CommandDefinition& program, const ManualOptions& options,
               const Session& session) {
  const auto formats = manual_format_names();
  if (std::ranges::find(formats, options.format) == formats.end()) {
    throw Error(ErrorKind::usage, describe_unknown("--format", options.format, formats));
  }
  if (!options.out.empty()) {
    if (!options.command.empty()) {
      throw Error(ErrorKind::usage,
                  fmt::format("--out writes the pages of all commands; leave out '{}' or --out",
                              sanitize(join(options.command, " "))));
    }
    return write_pages(program, options);
  }
  if (options.format == "markdown" && options.command.empty()) {
    write_stdout(to_markdown_reference(make_all_pages(program)));
    return exit_code::kDone;
  }
  const ManualPage page = make_manual_page(find_command(program, options.command), program);
  write_stdout(format_page(page, options.format, make_style(Stream::out, session.color),
                           get_text_width(Stream::out)));
  return exit_code::kDone;
}

}  // namespace

std::vector<std::string> manual_format_names() {
  return {"text", "man", "markdown"};
}

void add_manual(CLI::App& app, Session& session) {
  auto options = std::make_shared<ManualOptions>();
  CLI::App* command =
      add_command(app, session, "manual", "Print the manual page of a command", kManualExamples);
  command->add_option(
      "COMMAND", options->command,
      "The command, as in optimize or testset export (default: the program itself; with\n"
      "markdown, all commands on one page)");
  command
      ->add_option("--format", options->format,
                   "text (default), man (roff for the program man) or markdown")
      ->type_name("FORMAT")
      ->group("Output");
  command
      ->add_option("--out", options->out,
                   "Write the pages of all commands to this folder, one file per command\n"
                   "(markdown: one file for all); files of these names are replaced")
      ->type_name("DIR")
      ->group("Output");
  command->callback([options, &app, &session] {
    session.action = [options, &app, &session] {
      return run_manual(describe_command(app), *options, session);
    };
  });
}

}  // namespace armwright
