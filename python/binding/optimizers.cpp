// Optimizers: those of the table, and Python classes as rows of the same kind.
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>
#include <utility>

#include "arrays.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "host.hpp"
#include "optimizers/plugins/recorded_optimizer.hpp"
#include "optimizers/table/optimizer_table.hpp"
#include "parts.hpp"
#include "study/contract/contract.hpp"

namespace armwright::python {
namespace {

// The evaluator as a Python class sees it. It is valid until minimize() returns.
class EvaluatorBridge {
 public:
  EvaluatorBridge(Evaluator& evaluator, Host& host) : evaluator_(&evaluator), host_(host) {}

  std::string describe_problem() const { return describe(get().problem()).dump(); }
  bool stopped() const { return get().stopped(); }
  std::int64_t remaining() const { return std::max<std::int64_t>(0, get().remaining()); }
  std::int64_t evaluations() const { return evaluations_; }

  void begin_generation() {
    guard([&] { evaluator_->begin_generation(); });
  }
  void recommend(const Numbers& point) {
    check_points(point, get().problem().variables, "x", false);
    guard([&] { evaluator_->recommend(get_row(point, 0)); });
  }
  void explain_end(const std::string& reason) {
    guard([&] { evaluator_->explain_end(reason); });
  }
  // Returns (objectives, constraints, status, clipped, residuals, Jacobians) with one row per
  // evaluated point.
  py::tuple evaluate(const Numbers& points, bool with_jacobian) {
    check_points(points, get().problem().variables, "X", false);
    if (with_jacobian && !get().problem().has_jacobian) {
      throw Error(ErrorKind::usage,
                  "this problem has no exact derivatives: " + get().problem().jacobian_advice);
    }
    std::vector<std::vector<double>> asked(static_cast<std::size_t>(points.shape(0)));
    for (std::size_t i = 0; i < asked.size(); ++i) {
      const auto row = get_row(points, static_cast<py::ssize_t>(i));
      asked[i].assign(row.begin(), row.end());
    }
    std::vector<Score> scores;
    guard([&] {
      if (!asked.empty()) {
        scores =
            with_jacobian ? evaluator_->evaluate_with_jacobian(asked) : evaluator_->evaluate(asked);
      }
    });
    evaluations_ += std::ssize(scores);
    return to_arrays(scores);
  }

  void close() { evaluator_ = nullptr; }
  // Throws again what the evaluator has thrown. That is a failure of the run, not of the optimizer.
  void rethrow_failure() const {
    if (failure_) {
      std::rethrow_exception(failure_);
    }
  }

 private:
  Evaluator& get() const {
    if (evaluator_ == nullptr) {
      throw Error(
          ErrorKind::usage,
          "the run of this evaluator is over; an evaluator can be used only within minimize()");
    }
    return *evaluator_;
  }

  // Makes a call without the GIL. Keeps its exception for rethrow_failure(); the Python class gets
  // another exception instead.
  void guard(const std::function<void()>& call) {
    get();
    try {
      rethrow_failure();
      const py::gil_scoped_release released;
      call();
    } catch (...) {
      failure_ = std::current_exception();
      throw std::runtime_error("the run cannot go on: let this exception pass");
    }
    host_.raise_held();
  }

  py::tuple to_arrays(const std::vector<Score>& scores) const {
    const ProblemDescription& problem = evaluator_->problem();
    const std::size_t n = scores.size(), objectives = problem.objectives.size(),
                      constraints = problem.constraints.size();
    Numbers values = make_matrix(n, objectives), violations = make_matrix(n, constraints);
    py::array_t<std::uint8_t> status(static_cast<py::ssize_t>(n));
    py::array_t<bool> clipped(static_cast<py::ssize_t>(n));
    double* value = values.mutable_data();
    double* violation = violations.mutable_data();
    bool has_residuals = false, has_jacobian = false;
    for (std::size_t i = 0; i < n; ++i) {
      const Score& score = scores[i];
      value = std::ranges::copy(score.objectives, value).out;
      // A failed evaluation has no constraint values. They count as infinitely violated.
      violation = score.constraint_values.empty()
                      ? std::fill_n(violation, constraints, kNothing)
                      : std::ranges::copy(score.constraint_values, violation).out;
      status.mutable_at(static_cast<py::ssize_t>(i)) = static_cast<std::uint8_t>(score.status);
      clipped.mutable_at(static_cast<py::ssize_t>(i)) = score.clipped;
      has_residuals = has_residuals || !score.residuals.empty();
      has_jacobian = has_jacobian || !score.jacobian.empty();
    }
    const auto collect = [&](bool is_there, auto member) -> py::object {
      if (!is_there) {
        return py::none();
      }
      std::vector<std::vector<double>> rows;
      for (const Score& score : scores) {
        rows.push_back(score.*member);
      }
      return make_ragged(rows);
    };
    return py::make_tuple(values, violations, status, clipped,
                          collect(has_residuals, &Score::residuals),
                          collect(has_jacobian, &Score::jacobian));
  }

