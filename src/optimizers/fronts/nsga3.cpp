#include "optimizers/fronts/nsga3.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "base/error.hpp"
#include "optimizers/fronts/front_generation.hpp"

namespace armwright {
namespace {

// The number of directions that the default stays below: 91 for three objectives, as in the source.
constexpr std::int64_t kDirections = 100;
constexpr std::int64_t kMostDirections = 10000;

class Nsga3Optimizer : public Optimizer {
 public:
  explicit Nsga3Optimizer(const Options& options)
      : divisions_(options.get_integer("divisions")),
        population_(options.get_integer("population")),
        spread_(options.get_number("spread")),
        settings_{.crossover = options.get_number("cr"),
                  .crossover_index = options.get_number("eta_c"),
                  .mutation_index = options.get_number("eta_m")} {}

  void check_problem(const ProblemDescription& problem) const override {
    const std::size_t objectives = problem.objectives.size();
    if (count_directions(objectives, choose_divisions(objectives), kMostDirections) >
        kMostDirections) {
      throw Error(
          ErrorKind::usage,
          fmt::format("optimizer 'nsga3': option 'divisions' is {}; with {} objectives this "
                      "gives more than {} reference directions; choose fewer divisions",
                      divisions_, objectives, kMostDirections));
    }
  }

  void minimize(Evaluator& evaluator, std::uint64_t seed) override {
    const std::size_t objectives = evaluator.problem().objectives.size();
    const auto directions = make_directions(objectives, choose_divisions(objectives));
    const std::size_t size = choose_size(directions.size());
    RandomStream random("optimizer/nsga3", seed);
    FrontGeneration generation(evaluator);
    FrontScale scale;
    std::vector<FrontMember> members;
    std::vector<FrontMember> children = generation.make_first(size, spread_, random);
    while (generation.evaluate(members, children)) {
      if (generation.has_changed_cases()) {
        scale.reset();
      }
      std::ranges::move(children, std::back_inserter(members));
      members = select_along_directions(std::move(members), size, directions, scale, random);
      children = breed(members, size, generation.space(), random);
    }
  }

 private:
  std::int64_t choose_divisions(std::size_t objectives) const {
    if (divisions_ > 0) {
      return divisions_;
    }
    std::int64_t divisions = 1;
    while (count_directions(objectives, divisions + 1, kDirections) <= kDirections &&
           divisions < kDirections) {
      ++divisions;
    }
    return divisions;
  }

  // Children come in pairs, so the size is even; the source uses a multiple of 4.
  std::size_t choose_size(std::size_t directions) const {
    const std::size_t least = population_ > 0 ? static_cast<std::size_t>(population_) : directions;
    return std::max<std::size_t>(4, (least + 3) / 4 * 4);
  }

  std::vector<FrontMember> breed(std::span<const FrontMember> members, std::size_t size,
                                 const SearchSpace& space, RandomStream& random) const {
    // The less violated of two members; of feasible ones, all are equally good parents.
    const auto choose = [&]() -> const FrontMember& {
      const FrontMember& a = members[random.below(members.size())];
      const FrontMember& b = members[random.below(members.size())];
      return b.violation < a.violation ? b : a;
    };
    std::vector<FrontMember> children;
    while (children.size() < size) {
      const FrontMember& first = choose();
      const FrontMember& second = choose();
      for (std::vector<double>& coordinates : breed_pair(first, second, space, settings_, random)) {
        children.push_back({.coordinates = std::move(coordinates), .objectives = {}});
      }
    }
    return children;
  }

  std::int64_t divisions_;
  std::int64_t population_;
  double spread_;
  GeneticSettings settings_;
};

// Returns how far a child lies from the middle of its parents, as a multiple of half their distance.
// `room` is the distance from the nearer parent to the bound, in the same unit.
double calc_spread(double u, double room, double index) {
  const double alpha = 2 - std::pow(1 + room, -(index + 1));
  const double base = u <= 1 / alpha ? u * alpha : 1 / (2 - u * alpha);
  return std::pow(base, 1 / (index + 1));
}

void cross_coordinate(double& a, double& b, double lower, double upper, double index, double u) {
  // Closer parents are equal: their children would differ by rounding errors only.
  constexpr double kClose = 1e-14;
  if (std::abs(a - b) <= kClose * (upper - lower)) {
    return;
  }
  const double low = std::min(a, b);
  const double high = std::max(a, b);
  const double half = 0.5 * (high - low);
  const double middle = low + half;
  const double down = calc_spread(u, (low - lower) / half, index);
  const double up = calc_spread(u, (upper - high) / half, index);
  a = std::clamp(middle - down * half, lower, upper);
  b = std::clamp(middle + up * half, lower, upper);
}

double mutate_coordinate(double value, double lower, double upper, double index, double u) {
  const double range = upper - lower;
  if (!(range > 0)) {
    return value;
  }
  const double power = index + 1;
  const double step =
      u < 0.5
          ? std::pow(2 * u + (1 - 2 * u) * std::pow(1 - (value - lower) / range, power),
                     1 / power) -
                1
          : 1 - std::pow(2 * (1 - u) + (2 * u - 1) * std::pow(1 - (upper - value) / range, power),
                         1 / power);
  return std::clamp(value + step * range, lower, upper);
}

// The members of the front that is cut, and how the survivors so far lie along the directions.
class Niches {
 public:
  Niches(std::span<const FrontMember> members, std::span<const std::size_t> kept,
         std::span<const std::size_t> cut, std::span<const std::vector<double>> directions,
         const FrontScale& scale)
      : counts_(directions.size(), 0), candidates_(directions.size()) {
    const auto locate = [&](std::size_t member) {
      return find_nearest_direction(scale.normalise(members[member].objectives), directions);
    };
    for (const std::size_t member : kept) {
      ++counts_[locate(member).direction];
    }
    for (const std::size_t member : cut) {
      const NearestDirection nearest = locate(member);
      candidates_[nearest.direction].emplace_back(nearest.distance, member);
    }
    for (std::size_t i = 0; i < directions.size(); ++i) {
      std::ranges::sort(candidates_[i]);
      if (!candidates_[i].empty()) {
        open_.push_back(i);
      }
    }
  }

