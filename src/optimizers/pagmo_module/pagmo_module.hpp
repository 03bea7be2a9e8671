// The border between the program and the module libarmwright_pagmo.so, which alone contains and
// needs pagmo. This header includes only the standard library.
//
// Exceptions cross the border in both directions: those of PagmoProblem::evaluate() come back out
// of PagmoSearch::evolve(), and pagmo's own are std::exceptions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace armwright {

// More generations than any budget allows. A method without a schedule of its own ends with the
// budget.
constexpr unsigned kEndlessGenerations = 1'000'000'000;

// The values that are known only when a run begins.
struct PagmoPlan {
  unsigned generations = kEndlessGenerations;  // for annealing: temperatures
  double scale = 1;  // what a temperature of 1 means: the magnitude of the objective at the start
  unsigned seed = 0;
};

// A checked set of options, as Options::values().
using PagmoOptions = std::map<std::string, std::variant<bool, std::int64_t, double, std::string>>;

// A problem in pagmo's coordinates. The program implements it.
class PagmoProblem {
 public:
  virtual ~PagmoProblem() = default;
  // Returns pagmo's fitness vectors of the points: the objectives, then the constraints.
  virtual std::vector<std::vector<double>> evaluate(
      std::span<const std::vector<double>> points) = 0;
  virtual std::pair<std::vector<double>, std::vector<double>> bounds() const = 0;
  virtual std::size_t objective_count() const = 0;
  virtual std::size_t constraint_count() const = 0;
  virtual std::size_t integer_count() const = 0;  // the last ones of the coordinates
};

// A run of one of pagmo's algorithms. The module implements it. All functions throw the exceptions
// of pagmo.
class PagmoSearch {
 public:
  virtual ~PagmoSearch() = default;
  // Begins an empty population. The problem must live until the next begin().
  virtual void begin(PagmoProblem& problem, unsigned seed) = 0;
  // Adds an evaluated individual.
  virtual void add(const std::vector<double>& point, const std::vector<double>& fitness) = 0;
  // Makes the algorithm anew.
  virtual void plan(const PagmoPlan& plan) = 0;
  // Lets the planned algorithm improve the population.
  virtual void evolve() = 0;
};

// The module's entry: makes a search by an algorithm with pagmo's name for it; the caller owns it. Throws an exception
// of pagmo if pagmo refuses the options.
using MakePagmoSearch = PagmoSearch*(const std::string& algorithm, const PagmoOptions& options);
inline constexpr const char* kPagmoEntry = "armwright_make_pagmo_search";

}  // namespace armwright
