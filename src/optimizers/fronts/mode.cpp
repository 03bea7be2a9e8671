#include "optimizers/fronts/mode.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <memory>
#include <utility>

#include "optimizers/fronts/front_generation.hpp"

namespace armwright {
namespace {

constexpr double kLeastModeMembers = 4;  // a member and three others

class ModeOptimizer : public Optimizer {
 public:
  explicit ModeOptimizer(const Options& options)
      : size_(static_cast<std::size_t>(options.get_integer("population"))),
        spread_(options.get_number("spread")),
        settings_{.weight = options.get_number("f"), .crossover = options.get_number("cr")} {}

  void minimize(Evaluator& evaluator, std::uint64_t seed) override {
    RandomStream random("optimizer/mode", seed);
    FrontGeneration generation(evaluator);
    std::vector<FrontMember> members;
    std::vector<FrontMember> trials = generation.make_first(size_, spread_, random);
    while (generation.evaluate(members, trials)) {
      members = members.empty() ? std::move(trials) : select_survivors(members, trials, size_);
      trials.clear();
      for (std::size_t i = 0; i < size_; ++i) {
        trials.push_back(
            {.coordinates = make_trial(members, i, generation.space(), settings_, random),
             .objectives = {}});
      }
    }
  }

 private:
  std::size_t size_;
  double spread_;
  DifferentialSettings settings_;
};

}  // namespace

std::vector<double> make_trial(std::span<const FrontMember> members, std::size_t index,
                               const SearchSpace& space, const DifferentialSettings& settings,
                               RandomStream& random) {
  std::array<std::size_t, 4> taken = {index};
  for (std::size_t k = 1; k < taken.size(); ++k) {
    do {
      taken[k] = random.below(members.size());
    } while (std::find(taken.begin(), taken.begin() + static_cast<std::ptrdiff_t>(k), taken[k]) !=
             taken.begin() + static_cast<std::ptrdiff_t>(k));
  }
  const std::vector<double>& a = members[taken[1]].coordinates;
  const std::vector<double>& b = members[taken[2]].coordinates;
  const std::vector<double>& c = members[taken[3]].coordinates;
  std::vector<double> trial = members[index].coordinates;
  const std::size_t certain = random.below(trial.size());
  for (std::size_t i = 0; i < trial.size(); ++i) {
    if (random.bernoulli(settings.crossover) || i == certain) {
      trial[i] =
          std::clamp(a[i] + settings.weight * (b[i] - c[i]), space.lower()[i], space.upper()[i]);
    }
  }
  return trial;
}

std::vector<FrontMember> select_survivors(std::span<const FrontMember> members,
                                          std::span<const FrontMember> trials, std::size_t size) {
  std::vector<FrontMember> all;
  for (std::size_t i = 0; i < members.size(); ++i) {
    const bool trial_wins = equals_or_dominates(trials[i], members[i]);
    if (!trial_wins) {
      all.push_back(members[i]);
    }
    if (trial_wins || !dominates(members[i], trials[i])) {
      all.push_back(trials[i]);
    }
  }
  std::vector<FrontMember> survivors;
  for (std::vector<std::size_t>& front : sort_into_fronts(all)) {
    if (survivors.size() + front.size() > size) {
      const std::vector<double> crowding = calc_crowding(all, front);
      std::vector<std::pair<double, std::size_t>> ranked;
      for (std::size_t i = 0; i < front.size(); ++i) {
        ranked.emplace_back(-crowding[i], front[i]);
      }
      std::ranges::sort(ranked);
      front.clear();
      for (std::size_t i = 0; survivors.size() + i < size; ++i) {
        front.push_back(ranked[i].second);
      }
    }
    for (const std::size_t member : front) {
      survivors.push_back(std::move(all[member]));
    }
    if (survivors.size() == size) {
      break;
    }
  }
  return survivors;
}

OptimizerRow make_mode_row() {
  OptimizerRow row = make_front_row("mode");
  row.summary = "Multi-objective differential evolution (GDE3)";
  row.source =
      "Kukkonen and Lampinen 2005, GDE3: the third evolution step of generalized differential "
      "evolution";
  row.options = {{.name = "population",
                  .description = "individuals",
                  .fallback = std::int64_t{24},
                  .lower = kLeastModeMembers,
                  .upper = 10000},
                 make_spread_option(),
                 {.name = "f",
                  .description = "weight of the difference of two individuals",
                  .fallback = 0.5,
                  .lower = 0,
                  .upper = 2},
                 {.name = "cr",
                  .description = "probability that a coordinate is taken from the mutant",
                  .fallback = 0.9,
                  .lower = 0,
                  .upper = 1}};
  row.make = [](const Options& options) -> std::unique_ptr<Optimizer> {
    return std::make_unique<ModeOptimizer>(options);
  };
  return row;
}

}  // namespace armwright
