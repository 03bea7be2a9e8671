#include "study/compare/cell_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "base/bits.hpp"
#include "base/error.hpp"
#include "base/folder_checksums.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "study/journal/journal.hpp"
#include "study/run/run_plan.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr std::size_t kFileLimit_bytes = std::size_t{256} << 20;
constexpr const char* kAbsent = "absent";

std::string show(double value) {
  return std::isfinite(value) ? format_exact(value) : fmt::format("{}", value);
}
std::string show(std::uint64_t value) {
  return fmt::format("{}", value);
}
std::string show(int value) {
  return fmt::format("{}", value);
}
std::string show(bool value) {
  return value ? "true" : "false";
}
std::string show(const std::string& value) {
  return "'" + sanitize(value) + "'";
}
std::string show(CaseRole role) {
  constexpr const char* kNames[] = {"training", "validation", "test"};
  return kNames[static_cast<std::size_t>(role)];
}
std::string show(EvaluationStatus status) {
  return to_string(status);
}

bool is_same(double a, double b) {
  return same_bits({&a, 1}, {&b, 1});
}
template <class T>
bool is_same(const T& a, const T& b) {
  return a == b;
}

// Finds the first field in which two records differ.
class FieldSearch {
 public:
  template <class T>
  void meet(const char* field, const T& recorded, const T& now) {
    if (!found_ && !is_same(recorded, now)) {
      found_ = CellDifference{"", field, show(recorded), show(now)};
    }
  }
  template <class T>
  void meet(const char* field, const std::vector<T>& recorded, const std::vector<T>& now) {
    for (std::size_t i = 0; !found_ && i < std::max(recorded.size(), now.size()); ++i) {
      const bool is_in_both = i < recorded.size() && i < now.size();
      if (!is_in_both || !is_same(recorded[i], now[i])) {
        found_ = CellDifference{"", fmt::format("{}[{}]", field, i),
                                i < recorded.size() ? show(recorded[i]) : kAbsent,
                                i < now.size() ? show(now[i]) : kAbsent};
      }
    }
  }
  std::optional<CellDifference> make_difference(std::string where) {
    if (found_) {
      found_->where = std::move(where);
    }
    return std::move(found_);
  }

 private:
  std::optional<CellDifference> found_;
};

// Compares fields in the order of cause and effect.
std::optional<CellDifference> compare_records(const EvaluationRecord& a, const EvaluationRecord& b,
                                              std::string where) {
  FieldSearch search;
  search.meet("index", a.index, b.index);
  search.meet("generation", a.generation, b.generation);
  search.meet("x", a.x, b.x);
  search.meet("clipped", a.clipped, b.clipped);
  search.meet("with_jacobian", a.with_jacobian, b.with_jacobian);
  search.meet("role", a.cases.role, b.cases.role);
  search.meet("set", a.cases.set, b.cases.set);
  search.meet("cases", a.cases.numbers, b.cases.numbers);
  const Evaluation& before = a.evaluation;
  const Evaluation& after = b.evaluation;
  search.meet("case_errors", before.case_errors, after.case_errors);
  search.meet("status", before.status, after.status);
  search.meet("reason", before.reason, after.reason);
  search.meet("failed_cases", before.failed_cases, after.failed_cases);
  search.meet("objectives", before.objectives, after.objectives);
  search.meet("constraint_values", before.constraint_values, after.constraint_values);
  search.meet("metrics", before.metrics, after.metrics);
  search.meet("residuals", before.residuals, after.residuals);
  search.meet("jacobian", before.jacobian, after.jacobian);
  return search.make_difference(std::move(where));
}

template <class Records>
void compare_lists(const Records& recorded, const Records& now, const char* what, std::size_t& same,
                   std::optional<CellDifference>& difference) {
  for (std::size_t i = 0; !difference && i < std::min(recorded.size(), now.size()); ++i) {
    difference = compare_records(recorded[i], now[i], fmt::format("{} {}", what, i));
    same += difference ? 0 : 1;
  }
  if (!difference && recorded.size() != now.size()) {
    difference = CellDifference{"the journal", fmt::format("number of {}s", what),
                                fmt::format("{}", recorded.size()), fmt::format("{}", now.size())};
  }
}

// Sorts the judgements, because threads decide the order in which they are written.
void sort_judgements(std::vector<EvaluationRecord>& judgements) {
  std::ranges::stable_sort(judgements, {}, [](const EvaluationRecord& record) {
    return std::tuple(record.cases.role, record.index);
  });
}

void compare_journals(const std::filesystem::path& recorded, const std::filesystem::path& now,
                      CellComparison& comparison) {
  JournalContent before = read_journal(recorded / "journal");
  JournalContent after = read_journal(now / "journal");
  compare_lists(before.training, after.training, "evaluation", comparison.evaluations,
                comparison.difference);
  sort_judgements(before.judgements);
  sort_judgements(after.judgements);
  compare_lists(before.judgements, after.judgements, "judgement", comparison.judgements,
                comparison.difference);
  if (comparison.difference) {
    return;
  }
  FieldSearch end;
  end.meet("ended", before.ended, after.ended);
  end.meet("reason", before.end.reason, after.end.reason);
  end.meet("evaluations", before.end.evaluations, after.end.evaluations);
  comparison.difference = end.make_difference("the journal's end");
}

