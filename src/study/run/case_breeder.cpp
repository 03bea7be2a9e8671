#include "study/run/case_breeder.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <utility>

#include "sim/tracking/test_case.hpp"

namespace armwright {
namespace {

constexpr double kMutation = 0.125;         // of each key of a child
constexpr double kCap = 2.302585092994046;  // log 10
constexpr double kLeastError = 1e-300;      // keeps the logarithm finite

// Returns the hardness of each case for one design. A case without an error has the largest one.
std::vector<double> calc_relative_hardness(std::span<const double> errors) {
  std::vector<double> hardness;
  double sum = 0;
  double numbers = 0;
  for (const double error : errors) {
    hardness.push_back(std::log(std::max(error, kLeastError)));
    if (!std::isnan(error)) {
      sum += hardness.back();
      ++numbers;
    }
  }
  const double mean = numbers > 0 ? sum / numbers : 0;
  for (std::size_t j = 0; j < errors.size(); ++j) {
    hardness[j] = std::isnan(errors[j]) ? kCap : std::clamp(hardness[j] - mean, -kCap, kCap);
  }
  return hardness;
}

}  // namespace

CaseBreeder::CaseBreeder(const std::string& set, int cases) : random_("coevolution/" + set) {
  while (std::ssize(genomes_) < cases) {
    const std::uint64_t genome = draw_genome();
    if (!is_known(genome, genomes_)) {
      genomes_.push_back(genome);
    }
  }
}

std::uint64_t CaseBreeder::draw_genome() {
  return random_.below(std::uint64_t{1} << (kGenomeKeys * kGenomeKeyBits));
}

bool CaseBreeder::is_known(std::uint64_t genome, std::span<const std::uint64_t> among) const {
  return std::ranges::find(among, genome) != among.end();
}

void CaseBreeder::add(const EvaluationRecord& record, double objective) {
  if (record.evaluation.case_errors.size() == genomes_.size()) {
    objectives_.push_back(objective);
    errors_.push_back(record.evaluation.case_errors);
  }
}

std::vector<double> CaseBreeder::calc_hardness() const {
  std::vector<std::size_t> best(objectives_.size());
  std::iota(best.begin(), best.end(), std::size_t{0});
  std::ranges::stable_sort(best, {}, [&](std::size_t i) { return objectives_[i]; });
  best.resize((best.size() + 1) / 2);
  std::vector<double> hardness(genomes_.size());
  for (const std::size_t design : best) {
    const std::vector<double> its = calc_relative_hardness(errors_[design]);
    for (std::size_t j = 0; j < hardness.size(); ++j) {
      hardness[j] += its[j] / static_cast<double>(best.size());
    }
  }
  return hardness;
}

std::uint64_t CaseBreeder::make_child(std::span<const std::uint64_t> parents) {
  const auto first = random_.below(parents.size());
  const auto second = (first + 1 + random_.below(parents.size() - 1)) % parents.size();
  std::uint64_t child = 0;
  for (int place = 0; place < kGenomeKeys; ++place) {
    const std::uint64_t parent = parents[random_.bernoulli(0.5) ? first : second];
    const std::uint64_t key =
        random_.bernoulli(kMutation) ? random_.below(kGenomeKeyValues) : get_key(parent, place);
    child = set_key(child, place, key);
  }
  return child;
}

void CaseBreeder::breed() {
  if (objectives_.empty()) {
    return;
  }
  const std::vector<double> hardness = calc_hardness();
  objectives_.clear();
  errors_.clear();
  std::vector<std::size_t> order(genomes_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater{}, [&](std::size_t j) { return hardness[j]; });
  const std::size_t count = genomes_.size();
  const std::size_t replaced = count / 2;
  const std::size_t fresh = (replaced + 2) / 4;
  std::vector<std::uint64_t> next;
  for (std::size_t i = 0; i < count - replaced; ++i) {
    next.push_back(genomes_[order[i]]);
  }
  const std::vector<std::uint64_t> parents = next;
  while (next.size() < count) {
    const bool is_child = next.size() < count - fresh;
    std::uint64_t genome = is_child ? make_child(parents) : draw_genome();
    while (is_known(genome, next)) {
      const auto place = static_cast<int>(random_.below(kGenomeKeys));
      genome = set_key(genome, place, random_.below(kGenomeKeyValues));
    }
    next.push_back(genome);
  }
  genomes_ = std::move(next);
}

}  // namespace armwright
