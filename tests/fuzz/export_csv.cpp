// Exports as CSV, read back: a point has a number for every variable.
#include <cmath>

#include "fuzz/harness.hpp"
#include "report/exchange/import.hpp"
#include "report/formats/formats.hpp"

namespace armwright::fuzz {

void fuzz_export_csv(std::string_view input) {
  const auto& folder = get_scratch_folder("export-csv");
  static const bool made = [&] {
    write_scratch(folder / kRunsCsv, "");
    return std::filesystem::create_directory(folder / kEvaluationsFolder);
  }();
  require(made, "no folder");
  write_scratch(folder / kEvaluationsFolder / "problem.csv", input);
  is_read([&] {
    for (const ImportedRun& run : read_export(folder)) {
      require(run.replicate >= 1, "replicates are counted from 1");
      require(!run.feasible || run.x.size() == run.variables.size(),
              "a point of another dimension");
      require(std::isfinite(run.objective), "an objective is not finite");
    }
  });
}

}  // namespace armwright::fuzz
