// A problem of a user for tests, which this process answers itself: minimise (a - 1)^2 + n^2 with
// a + n <= 3.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <utility>
#include <vector>

#include "problems/config/problem_loader.hpp"
#include "problems/user/user_problem.hpp"

namespace armwright {

// Counts what was simulated.
struct OwnProblemCounts {
  std::mutex mutex;
  std::multiset<std::vector<double>> points;
};

inline CaseAnswer answer_own(std::span<const double> x) {
  CaseAnswer answer;
  if (x[0] < -3) {
    answer.status = EvaluationStatus::failed;
    answer.reason = "the motor stalled";
    return answer;
  }
  answer.objectives = {(x[0] - 1) * (x[0] - 1) + x[1] * x[1]};
  answer.constraints = {x[0] + x[1]};
  answer.metrics = {x[0] * x[1]};
  return answer;
}

class OwnServer final : public CaseServer {
 public:
  explicit OwnServer(std::shared_ptr<OwnProblemCounts> counts) : counts_(std::move(counts)) {}
  void answer(std::span<const CaseJob> jobs, std::vector<CaseAnswer>& answers) override {
    for (const CaseJob& job : jobs) {
      const std::lock_guard lock(counts_->mutex);
      counts_->points.insert({job.x.begin(), job.x.end()});
      answers.push_back(answer_own(job.x));
    }
  }
  CaseRecord record(const CaseJob& job) override {
    CaseRecord record;
    record.abscissa = {"time", "s"};
    record.abscissa_values = {0, 0.5};
    record.series = {{{"speed", "rad/s"}, {job.x[0], job.x[1]}}};
    record.files = {{"note.txt", "the best\n"}};
    return record;
  }

 private:
  std::shared_ptr<OwnProblemCounts> counts_;
};

inline UserDescription describe_own() {
  UserDescription description;
  description.name = "own";
  DecisionVariable a;
  a.name = "a";
  a.unit = "V";
  a.lower = -4;
  a.upper = 4;
  a.start = 2;
  DecisionVariable n = a;
  n.name = "n";
  n.type = VariableType::integer;
  description.variables = {a, n};
  UserObjective loss;
  loss.quantity = {"loss", "W"};
  description.objectives = {loss};
  description.constraints = {{.quantity = {"sum", "V"}, .limit = 3}};
  description.metrics = {{"product", "V"}};
  return description;
}

// Without `start`, the problem cannot be simulated.
inline LoadedProblem make_served_problem(UserDescription description, StartServer start) {
  LoadedProblem loaded;
  loaded.name = description.name;
  loaded.sets = {.validation_cases = static_cast<int>(description.validation_cases),
                 .test_cases = static_cast<int>(description.test_cases),
                 .training_cases = description.training_cases};
  loaded.schedule = {.kind = Schedule::Kind::fixed, .cases = 1};
  loaded.resolved_json = R"({"kind": "program"})";
  UserProgram program{.name = "own",
                      .description = std::move(description),
                      .start = std::move(start),
                      .why_not = "it is computed elsewhere"};
  loaded.problem = make_user_problem(std::move(program));
  return loaded;
}

// Without `counts`, the problem cannot be simulated.
inline LoadedProblem make_own_problem(UserDescription description,
                                      const std::shared_ptr<OwnProblemCounts>& counts) {
  StartServer start;
  if (counts) {
    start = [counts] { return std::make_unique<OwnServer>(counts); };
  }
  return make_served_problem(std::move(description), std::move(start));
}

// A server whose cases fail where `fails` returns true; a warning then says what it printed.
class PrintingServer final : public CaseServer {
 public:
  using Fails = std::function<bool(const CaseJob&)>;
  explicit PrintingServer(Fails fails) : fails_(std::move(fails)) {}
  void answer(std::span<const CaseJob> jobs, std::vector<CaseAnswer>& answers) override {
    for (const CaseJob& job : jobs) {
      CaseAnswer& answer = answers.emplace_back(answer_own(job.x));
      if (fails_(job)) {
        answer.status = EvaluationStatus::failed;
        answer.reason = "no mesh";
        answer.details = "; it printed: angle 0";
      }
    }
  }

 private:
  Fails fails_;
};

inline LoadedProblem make_printing_problem(UserDescription description,
                                           PrintingServer::Fails fails) {
  return make_served_problem(std::move(description), [fails = std::move(fails)] {
    return std::make_unique<PrintingServer>(fails);
  });
}

}  // namespace armwright
