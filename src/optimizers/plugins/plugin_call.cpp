#include "optimizers/plugins/plugin_call.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <exception>
#include <limits>
#include <vector>

#include "base/text.hpp"
#include "process/parent_link.hpp"

namespace armwright {
namespace {

// The problem in the form of the C interface, with the memory that it points to.
class ProblemView {
 public:
  explicit ProblemView(const ProblemDescription& problem) {
    for (const DecisionVariable& variable : problem.variables) {
      names_.push_back(variable.name.c_str());
      units_.push_back(variable.unit.c_str());
      lower_.push_back(variable.lower);
      upper_.push_back(variable.upper);
      start_.push_back(variable.start);
      is_logarithmic_.push_back(variable.scale == Scale::logarithmic ? 1 : 0);
      types_.push_back(static_cast<std::uint8_t>(variable.type));
      std::vector<const char*>& words = words_.emplace_back();
      for (const std::string& choice : variable.choices) {
        words.push_back(choice.c_str());
      }
      choices_.push_back(words.empty() ? nullptr : words.data());
    }
    for (const Quantity& objective : problem.objectives) {
      objectives_.push_back(objective.name.c_str());
      objective_units_.push_back(objective.unit.c_str());
    }
    for (const Quantity& constraint : problem.constraints) {
      constraints_.push_back(constraint.name.c_str());
      constraint_units_.push_back(constraint.unit.c_str());
    }
    raw = {.struct_size = sizeof raw,
           .name = problem.name.c_str(),
           .dimension = names_.size(),
           .variable_names = names_.data(),
           .variable_units = units_.data(),
           .lower = lower_.data(),
           .upper = upper_.data(),
           .start = start_.data(),
           .is_logarithmic = is_logarithmic_.data(),
           .objective_count = objectives_.size(),
           .objective_names = objectives_.data(),
           .constraint_count = constraints_.size(),
           .constraint_names = constraints_.data(),
           .objective_units = objective_units_.data(),
           .constraint_units = constraint_units_.data(),
           .objective_weights =
               problem.objective_weights.empty() ? nullptr : problem.objective_weights.data(),
           .has_residuals = problem.has_residuals ? std::size_t{1} : std::size_t{0},
           .variable_types = types_.data(),
           .variable_choices = choices_.data()};
  }
  ProblemView(const ProblemView&) = delete;
  ProblemView& operator=(const ProblemView&) = delete;

  struct armwright_problem raw {};

 private:
  std::vector<const char*> names_;
  std::vector<const char*> units_;
  std::vector<double> lower_;
  std::vector<double> upper_;
  std::vector<double> start_;
  std::vector<std::uint8_t> is_logarithmic_;
  std::vector<std::uint8_t> types_;
  std::vector<std::vector<const char*>> words_;
  std::vector<const char* const*> choices_;  // into words_
  std::vector<const char*> objectives_;
  std::vector<const char*> constraints_;
  std::vector<const char*> objective_units_;
  std::vector<const char*> constraint_units_;
};

class Call {
 public:
  Call(const Options& options, Evaluator& evaluator) : options_(options), evaluator_(evaluator) {}

  struct armwright_evaluator make_evaluator() {
    return {.struct_size = sizeof(struct armwright_evaluator),
            .context = this,
            .evaluate = [](void* self, const double* points, std::size_t count, double* objectives,
                           double* constraint_values, std::int32_t* statuses) -> std::size_t {
              return guard(self, std::size_t{0}, [&](Call& call) {
                return call.evaluate(points, count, objectives, constraint_values, statuses);
              });
            },
            .stopped = [](void* self) -> int {
              return guard(self, 1, [](Call& call) { return call.evaluator_.stopped() ? 1 : 0; });
            },
            .remaining = [](void* self) -> std::int64_t {
              return guard(self, std::int64_t{0},
                           [](Call& call) { return call.evaluator_.remaining(); });
            },
            .begin_generation =
                [](void* self) {
                  guard(self, 0, [](Call& call) { return call.evaluator_.begin_generation(), 0; });
                },
            .recommend =
                [](void* self, const double* point) {
                  guard(self, 0, [&](Call& call) {
                    call.evaluator_.recommend({point, call.dimension()});
                    return 0;
                  });
                },
            .residuals = [](void* self, std::size_t point, std::size_t* count) -> const double* {
              return static_cast<Call*>(self)->get_residuals(point, count);
            },
            .is_clipped = [](void* self, std::size_t point) -> int {
              const std::vector<Score>& scores = static_cast<Call*>(self)->scores_;
              return point < scores.size() && scores[point].clipped ? 1 : 0;
            }};
  }

  struct armwright_options make_options() {
    return {.struct_size = sizeof(struct armwright_options),
            .context = this,
            .get_bool = [](void* self, const char* name) -> int {
              return guard(self, 0, [&](Call& call) { return call.get<bool>(name) ? 1 : 0; });
            },
            .get_integer = [](void* self, const char* name) -> std::int64_t {
              return guard(self, std::int64_t{0},
                           [&](Call& call) { return call.get<std::int64_t>(name); });
            },
            .get_number = [](void* self, const char* name) -> double {
              return guard(self, 0.0, [&](Call& call) { return call.get<double>(name); });
            },
            .get_text = [](void* self, const char* name) -> const char* {
              return guard(self, static_cast<const char*>(""),
                           [&](Call& call) { return call.get<std::string>(name).c_str(); });
            }};
  }

