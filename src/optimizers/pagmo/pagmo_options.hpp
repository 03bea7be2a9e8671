// Short words for the options of pagmo's rows. Options keep pagmo's names, so that pagmo's
// documentation explains them.
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
// The first choice is the default.
OptionSpec choice(std::string name, std::string description, std::vector<std::string> choices);

// The first population: its size, the fewest that the method works with, how wide it lies; and then
// the others.
std::vector<OptionSpec> population(std::int64_t size, double fewest,
                                   std::vector<OptionSpec> others = {},
                                   std::string description = "individuals");

}  // namespace armwright::pagmo_options
