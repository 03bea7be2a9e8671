// Reads and writes a reproduction's folder.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/build_info.hpp"
#include "base/error.hpp"
#include "base/file.hpp"
#include "base/folder_checksums.hpp"
#include "base/hash.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "report/evidence/page_json.hpp"
#include "report/reproduction/reproduction.hpp"
#include "study/run/json_values.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr const char* kRecordFile = "reproduction.json";
constexpr std::size_t kRecordLimit_bytes = std::size_t{256} << 20;
constexpr int kRecordFormat = 1;
constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

// In the order of ReproductionPart::Kind.
const std::vector<std::string>& kind_names() {
  static const std::vector<std::string> names = {"published", "unpublished", "anew", "sweep"};
  return names;
}

std::vector<double> numbers_from_json(const json& list) {
  std::vector<double> numbers;
  for (const json& number : list) {
    numbers.push_back(number.is_null() ? kNoNumber : number.get<double>());
  }
  return numbers;
}

std::optional<double> optional_number(const json& value) {
  return value.is_null() ? std::nullopt : std::optional(value.get<double>());
}

json part_to_json(const PartResult& result) {
  const ReproductionPart& part = result.part;
  json failures = json::array();
  for (const CaseFailure& failure : result.failures) {
    failures.push_back({{"case", failure.number}, {"reason", sanitize(failure.reason)}});
  }
  return {{"kind", kind_names()[static_cast<std::size_t>(part.kind)]},
          {"design", part.design},
          {"run", part.run},
          {"problem", part.problem},
          {"set", part.overrides},
          {"published_error_m", finite_or_null(part.published_error_m)},
          {"published_torque_n_m", finite_or_null(part.published_torque_n_m)},
          {"where", part.where},
          {"value", finite_or_null(part.value)},
          {"inputs_sha256", result.inputs_sha256},
          {"engine", result.engine},
          {"test_set", result.test_set},
          {"case_errors_m", finite_or_null(result.case_errors)},
          {"without_number", failures},
          {"point_mean_m", finite_or_null(result.points.mean_m)},
          {"point_standard_error_m", finite_or_null(result.points.standard_error_m)},
          {"total_torque_n_m", result.total_torque_n_m}};
}

PartResult part_from_json(const std::string& label, const json& j) {
  PartResult result;
  ReproductionPart& part = result.part;
  const auto kind = std::ranges::find(kind_names(), j.at("kind").get<std::string>());
  if (kind == kind_names().end()) {
    throw std::runtime_error("it has a part of an unknown kind");
  }
  part.kind = static_cast<ReproductionPart::Kind>(kind - kind_names().begin());
  part.label = label;
  part.design = j.at("design");
  part.run = j.at("run");
  part.problem = j.at("problem");
  part.overrides = j.at("set").get<std::vector<std::string>>();
  part.published_error_m = optional_number(j.at("published_error_m"));
  part.published_torque_n_m = optional_number(j.at("published_torque_n_m"));
  part.where = j.at("where");
  part.value = optional_number(j.at("value"));
  result.inputs_sha256 = j.at("inputs_sha256");
  result.engine = j.at("engine");
  result.test_set = j.at("test_set");
  result.case_errors = numbers_from_json(j.at("case_errors_m"));
  for (const json& failure : j.at("without_number")) {
    result.failures.push_back({whole_from_json(failure.at("case")), failure.at("reason")});
  }
  result.points = {numbers_from_json(j.at("point_mean_m")),
                   numbers_from_json(j.at("point_standard_error_m"))};
  result.total_torque_n_m = j.at("total_torque_n_m");
  return result;
}

json record_to_json(const ReproductionRecord& record) {
  json parts = json::object();
  for (const auto& [label, result] : record.results) {
    parts[label] = part_to_json(result);
  }
  return {{"format", kRecordFormat},
          {"config", record.config},
          {"cases", record.cases ? json(*record.cases) : json(nullptr)},
          {"set", record.overrides},
          {"build", record.build},
          {"planned", record.planned},
          {"parts", parts}};
}

ReproductionRecord record_from_json(const json& j) {
  if (j.at("format") != kRecordFormat) {
    throw std::runtime_error("its format is not the one this version reads");
  }
  ReproductionRecord record;
  record.config = j.at("config");
  if (!j.at("cases").is_null()) {
    record.cases = whole_from_json(j.at("cases"));
  }
  record.overrides = j.at("set").get<std::vector<std::string>>();
  record.build = j.at("build").get<std::map<std::string, std::string>>();
  record.planned = j.at("planned").get<std::vector<std::string>>();
  for (const auto& [label, part] : j.at("parts").items()) {
    record.results.emplace(label, part_from_json(label, part));
  }
  return record;
}

std::string describe_settings(const std::optional<std::uint64_t>& cases,
                              const std::vector<std::string>& overrides) {
  return fmt::format(
      "{}, {}", cases ? fmt::format("--cases {}", *cases) : "as many cases as the problems say",
      overrides.empty() ? "the problems' own engines" : join(overrides, " "));
}

// Creates the folder, or accepts one that holds a reproduction or nothing.
Folder claim_folder(const std::filesystem::path& path) {
  Folder folder = Folder::make(path, path);
  if (is_reproduction_folder(path)) {
    return folder;
  }
  for (const auto& entry : list_folder(path)) {
    const std::string name = entry.filename().string();
    // A program that is killed early leaves these.
    if (name != "lock" && name != kChecksumFile && !name.ends_with(".new")) {
      throw Error(ErrorKind::usage,
                  fmt::format("{}: holds '{}' but no {}, so it is not the folder of a "
                              "reproduction; choose another with --out, or --new",
                              path.string(), sanitize(name), kRecordFile));
    }
  }
  return folder;
}

}  // namespace

