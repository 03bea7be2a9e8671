#include "study/run/ask_tell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "base/bits.hpp"
#include "base/error.hpp"
#include "base/file.hpp"
#include "base/folder.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "problems/user/user_problem.hpp"
#include "study/run/run_lock.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr int kAskedFormat = 1;
constexpr std::size_t kAskedLimit_bytes = std::size_t{256} << 20;

// The points that were handed out and have no result yet, by identifier. They are requests: records
// without an evaluation.
struct Asked {
  std::map<std::uint64_t, EvaluationRecord> requests;
  bool wants_residuals = false;  // the optimizer needs the residuals of each point
};

[[noreturn]] void refuse_asked(const std::filesystem::path& file, const std::string& fault) {
  throw Error(ErrorKind::bad_data,
              fmt::format("{}: {}. Remove the file: 'armwright ask' then hands the same points out "
                          "again, with the same identifiers",
                          sanitize(file.string()), fault));
}

// Refuses a request that no run of the problem can have made.
void check_request(const EvaluationRecord& request, const ProblemDescription& problem,
                   const std::filesystem::path& file) {
  const auto& variables = problem.variables;
  bool fits = request.x.size() == variables.size() &&
              (request.proposed.empty() || request.proposed.size() == variables.size()) &&
              request.cases.numbers.size() == 1;
  for (std::size_t i = 0; fits && i < variables.size(); ++i) {
    fits = request.x[i] >= variables[i].lower && request.x[i] <= variables[i].upper;
  }
  if (!fits) {
    refuse_asked(file, fmt::format("its point {} is none of the problem {}", request.index,
                                   sanitize(problem.name)));
  }
}

Asked read_asked(const std::filesystem::path& folder, const ProblemDescription& problem) {
  Asked asked;
  const auto file = folder / kAskedFile;
  if (!path_exists(file)) {
    return asked;
  }
  try {
    const json content = json::parse(read_json_file(file, kAskedLimit_bytes));
    if (content.at("format") != kAskedFormat) {
      refuse_asked(file, fmt::format("its format is {}, and this version of armwright reads format "
                                     "{}",
                                     content.at("format").dump(), kAskedFormat));
    }
    asked.wants_residuals = content.at("residuals").get<bool>();
    for (const json& point : content.at("points")) {
      EvaluationRecord request;
      request.index = point.at("id").get<std::uint64_t>();
      request.generation = point.at("generation").get<std::uint64_t>();
      request.clipped = point.at("clipped").get<bool>();
      request.x = point.at("x").get<std::vector<double>>();
      request.proposed = point.at("proposed").get<std::vector<double>>();
      request.cases = {CaseRole::training, point.at("set").get<std::string>(),
                       point.at("cases").get<std::vector<std::uint64_t>>()};
      check_request(request, problem, file);
      asked.requests.emplace(request.index, std::move(request));
    }
  } catch (const json::exception& error) {
    refuse_asked(
        file, fmt::format("is not what armwright wrote ({})", describe_json_error(error.what())));
  }
  return asked;
}

void write_asked(const Folder& folder, const Asked& asked) {
  json points = json::array();
  for (const auto& [id, request] : asked.requests) {
    points.push_back({{"id", id},
                      {"generation", request.generation},
                      {"clipped", request.clipped},
                      {"x", request.x},
                      {"proposed", request.proposed},
                      {"set", request.cases.set},
                      {"cases", request.cases.numbers}});
  }
  const json content = {
      {"format", kAskedFormat}, {"residuals", asked.wants_residuals}, {"points", points}};
  write_file_atomically(folder, kAskedFile, content.dump() + "\n");
}

bool is_same_request(const EvaluationRecord& a, const EvaluationRecord& b) {
  return same_bits(a.x, b.x) && same_bits(a.proposed, b.proposed) && a.clipped == b.clipped &&
         a.generation == b.generation && a.cases.set == b.cases.set &&
         a.cases.numbers == b.cases.numbers;
}

// Divides the missing evaluations into points that wait and points that are handed out now, and
// records the latter.
void hand_out(const RunPlan& plan, const Folder& folder,
              std::span<const EvaluationRecord* const> missing, std::size_t count,
              AskOutcome& outcome) {
  Asked before = read_asked(folder.path(), plan.problem.problem->description());
  Asked now;
  now.wants_residuals = wants_residuals(plan.optimizer);
  for (const EvaluationRecord* request : missing) {
    const auto known = before.requests.find(request->index);
    if (known == before.requests.end()) {
      if (outcome.points.size() < count) {
        outcome.points.push_back({request->index, request->x});
        now.requests.emplace(request->index, *request);
      }
      continue;
    }
    if (!is_same_request(known->second, *request)) {
      refuse_asked(folder.path() / kAskedFile,
                   fmt::format("its point {} is not what optimizer '{}' asks for now; the run was "
                               "made by another version, machine or plugin",
                               request->index, sanitize(plan.optimizer.name)));
    }
    outcome.waiting.push_back({request->index, request->x});
    now.requests.insert(*known);
  }
  write_asked(folder, now);
}

