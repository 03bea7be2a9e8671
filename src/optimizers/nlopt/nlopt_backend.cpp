#include "optimizers/nlopt/nlopt_backend.hpp"

#include "optimizers/interface/optimizer.hpp"

#ifdef ARMWRIGHT_WITH_NLOPT

#include <fmt/format.h>
#include <nlopt.h>

#include <algorithm>
#include <memory>
#include <span>
#include <type_traits>

#include "optimizers/interface/scalar_function.hpp"
#include "optimizers/nlopt/nlopt_adapter.hpp"

namespace armwright {
namespace {

using NloptHandle = std::unique_ptr<std::remove_pointer_t<nlopt_opt>, decltype(&nlopt_destroy)>;

// ORIG_DIRECT allocates memory for all its evaluations at once; for 100 000 if it does not know
// their number. This many need a few hundred MiB.
constexpr std::int64_t kMostPacedEvaluations = 1'000'000;

// The smallest first step of a restart, as a share of the box. Below it coordinates stop changing.
constexpr double kSmallestRestartScale = 1e-9;

struct ConstraintQuestion {
  NloptAdapter* questions = nullptr;
  std::size_t index = 0;
};

// NLopt asks for no gradient with a null pointer.
std::span<double> get_gradient(double* gradient, unsigned n) {
  return {gradient, gradient == nullptr ? 0 : n};
}

double call_objective(unsigned n, const double* x, double* gradient, void* data) {
  return static_cast<NloptAdapter*>(data)->ask_objective({x, n}, get_gradient(gradient, n));
}

double call_constraint(unsigned n, const double* x, double* gradient, void* data) {
  const auto& question = *static_cast<ConstraintQuestion*>(data);
  return question.questions->ask_constraint({x, n}, question.index, get_gradient(gradient, n));
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
    const nlopt_result result = search();
    if (!is_over()) {
      evaluator_.explain_end(explain(result));
    }
  }

 private:
  // Returns how the last descent ended.
  nlopt_result search() {
    const SearchSpace& space = questions_.space();
    nlopt_result result = descend(space.start(), 1);
    double scale = 1;
    for (std::int64_t restart = 1; restart <= settings_.restarts && !is_over(); ++restart) {
      scale *= 0.5;
      if (!questions_.has_best() || scale < kSmallestRestartScale) {
        return result;
      }
      std::vector<double> from = questions_.best_coordinates();
      for (std::size_t i = 0; i < from.size(); ++i) {  // where it was evaluated
        from[i] = std::clamp(from[i], space.lower()[i], space.upper()[i]);
      }
      const auto before = questions_.best_rank();
      result = descend(from, scale);
      if (!(questions_.best_rank() < before)) {
        return result;
      }
    }
    return result;
  }

  static std::string explain(nlopt_result result) {
    switch (result) {
      case NLOPT_XTOL_REACHED:
        return "its steps are smaller than xtol_rel";
      case NLOPT_FTOL_REACHED:
        return "its gains are smaller than ftol_rel";
      case NLOPT_ROUNDOFF_LIMITED:
        return "rounding errors prevent further progress";
      default:
        return fmt::format("NLopt reports {}", nlopt_result_to_string(result));
    }
  }

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
    // MLSL reads this array even if it was never set.
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

  // Sets the step of every coordinate, in the NLopt solver that uses steps.
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

  nlopt_result descend(std::vector<double> from, double scale) {
    if (local_) {
      set_step(local_.get(), from, scale);
      apply(nlopt_set_local_optimizer(solver_.get(), local_.get()), "option 'local'");
    } else {
      set_step(solver_.get(), from, scale);
    }
    questions_.begin([this] { nlopt_force_stop(solver_.get()); });
    double value = 0;
    const nlopt_result result = nlopt_optimize(solver_.get(), from.data(), &value);
    questions_.rethrow();
    // The point that NLopt returns is not used, since the evaluator knows the best one (COBYLA
    // returns its last point).
    // SLSQP calls it a failure if a rough objective leaves it no step.
    const bool is_normal_end = result > 0 || result == NLOPT_ROUNDOFF_LIMITED ||
                               result == NLOPT_FORCED_STOP ||
                               (result == NLOPT_FAILURE && settings_.differences);
    if (!is_normal_end && !is_over()) {
      const char* message = nlopt_get_errmsg(solver_.get());
      throw OptimizerFailure(fmt::format(
          "optimizer '{}': NLopt's {} ended with {}{}{} on {} variables and {} constraints",
          settings_.optimizer, settings_.algorithm, nlopt_result_to_string(result),
          message == nullptr ? "" : ": ", message == nullptr ? "" : message, from.size(),
          evaluator_.problem().constraints.size()));
    }
    return result;
  }

  const NloptSettings& settings_;
  Evaluator& evaluator_;
  NloptAdapter questions_;
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
