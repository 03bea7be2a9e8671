#include "optimizers/builtin/ga.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/error.hpp"

namespace armwright {
namespace {

class GeneticAlgorithm : public Optimizer {
 public:
  // `elite_size` is a parameter because ga:simple has no such option.
  GeneticAlgorithm(const Options& options, std::int64_t elite_size)
      : population_size_(static_cast<std::size_t>(options.get_integer("population"))),
        elite_size_(static_cast<std::size_t>(elite_size)),
        generations_(options.get_integer("generations")),
        include_prototype_(options.get_bool("include_prototype")),
        tournament_probability_(options.get_number("tournament_probability")),
        crossover_{.probability = options.get_number("crossover_probability"),
                   .extent = options.get_number("crossover_extent")},
        mutation_{.probability = options.get_number("mutation_probability"),
                  .factor = options.get_number("mutation_factor")},
        initial_mutation_{.probability = options.get_number("initial_mutation_probability"),
                          .factor = options.get_number("initial_mutation_factor")} {
    if (elite_size_ >= population_size_) {
      throw Error(ErrorKind::usage,
                  fmt::format("optimizer 'ga': option 'elite' is {}; it must be smaller than "
                              "option 'population', which is {}",
                              elite_size_, population_size_));
    }
  }

  void minimize(Evaluator& evaluator, std::uint64_t seed) override {
    const std::vector<DecisionVariable>& variables = evaluator.problem().variables;
    RandomStream random("optimizer/ga", seed);
    std::vector<Genome> population = make_initial_population(variables, random);
    for (std::int64_t generation = 1; !evaluator.stopped(); ++generation) {
      evaluator.begin_generation();
      const std::vector<Score> scores = evaluator.evaluate(population);
      if (scores.size() < population.size() || generation == generations_) {
        return;
      }
      std::vector<Fitness> fitness;
      for (const Score& score : scores) {
        fitness.push_back(calc_fitness(evaluator.problem(), score));
      }
      clamp(population, variables);
      population = make_next_population(population, fitness, variables, random);
    }
  }

 private:
  std::vector<Genome> make_initial_population(std::span<const DecisionVariable> variables,
                                              RandomStream& random) const {
    const Genome prototype = list_starts(variables);
    std::vector<Genome> population(population_size_, prototype);
    for (std::size_t i = include_prototype_ ? 1 : 0; i < population.size(); ++i) {
      mutate(population[i], variables, initial_mutation_, random);
    }
    return population;
  }

  std::vector<Genome> make_next_population(const std::vector<Genome>& population,
                                           std::span<const Fitness> fitness,
                                           std::span<const DecisionVariable> variables,
                                           RandomStream& random) const {
    std::vector<Genome> next;
    next.reserve(population_size_);
    const std::vector<std::size_t> ranking = rank(fitness);
    for (std::size_t i = 0; i < elite_size_; ++i) {
      next.push_back(population[ranking[i]]);
    }
    while (next.size() < population_size_) {
      const std::size_t first = select(fitness, tournament_probability_, random);
      const std::size_t second = select(fitness, tournament_probability_, random);
      Genome child = cross(population[first], population[second], variables, crossover_, random);
      mutate(child, variables, mutation_, random);
      next.push_back(std::move(child));
    }
    return next;
  }

  static void clamp(std::vector<Genome>& population, std::span<const DecisionVariable> variables) {
    for (Genome& genome : population) {
      for (std::size_t i = 0; i < genome.size(); ++i) {
        genome[i] = std::clamp(genome[i], variables[i].lower, variables[i].upper);
      }
    }
  }

