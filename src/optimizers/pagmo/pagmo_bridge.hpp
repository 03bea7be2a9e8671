// An Evaluator in the form of a pagmo problem. This header needs no header of pagmo, because pagmo
// accepts any class with the member functions that it calls.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "optimizers/interface/scalar_function.hpp"
#include "optimizers/pagmo/pagmo_backend.hpp"

namespace armwright {

// Evaluates points and returns pagmo's fitness vectors: the objectives, then the constraints.
class PagmoBridge {
 public:
  PagmoBridge(const PagmoMethod& method, const Options& options, Evaluator& evaluator);

  const SearchSpace& space() const { return function_.space(); }
  const ProblemDescription& problem() const { return function_.evaluator().problem(); }
  std::size_t objective_count() const {
    return method_.multi_objective ? problem().objectives.size() : 1;
  }
  std::size_t constraint_count() const {
    return method_.constraints ? problem().constraints.size() : 0;
  }
  std::int64_t evaluation_count() const { return evaluation_count_; }
  // True after an exception of the evaluator has passed through pagmo.
  bool has_thrown() const { return has_thrown_; }

  std::vector<std::vector<double>> evaluate(std::span<const std::vector<double>> coordinates);

 private:
  void require_finite(std::span<const double> coordinates) const;
  std::vector<double> calc_fitness(const Score& score) const;

  const PagmoMethod& method_;
  double constraint_weight_;
  ScalarFunction function_;
  std::int64_t evaluation_count_ = 0;
  bool has_thrown_ = false;
};

// The problem as pagmo needs it: default-constructible and copyable. All copies share the bridge.
struct BridgedPagmoProblem {
  PagmoBridge* bridge = nullptr;

  std::vector<double> fitness(const std::vector<double>& coordinates) const {
    return bridge->evaluate({&coordinates, 1}).front();
  }
  // Evaluates many points. pagmo stores points and fitness vectors one after the other in one
  // vector.
  std::vector<double> batch_fitness(const std::vector<double>& all) const;

  std::pair<std::vector<double>, std::vector<double>> get_bounds() const {
    return {bridge->space().lower(), bridge->space().upper()};
  }
  // pagmo calls these on a default-constructed object as well.
  std::size_t get_nobj() const { return bridge == nullptr ? 1 : bridge->objective_count(); }
  std::size_t get_nic() const { return bridge == nullptr ? 0 : bridge->constraint_count(); }
};

}  // namespace armwright
