// Exports as JSON, ours and IOHprofiler's, read back: a point has a number for every variable.
#include <cmath>

#include "fuzz/harness.hpp"
#include "report/exchange/import.hpp"
#include "report/formats/formats.hpp"

namespace armwright::fuzz {
namespace {

void read(const std::string& folder_name, const char* file, std::string_view input) {
  const auto& folder = get_scratch_folder(folder_name);
  write_scratch(folder / file, input);
  is_read([&] {
    for (const ImportedRun& run : read_export(folder)) {
      require(!run.feasible || run.x.size() == run.variables.size(),
              "a point of another dimension");
      require(!run.feasible || std::isfinite(run.objective), "an objective is not finite");
    }
  });
}

}  // namespace

void fuzz_export_json(std::string_view input) {
  read("export-json", kRunsJson, input);
  read("export-ioh", "IOHprofiler_f1_bowl.json", input);
}

}  // namespace armwright::fuzz
