// The part of a study's page that compares optimizers over all problems.
#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "report/evidence/page_json.hpp"
#include "report/page/study_parts.hpp"
#include "study/statistics/ranking.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr std::size_t kMostCliques = 200;

json make_profiles(std::span<const Profile> profiles) {
  json list = json::array();
  for (const Profile& profile : profiles) {
    list.push_back({{"tolerance", profile.tolerance}, {"shares", profile.shares}});
  }
  return list;
}

bool has_all_cells(const StudyResult& result, std::size_t problem) {
  return std::ranges::find(result.missing, problem, &Cell::problem) == result.missing.end();
}

// Returns a confidence interval of each optimizer's mean rank, as if the problems were a random
// sample. Returns null if there are fewer problems than a conclusion needs (kFewestPairs).
json make_rank_intervals(const StudyPlan& plan, const StudyResult& result) {
  std::vector<std::vector<double>> ranks(plan.optimizers.size());
  for (std::size_t p = 0; p < result.problems.size(); ++p) {
    if (!has_all_cells(result, p)) {
      continue;
    }
    std::vector<double> medians;
    for (const OptimizerResult& one : result.problems[p].optimizers) {
      medians.push_back(result.problems[p].margin.round(one.spread.median));
    }
    const auto its_ranks = calc_ranks(medians);
    for (std::size_t o = 0; o < ranks.size(); ++o) {
      ranks[o].push_back(its_ranks[o]);
    }
  }
  if (std::ssize(ranks.front()) < kFewestPairs) {
    return nullptr;
  }
  const auto calc_mean = [](std::span<const double> values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  };
  json intervals = json::array();
  for (std::size_t o = 0; o < ranks.size(); ++o) {
    const Interval interval =
        calc_bootstrap_interval(ranks[o], calc_mean, kIntervalLevel, kResamples,
                                fmt::format("page/mean rank/{}", plan.optimizers[o].label));
    intervals.push_back({interval.lower, interval.upper});
  }
  return intervals;
}

json make_cliques(const StudyPlan& plan, std::span<const PairResult> pairs,
                  std::vector<std::string>& notes) {
  if (pairs.empty()) {
    return json::array();  // one problem allows no test
  }
  std::vector<std::pair<std::size_t, std::size_t>> distinguished;
  for (const PairResult& pair : pairs) {
    if (pair.is_significant()) {
      distinguished.emplace_back(pair.a, pair.b);
    }
  }
  const auto cliques = find_cliques(plan.optimizers.size(), distinguished, kMostCliques);
  if (!cliques) {
    notes.push_back(fmt::format(
        "Over the problems there are more than {} sets of optimizers without a significant "
        "difference. They are left out; the table of pairs has every comparison.",
        kMostCliques));
    return json::array();
  }
  return *cliques;
}

}  // namespace

json make_study_overall(const StudyPlan& plan, const StudyResult& result,
                        std::vector<std::string>& notes) {
  const OverallResult& overall = result.overall;
  if (overall.ranking.full.mean_ranks.empty()) {
    return nullptr;
  }
  return {{"mean_ranks", overall.ranking.full.mean_ranks},
          {"rank_intervals", make_rank_intervals(plan, result)},
          {"friedman", make_friedman(overall.friedman)},
          {"pairs", make_study_pairs(overall.pairs)},
          {"cliques", make_cliques(plan, overall.pairs, notes)},
          {"kappas", overall.kappas},
          {"data_profiles", make_profiles(overall.data_profiles)},
          {"alphas", overall.alphas},
          {"performance_profiles", make_profiles(overall.performance_profiles)}};
}

}  // namespace armwright
