// Makes the page of a reproduction.

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "base/text.hpp"
#include "problems/config/config_files.hpp"
#include "report/evidence/distance_response.hpp"
#include "report/evidence/page_json.hpp"
#include "report/evidence/signals.hpp"
#include "report/page/page_file.hpp"
#include "report/page/progress_meter.hpp"
#include "report/page/reproduction_replays.hpp"
#include "study/run/design_evaluation.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using Kind = ReproductionPart::Kind;

constexpr const char* kProgram = "armwright";

// Returns a sentence to append to others if a few failed cases dominate the mean; otherwise
// nothing.
std::string describe_few_failures(const std::string& name, const ErrorSummary& summary) {
  if (summary.failures == 0 || 2 * summary.failures > summary.cases || !summary.median) {
    return "";
  }
  constexpr double kMillimetres = 1e3;
  return fmt::format(
      " {} loses its target, by more than {:g} mm, in {} of {} cases, which raises its mean; the "
      "median is {:.3g} mm.",
      name, kFailureError_m * kMillimetres, summary.failures, summary.cases,
      *summary.median * kMillimetres);
}

class ReproductionPage {
 public:
  explicit ReproductionPage(const std::filesystem::path& folder)
      : folder_(folder),
        record_(load_reproduction(folder)),
        config_(load_reproduction_config(record_.config)) {
    for (const auto& [label, result] : record_.results) {
      results_.push_back(&result);
    }
    std::ranges::stable_sort(results_, {}, [](const PartResult* result) {
      const ReproductionPart& part = result->part;
      return std::tuple(get_natural_key(part.design), part.run, part.value.value_or(0), part.label);
    });
  }

  json make(const PageOptions& options, StopSignal& stop, RunObserver& observer) {
    const std::size_t planned = record_.planned.size();
    const std::size_t there = record_.results.size();
    if (there < planned) {
      notes_.push_back(
          fmt::format("This reproduction is unfinished: it has {} of {} results.", there, planned));
    }
    const auto is_anew = [](const PartResult* one) { return one->part.kind == Kind::anew; };
    if (!config_.remark.empty() && std::ranges::any_of(results_, is_anew)) {
      notes_.push_back(config_.remark);
    }
    json responses = make_responses();
    json sweep = make_sweep();
    PageSimulator simulator(options.jobs, stop, observer);
    json replays = make_reproduction_replays(record_, config_, options, simulator, notes_);
    json progress = nullptr;
    if (there < planned) {
      progress = {{"done", there}, {"total", planned}, {"unit", "results"}};
    }
    return {{"format", kPageFormat},
            {"kind", "reproduction"},
            {"title", config_.title},
            {"subtitle", make_subtitle()},
            {"program", make_program()},
            {"folder", folder_.string()},
            {"command", make_own_command()},
            {"finished", there == planned},
            {"progress", std::move(progress)},
            {"watched", options.meter == nullptr ? json(nullptr)
                                                 : options.meter->observe_results(there, planned)},
            {"notes", notes_},
            {"facts", make_facts()},
            {"robots", std::move(replays["robots"])},
            {"replays", std::move(replays["replays"])},
            {"rows", make_rows()},
            {"runs", make_runs()},
            {"responses", std::move(responses)},
            {"signals", make_signals(load_problem("q1-complex").tracking()->config().task, false)},
            {"sweep", std::move(sweep)},
            {"momentary", std::move(replays["momentary"])}};
  }

 private:
  // Returns the flags that make the same changes to every problem as the record.
  std::vector<std::string> make_engine_flags() const {
    std::vector<std::string> words;
    for (const std::string& change : record_.overrides) {
      const auto parts = split(change, '=');
      if (parts.size() == 2 && parts[0] == "physics.engine") {
        words.insert(words.end(), {"--engine", parts[1]});
      } else if (parts.size() == 2 && parts[0] == "physics.simd") {
        words.insert(words.end(), {"--simd", parts[1]});
      }
    }
    return words;
  }

  void add_flags(std::vector<std::string>& words) const {
    if (record_.cases) {
      words.insert(words.end(), {"--cases", std::to_string(*record_.cases)});
    }
    for (const std::string& word : make_engine_flags()) {
      words.push_back(word);
    }
  }

