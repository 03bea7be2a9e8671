// What both optimizers made of Ceres share; included by their .cpp files only.
#pragma once

#include <ceres/ceres.h>

#include <exception>

#include "optimizers/interface/evaluator.hpp"
#include "optimizers/interface/scalar_function.hpp"

namespace armwright {

constexpr double kCeresBoxWidth = 10;  // in the coordinates that Ceres sees

// Exceptions must not pass through Ceres: the first one is held, every later question answered with
// "failed" at once, and the held one thrown again when Ceres has returned.
class HeldException {
 public:
  bool any() const { return exception_ != nullptr; }

  // Whether `action` ran to its end and returned true.
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
