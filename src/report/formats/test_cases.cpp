// Writes the test cases of runs, so that other programs can simulate them.

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "base/error.hpp"
#include "base/folder_checksums.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "report/formats/export_files.hpp"
#include "report/formats/formats.hpp"
#include "sim/tracking/test_case.hpp"

namespace armwright {
namespace {

// Returns the workspace of generated cases, from the resolved configuration that the run recorded.
// Returns nothing if the cases are a path: the user has its file.
std::optional<WorkspaceSphere> read_workspace(const std::filesystem::path& run) {
  constexpr std::size_t kCaseFileLimit_bytes = std::size_t{16} << 20;
  const auto file = run / "manifest.json";
  WorkspaceSphere sphere;
  try {
    const auto manifest = nlohmann::json::parse(read_checked_json(file, kCaseFileLimit_bytes));
    const auto& problem = manifest.at("configuration").at("problem");
    if (problem.contains("path") && problem.at("path").contains("kind")) {
      return std::nullopt;
    }
    if (!problem.contains("workspace")) {
      return sphere;
    }
    const auto& workspace = problem.at("workspace");
    if (workspace.contains("centre_m")) {
      const auto& centre = workspace.at("centre_m");
      sphere.centre_m = {centre.at(0).get<double>(), centre.at(1).get<double>(),
                         centre.at(2).get<double>()};
    }
    if (workspace.contains("normal")) {
      const auto& normal = workspace.at("normal");
      sphere.normal = Eigen::Vector3d(normal.at(0).get<double>(), normal.at(1).get<double>(),
                                      normal.at(2).get<double>())
                          .normalized();
    }
    sphere.radius_m = workspace.value("radius_m", sphere.radius_m);
    sphere.shortest_move_m = workspace.value("shortest_move_m", sphere.shortest_move_m);
    sphere.points = workspace.value("points", sphere.points);
  } catch (const nlohmann::json::exception& error) {
    throw Error(ErrorKind::bad_data, fmt::format("{}: is not a manifest that armwright wrote ({})",
                                                 file.string(), sanitize(error.what())));
  }
  return sphere;
}

}  // namespace

void write_test_cases(const CollectedRuns& collected, const std::filesystem::path& folder) {
  UniqueNames files;
  for (const ProblemRuns& problem : collected.problems) {
    if (!problem.tracking || !problem.tested_on || problem.tested_on->set.starts_with("file:")) {
      continue;
    }
    const auto workspace = read_workspace(problem.labels.begin()->second.front().folder);
    if (!workspace) {
      continue;
    }
    const TestSet set = TestSet::make_generated(problem.tested_on->set, *workspace);
    std::vector<TestCase> cases;
    for (std::uint64_t i = 0; i < problem.tested_on->count; ++i) {
      cases.push_back(set.make_case(i));
    }
    write_output_file(folder / "test-cases" / (files.add(escape_file_name(problem.name)) + ".json"),
                      to_json(cases));
  }
}

}  // namespace armwright