  std::string make_own_command() const {
    std::vector<std::string> words = {kProgram, "reproduce", "--out", folder_.string()};
    add_flags(words);
    return quote_command(words);
  }

  std::string get_run_folder(const std::string& run) const {
    return (folder_ / "runs" / run).string();
  }

  // Returns the command that evaluates a part again.
  std::string make_command(const ReproductionPart& part) const {
    std::vector<std::string> words = {
        kProgram, "evaluate",
        part.run.empty() ? part.design : get_run_folder(part.run) + "/winner.toml", "--problem",
        part.problem};
    for (const std::string& change : part.overrides) {
      words.insert(words.end(), {"--set", change});
    }
    add_flags(words);
    return quote_command(words);
  }

  std::string make_optimize_command(const std::string& run) const {
    const std::vector<std::string> words = {kProgram,
                                            "optimize",
                                            run,
                                            "--optimizer",
                                            config_.optimizer,
                                            "--seed",
                                            std::to_string(config_.seed),
                                            "--engine",
                                            config_.engine};
    return quote_command(words);
  }

  std::string make_subtitle() const {
    return record_.cases ? fmt::format("published designs and figures, on the first {} test cases",
                                       *record_.cases)
                         : "published designs and figures, on our own test cases";
  }

  // Returns why our numbers of a part may differ from the published ones; empty if no reason is
  // known.
  std::string get_reason(const ReproductionPart& part) const {
    const auto found = config_.reasons.find(part.label);
    return found == config_.reasons.end() ? "" : found->second;
  }

  json make_facts() const {
    json facts = json::array();
    std::vector<std::string> engines;
    std::vector<std::string> sets;
    const auto add_once = [](std::vector<std::string>& all, const std::string& one) {
      if (std::ranges::find(all, one) == all.end()) {
        all.push_back(one);
      }
    };
    std::size_t published = 0;
    for (const PartResult* result : results_) {
      add_once(engines, result->engine);
      add_once(sets, result->test_set);
      published += result->part.kind == Kind::published ? 1 : 0;
    }
    facts.push_back(make_fact("Published results", std::to_string(published)));
    facts.push_back(make_fact("Test set", join(sets, ", ")));
    if (!results_.empty()) {
      facts.push_back(
          make_fact("Test cases of each", std::to_string(results_.front()->case_errors.size())));
    }
    facts.push_back(make_fact("Engine", join(engines, ", ")));
    facts.push_back(make_fact(
        "Optimized anew", fmt::format("by {}, seed {}, trained and judged on the engine {}; shown "
                                      "are their winners on the test set, by the engine above",
                                      config_.optimizer, config_.seed, config_.engine)));
    return facts;
  }

  json make_rows() const {
    json rows = json::array();
    for (const PartResult* result : results_) {
      const ReproductionPart& part = result->part;
      if (part.kind != Kind::published && part.kind != Kind::unpublished) {
        continue;
      }
      const ErrorSummary summary = result->calc_summary();
      rows.push_back({{"label", part.label},
                      {"design", part.design},
                      {"problem", part.problem},
                      {"overrides", part.overrides},
                      {"where", part.where},
                      {"published_error_m", finite_or_null(part.published_error_m)},
                      {"published_torque_n_m", finite_or_null(part.published_torque_n_m)},
                      {"cases", summary.cases},
                      {"mean_m", finite_or_null(summary.mean)},
                      {"median_m", finite_or_null(summary.median)},
                      {"p95_m", finite_or_null(summary.percentile_95)},
                      {"worst_m", finite_or_null(summary.worst)},
                      {"standard_error_m",
                       finite_or_null(calc_mean_and_error(result->case_errors).standard_error)},
                      {"failures", summary.failures},
                      {"torque_n_m", finite_or_null(result->total_torque_n_m)},
                      {"reason", get_reason(part)},
                      {"command", make_command(part)}});
    }
    return rows;
  }

