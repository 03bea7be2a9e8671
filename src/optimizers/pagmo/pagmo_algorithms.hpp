// Makes pagmo's algorithms by name. Only pagmo_backend.cpp includes this header, because it shows
// types of pagmo.
#pragma once

#include <pagmo/algorithm.hpp>
#include <string>

#include "optimizers/interface/optimizer.hpp"

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

// Makes the algorithm with the options of its row. Throws the exceptions of pagmo for options that
// pagmo refuses.
pagmo::algorithm make_pagmo_algorithm(const std::string& name, const Options& options,
                                      const PagmoPlan& plan);

}  // namespace armwright
