// Loading a study makes its optimizers but runs none. And a name in it can be a program to start or
// a library to open: nothing that a fuzzer has made up is ever run.
#include "base/error.hpp"
#include "optimizers/builtin/random_search.hpp"
#include "optimizers/ceres/ceres_backend.hpp"
#include "optimizers/cma/cma_search.hpp"
#include "optimizers/dfls/dfls_search.hpp"
#include "optimizers/fronts/front_generation.hpp"
#include "optimizers/nlopt/nlopt_algorithms.hpp"
#include "optimizers/pagmo/pagmo_backend.hpp"
#include "optimizers/plugins/plugin_library.hpp"
#include "optimizers/plugins/plugin_process.hpp"
#include "optimizers/table/auto.hpp"
#include "optimizers/turbo/turbo.hpp"

namespace armwright {

std::vector<OptimizerRow> make_auto_rows() {
  return {};
}
std::vector<OptimizerRow> make_cmaes_rows() {
  return {};
}
std::vector<OptimizerRow> make_dfls_rows() {
  return {};
}
std::vector<OptimizerRow> make_turbo_rows() {
  return {};
}
std::vector<OptimizerRow> make_front_rows() {
  return {};
}
std::vector<OptimizerRow> make_ceres_rows() {
  return {};
}
std::vector<OptimizerRow> make_pagmo_rows() {
  return {};
}
// The local search that stands in every comparison.
std::vector<OptimizerRow> make_nlopt_rows() {
  std::vector<OptimizerRow> rows = make_random_search_rows();
  rows.front().name = "nlopt:neldermead";
  rows.front().capabilities.local = true;
  return rows;
}

OptimizerRow load_process_plugin(std::string_view /*command*/, double /*loading_s*/) {
  throw Error(ErrorKind::usage, "fuzzers start no programs");
}

OptimizerRow load_library_plugin(const std::filesystem::path& /*file*/, const std::string& /*name*/,
                                 const ProcessLimits& /*loading*/) {
  throw Error(ErrorKind::usage, "fuzzers open no libraries");
}

bool is_library_name(std::string_view name) {
  return name.find('/') != name.npos || name.ends_with(".so");
}

std::optional<std::filesystem::path> find_library_plugin(std::string_view /*name*/) {
  return std::nullopt;
}

}  // namespace armwright