// Returns the evaluation of a point from the answer to it.
EvaluationRecord answer_request(const Problem& problem, const EvaluationRecord& request,
                                bool residuals, const ToldAnswer& told) {
  EvaluationRecord record = request;
  const bool lacks_residuals =
      residuals && told.answer.status == EvaluationStatus::ok && told.answer.residuals.empty();
  if (lacks_residuals) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: has no \"residuals\", which the optimizer of this run needs; they "
                            "are a list of numbers whose squares add up to the objective",
                            told.where));
  }
  const CaseJob job{.x = record.x,
                    .block = &record.cases,
                    .number = record.cases.numbers.front(),
                    .residuals = residuals};
  try {
    record.evaluation = make_evaluation(problem, job, told.answer);
  } catch (const Error& error) {
    throw Error(error.kind(), fmt::format("{}: {}", told.where, error.what()));
  }
  return record;
}

}  // namespace

void prepare_to_ask(RunPlan& plan) {
  const Problem& problem = *plan.problem.problem;
  const std::string& name = plan.problem.name;
  if (find_user_description(problem) == nullptr) {
    throw Error(ErrorKind::usage,
                fmt::format("armwright simulates {} itself; 'armwright optimize' runs it. Ask and "
                            "tell need a problem of your own: a file with kind = \"external\" or a "
                            "program",
                            sanitize(name)));
  }
  if (!problem.description().has_single_case) {
    throw Error(ErrorKind::usage,
                fmt::format("ask and tell need a problem with one case, whose result counts as it "
                            "is told, and {} has several cases or answers that differ from time to "
                            "time. Let it combine its cases into one result, and declare it "
                            "deterministic",
                            sanitize(name)));
  }
  if (plan.racing.kind != Racing::Kind::none) {
    throw Error(ErrorKind::usage, "ask and tell need --racing none: each point has one result");
  }
  plan.selection.evaluated_only = true;
}

AskOutcome ask(RunRequest request, std::size_t count, RunObserver& observer) {
  prepare_to_ask(request.plan);
  AskOutcome outcome;
  StopSignal stop;
  request.ask = [&](const Folder& folder, std::span<const EvaluationRecord* const> missing) {
    hand_out(request.plan, folder, missing, count, outcome);
    stop.request(StopReason::interrupted);
  };
  outcome.result = execute_run(request, stop, observer);
  if (outcome.result && path_exists(request.folder / kAskedFile)) {
    Folder::make(request.folder, request.root).remove(kAskedFile);
  }
  return outcome;
}

void tell(const std::filesystem::path& path, const Problem& problem,
          std::span<const ToldAnswer> answers) {
  if (!path_exists(path / "manifest.json")) {
    throw Error(
        ErrorKind::usage,
        fmt::format("{}: is not the folder of a run (it has no manifest.json); 'armwright ask' "
                    "begins one",
                    sanitize(path.string())));
  }
  const Folder folder = Folder::make(path, path);
  const RunLock lock(folder);
  Asked asked = read_asked(path, problem.description());
  JournalContent recorded;
  Journal journal(folder, "journal", recorded);
  std::map<std::uint64_t, const ToldAnswer*> seen;
  std::vector<EvaluationRecord> records;
  for (const ToldAnswer& told : answers) {
    const auto [before, is_new] = seen.emplace(told.id, &told);
    const auto request = asked.requests.find(told.id);
    std::string fault;
    if (!is_new) {
      fault = fmt::format("has another result at {}", before->second->where);
    } else if (recorded.training.find(told.id)) {
      fault = "has a result already, which stays as it was told first";
    } else if (recorded.ended) {
      fault = "comes too late: the run has ended";
    } else if (request == asked.requests.end()) {
      fault = fmt::format(
          "was never handed out; 'armwright ask {} --waiting' lists the points that "
          "wait for a result",
          sanitize(path.string()));
    }
    if (!fault.empty()) {
      throw Error(ErrorKind::usage, fmt::format("{}: point {} {}. None of the results was recorded",
                                                told.where, told.id, fault));
    }
    records.push_back(answer_request(problem, request->second, asked.wants_residuals, told));
  }
  for (const EvaluationRecord& record : records) {
    journal.append(record);
    asked.requests.erase(record.index);
  }
  journal.close();  // a result that was told survives a power cut
  if (!records.empty()) {
    write_asked(folder, asked);
  }
}

}  // namespace armwright
