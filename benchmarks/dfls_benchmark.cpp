// Counts how many evaluations dfls needs on the 53 smooth problems of More and Wild 2009
// (more_wild.hpp). A problem is solved at tau when f <= f_L + tau (f_0 - f_L), where f_0 is the value
// of the start and f_L the best known value. The budget is 50 (n + 1) evaluations. As in the paper,
// the problems have no bounds: the box is too wide to matter. Writes a table as CSV, the columns of
// benchmarks/more_wild/dfols.csv. KEY=VALUE are options of dfls.
//
//   build/release/bin/dfls_benchmark [KEY=VALUE ...] > benchmarks/more_wild/dfls.csv
//
// With --serve, it evaluates problems for other programs (benchmarks/more_wild/run_dfols.py). A line
// "NUMBER" is answered by the start of that problem, "NUMBER x_1 ... x_n" by the residuals.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iostream>
#include <limits>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "more_wild.hpp"
#include "optimizers/table/optimizer_table.hpp"

namespace {

using namespace armwright;
using more_wild::Instance;

constexpr std::array<double, 3> kTaus{1e-1, 1e-3, 1e-5};

// The first trust region of DFO-LS, so that both programs begin alike.
double calc_first_radius(const std::vector<double>& start) {
  double largest = 1;
  for (const double value : start) {
    largest = std::max(largest, std::abs(value));
  }
  return 0.1 * largest;
}

constexpr double kShare = 1e-5;       // of the first radius in the width of the box
constexpr double kLastRadius = 1e-8;  // as of DFO-LS

// Counts the evaluations of one problem, and notes when it is solved.
class SolvingEvaluator : public Evaluator {
 public:
  SolvingEvaluator(const Instance& instance, double best_known)
      : instance_(instance), best_known_(best_known) {
    const std::vector<double> start = more_wild::make_start(instance);
    const double width = calc_first_radius(start) / kShare;
    for (const double value : start) {
      problem_.variables.push_back({"x" + std::to_string(problem_.variables.size()), "",
                                    value - width / 2, value + width / 2, value, Scale::linear});
    }
    problem_.name = more_wild::get_name(instance);
    problem_.objectives = {{"f", ""}};
    problem_.has_residuals = true;
    at_start_ = more_wild::calc_square_sum(more_wild::calc_residuals(instance, start));
  }

  const ProblemDescription& problem() const override { return problem_; }
  std::vector<Score> evaluate(std::span<const std::vector<double>> points) override {
    std::vector<Score> scores;
    for (const std::vector<double>& point : points) {
      if (stopped()) {
        break;
      }
      scores.push_back(evaluate_one(point));
    }
    return scores;
  }
  bool stopped() const override { return remaining() == 0; }
  std::int64_t remaining() const override {
    return 50 * static_cast<std::int64_t>(instance_.n + 1) - count_;
  }
  void begin_generation() override {}
  void recommend(std::span<const double> /*x*/) override {}

  double at_start() const { return at_start_; }
  double best() const { return best_; }
  std::int64_t count() const { return count_; }
  // Returns the number of evaluations until the problem was solved at kTaus[i]; 0: it was not.
  std::int64_t solved(std::size_t i) const { return solved_.at(i); }

 private:
  Score evaluate_one(const std::vector<double>& point) {
    ++count_;
    Score score;
    score.residuals = more_wild::calc_residuals(instance_, point);
    const double f = more_wild::calc_square_sum(score.residuals);
    if (!std::isfinite(f)) {
      score = {.objectives = {1e300}, .constraint_values = {}, .residuals = {}, .jacobian = {}};
      score.status = EvaluationStatus::failed;
      return score;
    }
    score.objectives = {f};
    best_ = std::min(best_, f);
    for (std::size_t i = 0; i < kTaus.size(); ++i) {
      if (solved_[i] == 0 && f <= best_known_ + kTaus[i] * (at_start_ - best_known_)) {
        solved_[i] = count_;
      }
    }
    return score;
  }

  const Instance& instance_;
  ProblemDescription problem_;
  double best_known_;
  double at_start_ = 0;
  double best_ = std::numeric_limits<double>::infinity();
  std::int64_t count_ = 0;
  std::array<std::int64_t, kTaus.size()> solved_{};
};

// Reads f_L, the third column, of every problem.
std::vector<double> read_best_known() {
  std::ifstream file(ARMWRIGHT_BENCHMARKS "/more_wild/best_known.csv");
  std::vector<double> values;
  std::string line;
  std::getline(file, line);  // the names of the columns
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    std::string cell;
    for (int column = 0; column < 3; ++column) {
      std::getline(cells, cell, ',');
    }
    values.push_back(std::stod(cell));
  }
  return values;
}

void serve() {
  std::string line;
  while (std::getline(std::cin, line)) {
    std::istringstream words(line);
    std::size_t number = 0;
    words >> number;
    const Instance& instance = more_wild::kInstances.at(number - 1);
    std::vector<double> x;
    for (double value = 0; words >> value;) {
      x.push_back(value);
    }
    const std::vector<double> answer =
        x.empty() ? more_wild::make_start(instance) : more_wild::calc_residuals(instance, x);
    fmt::print("{}\n", fmt::join(answer, " "));
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::string_view(argv[1]) == "--serve") {
    serve();
    return 0;
  }
  const OptimizerRow& row = find_optimizer("dfls");
  const std::vector<double> best_known = read_best_known();
  fmt::print("problem,name,n,m,f_0,tau_1e-1,tau_1e-3,tau_1e-5,f_best,evaluations\n");
  int solved = 0;
  for (std::size_t i = 0; i < more_wild::kInstances.size(); ++i) {
    const Instance& instance = more_wild::kInstances.at(i);
    SolvingEvaluator evaluator(instance, best_known.at(i));
    const double first_radius = calc_first_radius(more_wild::make_start(instance));
    std::vector<std::string> assignments = {
        fmt::format("radius={}", kShare),
        fmt::format("smallest_radius={}", kLastRadius / first_radius * kShare)};
    assignments.insert(assignments.end(), argv + 1, argv + argc);
    row.make(Options::parse(row.name, row.options, assignments))->minimize(evaluator, 1);
    const auto show = [&](std::size_t tau) {
      return evaluator.solved(tau) > 0 ? std::to_string(evaluator.solved(tau)) : std::string();
    };
    fmt::print("{},\"{}\",{},{},{:.6g},{},{},{},{:.10g},{}\n", i + 1, more_wild::get_name(instance),
               instance.n, instance.m, evaluator.at_start(), show(0), show(1), show(2),
               evaluator.best(), evaluator.count());
    solved += evaluator.solved(2) > 0 ? 1 : 0;
  }
  fmt::print(stderr, "{} of {} are solved at tau = 1e-5\n", solved, more_wild::kInstances.size());
}
