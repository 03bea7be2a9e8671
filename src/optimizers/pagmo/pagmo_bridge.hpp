// An Evaluator as pagmo wants to see a problem. No header of pagmo is needed for it: pagmo takes
// any class that has the members it calls.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "optimizers/interface/scalar_function.hpp"
#include "optimizers/pagmo/pagmo_backend.hpp"

namespace armwright {

// Scores as pagmo's fitness vectors: objectives first, then constraints.
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
  // An exception passed through the library that is not the library's own.
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

// The problem, default-constructible and copyable as pagmo wants it. All copies share the bridge.
struct BridgedPagmoProblem {
  PagmoBridge* bridge = nullptr;

  std::vector<double> fitness(const std::vector<double>& coordinates) const {
    return bridge->evaluate({&coordinates, 1}).front();
  }
  // pagmo lays points and fitness vectors end to end.
  std::vector<double> batch_fitness(const std::vector<double>& all) const;

  std::pair<std::vector<double>, std::vector<double>> get_bounds() const {
    return {bridge->space().lower(), bridge->space().upper()};
  }
  // pagmo asks a default-constructed one for these as well.
  std::size_t get_nobj() const { return bridge == nullptr ? 1 : bridge->objective_count(); }
  std::size_t get_nic() const { return bridge == nullptr ? 0 : bridge->constraint_count(); }
};

}  // namespace armwright