// Returns "candidates.0.x.3" for the JSON pointer "/candidates/0/x/3".
std::string name_field(std::string pointer) {
  pointer.erase(0, 1);
  std::ranges::replace(pointer, '/', '.');
  return sanitize(pointer);
}

std::optional<CellDifference> compare_json(const std::string& recorded, const std::string& now,
                                           const std::string& file) {
  const json before = json::parse(recorded).flatten();
  const json after = json::parse(now).flatten();
  const auto find = [](const json& in, const std::string& key) {
    return in.contains(key) ? sanitize(in[key].dump(-1, ' ', false, json::error_handler_t::replace))
                            : std::string(kAbsent);
  };
  for (const json* one : {&before, &after}) {
    for (const auto& [key, ignored] : one->items()) {
      const std::string was = find(before, key);
      const std::string is = find(after, key);
      if (was != is) {
        return CellDifference{file, name_field(key), was, is};
      }
    }
  }
  return std::nullopt;
}

CellDifference compare_lines(const std::string& recorded, const std::string& now,
                             const std::string& file) {
  const auto before = split(recorded, '\n');
  const auto after = split(now, '\n');
  std::size_t i = 0;
  while (i < before.size() && i < after.size() && before[i] == after[i]) {
    ++i;
  }
  return {file, fmt::format("line {}", i + 1), i < before.size() ? show(before[i]) : kAbsent,
          i < after.size() ? show(after[i]) : kAbsent};
}

void compare_file(const std::filesystem::path& recorded, const std::filesystem::path& now,
                  const std::string& file, CellComparison& comparison) {
  const bool was_there = path_exists(recorded / file);
  const bool is_there = path_exists(now / file);
  if (was_there != is_there) {
    comparison.difference = CellDifference{file, "the file", was_there ? "there" : kAbsent,
                                           is_there ? "there" : kAbsent};
    return;
  }
  if (!was_there) {
    return;  // winner.toml is missing if there is no winner or no arm
  }
  const std::string before = read_checked_file(recorded / file, kFileLimit_bytes);
  const std::string after = read_checked_file(now / file, kFileLimit_bytes);
  if (before == after) {
    comparison.files.push_back(file);
    return;
  }
  if (file.ends_with(".json")) {
    check_json_depth(before, (recorded / file).string());
    check_json_depth(after, (now / file).string());
    try {
      comparison.difference = compare_json(before, after, file);
    } catch (const json::exception& error) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("{}: is not what armwright wrote ({})", (recorded / file).string(),
                              describe_json_error(error.what())));
    }
  }
  if (!comparison.difference) {
    comparison.difference = compare_lines(before, after, file);
  }
}

json read_cell_manifest(const std::filesystem::path& folder) {
  const auto file = folder / "manifest.json";
  try {
    json manifest = json::parse(read_checked_json(file, kFileLimit_bytes));
    for (const char* part : {"configuration", "build"}) {
      manifest.at(part).get<std::map<std::string, json>>();  // throws unless both are objects
    }
    return manifest;
  } catch (const json::exception& error) {
    throw Error(ErrorKind::bad_data, fmt::format("{}: is not a manifest that armwright wrote ({})",
                                                 file.string(), describe_json_error(error.what())));
  }
}

}  // namespace

CellComparison compare_cells(const std::filesystem::path& recorded,
                             const std::filesystem::path& now) {
  CellComparison comparison;
  compare_journals(recorded, now, comparison);
  for (const char* file : {"result.json", "winner.toml", "cell.json"}) {
    if (!comparison.difference) {
      compare_file(recorded, now, file, comparison);
    }
  }
  return comparison;
}

std::vector<std::string> list_likely_causes(const std::filesystem::path& recorded,
                                            const std::filesystem::path& now) {
  const json before = read_cell_manifest(recorded);
  const json after = read_cell_manifest(now);
  std::vector<std::string> causes;
  for (const std::string& difference :
       describe_differences(before["configuration"].dump(), after["configuration"].dump())) {
    causes.push_back("The configuration is another one: " + difference + ".");
  }
  // Compares only fields that both manifests have: another version may record more or fewer.
  json build_before = json::object();
  json build_after = json::object();
  for (const auto& [key, value] : after["build"].items()) {
    if (key != "host" && before["build"].contains(key)) {  // does not change a result
      build_before[key] = before["build"][key];
      build_after[key] = value;
    }
  }
  for (const std::string& difference :
       describe_differences(build_before.dump(), build_after.dump())) {
    causes.push_back("The program or the machine is another one: " + difference + ".");
  }
  if (causes.empty()) {
    causes.emplace_back(
        "Version, machine and configuration are the recorded ones. So either the recorded files "
        "were changed after the run, or the optimizer does not give the same results for the same "
        "seed.");
  }
  return causes;
}

}  // namespace armwright
