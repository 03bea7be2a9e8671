// Plans of comparisons: what is read is resolved, and the resolved plan reads back as the same.
#include "fuzz/harness.hpp"
#include "problems/config/config_files.hpp"
#include "study/compare/study_folder.hpp"
#include "study/compare/study_plan.hpp"

namespace armwright::fuzz {
namespace {

namespace fs = std::filesystem;

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
    StudyRequest request;
    request.file = file.string();
    request.plugins = PluginUse::read;  // starts no program and opens no library
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