  std::size_t population_size_;
  std::size_t elite_size_;
  std::int64_t generations_;
  bool include_prototype_;
  double tournament_probability_;
  CrossoverSettings crossover_;
  MutationSettings mutation_;
  MutationSettings initial_mutation_;
};

}  // namespace

std::vector<std::size_t> rank(std::span<const Fitness> population) {
  std::vector<std::size_t> ranking(population.size());
  std::iota(ranking.begin(), ranking.end(), std::size_t{0});
  std::ranges::stable_sort(ranking, [&](std::size_t a, std::size_t b) {
    return is_fitter(population[a], population[b]);
  });
  return ranking;
}

std::size_t select(std::span<const Fitness> population, double probability, RandomStream& random) {
  assert(population.size() >= 2);
  const std::size_t first = random.below(population.size());
  std::size_t second = random.below(population.size() - 1);
  if (second >= first) {
    ++second;  // uniform over all but the first
  }
  const bool first_is_fitter = !is_fitter(population[second], population[first]);
  const bool fitter_wins = random.bernoulli(probability);
  return first_is_fitter == fitter_wins ? first : second;
}

double calc_crossed_gene(double base, double other, double sigma) {
  return 0.5 * (base + other) + sigma * (base - other);
}

Genome cross(const Genome& first, const Genome& second, std::span<const DecisionVariable> variables,
             const CrossoverSettings& settings, RandomStream& random) {
  const bool first_is_base = random.bernoulli(0.5);
  const Genome& base = first_is_base ? first : second;
  const Genome& other = first_is_base ? second : first;
  Genome child = base;
  for (std::size_t i = 0; i < child.size(); ++i) {
    const bool is_crossed = random.bernoulli(settings.probability);
    if (is_crossed && variables[i].type == VariableType::category) {
      child[i] = random.bernoulli(0.5) ? base[i] : other[i];
    } else if (is_crossed) {
      const double sigma = random.uniform(0, settings.extent);
      child[i] = calc_crossed_gene(base[i], other[i], sigma);
      if (variables[i].type == VariableType::integer) {
        child[i] = settle_value(variables[i], child[i]);
      }
    }
  }
  return child;
}

namespace {

double calc_mutated_number(const DecisionVariable& variable, double gene, double factor, double u) {
  if (variable.scale == Scale::logarithmic) {
    return gene * std::exp(u * std::log(factor));
  }
  const double share = std::log(factor) / std::log(100.0);
  return gene + u * share * 0.5 * (variable.upper - variable.lower);
}

double calc_mutated_integer(const DecisionVariable& variable, double gene, double factor,
                            double u) {
  const double moved = settle_value(variable, calc_mutated_number(variable, gene, factor, u));
  if (moved != gene) {
    return moved;
  }
  // On a logarithmic scale, a negative u makes the magnitude smaller.
  const bool is_mirrored = variable.scale == Scale::logarithmic && gene < 0;
  const double step = (u < 0) == is_mirrored ? 1 : -1;
  const double next = settle_value(variable, gene + step);
  return next != gene ? next : settle_value(variable, gene - step);
}

double calc_mutated_category(const DecisionVariable& variable, double gene, double u) {
  const double others = variable.upper - variable.lower;
  if (others == 0) {
    return gene;
  }
  const double drawn = std::min(std::floor(0.5 * (u + 1) * others), others - 1);
  return variable.lower + drawn + (variable.lower + drawn < gene ? 0 : 1);
}

}  // namespace

double calc_mutated_gene(const DecisionVariable& variable, double gene, double factor, double u) {
  switch (variable.type) {
    case VariableType::integer:
      return calc_mutated_integer(variable, gene, factor, u);
    case VariableType::category:
      return calc_mutated_category(variable, gene, u);
    case VariableType::real:
      break;
  }
  return calc_mutated_number(variable, gene, factor, u);
}

void mutate(Genome& genome, std::span<const DecisionVariable> variables,
            const MutationSettings& settings, RandomStream& random) {
  for (std::size_t i = 0; i < genome.size(); ++i) {
    const bool is_mutated = random.bernoulli(settings.probability);
    if (is_mutated) {
      const double u = random.uniform(-1, 1);
      genome[i] = calc_mutated_gene(variables[i], genome[i], settings.factor, u);
    }
  }
}

namespace {

OptimizerRow make_ga_row() {
  const auto probability = [](std::string name, std::string description, double fallback) {
    return OptionSpec{.name = std::move(name),
                      .description = std::move(description),
                      .fallback = fallback,
                      .lower = 0,
                      .upper = 1};
  };
  const auto factor = [](std::string name, std::string description, double fallback) {
    return OptionSpec{.name = std::move(name),
                      .description = std::move(description),
                      .fallback = fallback,
                      .lower = 1,
                      .upper = 1e6};
  };
  return {
      .name = "ga",
      .summary = "The thesis's real-coded genetic algorithm",
      .source =
          "Gunnarsson 2010, Robot Design Optimization by means of a Genetic Algorithm and Physics "
          "Simulation (thesis), section 5.3 and Table A.3",
      .capabilities = {.bounds = false,
                       .constraints = true,
                       .batch = true,
                       .noisy = true,
                       .stochastic = true,
                       .generations = true,
                       .integer = true,
                       .categorical = true},
      .options =
          {
              {.name = "population",
               .description = "individuals of a generation, the elite included",
               .fallback = std::int64_t{35},
               .lower = 2,
               .upper = 100000},
              {.name = "elite",
               .description = "fittest individuals copied unchanged into the next generation",
               .fallback = std::int64_t{2},
               .lower = 0,
               .upper = 99999},
              probability("tournament_probability",
                          "probability that the fitter of two individuals becomes a parent", 0.7),
              probability("crossover_probability", "probability that a gene of a child is crossed",
                          0.75),
              {.name = "crossover_extent",
               .description =
                   "a crossed gene is 0.5 (A + B) + sigma (A - B), with sigma drawn from 0 to this",
               .fallback = 0.25,
               .lower = 0,
               .upper = 10},
              probability("mutation_probability", "probability that a gene of a child mutates",
                          0.05),
              factor("mutation_factor",
                     "a gene is multiplied or divided by at most this; that of a linear variable "
                     "moves by "
                     "at most ln(this) / ln(100) of half the box",
                     2.0),
              probability("initial_mutation_probability",
                          "as mutation_probability, for the first generation", 0.8),
              factor("initial_mutation_factor", "as mutation_factor, for the first generation",
                     10.0),
              {.name = "include_prototype",
               .description = "the start itself is the first individual of the first generation",
               .fallback = false},
              {.name = "generations",
               .description = "generations to run at most; 0: until the budget ends",
               .fallback = std::int64_t{0},
               .lower = 0,
               .upper = 1e9},
          },
      .make = [](const Options& options) -> std::unique_ptr<Optimizer> {
        return std::make_unique<GeneticAlgorithm>(options, options.get_integer("elite"));
      },
  };
}

OptimizerRow make_simple_ga_row() {
  OptimizerRow row = make_ga_row();
  row.name = "ga:simple";
  row.summary = "ga without an elite: what the thesis's sources call the simple GA";
  row.source = "Goldberg 1989, Genetic Algorithms in Search, Optimization and Machine Learning";
  std::erase_if(row.options, [](const OptionSpec& option) { return option.name == "elite"; });
  row.options.front().description = "individuals of a generation";
  row.make = [](const Options& options) -> std::unique_ptr<Optimizer> {
    return std::make_unique<GeneticAlgorithm>(options, 0);
  };
  return row;
}

}  // namespace

std::vector<OptimizerRow> make_ga_rows() {
  return {make_ga_row(), make_simple_ga_row()};
}

}  // namespace armwright
