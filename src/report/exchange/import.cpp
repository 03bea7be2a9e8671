#include "report/exchange/import.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "base/error.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

// Keeps the runs with this value. Throws Error{usage} that lists the existing values if no run has
// it.
template <typename Value, typename Get>
void keep(std::vector<ImportedRun>& runs, std::string_view flag, const std::optional<Value>& value,
          Get get) {
  if (!value) {
    return;
  }
  std::set<Value> there;
  for (const ImportedRun& run : runs) {
    there.insert(get(run));
  }
  if (!there.contains(*value)) {
    std::vector<std::string> names;
    for (const Value& one : there) {
      names.push_back(sanitize(fmt::format("{}", one)));
    }
    throw Error(ErrorKind::usage, describe_unknown(flag, fmt::format("{}", *value), names));
  }
  std::erase_if(runs, [&](const ImportedRun& run) { return get(run) != *value; });
}

}  // namespace

ImportedRun import_best(const std::filesystem::path& folder, const ImportChoice& choice) {
  std::vector<ImportedRun> runs = read_export(folder);
  keep(runs, "--problem", choice.problem, [](const ImportedRun& run) { return run.problem; });
  keep(runs, "--optimizer", choice.label, [](const ImportedRun& run) { return run.label; });
  keep(runs, "--replicate", choice.replicate, [](const ImportedRun& run) { return run.replicate; });
  std::set<std::string> problems;
  for (const ImportedRun& run : runs) {
    problems.insert(run.problem);
  }
  if (problems.size() > 1) {
    std::vector<std::string> names;
    for (const std::string& problem : problems) {
      names.push_back(sanitize(problem));
    }
    throw Error(ErrorKind::usage,
                fmt::format("{}: holds runs on {} problems, whose objectives cannot be compared; "
                            "choose one with --problem: {}",
                            folder.string(), names.size(), join(names, ", ")));
  }
  std::erase_if(runs, [](const ImportedRun& run) { return !run.feasible; });
  if (runs.empty()) {
    throw Error(ErrorKind::usage,
                fmt::format("{}: no run that was chosen found anything feasible", folder.string()));
  }
  return *std::ranges::min_element(runs, {}, &ImportedRun::objective);
}

}  // namespace armwright
