#include "study/run/winner_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "base/error.hpp"
#include "base/folder_checksums.hpp"
#include "base/text.hpp"
#include "problems/motion/motion_problem.hpp"
#include "problems/user/user_problem.hpp"

namespace armwright {
namespace {

// Names that the program gives become names of files.
void check_file_name(const std::string& name) {
  constexpr std::size_t kLongest = 100;
  const bool is_plain = !name.empty() && name.size() <= kLongest && name.front() != '.' &&
                        name.find('/') == std::string::npos && sanitize(name) == name;
  if (!is_plain) {
    throw Error(ErrorKind::bad_data,
                fmt::format("the problem's record has a file named '{}'; it must be a plain name "
                            "without folders, of at most {} bytes",
                            sanitize(name.substr(0, kLongest)), kLongest));
  }
}

std::string make_title(const Quantity& quantity) {
  return quote_csv(quantity.unit.empty() ? quantity.name
                                         : fmt::format("{} [{}]", quantity.name, quantity.unit));
}

}  // namespace

bool has_values(const Problem& problem) {
  return find_user_description(problem) != nullptr || find_motion(problem) != nullptr;
}

bool has_record(const RunPlan& plan) {
  const UserDescription* description = find_user_description(*plan.problem.problem);
  return find_motion(*plan.problem.problem) != nullptr ||
         (description != nullptr && description->has_records && !plan.selection.evaluated_only);
}

bool are_record_files_there(const RunFolder& folder, const RunPlan& plan) {
  if (!has_record(plan)) {
    return true;
  }
  const auto lines = FolderChecksums(folder.path()).lines();
  return path_exists(folder.path() / kWinnerRecord) &&
         std::ranges::all_of(lines, [&](const auto& line) {
           return !line.first.starts_with(kWinnerFiles) || path_exists(folder.path() / line.first);
         });
}

namespace {

void check_record_files(const CaseRecord& record) {
  std::set<std::string> names;
  for (const CaseRecord::File& file : record.files) {
    check_file_name(file.name);
    if (!names.insert(file.name).second) {
      throw Error(ErrorKind::bad_data, fmt::format("the problem's record has two files named '{}'",
                                                   sanitize(file.name)));
    }
  }
}

}  // namespace

void write_record_files(const Folder& folder, const RunPlan& plan, const std::vector<double>& x) {
  const CaseBlock block{CaseRole::test, plan.problem.sets.test, {0}};
  CaseRecord record;
  try {
    record = plan.problem.problem->record_case(x, block, 0);
    check_record_files(record);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::bad_data) {
      throw;
    }
    // The run is complete without its record.
    record = {};
    record.files.push_back({"record-error.txt", std::string(error.what()) + "\n"});
  }
  std::vector<std::pair<std::string, std::string>> files;
  for (const CaseRecord::File& file : record.files) {
    files.emplace_back(kWinnerFiles + file.name, file.bytes);
  }
  files.emplace_back(kWinnerRecord, make_record_csv(record));  // last: then all others are there
  FolderChecksums checksums(folder);
  checksums.write(files);
  checksums.save();
}

std::string make_record_csv(const CaseRecord& record) {
  std::string csv = make_title(record.abscissa);
  for (const CaseRecord::Series& series : record.series) {
    csv += "," + make_title(series.quantity);
  }
  csv += "\n";
  for (std::size_t i = 0; i < record.abscissa_values.size(); ++i) {
    csv += format_exact(record.abscissa_values[i]);
    for (const CaseRecord::Series& series : record.series) {
      csv += "," + format_exact(series.values[i]);
    }
    csv += "\n";
  }
  return csv;
}

}  // namespace armwright
