#include "study/matrix/recorded_study.hpp"

#include <fmt/format.h>

#include "base/config.hpp"
#include "base/error.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "study/compare/study_folder.hpp"

namespace armwright {
namespace {

std::filesystem::path find_study_folder(const std::filesystem::path& name) {
  if (is_study_folder(name)) {
    return name;
  }
  if (name.filename() == "study.toml" && std::filesystem::is_regular_file(name)) {
    return name.has_parent_path() ? name.parent_path() : std::filesystem::path(".");
  }
  throw Error(ErrorKind::usage,
              fmt::format("{}: is neither the folder of a study nor the study.toml in one; "
                          "'armwright compare' makes such a folder, --executor script without "
                          "running anything",
                          sanitize(name.string())));
}

}  // namespace

RecordedStudy load_recorded_study(const std::filesystem::path& name) {
  RecordedStudy study{find_study_folder(name), {}};
  const auto file = study.folder / "study.toml";
  study.plan = load_study_plan(study.folder);
  const ConfigTable recorded = ConfigTable::load(file);
  const ConfigTable now = ConfigTable::parse(to_toml(study.plan), file.string());
  const auto differences = describe_differences(recorded.to_json(), now.to_json());
  if (!differences.empty()) {
    throw Error(ErrorKind::usage,
                fmt::format("{}: comes out as another plan here than where it was made, so that "
                            "cells would not compare:\n  {}",
                            sanitize(file.string()), join(differences, "\n  ")));
  }
  return study;
}

}  // namespace armwright
