// Plans of comparisons: what is read is resolved, and the resolved plan reads back as the same.
#include <algorithm>

#include "base/config.hpp"
#include "fuzz/harness.hpp"
#include "problems/config/config_files.hpp"
#include "study/compare/study_folder.hpp"
#include "study/compare/study_plan.hpp"

namespace armwright::fuzz {
namespace {

namespace fs = std::filesystem;

// A program to start or a library to open: nobody runs what a fuzzer has made up.
bool runs_code(const std::string& optimizer) {
  return optimizer.find('/') != std::string::npos || optimizer.find(".so") != std::string::npos ||
         optimizer.find("exec:") != std::string::npos;
}

bool names_plugin(const fs::path& file) {
  const ConfigTable table = ConfigTable::load(file);
  const Setting<std::vector<std::string>> optimizers("optimizers", kNoDefault, "");
  const SettingTable entry{.key = "optimizer", .is_array = true};
  const Setting<std::string> name("name", "", "");
  std::vector<std::string> names = table.get_or(optimizers, {});
  for (const ConfigTable& optimizer : table.get_tables_or_empty(entry)) {
    names.push_back(optimizer.get(name));
  }
  return std::ranges::any_of(names, runs_code);
}

const fs::path& get_studies_folder() {
  static const fs::path folder = [] {
    const fs::path& made = get_scratch_folder("study");
    for (const auto& entry : fs::directory_iterator(find_config_folder() / "studies")) {
      if (entry.path().extension() == ".toml") {
        fs::create_symlink(fs::canonical(entry.path()), made / entry.path().filename());
      }
    }
    return made;
  }();
  return folder;
}

}  // namespace

void fuzz_study(std::string_view input) {
  const fs::path file = get_studies_folder() / "fuzzed.toml";
  write_scratch(file, input);
  is_read([&] {
    if (names_plugin(file)) {
      return;
    }
    StudyRequest request;
    request.file = file.string();
    const StudyPlan plan = make_study_plan(request);
    require(!plan.problems.empty() && !plan.optimizers.empty() && plan.budget > 0,
            "a plan of nothing");
    require(calc_cost(plan).cells > 0, "a plan without cells");
    const std::string text = to_toml(plan);
    const fs::path resolved = get_studies_folder() / "resolved.toml";
    write_scratch(resolved, text);
    request.file = resolved.string();
    try {
      require(to_toml(make_study_plan(request)) == text, "another plan is read back");
    } catch (const Error& error) {
      throw BrokenPromise(std::string("a resolved plan is not read back: ") + error.what());
    }
  });
}

}  // namespace armwright::fuzz
