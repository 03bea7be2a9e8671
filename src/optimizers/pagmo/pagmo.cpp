// The rows of the pagmo algorithms: their options and what they need.

#include <utility>

#include "optimizers/interface/scalar_function.hpp"
#include "optimizers/pagmo/pagmo_backend.hpp"
#include "optimizers/pagmo/pagmo_options.hpp"
#include "process/module_loader.hpp"

namespace armwright {
namespace {

using namespace pagmo_options;

OptimizerRow make_row(PagmoMethod method, std::string summary, std::string source,
                      std::vector<OptionSpec> options, Capabilities others = {}) {
  if (method.row.empty()) {
    method.row = "pagmo:" + method.algorithm;
  }
  if (!method.constraints) {
    options.push_back(make_constraint_weight_option());
  }
  Capabilities capabilities = others;
  capabilities.constraints = method.constraints;
  capabilities.multi_objective = method.multi_objective;
  capabilities.batch = method.batch;
  capabilities.paced = method.paced;
  capabilities.stochastic = !method.ends;
  capabilities.integer = method.integer;
  return {.name = method.row,
          .summary = std::move(summary),
          .source = std::move(source),
          .capabilities = capabilities,
          .options = std::move(options),
          .make = [method](const Options& given) { return make_pagmo_optimizer(method, given); },
          .requirements = {.objectives = method.multi_objective ? 2 : 1},
          .backend = "pagmo (CMake option ARMWRIGHT_WITH_PAGMO)"};
}

OptionSpec adaptation_option() {
  return count("variant_adptv", "how F and CR adapt: 1 jDE, 2 iDE", 1, 1, 2);
}

OptimizerRow make_de_row(std::string name, std::string summary) {
  return make_row(
      {.row = std::move(name), .algorithm = "de"}, std::move(summary),
      "Storn and Price 1997, Differential evolution - a simple and efficient heuristic for global "
      "optimization over continuous spaces",
      population(24, 6,
                 {number("F", "weight of the difference of two individuals", 0.8, 0, 1),
                  number("CR", "probability that a coordinate is taken from the mutant", 0.9, 0, 1),
                  count("variant",
                        "how mutants are made (base/differences/crossover): 1 best/1/exp, 2 "
                        "rand/1/exp, 3 rand-to-best/1/exp, 4 best/2/exp, "
                        "5 rand/2/exp; 6 to 10: the same with /bin",
                        2, 1, 10)}));
}

std::vector<OptimizerRow> make_differential_evolution_rows() {
  return {
      make_de_row("pagmo:de", "Differential evolution"),
      make_de_row("de", "Differential evolution: another name of pagmo:de"),
      make_row({.algorithm = "sade"},
               "Differential evolution that adapts every individual's F and CR",
               "Brest, Greiner, Boskovic, Mernik and Zumer 2006, Self-adapting control parameters "
               "in differential evolution",
               population(
                   24, 8,
                   {count("variant",
                          "how mutants are made: 1 to 10 as in pagmo:de; 11 rand/3/exp, 12 "
                          "rand/3/bin, 13 best/3/exp, 14 best/3/bin; to current/2 15 exp, 16 bin; "
                          "to best and current/2 17 exp, 18 bin",
                          2, 1, 18),
                    adaptation_option()})),
      make_row({.algorithm = "de1220"},
               "Differential evolution that adapts F, CR and the way mutants are made",
               "Biscani and Izzo 2020, A parallel global multiobjective framework for "
               "optimization: pagmo",
               population(24, 8, {adaptation_option()})),
  };
}

std::vector<OptionSpec> swarm_options() {
  return population(
      24, 5,
      {number("omega", "inertia, or constriction coefficient", 0.7298, 0, 1),
       number("eta1", "pull towards a particle's own best point", 2.05, 0, 4),
       number("eta2", "pull towards its neighbours' best point", 2.05, 0, 4),
       number("max_vel", "largest step, as a share of the box", 0.1, 1e-6, 1),
       count("variant",
             "how velocities change: 1 to 4 with inertia (1 random factors for every coordinate "
             "and pull, 2 the same ones for both pulls, 3 one for each pull, 4 a single one), 5 "
             "constriction with factors as in 1, 6 fully informed",
             5, 1, 6),
       count("neighb_type",
             "who is whose neighbour: 1 all (gbest), 2 a ring (lbest), 3 von Neumann's lattice, 4 "
             "adaptive random",
             2, 1, 4),
       count("neighb_param", "neighbours of a particle, for lbest and adaptive random", 4, 1,
             1000)});
}

OptimizerRow make_particle_swarm_row(PagmoMethod method, std::string summary,
                                     std::vector<std::string> tuned_on, std::string tuning) {
  OptimizerRow row =
      make_row(std::move(method), std::move(summary),
               "Poli, Kennedy and Blackwell 2007, Particle swarm optimization: an overview",
               swarm_options());
  row.tuned_on = std::move(tuned_on);
  row.tuning = std::move(tuning);
  return row;
}

std::vector<OptionSpec> ant_options(std::vector<OptionSpec> others) {
  std::vector<OptionSpec> options =
      population(32, 8,
                 {count("ker", "solutions in the archive, at most population", 31, 2, 100000),
                  number("q", "the smaller, the faster it converges", 1, 0, 1e6),
                  count("threshold", "generation from which on q is 0.01", 1, 1, 1e9),
                  count("n_gen_mark", "generations over which the deviations shrink", 7, 1, 1e6),
                  number("focus", "the higher, the greedier", 0, 0, 1e12)});
  options.insert(options.end(), others.begin(), others.end());
  return options;
}

std::vector<OptimizerRow> make_swarm_rows() {
  return {
      make_particle_swarm_row({.algorithm = "pso"}, "Particle swarm, particles one after another",
                              {"irb4600_six", "planar2", "arm7"},
                              "max_vel has the best mean rank of four values there"),
      make_particle_swarm_row(
          {.algorithm = "pso_gen", .batch = true}, "Particle swarm, a generation at a time",
          {"q1-complex", "irb4600_six", "planar2", "arm7"},
          "max_vel was first chosen on q1-complex; on the other arms no value was significantly "
          "better"),
      make_row({.algorithm = "gwo", .paced = true},
               "Grey wolves: all close in on the best three, at the pace of the budget",
               "Mirjalili, Mirjalili and Lewis 2014, Grey wolf optimizer", population(24, 4)),
      make_row(
          {.algorithm = "bee_colony"}, "Artificial bee colony: abandons what does not improve",
          "Karaboga and Basturk 2007, A powerful and efficient algorithm for numerical "
          "function optimization: artificial bee colony (ABC) algorithm",
          population(20, 2,
                     {count("limit", "failures after which a source is abandoned", 20, 1, 1e6)})),
      make_row({.algorithm = "gaco", .batch = true, .constraints = true, .integer = true},
               "Extended ant colony: samples about an archive, oracle penalty",
               "Schlueter, Egea and Banga 2009, Extended ant colony optimization for non-convex "
               "mixed integer nonlinear programming",
               ant_options({number("oracle", "objective that the penalty takes as within reach", 0,
                                   0, 1e12),
                            number("acc", "smallest distance between penalties", 0.01, 0, 1e12)})),
  };
}

std::vector<OptionSpec> strategy_options(std::int64_t size) {
  return population(
      size, 5,
      {number("sigma0", "first step, as a share of the box", 0.07, 1e-6, 1),
       number("ftol", "begin again once the population's objectives differ by less", 0, 0, 1e12),
       number("xtol", "begin again once the steps are shorter", 1e-10, 0, 1e12)});
}

std::vector<OptimizerRow> make_evolution_rows() {
  return {
      make_row({.algorithm = "cmaes"}, "CMA-ES; points outside the box are moved to its bounds",
               "Hansen 2006, The CMA evolution strategy: a comparing review", strategy_options(12)),
      make_row({.algorithm = "xnes"},
               "xNES, an evolution strategy; points outside are moved to the bounds",
               "Glasmachers, Schaul, Sun, Wierstra and Schmidhuber 2010, Exponential natural "
               "evolution strategies",
               strategy_options(12)),
      make_row({.algorithm = "sea"}, "(N+1) evolution: mutates the best, replaces the worst",
               "Oliveto, He and Yao 2007, Time complexity of evolutionary algorithms for "
               "combinatorial optimization: a decade of results",
               population(5, 1)),
      make_row(
          {.algorithm = "sga", .integer = true},
          "Simple genetic algorithm with a choice of operators",
          "Holland 1975, Adaptation in natural and artificial systems",
          population(
              32, 2,
              {number("cr", "probability of crossover", 0.9, 0, 1),
               number("eta_c", "distribution index of crossover sbx", 1, 1, 100),
               number("m", "probability of mutation", 0.02, 0, 1),
               number("param_m",
                      "mutation polynomial: distribution index, 1 to 100; gaussian: width as a "
                      "share of the box, up to 1",
                      1, 0, 100),
               count("param_s", "size of the tournament, or number of the best kept", 2, 1, 100000),
               choice("crossover", "how children are made",
                      {"exponential", "binomial", "single", "sbx"}),
               choice("mutation", "how children change", {"polynomial", "gaussian", "uniform"}),
               choice("selection", "how parents are found", {"tournament", "truncated"})})),
      make_row({.algorithm = "ihs", .constraints = true, .paced = true, .integer = true},
               "Improved harmony search: steps shrink over the budget",
               "Mahdavi, Fesanghary and Damangir 2007, An improved harmony search algorithm for "
               "solving optimization problems",
               population(
                   20, 1,
                   {number("phmcr", "probability of choosing a coordinate from memory", 0.85, 0, 1),
                    number("ppar_min",
                           "probability of moving what was chosen (pitch adjustment), at first",
                           0.35, 0, 1),
                    number("ppar_max", "the same, at last", 0.99, 0, 1),
                    number("bw_min", "last step, as a share of the box", 1e-5, 0, 1),
                    number("bw_max", "first step, as a share of the box", 1, 0, 1)})),
  };
}

std::vector<OptionSpec> compass_options(double start_range, double stop_range) {
  return {number("start_range", "first step, as a share of the box", start_range, 1e-9, 1),
          number("stop_range", "last step, as a share of the box", stop_range, 1e-12, 1),
          number("reduction_coeff", "factor of the step where no direction improves", 0.5, 0, 1)};
}

std::vector<OptimizerRow> make_point_rows() {
  std::vector<OptionSpec> hopping = compass_options(0.05, 0.005);
  hopping.push_back(number("perturb", "length of a hop, as a share of the box", 0.05, 1e-9, 1));
  return {
      make_row(
          {.algorithm = "simulated_annealing", .paced = true},
          "Simulated annealing along the coordinates, cooling over the budget",
          "Corana, Marchesi, Martini and Ridella 1987, Minimizing multimodal functions of "
          "continuous variables with the simulated annealing algorithm",
          {number("Ts", "first temperature, as a share of the objective at the start", 0.1, 1e-12,
                  1e12),
           number("Tf", "last temperature, as a share of the objective at the start", 1e-4, 1e-12,
                  1e12),
           count("n_range_adj", "adjustments of the steps at each temperature", 1, 1, 1000),
           count("bin_size", "mutations of each coordinate between two adjustments", 10, 1, 1000),
           number("start_range", "first step, as a share of the box", 0.1, 1e-6, 1)}),
      make_row({.algorithm = "compass_search", .constraints = true, .ends = true},
               "Compass search: along each axis in turn, halving the step",
               "Kolda, Lewis and Torczon 2003, Optimization by direct search: new perspectives on "
               "some classical and modern methods",
               compass_options(0.1, 1e-6), {.local = true}),
      make_row({.algorithm = "mbh", .constraints = true},
               "Monotonic basin hopping: compass searches from about the best point",
               "Wales and Doye 1997, Global optimization by basin-hopping and the lowest energy "
               "structures of Lennard-Jones clusters containing up to 110 atoms",
               std::move(hopping)),
  };
}

std::vector<OptimizerRow> make_multi_objective_rows() {
  return {
      make_row(
          {.algorithm = "nsga2", .batch = true, .multi_objective = true, .integer = true},
          "NSGA-II: genetic algorithm by non-dominated sorting and crowding",
          "Deb, Pratap, Agarwal and Meyarivan 2002, A fast and elitist multiobjective "
          "genetic algorithm: NSGA-II",
          population(32, 8,
                     {number("cr", "probability of crossover, below 1", 0.95, 0, 1),
                      number("eta_c", "distribution index of crossover, below 100", 10, 1, 100),
                      number("m", "probability of mutation", 0.1, 0, 1),
                      number("eta_m", "distribution index of mutation, below 100", 10, 1, 100)},
                     "individuals, a multiple of 4")),
      make_row(
          {.algorithm = "moead", .multi_objective = true},
          "MOEA/D: many weighted problems at once, each helped by its neighbours",
          "Li and Zhang 2009, Multiobjective optimization problems with complicated Pareto sets, "
          "MOEA/D and NSGA-II",
          population(
              32, 4,
              {choice("weight_generation", "where the weights lie",
                      {"grid", "low discrepancy", "random"}),
               choice("decomposition", "how weights make one objective",
                      {"tchebycheff", "weighted", "bi"}),
               count("neighbours", "neighbours of a weight, fewer than population", 20, 2, 100000),
               number("CR", "crossover of the differential evolution within", 1, 0, 1),
               number("F", "difference weight of the differential evolution within", 0.5, 0, 1),
               number("eta_m", "distribution index of mutation", 20, 0, 1000),
               number("realb", "probability that only neighbours mate", 0.9, 0, 1),
               count("limit", "copies of a child at most", 2, 1, 100000),
               {.name = "preserve_diversity",
                .description = "realb and limit apply",
                .fallback = true}})),
      make_row({.algorithm = "maco", .batch = true, .multi_objective = true, .integer = true},
               "MHACO: ant colony whose solutions are ranked by hypervolume",
               "Acciarini, Izzo and Mooij 2020, MHACO: a multi-objective hypervolume-based ant "
               "colony optimizer for space trajectory optimization",
               ant_options({})),
      make_row({.algorithm = "nspso", .batch = true, .multi_objective = true},
               "NSPSO: particle swarm led by the non-dominated particles",
               "Li 2003, A non-dominated sorting particle swarm optimizer for multiobjective "
               "optimization",
               population(32, 4,
                          {number("omega", "inertia", 0.6, 1e-9, 10),
                           number("c1", "pull towards a particle's own best point", 2, 1e-9, 100),
                           number("c2", "pull towards a leader", 2, 1e-9, 100),
                           number("chi", "factor of the velocity", 1, 1e-9, 100),
                           number("v_coeff", "largest step, as a share of the box", 0.5, 1e-6, 1),
                           count("leader_selection_range", "percentage of the front that leads", 60,
                                 1, 100),
                           choice("diversity_mechanism", "how leaders are ranked",
                                  {"crowding distance", "niche count", "max min"})})),
  };
}

}  // namespace

std::vector<OptimizerRow> make_pagmo_rows() {
  const std::string unavailable = explain_missing(kPagmoModule);
  std::vector<OptimizerRow> rows;
  for (const auto make_rows : {make_differential_evolution_rows, make_swarm_rows,
                               make_evolution_rows, make_point_rows, make_multi_objective_rows}) {
    for (OptimizerRow& row : make_rows()) {
      row.unavailable = unavailable;
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

}  // namespace armwright
