// armwright plot: writes the figures of a page as SVG files, and their numbers as CSV.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "cli/commands/commands.hpp"
#include "cli/commands/page_input.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/table.hpp"
#include "cli/terminal/terminal.hpp"
#include "report/page/page_file.hpp"
#include "report/page/plotter.hpp"

namespace armwright {
namespace {

constexpr const char* kPlotExamples = R"(Examples:
  armwright plot results/irb4600-auto-seed1       # all figures, to results/irb4600-auto-seed1/figures
  armwright plot results/q1/report.html --list     # list the figures and their choices
  armwright plot results/q1/report.html --figure convergence --out - > convergence.svg
  armwright plot results/irb4600-auto-seed1 --figure joint-torques --choose joint=2 --size 800x400

The figures are those of 'armwright report', drawn by the same code. From a page's file, nothing is simulated again.)";

struct PlotOptions {
  PageInput input;
  std::vector<std::string> figures;
  std::vector<std::string> choices;
  std::string out;
  std::string theme = "light";
  std::string size;
  bool list = false;
};

Plotter::Format parse_format(const PlotOptions& options) {
  Plotter::Format format;
  format.dark = options.theme == "dark";
  if (options.size.empty()) {
    return format;
  }
  const std::vector<std::string> parts = split(options.size, 'x');
  if (parts.size() != 2) {
    throw Error(ErrorKind::usage,
                fmt::format("--size is '{}'; it must be WIDTHxHEIGHT in pixels, as in 640x400",
                            sanitize(options.size)));
  }
  format.width = static_cast<int>(parse_count("--size (width)", parts[0], 100, 10000));
  format.height = static_cast<int>(parse_count("--size (height)", parts[1], 100, 10000));
  return format;
}

Plotter::Picks parse_picks(const std::vector<std::string>& choices) {
  Plotter::Picks picks;
  for (const std::string& choice : choices) {
    const std::size_t equals = choice.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw Error(ErrorKind::usage,
                  fmt::format("--choose is '{}'; it must be NAME=VALUE, as --list "
                              "shows it",
                              sanitize(choice)));
    }
    picks[choice.substr(0, equals)] = choice.substr(equals + 1);
  }
  return picks;
}

std::string describe_choices(const PlotEntry& entry) {
  constexpr std::size_t kShown = 6;
  std::string text;
  for (const PlotChoice& choice : entry.choices) {
    const std::size_t count = std::min(kShown, choice.values.size());
    text += fmt::format("{}{}={}{}", text.empty() ? "" : "; ", choice.id,
                        join(std::span(choice.values).first(count), "|"),
                        choice.values.size() > count ? "|..." : "");
  }
  return sanitize(text);
}

std::string describe_entries(const Plotter& plotter, const Style& style) {
  Table table({{"figure", false}, {"thesis", false}, {"title", false}, {"choices", false}});
  for (const PlotEntry& entry : plotter.entries()) {
    table.add_row({sanitize(entry.id), sanitize(entry.thesis),
                   sanitize(entry.title) + (entry.is_table ? " (table)" : ""),
                   describe_choices(entry)});
  }
  return table.format(style);
}

// Returns the figures that the user named, or all.
std::vector<PlotEntry> choose_entries(const PlotOptions& options, const Plotter& plotter) {
  if (options.figures.empty()) {
    return plotter.entries();
  }
  std::vector<std::string> ids;
  for (const PlotEntry& entry : plotter.entries()) {
    ids.push_back(entry.id);
  }
  std::vector<PlotEntry> chosen;
  for (const std::string& id : options.figures) {
    const auto found = std::ranges::find(plotter.entries(), id, &PlotEntry::id);
    if (found == plotter.entries().end()) {
      const std::vector<std::string> list = {"armwright", "plot", options.input.source, "--list"};
      throw Error(ErrorKind::usage,
                  describe_unknown("figure", id, ids, sanitize(quote_command(list))));
    }
    chosen.push_back(*found);
  }
  return chosen;
}

// Returns the choices that this figure has.
Plotter::Picks get_picks(const PlotEntry& entry, const Plotter::Picks& wanted) {
  Plotter::Picks picks;
  for (const PlotChoice& choice : entry.choices) {
    if (const auto pick = wanted.find(choice.id); pick != wanted.end()) {
      picks.insert(*pick);
    }
  }
  return picks;
}

// Throws Error{usage} for a choice that none of the figures has.
void check_picks(const std::vector<PlotEntry>& entries, const Plotter::Picks& wanted) {
  for (const auto& [id, value] : wanted) {
    std::vector<std::string> valid;
    for (const PlotEntry& entry : entries) {
      for (const PlotChoice& choice : entry.choices) {
        if (std::ranges::find(valid, choice.id) == valid.end()) {
          valid.push_back(choice.id);
        }
      }
    }
    if (std::ranges::find(valid, id) == valid.end()) {
      throw Error(ErrorKind::usage, describe_unknown("choice of these figures", id, valid));
    }
  }
}

std::filesystem::path choose_folder(const PlotOptions& options) {
  if (!options.out.empty()) {
    return options.out;
  }
  const std::filesystem::path source = options.input.source;
  return (regular_file_exists(source) ? source.parent_path() : source) / "figures";
}

int run_plot(const PlotOptions& options, Session& session) {
  get_page_assets();  // throws before anything is computed if this build has no page
  const Plotter::Format format = parse_format(options);
  const Plotter::Picks picks = parse_picks(options.choices);
  if (options.out == "-" && options.figures.size() != 1) {
    throw Error(ErrorKind::usage,
                "--out - writes one figure to standard output: name it with "
                "--figure (--list shows them)");
  }
  const std::optional<std::string> data = options.input.make_data(session);
  if (!data) {
    write_message(fmt::format("{}; nothing was written", describe_stop(session.stop.reason())));
    return get_stop_code(session.stop.reason());
  }
  const Plotter plotter(*data);
  if (options.list) {
    write_stdout(describe_entries(plotter, make_style(Stream::out, session.color)));
    return exit_code::kDone;
  }
  const std::vector<PlotEntry> entries = choose_entries(options, plotter);
  check_picks(entries, picks);
  if (options.out == "-") {
    const PlotEntry& entry = entries.front();
    write_stdout(entry.is_table ? plotter.make_csv(entry.id, picks)
                                : plotter.draw(entry.id, format, picks) + "\n");
    return exit_code::kDone;
  }
  const std::filesystem::path path = choose_folder(options);
  const Folder folder = Folder::make(path, options.out.empty() ? path.parent_path() : path);
  std::size_t drawn = 0;
  for (const PlotEntry& entry : entries) {
    const Plotter::Picks its = get_picks(entry, picks);
    if (!entry.is_table) {
      write_file_atomically(folder, entry.id + ".svg", plotter.draw(entry.id, format, its) + "\n");
      ++drawn;
    }
    write_file_atomically(folder, entry.id + ".csv", plotter.make_csv(entry.id, its));
  }
  write_stdout(fmt::format("{} as SVG and {} as CSV in {}\n", format_count(drawn, "figure"),
                           format_count(entries.size(), "table"), sanitize(path.string())));
  return exit_code::kDone;
}

}  // namespace

