// pagmo's algorithms by name. For pagmo_backend.cpp only: this header shows pagmo's types.
#pragma once

#include <pagmo/algorithm.hpp>
#include <string>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

// More generations than any budget holds: the methods without a schedule end with the budget.
constexpr unsigned kEndlessGenerations = 1'000'000'000;

// What is known only when a run begins.
struct PagmoPlan {
  unsigned generations = kEndlessGenerations;  // for annealing: temperatures
  double scale = 1;  // a temperature of 1: the magnitude of the objective at the start
  unsigned seed = 0;
};

// The algorithm with the row's options. Throws what pagmo throws at options it refuses.
pagmo::algorithm make_pagmo_algorithm(const std::string& name, const Options& options,
                                      const PagmoPlan& plan);

}  // namespace armwright
