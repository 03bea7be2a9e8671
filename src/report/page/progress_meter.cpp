#include "report/page/progress_meter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <system_error>

#include "base/error.hpp"
#include "base/folder.hpp"
#include "base/text.hpp"
#include "report/evidence/page_json.hpp"
#include "study/journal/journal.hpp"
#include "study/matrix/cell_selection.hpp"
#include "study/matrix/study_status.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr std::size_t kMostFailures = 6;  // that a page lists

// Returns whether a simulation of the candidate failed. An abandoned candidate only lost a race.
bool has_failed(EvaluationStatus status) {
  return status != EvaluationStatus::ok && status != EvaluationStatus::abandoned;
}

json make_failure(const std::string& where, const std::string& state, const std::string& reason) {
  return {{"where", sanitize(where)}, {"state", state}, {"reason", sanitize(reason)}};
}

// Returns the folder in which the cell's run is written.
std::filesystem::path find_run(const StudyPlan& plan, const CellStatus& status,
                               const std::filesystem::path& study) {
  return status.attempt ? make_token_path(make_attempts_path(plan, status.cell, study),
                                          status.attempt->token) /
                              "run"
                        : study / make_cell_path(plan, status.cell);
}

}  // namespace

void RateEstimate::add(double time_s, double simulations, double work, double total) {
  const Observation now{time_s, simulations, work, total};
  if (!first_) {
    first_ = now;
  }
  recent_.push_back(now);
  while (recent_.front().time_s < time_s - kWindow_s) {
    recent_.pop_front();
  }
}

std::optional<double> RateEstimate::calc_per_second() const {
  if (recent_.empty() || recent_.back().time_s <= recent_.front().time_s) {
    return std::nullopt;
  }
  const double done = recent_.back().simulations - recent_.front().simulations;
  return std::max(0.0, done) / (recent_.back().time_s - recent_.front().time_s);
}

std::optional<double> RateEstimate::calc_left_s() const {
  if (recent_.empty() || recent_.back().work <= recent_.front().work ||
      recent_.back().work <= first_->work) {
    return std::nullopt;
  }
  const Observation& now = recent_.back();
  return std::max(0.0, now.total - now.work) * (now.time_s - first_->time_s) /
         (now.work - first_->work);
}

const ProgressMeter::Counted& ProgressMeter::count(const std::string& name,
                                                   const RecordedEvaluations& training) {
  Counted& counted = counted_[name];
  if (training.size() < counted.evaluations) {
    // Another attempt began without these evaluations.
    counted.evaluations = 0;
    counted.simulations = 0;
    counted.failed = 0;
  }
  for (; counted.evaluations < training.size(); ++counted.evaluations) {
    const EvaluationRecord record = training[counted.evaluations];
    counted.simulations += record.calc_charge();
    if (!has_failed(record.evaluation.status)) {
      continue;
    }
    ++counted.failed;
    if (counted.listed.insert(record.index).second) {
      failures_.push_front(make_failure(
          fmt::format("{}evaluation {}", name.empty() ? "" : name + ", ", record.index + 1),
          to_string(record.evaluation.status), record.evaluation.reason));
      failures_.resize(std::min(failures_.size(), kMostFailures));
    }
  }
  return counted;
}

const ProgressMeter::Counted& ProgressMeter::count_cell(const std::string& name,
                                                        const std::filesystem::path& journal) {
  Counted& counted = counted_[name];
  std::error_code ignored;
  const std::uintmax_t bytes = std::filesystem::file_size(journal, ignored);
  if (journal != counted.journal || bytes != counted.bytes) {
    count(name, read_journal(journal).training);
    counted.journal = journal;
    counted.bytes = bytes;
  }
  return counted;
}

json ProgressMeter::make(double simulations, double work, double total) {
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin_;
  rate_.add(time.count(), simulations, work, total);
  const auto per_second = rate_.calc_per_second();
  const auto left_s = rate_.calc_left_s();
  return {{"simulations", simulations},
          {"per_second", per_second ? json(*per_second) : json(nullptr)},
          {"left_s", left_s ? json(std::ceil(*left_s)) : json(nullptr)},
          {"running", json::array()},
          {"failed_evaluations", 0},
          {"failures", failures_}};
}

json ProgressMeter::observe_run(const RecordedRun& run) {
  const Counted& counted = count("", run.journal.training);
  const auto done = static_cast<double>(counted.simulations);
  json watched = make(done, done, static_cast<double>(run.budget));
  watched["failed_evaluations"] = counted.failed;
  return watched;
}

json ProgressMeter::observe_study(const StudyPlan& plan, std::span<const CellOutcome> ended,
                                  const std::filesystem::path& study) {
  const StudyStatus status = read_study_status(plan, study);
  const auto budget = static_cast<double>(plan.budget);
  double simulations = 0;
  std::uint64_t failed = 0;
  for (const CellOutcome& cell : ended) {
    simulations += static_cast<double>(cell.cases);
    failed += cell.failed_evaluations;
  }
  // A cell that ends early has used its budget as far as the time left is concerned.
  double work = budget * static_cast<double>(ended.size());
  double total = budget * static_cast<double>(list_cells(plan).size());
  json running = json::array();
  json failures = json::array();
  for (const CellStatus& one : status.notable) {
    const std::string name = make_cell_name(plan, one.cell);
    if (one.state != CellState::running) {
      const std::string reason = one.state == CellState::silent
                                     ? describe_holder(one) + " gives no sign of life"
                                     : one.error;
      failures.push_back(make_failure(name, to_string(one.state), reason));
      if (one.state != CellState::failed) {  // a failed cell is one of those that have ended
        const auto cases = static_cast<double>(one.attempt ? one.attempt->cases.value_or(0) : 0);
        simulations += cases;
        work += std::min(cases, budget);
        // An error has ended the cell, so it has no work left.
        total -= one.state == CellState::broken ? budget - std::min(cases, budget) : 0;
      }
      continue;
    }
    json done = nullptr;
    const auto journal = find_run(plan, one, study) / "journal";
    try {
      if (path_exists(journal)) {
        const Counted& counted = count_cell(name, journal);
        done = counted.simulations;
        failed += counted.failed;
      }
    } catch (const Error&) {
      // Its process may be moving the folder to its place right now.
    }
    if (done.is_null() && one.attempt && one.attempt->cases) {
      done = *one.attempt->cases;
    }
    const double cases = done.is_null() ? 0 : done.get<double>();
    simulations += cases;
    work += std::min(cases, budget);
    running.push_back({{"cell", sanitize(name)},
                       {"process", sanitize(describe_holder(one))},
                       {"done", std::move(done)},
                       {"total", plan.budget}});
  }
  json watched = make(simulations, work, total);
  watched["running"] = std::move(running);
  watched["failed_evaluations"] = failed;
  watched["failures"].insert(watched["failures"].begin(), failures.begin(), failures.end());
  return watched;
}

json ProgressMeter::observe_results(std::size_t done, std::size_t total) {
  json watched = make(0, static_cast<double>(done), static_cast<double>(total));
  watched["simulations"] = nullptr;  // they are not recorded before a result is there
  watched["per_second"] = nullptr;
  return watched;
}

}  // namespace armwright