void add_plot(CLI::App& app, Session& session) {
  auto options = std::make_shared<PlotOptions>();
  CLI::App* command = add_command(app, session, "plot",
                                  "Write the figures of a run or a study as SVG", kPlotExamples);
  options->input.add_to(*command);
  command->add_option("--figure", options->figures, "Write only this figure or table; repeatable")
      ->type_name("NAME")
      ->allow_extra_args(false);
  command
      ->add_option("--choose", options->choices,
                   "Choose what a figure shows, if it has choices; repeatable")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
  command->add_option("--theme", options->theme, "light or dark (default: light)")
      ->check(CLI::IsMember({"light", "dark"}))
      ->type_name("NAME");
  command
      ->add_option("--size", options->size,
                   "Size of a figure in pixels (default: that of the figure, mostly 640x400)")
      ->type_name("WIDTHxHEIGHT");
  command->add_flag("--list", options->list, "List the figures and draw none")->group("Output");
  command
      ->add_option("--out", options->out,
                   "The folder for the figures (default: FOLDER/figures); files of these names are "
                   "replaced; - writes one figure to standard output")
      ->type_name("DIR")
      ->group("Output");
  command->callback([options, &session] {
    session.action = [options, &session] { return run_plot(*options, session); };
  });
}

}  // namespace armwright
