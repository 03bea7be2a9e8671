// Problems as TOML, with what they extend and refer to, and settings of the command line: what
// stands behind a zero byte is one. What is loaded has a box with its start inside, and is loaded
// again from what a run's manifest records of it.
#include <fmt/format.h>

#include <cmath>

#include "base/text.hpp"
#include "fuzz/harness.hpp"
#include "problems/config/config_files.hpp"
#include "problems/config/problem_loader.hpp"

namespace armwright::fuzz {
namespace {

namespace fs = std::filesystem;

// With the shipped problems beside the one that is read, so that it can extend them.
const fs::path& get_problems_folder() {
  static const fs::path folder = [] {
    const fs::path& made = get_scratch_folder("problem");
    for (const auto& entry : fs::directory_iterator(find_config_folder() / "problems")) {
      fs::create_symlink(fs::canonical(entry.path()), made / entry.path().filename());
    }
    return made;
  }();
  return folder;
}

void check_description(const ProblemDescription& description) {
  require(!description.variables.empty(), "a problem without a variable");
  require(!description.objectives.empty(), "a problem without an objective");
  for (const DecisionVariable& variable : description.variables) {
    require(
        std::isfinite(variable.lower) && std::isfinite(variable.upper) &&
            variable.lower < variable.upper,
        fmt::format("{} lies between {} and {}", variable.name, variable.lower, variable.upper));
    require(variable.lower <= variable.start && variable.start <= variable.upper,
            fmt::format("{} starts at {}, outside of {} to {}", variable.name, variable.start,
                        variable.lower, variable.upper));
    require(variable.scale == Scale::linear || variable.lower > 0 || variable.upper < 0,
            fmt::format("{} has a logarithm of 0", variable.name));
  }
}

}  // namespace

void fuzz_problem(std::string_view input) {
  // What is proposed for a robot takes longer than fuzzing allows, whatever the input.
  for (const std::string_view proposing : {"propose", "\"robot\"", "'robot'"}) {
    if (input.find(proposing) != std::string_view::npos) {
      return;
    }
  }
  std::vector<std::string> overrides = split(input, '\0');
  const fs::path file = get_problems_folder() / "fuzzed.toml";
  write_scratch(file, overrides.front());
  overrides.erase(overrides.begin());
  is_read([&] {
    // No program starts: neither one that the input names nor a library.
    const LoadedProblem loaded = load_problem(file.string(), overrides, engine_table(),
                                              {.may_describe = false, .may_simulate = false});
    check_description(loaded.problem->description());
    const LoadedProblem again = [&] {
      try {
        return load_recorded_problem(loaded.resolved_json, loaded.name, get_problems_folder());
      } catch (const Error& error) {
        throw BrokenPromise(std::string("a problem is not loaded again: ") + error.what());
      }
    }();
    require(again.resolved_json == loaded.resolved_json,
            "another problem is loaded again: " + again.resolved_json);
    for (const auto& [name, hash] : again.input_hashes) {  // a preset's file is no longer needed
      const auto found = loaded.input_hashes.find(name);
      require(found != loaded.input_hashes.end() && found->second == hash,
              "another file is read the next time: " + name);
    }
  });
}

}  // namespace armwright::fuzz
