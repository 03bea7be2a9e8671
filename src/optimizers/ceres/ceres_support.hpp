// Code that both optimizers of Ceres share. Only their .cpp files include this header.
#pragma once

#include <exception>
#include <string_view>

#include "optimizers/ceres_module/ceres_module.hpp"
#include "optimizers/interface/scalar_function.hpp"
#include "process/module_loader.hpp"

namespace armwright {

constexpr double kCeresBoxWidth = 10;  // in the coordinates that Ceres sees

// Loads the module. Throws as load_module().
inline const CeresSolver& load_ceres(std::string_view user) {
  return *reinterpret_cast<GetCeresSolver*>(load_module(kCeresModule, kCeresEntry, user))();
}

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

}  // namespace armwright
