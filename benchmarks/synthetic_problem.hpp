// A problem whose pairs take a given time, the same on every rank. The decision vector gives it as
// a count of iterations. Vectors and outcomes are as large as those of the tracking problem with
// four joints.
#pragma once

#include <benchmark/benchmark.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/stop_signal.hpp"
#include "measure.hpp"
#include "study/executor/case_executor.hpp"

namespace armwright {

class SyntheticProblem final : public Problem {
 public:
  static constexpr std::size_t kVariables = 16;
  static constexpr std::size_t kMetrics = 11;

  explicit SyntheticProblem(BatchSize size) : size_(size) { description_.name = "synthetic"; }

  const ProblemDescription& description() const override { return description_; }
  BatchSize batch_size(CaseRole /*role*/) const override { return size_; }
  std::vector<CaseOutcome> simulate(std::span<const CaseJob> jobs) const override {
    std::vector<CaseOutcome> outcomes;
    outcomes.reserve(jobs.size());
    for (const CaseJob& job : jobs) {
      outcomes.push_back(make_outcome(burn(job.x[0])));
    }
    return outcomes;
  }
  Evaluation aggregate(std::span<const double> /*x*/,
                       std::span<const CaseOutcome> /*outcomes*/) const override {
    return {};
  }
  std::vector<double> penalty_objectives() const override { return {1}; }

  static CaseOutcome make_outcome(double error) {
    CaseOutcome outcome;
    outcome.error = error;
    outcome.metrics.assign(kMetrics, error);
    return outcome;
  }
  // Each iteration needs the result of the one before. (If the value started at 1, no iteration
  // would change it, and the compiler would remove the loop.)
  static double burn(double iterations) {
    double value = 0.5;
    for (auto left = static_cast<std::uint64_t>(iterations); left > 0; --left) {
      value = 0.999999 * value + 1e-6;
    }
    benchmark::DoNotOptimize(value);
    return value;
  }

 private:
  BatchSize size_;
  ProblemDescription description_;
};

// Returns the count of iterations per second of processor time.
inline double measure_iterations_per_s() {
  constexpr double kIterations = 4e6;
  std::vector<double> rates;
  for (int round = 0; round < 9; ++round) {
    rates.push_back(kIterations / measure_cpu_s([] { SyntheticProblem::burn(kIterations); }));
  }
  return calc_median(rates);
}

// A batch with one case and `pairs` candidates. Of all batches with that many pairs it has the
// longest messages.
class SyntheticBatch {
 public:
  SyntheticBatch(const Problem& problem, std::size_t pairs, double iterations)
      : points_(pairs, std::vector<double>(SyntheticProblem::kVariables, iterations)),
        candidates_(points_.begin(), points_.end()),
        batch_(problem, candidates_, block_, {},
               [](const CaseBatch&, std::size_t, const std::vector<CaseOutcome>&) {}) {}
  SyntheticBatch(const SyntheticBatch&) = delete;
  SyntheticBatch& operator=(const SyntheticBatch&) = delete;

  const CaseBatch& get() const { return batch_; }

 private:
  CaseBlock block_{.role = CaseRole::training, .set = "train/1", .numbers = {0}};
  std::vector<std::vector<double>> points_;
  std::vector<std::span<const double>> candidates_;
  CaseBatch batch_;
};

}  // namespace armwright
