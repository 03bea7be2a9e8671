#include "optimizers/pagmo/pagmo_options.hpp"

#include <utility>

#include "optimizers/interface/search_space.hpp"

namespace armwright::pagmo_options {

OptionSpec number(std::string name, std::string description, double fallback, double lower,
                  double upper) {
  return {.name = std::move(name),
          .description = std::move(description),
          .fallback = fallback,
          .lower = lower,
          .upper = upper};
}

OptionSpec count(std::string name, std::string description, std::int64_t fallback, double lower,
                 double upper) {
  OptionSpec spec = number(std::move(name), std::move(description), 0, lower, upper);
  spec.fallback = fallback;  // which makes it an integer
  return spec;
}

OptionSpec choice(std::string name, std::string description, std::vector<std::string> choices) {
  const std::string first = choices.front();
  return {.name = std::move(name),
          .description = std::move(description),
          .fallback = first,
          .choices = std::move(choices)};
}

std::vector<OptionSpec> population(std::int64_t size, double fewest, std::vector<OptionSpec> others,
                                   std::string description) {
  std::vector<OptionSpec> options = {
      count("population", std::move(description), size, fewest, 100000), make_spread_option()};
  options.insert(options.end(), others.begin(), others.end());
  return options;
}

}  // namespace armwright::pagmo_options