  // Takes one more member: the nearest one of a direction that has none, else any one.
  std::size_t take(RandomStream& random) {
    const std::size_t fewest = counts_[*std::ranges::min_element(
        open_, {}, [&](std::size_t direction) { return counts_[direction]; })];
    std::vector<std::size_t> tied;
    std::ranges::copy_if(open_, std::back_inserter(tied),
                         [&](std::size_t direction) { return counts_[direction] == fewest; });
    const std::size_t direction = tied[random.below(tied.size())];
    auto& candidates = candidates_[direction];
    const std::size_t place = fewest == 0 ? 0 : random.below(candidates.size());
    const std::size_t member = candidates[place].second;
    candidates.erase(candidates.begin() + static_cast<std::ptrdiff_t>(place));
    ++counts_[direction];
    if (candidates.empty()) {
      std::erase(open_, direction);
    }
    return member;
  }

 private:
  std::vector<std::size_t> counts_;                                      // survivors per direction
  std::vector<std::vector<std::pair<double, std::size_t>>> candidates_;  // distance, member
  std::vector<std::size_t> open_;  // the directions that have candidates
};

}  // namespace

std::vector<std::vector<double>> breed_pair(const FrontMember& first, const FrontMember& second,
                                            const SearchSpace& space,
                                            const GeneticSettings& settings, RandomStream& random) {
  std::vector<std::vector<double>> children = {first.coordinates, second.coordinates};
  const std::size_t n = space.dimension();
  if (random.bernoulli(settings.crossover)) {
    for (std::size_t i = 0; i < n; ++i) {
      if (!random.bernoulli(0.5)) {
        continue;
      }
      cross_coordinate(children[0][i], children[1][i], space.lower()[i], space.upper()[i],
                       settings.crossover_index, random.uniform());
      if (random.bernoulli(0.5)) {
        std::swap(children[0][i], children[1][i]);
      }
    }
  }
  for (std::vector<double>& child : children) {
    for (std::size_t i = 0; i < n; ++i) {
      if (random.bernoulli(1 / static_cast<double>(n))) {
        child[i] = mutate_coordinate(child[i], space.lower()[i], space.upper()[i],
                                     settings.mutation_index, random.uniform());
      }
    }
  }
  return children;
}

std::vector<FrontMember> select_along_directions(std::vector<FrontMember> members, std::size_t size,
                                                 std::span<const std::vector<double>> directions,
                                                 FrontScale& scale, RandomStream& random) {
  std::vector<std::size_t> kept;
  std::vector<std::size_t> cut;
  const std::vector<std::vector<std::size_t>> fronts = sort_into_fronts(members);
  for (const std::vector<std::size_t>& front : fronts) {
    if (kept.size() + front.size() > size) {
      cut = front;
      break;
    }
    kept.insert(kept.end(), front.begin(), front.end());
  }
  std::vector<std::vector<double>>
      seen;  // the objectives of feasible members, the best front first
  for (const std::vector<std::size_t>& part : {kept, cut}) {
    for (const std::size_t member : part) {
      if (members[member].violation == 0) {
        seen.push_back(members[member].objectives);
      }
    }
  }
  if (!seen.empty()) {
    scale.update(seen, std::min(seen.size(), fronts.front().size()));
  }
  if (!cut.empty() && members[cut.front()].violation > 0) {
    cut.resize(size - kept.size());  // equally violated
    kept.insert(kept.end(), cut.begin(), cut.end());
  } else if (!cut.empty()) {
    Niches niches(members, kept, cut, directions, scale);
    while (kept.size() < size) {
      kept.push_back(niches.take(random));
    }
  }
  std::vector<FrontMember> survivors;
  for (const std::size_t member : kept) {
    survivors.push_back(std::move(members[member]));
  }
  return survivors;
}

OptimizerRow make_nsga3_row() {
  const auto index = [](std::string name, std::string description, double fallback) {
    return OptionSpec{.name = std::move(name),
                      .description = std::move(description),
                      .fallback = fallback,
                      .lower = 0,
                      .upper = 1000};
  };
  OptimizerRow row = make_front_row("nsga3");
  row.summary = "NSGA-III: reference directions, for three objectives and more";
  row.source =
      "Deb and Jain 2014, An evolutionary many-objective optimization algorithm using "
      "reference-point-based nondominated sorting approach, part I";
  row.options = {
      {.name = "divisions",
       .description =
           "parts into which the reference directions divide each objective; 0: as many as give at "
           "most 100 directions (99 for two objectives, 12 for three, 6 for four)",
       .fallback = std::int64_t{0},
       .lower = 0,
       .upper = 1000},
      {.name = "population",
       .description =
           "individuals, rounded up to a multiple of 4; 0: as many as there are directions",
       .fallback = std::int64_t{0},
       .lower = 0,
       .upper = 10000},
      make_spread_option(),
      {.name = "cr",
       .description = "probability that two parents are crossed",
       .fallback = 1.0,
       .lower = 0,
       .upper = 1},
      index("eta_c", "distribution index of crossover", 30),
      index("eta_m", "distribution index of mutation", 20)};
  row.make = [](const Options& options) -> std::unique_ptr<Optimizer> {
    return std::make_unique<Nsga3Optimizer>(options);
  };
  return row;
}

}  // namespace armwright
