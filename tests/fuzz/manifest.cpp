// A manifest, compared with a plan, and the configuration of a problem that it records, loaded
// again.
#include "fuzz/harness.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "problems/config/problem_loader.hpp"
#include "study/run/run_folder.hpp"
#include "study/run/run_plan.hpp"

namespace armwright::fuzz {
namespace {

void check_read_back(const LoadedProblem& loaded) {
  const LoadedProblem again = [&] {
    try {
      return load_recorded_problem(loaded.resolved_json, loaded.name, "");
    } catch (const Error& error) {
      throw BrokenPromise(std::string("a problem is not loaded again: ") + error.what());
    }
  }();
  require(again.resolved_json == loaded.resolved_json, "another problem is loaded again");
}

// As a run is begun in a folder, and gone on with.
void open_folder(std::string_view manifest) {
  static const RunPlan plan = [] {
    RunPlan made;
    made.problem = load_problem("sphere");
    made.optimizer = find_optimizer("random");
    made.options = Options::parse("random", made.optimizer.options, {});
    return made;
  }();
  const auto& path = get_scratch_folder("manifest");
  // Of the right configuration, which no fuzzer finds: an input that begins with '=' is the build.
  write_scratch(path / "manifest.json", manifest.starts_with('=')
                                            ? R"({"format":1,"configuration":)" + to_json(plan) +
                                                  ",\"build\":" + std::string(manifest.substr(1)) +
                                                  "}"
                                            : std::string(manifest));
  const RunFolder folder(path, path, plan, {});
  for (const std::string& warning : folder.warnings()) {
    check_message(warning);
  }
}

}  // namespace

void fuzz_manifest(std::string_view input) {
  is_read([&] { open_folder(input); });
  is_read([&] { check_read_back(load_recorded_problem(std::string(input), "recorded", "")); });
}

}  // namespace armwright::fuzz
