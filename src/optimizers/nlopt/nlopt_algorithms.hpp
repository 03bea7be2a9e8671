// The gradient-free algorithms of NLopt and what is known about each. No part of the library: the
// table is the same whether armwright was built with NLopt or not.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace armwright {

// How an algorithm searches, which decides on its options.
enum class NloptKind {
  local,     // from the start, with a step; ends by itself
  dividing,  // DIRECT: cuts the box up
  drawing,   // populations of random points
  starting,  // MLSL: starts a local optimizer again and again
  wrapping,  // AUGLAG: a local optimizer under multipliers
  covering   // AGS: a space-filling curve
};

// What NLopt 2.7.1 is known for beyond its documentation.
struct NloptAlgorithm {
  std::string name;        // behind "nlopt:"
  std::string nlopt_name;  // without its prefix
  NloptKind kind = NloptKind::local;
  std::string summary;
  std::string source;
  bool takes_constraints = false;
  bool is_stochastic = false;
  bool leaves_box = false;
  // It can go round in circles without asking for a point, and then nothing inside this process
  // stops it.
  bool isolated = false;
  std::int64_t restarts = 20;  // of those that end by themselves
  bool needs_pace = false;     // is told the number of evaluations, for its storage only
  int smallest_dimension = 1;
  int largest_dimension = 0;  // 0: any
  std::string unfit = {};     // why it is not offered, although the library has it
};

const std::vector<NloptAlgorithm>& nlopt_algorithms();
const NloptAlgorithm& find_nlopt_algorithm(const std::string& name);  // one that is there

}  // namespace armwright
