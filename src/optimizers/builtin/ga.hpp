// The genetic algorithm of Gunnarsson 2010 (thesis), section 5.3 and Table A.3. It is real-coded
// and generational, with an elite, binary probabilistic tournaments, arithmetic crossover, and
// multiplicative mutation on the natural values of the variables. The thesis maximises fitness;
// this version minimises the objective.
//
// A generation is the elite, copied unchanged, and one child per pair of parents. The whole
// population is evaluated as one batch, including the elite, because the training cases may be new.
// The evaluator moves genes into the bounds. The population then carries the moved values, since
// the scores belong to them.
//
// Extensions of the thesis. None of them changes a run on an unconstrained problem with logarithmic
// variables:
// - A variable with a linear scale is mutated by addition, not by multiplication, so that it can
//   leave zero and change its sign. The step covers the same share of the box as the factor covers
//   of a logarithmic box from base/100 to base*100.
// - Constraints: feasibility first (feasibility.hpp).
// - Integers stay whole: a crossed or mutated gene is rounded, and a mutation moves it by at least
//   1. A category is crossed by taking the word of either parent, and mutated by drawing another
//   word, each with the same probability.
// - The options `generations` and `include_prototype`. Limits: several objectives count as their
//   weighted sum. Crossover never leaves the span of the parents (extent <= 1/2). So an optimum
//   outside the span of the first generation, a factor of 10 about the start, is reached by
//   mutations alone, which is slow.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/random.hpp"
#include "optimizers/interface/feasibility.hpp"
#include "optimizers/interface/optimizer.hpp"

namespace armwright {

// Returns the rows ga and ga-simple.
std::vector<OptimizerRow> make_ga_rows();

using Genome = std::vector<double>;

struct CrossoverSettings {
  double probability = 0;  // of each gene
  double extent = 0;       // sigma ~ U(0, extent)
};

struct MutationSettings {
  double probability = 0;  // of each gene
  double factor = 1;       // the gene is multiplied by exp(U(-ln factor, ln factor))
};

// Returns the indices of the population, the fittest first. Equal ones keep their order.
std::vector<std::size_t> rank(std::span<const Fitness> population);

// Chooses two different individuals at random and returns the index of the fitter one with the
// given probability, else of the other one. Draws in this order: first, second, whether the less
// fit one wins.
std::size_t select(std::span<const Fitness> population, double probability, RandomStream& random);

// Returns 0.5 (base + other) + sigma (base - other).
double calc_crossed_gene(double base, double other, double sigma);
// Makes a child. One of the parents, chosen at random, is the base; it gives the genes that are not
// crossed. Draws in this order: the base; then for each gene whether it is crossed and, if so,
// sigma, or for a category which parent gives the word.
Genome cross(const Genome& first, const Genome& second, std::span<const DecisionVariable> variables,
             const CrossoverSettings& settings, RandomStream& random);

// Returns the mutated gene, for u in [-1, 1):
//   logarithmic scale: gene * exp(u ln factor)
//   linear scale:      gene + u (ln factor / ln 100) (upper - lower) / 2
// Of an integer, this is moved into the bounds and rounded. If that is the gene itself, returns the
// next whole number in the direction of u or, at a bound, in the other direction. Of a category,
// returns one of the other words.
double calc_mutated_gene(const DecisionVariable& variable, double gene, double factor, double u);
// Mutates the genome. Draws for each gene whether it is mutated and, if so, u.
void mutate(Genome& genome, std::span<const DecisionVariable> variables,
            const MutationSettings& settings, RandomStream& random);

}  // namespace armwright