  json make_runs() const {
    json runs = json::array();
    for (const PartResult* result : results_) {
      const ReproductionPart& part = result->part;
      if (part.kind != Kind::anew) {
        continue;
      }
      const ErrorSummary summary = result->calc_summary();
      std::string problem = part.problem;
      for (const std::string& change : part.overrides) {
        problem += " " + change;
      }
      runs.push_back({{"name", part.label},
                      {"problem", problem},
                      {"cases", summary.cases},
                      {"mean_m", finite_or_null(summary.mean)},
                      {"torque_n_m", finite_or_null(result->total_torque_n_m)},
                      {"published_torque_n_m", finite_or_null(part.published_torque_n_m)},
                      {"reason", get_reason(part)},
                      {"folder", get_run_folder(part.run)},
                      {"command", part.overrides.empty() ? make_optimize_command(part.run)
                                                         : make_command(part)}});
    }
    return runs;
  }

  json make_responses() {
    json responses = json::array();
    std::vector<std::string> missing;
    for (const ResponseFigureConfig& figure : config_.figures) {
      json series = json::array();
      const PartResult* first = nullptr;
      std::string remark = figure.remark;
      for (const auto& [name, of] : figure.series) {
        const auto found = record_.results.find(of);
        if (found == record_.results.end()) {
          missing.push_back(fmt::format("{} ({})", name, figure.thesis));
          continue;
        }
        const PartResult& result = found->second;
        first = first == nullptr ? &result : first;
        remark += describe_few_failures(name, result.calc_summary());
        series.push_back(make_response_series(name, result.case_errors, result.points,
                                              result.part.published_error_m,
                                              make_command(result.part)));
      }
      if (first != nullptr) {
        const LoadedProblem problem = load_problem(first->part.problem, first->part.overrides);
        responses.push_back(make_distance_response(require_tracking(problem),
                                                   {figure.id, figure.title, figure.thesis, remark},
                                                   std::move(series)));
      }
    }
    if (!missing.empty()) {
      notes_.push_back("Missing: " + join(missing, ", ") + ".");
    }
    return responses;
  }

  json make_sweep() {
    const LoadedProblem problem = load_problem(config_.sweep);
    const SweepPlan plan = problem.sweep.value_or(SweepPlan{});
    json values = json::array();
    json means = json::array();
    json standard_errors = json::array();
    json medians = json::array();
    json failures = json::array();
    std::uint64_t cases = 0;
    std::string engine;
    for (const PartResult* result : results_) {
      if (result->part.kind != Kind::sweep) {
        continue;
      }
      const ErrorSummary summary = result->calc_summary();
      values.push_back(finite_or_null(result->part.value));
      means.push_back(finite_or_null(summary.mean));
      standard_errors.push_back(
          finite_or_null(calc_mean_and_error(result->case_errors).standard_error));
      medians.push_back(finite_or_null(summary.median));
      failures.push_back(summary.failures);
      cases = summary.cases;
      engine = result->engine;
    }
    json series = json::array();
    if (values.empty()) {
      notes_.emplace_back("The sweep over the speed (Fig. 6.16) is missing.");
    } else {
      series.push_back({{"name", get_table_name(plan.design)},
                        {"mean_m", means},
                        {"standard_error_m", standard_errors},
                        {"median_m", medians},
                        {"failures", failures}});
    }
    std::vector<std::string> words = {kProgram, "sweep", config_.sweep};
    add_flags(words);
    return {{"parameter", plan.parameter},
            {"quantity", make_quantity({"average speed", "m/s"})},
            {"values", std::move(values)},
            {"nominal", require_tracking(problem).config().task.speed_m_per_s},
            {"cases", cases},
            {"engine", engine},
            {"command", quote_command(words)},
            {"series", std::move(series)}};
  }

  std::filesystem::path folder_;
  ReproductionRecord record_;
  ReproductionConfig config_;
  std::vector<const PartResult*> results_;  // in the order of the page
  std::vector<std::string> notes_;
};

}  // namespace

std::optional<std::string> make_reproduction_page(const std::filesystem::path& folder,
                                                  const PageOptions& options, StopSignal& stop,
                                                  RunObserver& observer) {
  try {
    return dump_page(ReproductionPage(folder).make(options, stop, observer));
  } catch (const WorkStopped&) {
    return std::nullopt;
  }
}

}  // namespace armwright
