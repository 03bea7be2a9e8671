// The genetic algorithm of Gunnarsson 2010 (thesis), section 5.3 and Table A.3: real-coded,
// generational, with an elite, binary probabilistic tournaments, arithmetic crossover and
// multiplicative mutation on the variables' natural values. The thesis maximises fitness; here the
// objective is minimised.
//
// A generation: the elite, copied unchanged, then one child for each pair of parents. The whole
// population is evaluated as one batch, the elite too, because the training cases may be new. Genes
// outside the bounds are clipped by the evaluator; the population then carries the clipped values,
// which are what the scores belong to.
//
// Our extensions, none of which touches an unconstrained problem on logarithmic variables:
// - A variable of linear scale is mutated by adding, not by multiplying, so that zero is not a
//   trap and the sign can change. The step spans the same share of the box as the factor spans of
//   a logarithmic box from base/100 to base*100.
// - Constraints: feasibility first (feasibility.hpp).
// - `generations` and `include_prototype` as options.
// Limits: several objectives count as their weighted sum. Crossover never leaves the span of the
// parents (extent <= 1/2), so an optimum outside the first generation's span, a factor of 10 about
// the start, is approached by mutations alone, which is slow.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/random.hpp"
#include "optimizers/interface/feasibility.hpp"
#include "optimizers/interface/optimizer.hpp"

namespace armwright {

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

// Indices of the population, the fittest first; equals keep their order.
std::vector<std::size_t> rank(std::span<const Fitness> population);

// Two distinct individuals at random; the fitter of them with the given probability, else the
// other. Draws: first, second, upset.
std::size_t select(std::span<const Fitness> population, double probability, RandomStream& random);

// 0.5 (base + other) + sigma (base - other)
double calc_crossed_gene(double base, double other, double sigma);
// One of the parents, at random, is the base and gives the genes that are not crossed. Draws: base;
// for each gene crossed or not and, if it is, sigma.
Genome cross(const Genome& first, const Genome& second, const CrossoverSettings& settings,
             RandomStream& random);

// `u` in [-1, 1). Logarithmic scale: gene * exp(u ln factor); linear: gene + u (ln factor / ln 100)
// (upper - lower)/2.
double calc_mutated_gene(const DecisionVariable& variable, double gene, double factor, double u);
// Draws: for each gene mutated or not and, if it is, u.
void mutate(Genome& genome, std::span<const DecisionVariable> variables,
            const MutationSettings& settings, RandomStream& random);

}  // namespace armwright
