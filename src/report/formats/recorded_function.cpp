#include "report/formats/recorded_function.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/folder_checksums.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "problems/config/problem_loader.hpp"
#include "study/run/run.hpp"
#include "study/run/run_folder.hpp"

namespace armwright {

using nlohmann::json;

std::string make_function_settings(const std::string& resolved_json) {
  try {
    json settings = json::parse(resolved_json);
    for (const char* key : {"description", "title", "published", "sweep", "replicate", "run",
                            "schedule", "racing", "sets"}) {
      settings.erase(key);
    }
    if (settings.contains("function")) {
      json& function = settings.at("function");
      for (const char* key : {"dimension", "instance", "instance_per_replicate"}) {
        function.erase(key);
      }
    }
    if (settings.contains("physics")) {
      settings.at("physics").erase("simd");
    }
    return settings.dump();
  } catch (const json::exception& error) {
    throw Error(ErrorKind::bad_data,
                fmt::format("the recorded configuration of a problem is not what armwright wrote "
                            "({})",
                            sanitize(error.what())));
  }
}

RecordedFunction read_function(const std::filesystem::path& folder, const RunResult& result) {
  RecordedFunction function;
  function.problem = result.problem;
  const auto file = folder / "manifest.json";
  std::string resolved;
  try {
    const json manifest = json::parse(read_checked_json(file, kManifestLimit_bytes));
    resolved = manifest.at("configuration").at("problem").dump();
  } catch (const json::exception& error) {
    throw Error(ErrorKind::bad_data, fmt::format("{}: is not a manifest that armwright wrote ({})",
                                                 file.string(), sanitize(error.what())));
  }
  function.settings = make_function_settings(resolved);
  if (!result.tracking) {
    const LoadedProblem problem = load_recorded_problem(resolved, result.problem, folder);
    function.optimum = problem.problem->description().optimum;
  }
  return function;
}

}  // namespace armwright
