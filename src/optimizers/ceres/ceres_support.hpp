// Code that both optimizers of Ceres share. Only their .cpp files include this header.
#pragma once

#include <ceres/ceres.h>

#include <exception>

#include "optimizers/interface/evaluator.hpp"
#include "optimizers/interface/scalar_function.hpp"

namespace armwright {

constexpr double kCeresBoxWidth = 10;  // in the coordinates that Ceres sees

// Holds the first exception of the evaluator, since exceptions must not pass through Ceres. Every
// later call fails at once. The exception is thrown again when Ceres has returned.
class HeldException {
 public:
  bool any() const { return exception_ != nullptr; }

  // Runs `action` and returns its result. Returns false if it throws, or if an exception is already
  // held.
  template <typename Action>
  bool run(Action action) {
    if (any()) {
      return false;
    }
    try {
      return action();
    } catch (...) {
      exception_ = std::current_exception();
      return false;
    }
  }

  void rethrow_unless_stopped() const {
    if (!any()) {
      return;
    }
    try {
      std::rethrow_exception(exception_);
    } catch (const EvaluatorStopped&) {  // the run is over, which is no error
    }
  }

 private:
  std::exception_ptr exception_;
};

// Stops Ceres after an iteration if the evaluator has stopped or thrown.
class StopCallback : public ceres::IterationCallback {
 public:
  StopCallback(const HeldException& held, const Evaluator& evaluator)
      : held_(held), evaluator_(evaluator) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& /*summary*/) override {
    return held_.any() || evaluator_.stopped() ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
  }

 private:
  const HeldException& held_;
  const Evaluator& evaluator_;
};

}  // namespace armwright
