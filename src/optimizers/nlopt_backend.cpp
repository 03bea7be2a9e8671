#include "optimizers/nlopt_backend.hpp"

#include "optimizers/optimizer.hpp"

#ifdef ARMWRIGHT_WITH_NLOPT

#include <fmt/format.h>
#include <nlopt.h>

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>
#include <exception>
#include <memory>
#include <type_traits>
#include <utility>

#include "base/bits.hpp"
#include "optimizers/scalar_function.hpp"
#include "optimizers/seed.hpp"

namespace armwright {
namespace {

using NloptHandle = std::unique_ptr<std::remove_pointer_t<nlopt_opt>, decltype(&nlopt_destroy)>;

// A failed evaluation violates every constraint by this: more than any design does, and still a
// number that linear models of the constraints survive.
constexpr double kFailedViolation = 1e9;

// COBYLA and PRAXIS can ask for NaN for ever once they have begun; after so many in a row the start
// is given up.
constexpr std::int64_t kLongestNanSequence = 1000;

// ORIG_DIRECT reserves room for all its evaluations at once, for 100 000 if it is not told how many
// there will be. So many fit into some hundreds of MiB.
constexpr std::int64_t kMostPacedEvaluations = 1'000'000;

// A restart steps at least this share of the box: below, coordinates stop changing.
constexpr double kSmallestRestartScale = 1e-9;

bool is_finite(std::span<const double> values) {
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

// What NLopt asks about, point by point: objective and constraints in separate calls.
class Questions {
 public:
  Questions(const NloptSettings& settings, Evaluator& evaluator)
      : settings_(settings), function_(evaluator) {}

  const SearchSpace& space() const { return function_.space(); }
  // Whom to tell when there is no more to come.
  void begin(nlopt_opt solver) {
    solver_ = solver;
    calls_ = 0;
    nan_sequence_ = 0;
  }
  bool has_ended() const { return has_stopped_ || exception_ != nullptr; }
  void rethrow() const {
    if (exception_) {
      std::rethrow_exception(exception_);
    }
  }

  bool has_best() const { return !best_.coordinates.empty(); }
  const std::vector<double>& best_coordinates() const { return best_.coordinates; }
  std::pair<double, double> best_rank() const { return {best_.violation, best_.objective}; }

  // Every question for the objective is an evaluation, as it is to the bare library, unless the
  // constraints at that point came first.
  double ask_objective(std::span<const double> coordinates) {
    ++calls_;
    Answer* answer = find(coordinates);
    if (answer == nullptr || answer->is_objective_used) {
      answer = evaluate(coordinates);
    }
    if (answer == nullptr) {
      return worst_objective_;
    }
    answer->is_objective_used = true;
    return answer->objective;
  }

  double ask_constraint(std::span<const double> coordinates, std::size_t index) {
    ++calls_;
    const Answer* answer = find(coordinates);
    if (answer == nullptr) {
      answer = evaluate(coordinates);
    }
    return answer == nullptr ? kFailedViolation : answer->constraint_values[index];
  }

 private:
  struct Answer {
    std::vector<double> coordinates = {};
    double objective = 0;
    std::vector<double> constraint_values = {};
    double violation = 0;
    bool is_objective_used = false;
  };

  Answer* find(std::span<const double> coordinates) {
    const auto found = std::ranges::find_if(
        answers_, [&](const Answer& answer) { return same_bits(answer.coordinates, coordinates); });
    return found == answers_.end() ? nullptr : &*found;
  }

  // Null if there is no answer: nobody is asked about points that are none, nor after the end.
  Answer* evaluate(std::span<const double> coordinates) {
    if (has_ended()) {
      stop_solver();
      return nullptr;
    }
    const std::vector<double> point = space().to_point(coordinates);
    if (!is_finite(point)) {
      if (++nan_sequence_ >= kLongestNanSequence) {
        stop_solver();
      }
      return nullptr;
    }
    nan_sequence_ = 0;
    try {
      return &remember(coordinates, function_.evaluate_point(point));
    } catch (const EvaluatorStopped&) {
      has_stopped_ = true;
    } catch (...) {
      exception_ = std::current_exception();  // C code lies between here and who waits for it
    }
    stop_solver();
    return nullptr;
  }

  // Not at the first point: ORIG_DIRECT stopped there reads what it has not written yet, and now
  // and then it crashes. It is stopped at the second.
  void stop_solver() {
    const std::int64_t calls_a_point = 1 + std::ssize(function_.evaluator().problem().constraints);
    if (calls_ > calls_a_point) {
      nlopt_force_stop(solver_);
    }
  }

  Answer& remember(std::span<const double> coordinates, const Score& score) {
    const ProblemDescription& problem = function_.evaluator().problem();
    Answer& answer = answers_[next_answer_];
    next_answer_ = (next_answer_ + 1) % answers_.size();
    answer.coordinates.assign(coordinates.begin(), coordinates.end());
    answer.is_objective_used = false;
    if (settings_.takes_constraints) {
      answer.objective = calc_scalar(problem, score.objectives);
      answer.constraint_values = score.constraint_values;
      answer.constraint_values.resize(problem.constraints.size(), kFailedViolation);
      answer.violation = 0;
      for (const double g : answer.constraint_values) {
        answer.violation += std::max(0.0, g);
      }
    } else {
      answer.objective = calc_merit(problem, score, settings_.constraint_weight);
    }
    const bool is_first = !has_best();
    if (is_first || std::pair{answer.violation, answer.objective} < best_rank()) {
      best_ = answer;
    }
    worst_objective_ = is_first ? answer.objective : std::max(worst_objective_, answer.objective);
    return answer;
  }

  const NloptSettings& settings_;
  ScalarFunction function_;
  nlopt_opt solver_ = nullptr;
  std::array<Answer, 8> answers_;  // the latest
  std::size_t next_answer_ = 0;
  Answer best_;
  double worst_objective_ = 0;
  std::int64_t calls_ = 0;  // of the current start, for objective or constraint
  std::int64_t nan_sequence_ = 0;
  bool has_stopped_ = false;
  std::exception_ptr exception_;
};

struct ConstraintQuestion {
  Questions* questions = nullptr;
  std::size_t index = 0;
};

double call_objective(unsigned n, const double* x, double* /*gradient*/, void* data) {
  return static_cast<Questions*>(data)->ask_objective({x, n});
}

double call_constraint(unsigned n, const double* x, double* /*gradient*/, void* data) {
  const auto& question = *static_cast<ConstraintQuestion*>(data);
  return question.questions->ask_constraint({x, n}, question.index);
}

class Search {
 public:
  Search(const NloptSettings& settings, Evaluator& evaluator)
      : settings_(settings),
        evaluator_(evaluator),
        questions_(settings, evaluator),
        solver_(create(settings.algorithm)),
        local_(nullptr, &nlopt_destroy) {
    if (!settings_.local.empty()) {
      local_ = create(settings_.local);
      set_tolerances(local_.get());
    }
    if (!settings_.tolerances_are_local) {
      set_tolerances(solver_.get());
    }
    apply(nlopt_set_min_objective(solver_.get(), call_objective, &questions_), "the objective");
    if (settings_.takes_constraints) {
      constraints_.resize(evaluator.problem().constraints.size());
      for (std::size_t i = 0; i < constraints_.size(); ++i) {
        constraints_[i] = {&questions_, i};
        apply(nlopt_add_inequality_constraint(solver_.get(), call_constraint, &constraints_[i], 0),
              "constraints");
      }
    }
    if (settings_.population > 0) {
      apply(nlopt_set_population(solver_.get(), static_cast<unsigned>(settings_.population)),
            "option 'population'");
    }
    if (settings_.is_paced) {
      const std::int64_t most =
          std::clamp(evaluator.remaining(), std::int64_t{1}, kMostPacedEvaluations);
      apply(nlopt_set_maxeval(solver_.get(), static_cast<int>(most)), "maxeval");
    }
  }

  void run() {
    const SearchSpace& space = questions_.space();
    descend(space.start(), 1);
    double scale = 1;
    for (std::int64_t restart = 1; restart <= settings_.restarts && !is_over(); ++restart) {
      scale *= 0.5;
      if (!questions_.has_best() || scale < kSmallestRestartScale) {
        return;
      }
      std::vector<double> from = questions_.best_coordinates();
      for (std::size_t i = 0; i < from.size(); ++i) {  // where it was evaluated
        from[i] = std::clamp(from[i], space.lower()[i], space.upper()[i]);
      }
      const auto before = questions_.best_rank();
      descend(from, scale);
      if (!(questions_.best_rank() < before)) {
        return;
      }
    }
  }

 private:
  bool is_over() const { return questions_.has_ended() || evaluator_.stopped(); }

  NloptHandle create(const std::string& algorithm) const {
    const SearchSpace& space = questions_.space();
    const nlopt_algorithm number = nlopt_algorithm_from_string(algorithm.c_str());
    NloptHandle handle(
        number < 0 ? nullptr : nlopt_create(number, static_cast<unsigned>(space.dimension())),
        &nlopt_destroy);
    if (!handle) {
      throw OptimizerFailure(
          fmt::format("optimizer '{}': this NLopt has no {}", settings_.optimizer, algorithm));
    }
    apply(nlopt_set_lower_bounds(handle.get(), space.lower().data()), "the bounds");
    apply(nlopt_set_upper_bounds(handle.get(), space.upper().data()), "the bounds");
    // MLSL reads this array whether it is there or not.
    const std::vector<double> none(space.dimension(), 0.0);
    apply(nlopt_set_xtol_abs(handle.get(), none.data()), "xtol_abs");
    return handle;
  }

  void apply(nlopt_result result, const char* what) const {
    if (result < 0) {
      throw OptimizerFailure(fmt::format("optimizer '{}': NLopt refuses {}: {}",
                                         settings_.optimizer, what,
                                         nlopt_result_to_string(result)));
    }
  }

  void set_tolerances(nlopt_opt solver) const {
    apply(nlopt_set_xtol_rel(solver, settings_.xtol_rel), "option 'xtol_rel'");
    apply(nlopt_set_ftol_rel(solver, settings_.ftol_rel), "option 'ftol_rel'");
  }

  // The step in every coordinate, and into NLopt's solver that takes steps.
  void set_step(nlopt_opt solver, std::span<const double> from, double scale) const {
    const SearchSpace& space = questions_.space();
    std::vector<double> step(space.dimension());
    if (settings_.initial_step > 0) {
      for (std::size_t i = 0; i < step.size(); ++i) {
        step[i] = scale * settings_.initial_step * (space.upper()[i] - space.lower()[i]);
      }
    } else if (scale == 1) {
      return;  // its own
    } else {
      apply(nlopt_set_default_initial_step(solver, from.data()), "its own initial step");
      apply(nlopt_get_initial_step(solver, from.data(), step.data()), "its own initial step");
      std::ranges::for_each(step, [scale](double& value) { value *= scale; });
    }
    apply(nlopt_set_initial_step(solver, step.data()), "option 'initial_step'");
  }

  void descend(std::vector<double> from, double scale) {
    if (local_) {
      set_step(local_.get(), from, scale);
      apply(nlopt_set_local_optimizer(solver_.get(), local_.get()), "option 'local'");
    } else {
      set_step(solver_.get(), from, scale);
    }
    questions_.begin(solver_.get());
    double value = 0;
    const nlopt_result result = nlopt_optimize(solver_.get(), from.data(), &value);
    questions_.rethrow();
    // What it found is not read: the evaluator knows better (COBYLA returns its last point).
    const bool is_normal_end =
        result > 0 || result == NLOPT_ROUNDOFF_LIMITED || result == NLOPT_FORCED_STOP;
    if (!is_normal_end && !is_over()) {
      const char* message = nlopt_get_errmsg(solver_.get());
      throw OptimizerFailure(fmt::format(
          "optimizer '{}': NLopt's {} ended with {}{}{} on {} variables and {} constraints",
          settings_.optimizer, settings_.algorithm, nlopt_result_to_string(result),
          message == nullptr ? "" : ": ", message == nullptr ? "" : message, from.size(),
          evaluator_.problem().constraints.size()));
    }
  }

  const NloptSettings& settings_;
  Evaluator& evaluator_;
  Questions questions_;
  std::vector<ConstraintQuestion> constraints_;
  NloptHandle solver_;
  NloptHandle local_;
};

}  // namespace

std::string explain_missing_nlopt() {
  return "";
}

void minimize_with_nlopt(const NloptSettings& settings, Evaluator& evaluator, std::uint64_t seed) {
  if (evaluator.stopped()) {
    return;
  }
  nlopt_srand(fold_seed(seed));  // of this thread; by the time of day otherwise
  Search(settings, evaluator).run();
}

}  // namespace armwright

#else

namespace armwright {

std::string explain_missing_nlopt() {
  return "built without NLopt (CMake option ARMWRIGHT_WITH_NLOPT is OFF)";
}

void minimize_with_nlopt(const NloptSettings& settings, Evaluator& /*evaluator*/,
                         std::uint64_t /*seed*/) {
  throw OptimizerFailure("optimizer '" + settings.optimizer + "': " + explain_missing_nlopt());
}

}  // namespace armwright

#endif
