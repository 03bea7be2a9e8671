#include "cli/views/design_and_problem.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"
#include "base/folder_checksums.hpp"
#include "base/text.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/terminal.hpp"
#include "sim/controllers/controller.hpp"

namespace armwright {
namespace {

TestSet choose_set(const LoadedProblem& problem, const CaseOptions& options) {
  if (!options.test_cases.empty()) {
    return TestSet::load(options.test_cases);
  }
  const TrackingProblem& tracking = require_tracking(problem);
  if (options.test_set.empty()) {
    return tracking.get_set(problem.sets.test);
  }
  const bool complete = options.test_set.find('/') != std::string::npos;
  return tracking.get_set(complete ? options.test_set : "test/" + options.test_set);
}

}  // namespace

LoadedProblem load_problem_of_design(const DesignFile& design, const std::string& problem,
                                     std::vector<std::string> overrides, bool quiet) {
  if (find_controller(design.design.controller).feed_forward != FeedForward::none) {
    // The problem's target tables hold the feed-forward efforts, so the problem must know the
    // controller.
    overrides.insert(overrides.begin(), "control.controller=" + design.design.controller);
  }
  const ControlInterface interface = find_controller(design.design.controller).interface;
  if (interface != ControlInterface::effort) {
    overrides.insert(
        overrides.begin(),
        "control.interface=" + control_interface_names()[static_cast<std::size_t>(interface)]);
  }
  if (!problem.empty()) {
    return load_problem(problem, overrides);
  }
  if (design.published.empty()) {
    throw Error(
        ErrorKind::usage,
        fmt::format("--problem is missing, and design '{}' does not name the problem it was made "
                    "for; name one (armwright list problems)",
                    sanitize(design.name)));
  }
  const PublishedResult& published = design.published.front();
  overrides.insert(overrides.begin(), published.overrides.begin(), published.overrides.end());
  if (!quiet) {
    write_message(fmt::format("--problem is not given; using {}, which {} was published for",
                              published.problem, design.name));
  }
  return load_problem(published.problem, overrides);
}

namespace {

// Warns if the design is a winner.toml that is not as its run wrote it.
void warn_of_change(const std::filesystem::path& design) {
  if (design.filename() != "winner.toml") {
    return;
  }
  try {
    FolderChecksums(design.has_parent_path() ? design.parent_path() : ".").check("winner.toml");
  } catch (const Error& change) {
    write_message(fmt::format("warning: {}", change.what()));
  }
}

}  // namespace

std::pair<DesignFile, LoadedProblem> load_design_and_problem(const std::string& design,
                                                             const std::string& problem,
                                                             std::vector<std::string> overrides,
                                                             bool quiet) {
  if (design != kStartDesign) {
    DesignFile file = load_design(design);
    warn_of_change(design);
    LoadedProblem loaded = load_problem_of_design(file, problem, std::move(overrides), quiet);
    return {std::move(file), std::move(loaded)};
  }
  if (problem.empty()) {
    throw Error(ErrorKind::usage,
                "design 'start' is the one from which a problem's optimization starts; name the "
                "problem with --problem, or an arm of your own with --robot");
  }
  LoadedProblem loaded = load_problem(problem, overrides);
  const TrackingConfig& config = require_tracking(loaded).config();
  DesignFile file = make_design_file(config.robot, config.start);
  file.name = kStartDesign;
  file.title = fmt::format("Where {} starts", loaded.name);
  return {std::move(file), std::move(loaded)};
}

ChosenCases choose_cases(const LoadedProblem& problem, const CaseOptions& options) {
  TestSet set = choose_set(problem, options);
  const auto usual = set.size().value_or(static_cast<std::uint64_t>(problem.sets.test_cases));
  const auto count =
      options.cases.empty()
          ? usual
          : static_cast<std::uint64_t>(parse_count("--cases", options.cases, 1, kMostCases));
  if (set.size() && count > *set.size()) {
    throw Error(ErrorKind::usage,
                fmt::format("--cases is {}, but {} holds {}", count, sanitize(options.test_cases),
                            format_count(*set.size(), "case")));
  }
  return {std::move(set), count};
}

void report_failures(std::span<const CaseFailure> failures, const std::string& what) {
  constexpr std::size_t kMostNamed = 5;
  for (std::size_t i = 0; i < std::min(failures.size(), kMostNamed); ++i) {
    write_message(fmt::format("{}case {}: {}", what, failures[i].number, failures[i].reason));
  }
  if (failures.size() > kMostNamed) {
    write_message(
        fmt::format("{}and {} more cases without a number", what, failures.size() - kMostNamed));
  }
}

}  // namespace armwright
