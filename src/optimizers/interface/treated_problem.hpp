// A problem as an optimizer can treat it. An optimizer that declares neither `integer` nor
// `categorical` gets real variables in place of discrete ones, and its evaluator rounds. Every
// evaluator that meets optimizers goes through this class, so that a problem is never asked for a
// value that is not of the variable's type.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

// Returns the variables as an optimizer with these capabilities can treat them. Without
// `categorical`, a category becomes an integer, the number of its word. Without `integer`, an
// integer becomes a real variable whose bounds are 0.5 further out, so that every whole number has
// an equal share of the range. The scale stays: a logarithmic integer is at least 1 in magnitude, so
// its new bounds keep their sign.
std::vector<DecisionVariable> adapt_variables(std::span<const DecisionVariable> variables,
                                              const Capabilities& capabilities);

class TreatedProblem {
 public:
  // A point of the optimizer, and what is evaluated in its place.
  struct Point {
    std::vector<double> x;  // every coordinate is a value of its variable's type
    // As the optimizer asked, within the bounds that it was given. Empty if that is x.
    std::vector<double> proposed;
    bool clipped = false;  // the optimizer asked for a point outside the bounds that it was given
  };

  // The description must outlive this object. It is copied only if the variables have to be adapted.
  TreatedProblem(const ProblemDescription& problem, const Capabilities& capabilities);

  // Returns the description that the optimizer gets.
  const ProblemDescription& description() const { return adapted_ ? *adapted_ : *problem_; }
  // Moves a point into the bounds and rounds it. NaN becomes the variable's start value. The point
  // must have one coordinate per variable.
  Point settle(std::span<const double> point) const;

 private:
  const ProblemDescription* problem_;
  bool has_discrete_;
  std::optional<ProblemDescription> adapted_;
};

}  // namespace armwright