ErrorSummary PartResult::calc_summary() const {
  return summarize(case_errors, kFailureError_m);
}

std::optional<double> PartResult::calc_ratio() const {
  const auto mean = calc_summary().mean;
  return part.published_error_m && mean ? std::optional(*mean / *part.published_error_m)
                                        : std::nullopt;
}

bool is_reproduction_folder(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path / kRecordFile, ignored);
}

ReproductionRecord load_reproduction(const std::filesystem::path& folder) {
  const auto file = folder / kRecordFile;
  if (!is_reproduction_folder(folder)) {
    throw Error(ErrorKind::usage, fmt::format("{}: is not the folder of a reproduction (it has no "
                                              "{})",
                                              folder.string(), kRecordFile));
  }
  const std::string text = read_checked_json(file, kRecordLimit_bytes);
  const auto refuse = [&](const std::string& why) {
    return Error(ErrorKind::bad_data,
                 fmt::format("{}: is not what armwright wrote ({}); choose another folder with "
                             "--out, or --new",
                             file.string(), sanitize(why)));
  };
  try {
    return record_from_json(json::parse(text));
  } catch (const json::exception& error) {
    throw refuse(error.what());
  } catch (const std::runtime_error& error) {
    throw refuse(error.what());
  }
}

std::string calc_inputs_hash(const ReproductionPlan& plan, const PlannedPart& part) {
  json inputs = {{"problem", json::parse(part.problem.resolved_json)},
                 {"files", part.problem.input_hashes},
                 {"cases", part.cases}};
  if (part.part.run.empty()) {
    DesignFile design;
    design.design = part.design;
    design.joint_names.resize(part.design.joints.size());
    inputs["design"] = to_toml(design);
  } else {
    const auto run = std::ranges::find(plan.runs, part.part.run,
                                       [](const RunPlan& one) { return one.problem.name; });
    inputs["run"] = json::parse(to_json(*run));
  }
  return calc_sha256_hex(inputs.dump(-1, ' ', false, json::error_handler_t::replace));
}

ReproductionFolder::ReproductionFolder(const std::filesystem::path& path,
                                       const ReproductionPlan& plan)
    : folder_(claim_folder(path)), lock_(folder_) {
  if (is_reproduction_folder(path)) {
    record_ = load_reproduction(path);
    check(plan);
    warnings_ = describe_build_changes(record_.build, "reproduction");
  } else {
    record_.config = plan.request.config;
    record_.cases = plan.request.cases;
    record_.overrides = plan.request.overrides;
    record_.build = describe_build();
  }
  const auto before = record_.planned;
  for (const PlannedPart& part : plan.parts) {
    record_.planned.push_back(part.part.label);
  }
  std::ranges::sort(record_.planned);
  const auto doubled = std::ranges::unique(record_.planned);
  record_.planned.erase(doubled.begin(), doubled.end());
  if (before != record_.planned || !is_reproduction_folder(path) ||
      !std::filesystem::exists(path / kChecksumFile)) {
    write();
  }
}

void ReproductionFolder::check(const ReproductionPlan& plan) const {
  const std::string recorded = describe_settings(record_.cases, record_.overrides);
  const std::string now = describe_settings(plan.request.cases, plan.request.overrides);
  if (recorded != now) {
    throw Error(
        ErrorKind::usage,
        fmt::format("{} holds a reproduction with other settings: recorded {}, now {}. Continue "
                    "with the recorded ones, or use --new or --out for another folder",
                    path().string(), sanitize(recorded), now));
  }
  if (record_.config != plan.request.config) {
    throw Error(
        ErrorKind::usage,
        fmt::format("{} holds a reproduction of '{}', not of '{}'; use --new or --out for "
                    "another folder",
                    path().string(), sanitize(record_.config), sanitize(plan.request.config)));
  }
  for (const PlannedPart& part : plan.parts) {
    const PartResult* result = find(part.part.label);
    if (result != nullptr && result->inputs_sha256 != calc_inputs_hash(plan, part)) {
      throw Error(ErrorKind::usage,
                  fmt::format("{} holds a result '{}' that was computed from another problem, "
                              "design or SIMD level than there is now; use --new or --out for "
                              "another folder",
                              path().string(), sanitize(part.part.label)));
    }
  }
}

const PartResult* ReproductionFolder::find(const std::string& label) const {
  const auto found = record_.results.find(label);
  return found == record_.results.end() ? nullptr : &found->second;
}

void ReproductionFolder::add(PartResult result) {
  const std::string label = result.part.label;
  record_.results.insert_or_assign(label, std::move(result));
  write();
}

void ReproductionFolder::write() const {
  const std::pair<std::string, std::string> file(
      kRecordFile,
      record_to_json(record_).dump(1, ' ', false, json::error_handler_t::replace) + "\n");
  FolderChecksums checksums(folder_);
  checksums.write({&file, 1});
  for (const auto& [label, result] : record_.results) {
    const std::string& run = result.part.run;
    if (!run.empty()) {
      checksums.cover((get_run_folder(run) / kChecksumFile).lexically_relative(path()).string());
    }
  }
  checksums.save();
}

}  // namespace armwright
