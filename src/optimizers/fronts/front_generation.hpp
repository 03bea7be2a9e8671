// The generations of mode and nsga3: the first population, the evaluation of a generation, and the
// options that both have.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "base/random.hpp"
#include "optimizers/fronts/front_order.hpp"
#include "optimizers/interface/optimizer.hpp"
#include "optimizers/interface/search_space.hpp"

namespace armwright {

// Evaluates whole generations. Integers and categories are real variables here, which the evaluator
// rounds (treated_problem.hpp). The evaluator must outlive this object.
class FrontGeneration {
 public:
  explicit FrontGeneration(Evaluator& evaluator);

  const SearchSpace& space() const { return space_; }
  // Returns the start and members drawn around it (SearchSpace::draw_population), not evaluated.
  std::vector<FrontMember> make_first(std::size_t size, double spread, RandomStream& random) const;
  // Begins a generation and evaluates the children as one batch. If the training cases have
  // changed, the batch has the parents too, so that all numbers belong to the same cases. Returns
  // false if the evaluator stopped before the end of the batch; the members are then of no use.
  bool evaluate(std::vector<FrontMember>& parents, std::vector<FrontMember>& children);
  // Returns whether the last call of evaluate() evaluated the parents again.
  bool has_changed_cases() const { return has_changed_cases_; }

 private:
  Evaluator& evaluator_;
  SearchSpace space_;
  std::uint64_t case_changes_ = 0;
  bool has_changed_cases_ = false;
};

// Returns the row of an optimizer for fronts: its capabilities and requirements.
OptimizerRow make_front_row(std::string_view name);
// Return the row of each optimizer.
OptimizerRow make_mode_row();
OptimizerRow make_nsga3_row();

// Returns the rows mode and nsga3.
std::vector<OptimizerRow> make_front_rows();

}  // namespace armwright
