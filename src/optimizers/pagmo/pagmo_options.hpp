// Short functions that declare the options of pagmo's rows. Options keep pagmo's names, so that the
// documentation of pagmo explains them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "optimizers/interface/optimizer.hpp"

namespace armwright::pagmo_options {

OptionSpec number(std::string name, std::string description, double fallback, double lower,
                  double upper);
OptionSpec count(std::string name, std::string description, std::int64_t fallback, double lower,
                 double upper);
// Declares a choice. The first one is the default.
OptionSpec choice(std::string name, std::string description, std::vector<std::string> choices);

// Returns the options of the first population (its size with the smallest allowed one, and its
// width), followed by `others`.
std::vector<OptionSpec> population(std::int64_t size, double fewest,
                                   std::vector<OptionSpec> others = {},
                                   std::string description = "individuals");

}  // namespace armwright::pagmo_options