  void rethrow_held() const {
    if (held_) {
      std::rethrow_exception(held_);
    }
  }

 private:
  // After the first exception every function answers as if the run had stopped.
  template <typename Result, typename Body>
  static Result guard(void* self, Result at_the_end, Body&& body) {
    Call& call = *static_cast<Call*>(self);
    if (call.held_) {
      return at_the_end;
    }
    try {
      return body(call);
    } catch (...) {
      call.held_ = std::current_exception();
    }
    return at_the_end;
  }

  std::size_t dimension() const { return evaluator_.problem().variables.size(); }

  std::size_t evaluate(const double* points, std::size_t count, double* objectives,
                       double* constraint_values, std::int32_t* statuses) {
    std::vector<std::vector<double>> asked;
    for (std::size_t i = 0; i < count; ++i) {
      asked.emplace_back(points + i * dimension(), points + (i + 1) * dimension());
    }
    scores_ = evaluator_.evaluate(asked);
    const std::size_t constraint_count = evaluator_.problem().constraints.size();
    for (std::size_t i = 0; i < scores_.size(); ++i) {
      const Score& score = scores_[i];
      if (objectives != nullptr) {
        objectives = std::ranges::copy(score.objectives, objectives).out;
      }
      if (constraint_values != nullptr) {
        constraint_values = score.constraint_values.size() == constraint_count
                                ? std::ranges::copy(score.constraint_values, constraint_values).out
                                : std::fill_n(constraint_values, constraint_count,
                                              std::numeric_limits<double>::quiet_NaN());
      }
      if (statuses != nullptr) {
        statuses[i] = static_cast<std::int32_t>(score.status);
      }
    }
    return scores_.size();
  }

  const double* get_residuals(std::size_t point, std::size_t* count) const {
    *count = point < scores_.size() ? scores_[point].residuals.size() : 0;
    return *count == 0 ? nullptr : scores_[point].residuals.data();
  }

  template <typename Value>
  const Value& get(const char* name) const {
    const auto found = options_.values().find(name == nullptr ? "" : name);
    if (found == options_.values().end() || !std::holds_alternative<Value>(found->second)) {
      throw ChildFailure(fmt::format(
          "asked for option '{}', which it has not declared or declared as another type",
          sanitize(name == nullptr ? "" : name)));
    }
    return std::get<Value>(found->second);
  }

  const Options& options_;
  Evaluator& evaluator_;
  std::vector<Score> scores_;  // of the latest evaluate()
  std::exception_ptr held_;
};

}  // namespace

void call_plugin(const struct armwright_plugin& plugin, const Options& options,
                 Evaluator& evaluator, std::uint64_t seed) {
  static_assert(static_cast<int>(EvaluationStatus::ok) == ARMWRIGHT_OK &&
                static_cast<int>(EvaluationStatus::diverged) == ARMWRIGHT_DIVERGED &&
                static_cast<int>(EvaluationStatus::unreachable) == ARMWRIGHT_UNREACHABLE &&
                static_cast<int>(EvaluationStatus::timed_out) == ARMWRIGHT_TIMED_OUT &&
                static_cast<int>(EvaluationStatus::failed) == ARMWRIGHT_FAILED &&
                static_cast<int>(EvaluationStatus::abandoned) == ARMWRIGHT_ABANDONED);
  static_assert(static_cast<int>(VariableType::real) == ARMWRIGHT_REAL_VARIABLE &&
                static_cast<int>(VariableType::integer) == ARMWRIGHT_INTEGER_VARIABLE &&
                static_cast<int>(VariableType::category) == ARMWRIGHT_CATEGORY_VARIABLE);
  const ProblemView problem(evaluator.problem());
  Call call(options, evaluator);
  const struct armwright_evaluator raw_evaluator = call.make_evaluator();
  const struct armwright_options raw_options = call.make_options();
  std::array<char, 1024> message{};
  int status = 0;
  try {
    status = plugin.minimize(&problem.raw, &raw_evaluator, &raw_options, seed, message.data(),
                             message.size());
  } catch (const std::bad_alloc&) {
    throw;  // the child's memory limit speaks for itself
  } catch (const std::exception& error) {
    call.rethrow_held();
    throw ChildFailure(fmt::format("threw an exception ({})", sanitize(error.what())));
  } catch (...) {
    call.rethrow_held();
    throw ChildFailure("threw something that is no std::exception");
  }
  call.rethrow_held();
  message.back() = '\0';
  if (status == 0 && message[0] != '\0') {
    evaluator.explain_end(message.data());
  }
  if (status != 0) {
    throw ChildFailure(
        fmt::format("failed with code {} ({})", status,
                    message[0] == '\0' ? "it gave no reason" : sanitize(message.data())));
  }
}

}  // namespace armwright
