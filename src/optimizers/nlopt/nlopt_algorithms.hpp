// The algorithms of NLopt that work without exact gradients, and their known properties. This header
// needs no NLopt: the table is the same in builds with and without it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

// Returns one row per algorithm. In a build without NLopt they say so and cannot be used.
std::vector<OptimizerRow> make_nlopt_rows();

// The way in which an algorithm searches. It decides which options the algorithm has.
enum class NloptKind {
  local,     // searches from the start with a step, and ends
  dividing,  // DIRECT: divides the box
  drawing,   // draws populations of random points
  starting,  // MLSL: starts a local optimizer many times
  wrapping,  // AUGLAG: a local optimizer on an augmented Lagrangian
  covering   // AGS: follows a space-filling curve
};

// One algorithm of NLopt 2.7.1, with properties that its documentation does not mention.
struct NloptAlgorithm {
  std::string name;        // without "nlopt:"
  std::string nlopt_name;  // NLopt's own name without its prefix
  NloptKind kind = NloptKind::local;
  std::string summary;
  std::string source;
  bool takes_constraints = false;
  bool takes_gradients = false;  // it gets them by differences of evaluations
  bool is_stochastic = false;
  bool leaves_box = false;
  // It can loop forever without asking for a point. Only the end of its process stops it then.
  bool isolated = false;
  std::int64_t restarts = 20;  // default of the option, for algorithms that end
  bool needs_pace = false;     // it needs the number of evaluations, only to allocate its storage
  int smallest_dimension = 1;
  int largest_dimension = 0;  // 0: any
  std::string unfit = {};     // why armwright does not offer it; empty: it does
};

const std::vector<NloptAlgorithm>& nlopt_algorithms();
// Returns the algorithm of that name, which must be in the table.
const NloptAlgorithm& find_nlopt_algorithm(const std::string& name);

}  // namespace armwright