  Evaluator* evaluator_;
  Host& host_;
  std::int64_t evaluations_ = 0;
  std::exception_ptr failure_;
};

// An optimizer that is a Python class.
class PythonOptimizer : public Optimizer {
 public:
  PythonOptimizer(std::string name, std::shared_ptr<py::object> run, Options options, Host& host)
      : name_(std::move(name)), run_(std::move(run)), options_(std::move(options)), host_(host) {}

  void minimize(Evaluator& evaluator, std::uint64_t seed) override {
    const py::gil_scoped_acquire gil;
    const auto bridge = std::make_shared<EvaluatorBridge>(evaluator, host_);
    try {
      py::dict values;
      for (const auto& [name, value] : options_.values()) {
        values[py::str(name)] =
            std::visit([](const auto& v) -> py::object { return py::cast(v); }, value);
      }
      (*run_)(bridge, values, seed);
      bridge->close();
    } catch (py::error_already_set& error) {
      bridge->close();
      bridge->rethrow_failure();
      if (!error.matches(PyExc_Exception)) {  // KeyboardInterrupt, SystemExit
        host_.hold(error);
        return;
      }
      fail(error, bridge->evaluations());
    }
    bridge->rethrow_failure();
  }

 private:
  [[noreturn]] void fail(const py::error_already_set& error, std::int64_t evaluations) const {
    const py::tuple words =
        py::module_::import("armwright.optimizer").attr("_explain_failure")(to_exception(error));
    throw OptimizerFailure(
        fmt::format("optimizer '{}', after {} evaluation{}: {}", name_, evaluations,
                    evaluations == 1 ? "" : "s", sanitize(words[0].cast<std::string>())),
        words[1].cast<std::vector<std::string>>());
  }

  std::string name_;
  std::shared_ptr<py::object> run_;
  Options options_;
  Host& host_;
};

OptimizerRow make_row(const py::tuple& optimizer, Host& host) {
  const auto name = optimizer[0].cast<std::string>();
  OptimizerRow row = read_host_row(name, optimizer[1].cast<std::string>());
  row.input_hashes = optimizer[2].cast<std::map<std::string, std::string>>();
  row.unavailable = {};
  row.make = [name, run = share(optimizer[3]),
              &host](const Options& options) -> std::unique_ptr<Optimizer> {
    return std::make_unique<PythonOptimizer>(name, run, options, host);
  };
  return row;
}

}  // namespace

namespace {

// The name, promise, outcome and detail of every check.
using Findings = std::vector<std::tuple<std::string, std::string, std::string, std::string>>;

Findings check_optimizer(const py::object& optimizer, const std::vector<std::string>& options) {
  Host host{py::none()};
  const OptimizerRow row = load_row(optimizer, host);
  const Options parsed = Options::parse(row.name, row.options, options);
  Findings findings;
  host.run([&] {
    for (const ContractCheck& check : contract_checks()) {
      if (host.stop().requested()) {
        return;
      }
      const ContractFinding found = run_contract_check(check, row, parsed);
      const char* outcome = found.outcome == ContractOutcome::held     ? "held"
                            : found.outcome == ContractOutcome::broken ? "broken"
                                                                       : "exempt";
      findings.emplace_back(check.name, check.promise, outcome, sanitize(found.detail));
    }
  });
  return findings;
}

}  // namespace

OptimizerRow load_row(const py::object& optimizer, Host& host) {
  if (py::isinstance<py::str>(optimizer)) {
    return load_optimizer(optimizer.cast<std::string>());
  }
  return make_row(optimizer.cast<py::tuple>(), host);
}

void add_optimizers(py::module_& module) {
  module.def("list_optimizers", [] {
    nlohmann::json list = nlohmann::json::array();
    for (const OptimizerRow& row : optimizer_table()) {
      list.push_back(describe(row));
    }
    return list.dump();
  });
  module.def("check_optimizer", &check_optimizer);
  // Throws Error{bad_data} if the description of a class contradicts itself.
  module.def("check_description", [](const std::string& name, const std::string& description) {
    return describe(read_host_row(name, description)).dump();
  });
  py::class_<EvaluatorBridge, std::shared_ptr<EvaluatorBridge>>(module, "Evaluator")
      .def("describe_problem", &EvaluatorBridge::describe_problem)
      .def("evaluate", &EvaluatorBridge::evaluate)
      .def("begin_generation", &EvaluatorBridge::begin_generation)
      .def("recommend", &EvaluatorBridge::recommend)
      .def("explain_end", &EvaluatorBridge::explain_end)
      .def_property_readonly("stopped", &EvaluatorBridge::stopped)
      .def_property_readonly("remaining", &EvaluatorBridge::remaining);
}

}  // namespace armwright::python
