#include "study/matrix/cell_selection.hpp"

#include <fmt/format.h>

#include <set>
#include <string_view>

#include "base/config.hpp"
#include "base/error.hpp"
#include "base/folder.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "study/compare/rerun.hpp"
#include "study/compare/study_folder.hpp"

namespace armwright {
namespace {

std::filesystem::path find_study_folder(const std::filesystem::path& name) {
  if (is_study_folder(name)) {
    return name;
  }
  if (name.filename() == "study.toml" && regular_file_exists(name)) {
    return name.has_parent_path() ? name.parent_path() : std::filesystem::path(".");
  }
  throw Error(ErrorKind::usage,
              fmt::format("{}: is neither the folder of a study nor the study.toml in one; "
                          "'armwright compare' makes such a folder, and with --executor script it "
                          "runs nothing",
                          sanitize(name.string())));
}

std::size_t parse_cell_number(std::string_view text, std::string_view word, std::size_t count) {
  const auto number = parse_integer(text);
  if (!number || *number < 0 || static_cast<std::size_t>(*number) >= count) {
    throw Error(ErrorKind::usage,
                fmt::format("'{}' is not a cell of the study; name a cell by its number, 0 to {}, "
                            "or as PROBLEM/OPTIMIZER/rNN",
                            sanitize(word), count - 1));
  }
  return static_cast<std::size_t>(*number);
}

// Returns the study if its recorded plan is resolved to the same plan here.
RecordedStudy check_same(RecordedStudy study) {
  const auto file = study.folder / "study.toml";
  const ConfigTable recorded = ConfigTable::load(file);
  const ConfigTable now = ConfigTable::parse(to_toml(study.plan), file.string());
  const auto differences = describe_differences(recorded.to_json(), now.to_json());
  if (!differences.empty()) {
    throw Error(ErrorKind::usage,
                fmt::format("{}: gives another plan here than where it was made, so cells could "
                            "not be compared:\n  {}",
                            sanitize(file.string()), join(differences, "\n  ")));
  }
  return study;
}

}  // namespace

RecordedStudy load_recorded_study(const std::filesystem::path& name) {
  const auto folder = find_study_folder(name);
  return check_same({folder, load_study_plan(folder)});
}

RecordedStudy load_recorded_study(const std::filesystem::path& name, const AskUser& ask) {
  const auto folder = find_study_folder(name);
  return check_same({folder, load_study_plan(folder, ask)});
}

std::vector<Cell> select_cells(const StudyPlan& plan, std::span<const std::string> words) {
  const std::vector<Cell> all = list_cells(plan);
  std::vector<Cell> selected;
  std::set<std::string> names;
  const auto add = [&](const Cell& cell) {
    if (names.insert(make_cell_name(plan, cell)).second) {
      selected.push_back(cell);
    }
  };
  for (const std::string& word : words) {
    if (word.find_first_not_of("0123456789-") != std::string::npos) {
      add(find_cell(plan, word));
      continue;
    }
    const std::string_view text = word;
    const std::size_t dash = text.find('-');
    const std::size_t first = parse_cell_number(text.substr(0, dash), word, all.size());
    const std::size_t last = dash == std::string_view::npos
                                 ? first
                                 : parse_cell_number(text.substr(dash + 1), word, all.size());
    if (last < first) {
      throw Error(ErrorKind::usage, fmt::format("'{}' ends before it begins; a range of cells is "
                                                "FIRST-LAST",
                                                sanitize(word)));
    }
    for (std::size_t number = first; number <= last; ++number) {
      add(all[number]);
    }
  }
  return selected;
}

std::string make_cell_name(const StudyPlan& plan, const Cell& cell) {
  return make_cell_path(plan, cell).lexically_relative("cells").string();
}

}  // namespace armwright
