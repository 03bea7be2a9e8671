#include "optimizers/pagmo/pagmo_options.hpp"

#include <utility>

namespace armwright::pagmo_options {
namespace {

// A wide first population is wasted on robots: with gains that are drawn over two decades, 93 % of
// the arms become unstable. A share of 0.15 of such a box is a factor of 2 in both directions.
constexpr double kSpread = 0.15;

}  // namespace

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
      count("population", std::move(description), size, fewest, 100000),
      number("spread",
             "size of the box about the start, as a share of the whole box, from which the first "
             "population is drawn; 1: the whole box",
             kSpread, 0, 1)};
  options.insert(options.end(), others.begin(), others.end());
  return options;
}

}  // namespace armwright::pagmo_options
