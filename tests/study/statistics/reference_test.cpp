// Compares every statistic with the values of scipy, R and brute force (make_reference.py).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "study/statistics/pareto.hpp"
#include "study/statistics/ranking.hpp"
#include "study/statistics/running_time.hpp"
#include "study/statistics/significance.hpp"
#include "study/statistics/summary.hpp"

namespace armwright {
namespace {

using Numbers = std::vector<double>;
using Table = std::vector<Numbers>;

Numbers read_numbers(const nlohmann::json& numbers_json) {
  Numbers numbers;
  for (const nlohmann::json& number : numbers_json) {
    numbers.push_back(number.is_string() ? std::numeric_limits<double>::infinity()
                                         : number.get<double>());
  }
  return numbers;
}

Table skip(const Table& rows, int count) {
  return {rows.begin() + count, rows.end()};
}

Numbers join(const Table& rows) {
  Numbers joined;
  for (const Numbers& row : rows) {
    joined.insert(joined.end(), row.begin(), row.end());
  }
  return joined;
}

Numbers list(const Interval& interval) {
  return {interval.lower, interval.upper};
}

std::vector<Trial> make_trials(const Table& in) {
  std::vector<Trial> trials;
  for (std::size_t i = 0; i < in[0].size(); ++i) {
    trials.push_back({in[0][i], in[1][i] != 0});
  }
  return trials;
}

Numbers list_spread(const Table& in) {
  const Spread spread = calc_spread(in[0]);
  return {spread.median, spread.lower_quartile, spread.upper_quartile};
}

Numbers list_signed_rank(const Table& in) {
  const SignedRankTest test = calc_signed_rank_test(in[0], in[1]);
  return {static_cast<double>(test.pairs),
          static_cast<double>(test.zeros),
          test.positive_rank_sum,
          test.negative_rank_sum,
          test.p_value,
          test.exact ? 1.0 : 0.0};
}

Numbers list_friedman(const Table& in) {
  const FriedmanTest test = calc_friedman_test(in);
  return join({test.mean_ranks,
               {test.chi_squared, test.degrees, test.p_value, test.f, test.f_degrees_1,
                test.f_degrees_2, test.f_p_value}});
}

Numbers list_stability(const Table& in) {
  const RankingStability stability = calc_ranking_stability(in);
  Numbers result = stability.full.mean_ranks;
  for (const RankingWithout& without : stability.without) {
    result.push_back(without.tau);
    result.push_back(without.leader_changes ? 1 : 0);
  }
  return result;
}

Numbers list_data_profile(const Table& in) {
  const std::vector<int> dimensions(in[1].begin(), in[1].end());
  return join(calc_data_profiles(skip(in, 2), dimensions, in[0]));
}

Numbers list_non_dominated(const Table& in) {
  const std::vector<std::size_t> front = find_non_dominated(in);
  return {front.begin(), front.end()};
}

Numbers list_attainment(const Table& in) {
  std::vector<Table> fronts;
  for (const Numbers& numbers : skip(in, 1)) {
    fronts.emplace_back();
    for (std::size_t i = 0; i < numbers.size(); i += 2) {
      fronts.back().push_back({numbers[i], numbers[i + 1]});
    }
  }
  return join(calc_attainment_surface(fronts, in[0][0]));
}

const std::map<std::string, std::function<Numbers(const Table&)>>& functions() {
  static const std::map<std::string, std::function<Numbers(const Table&)>> table = {
      {"ranks", [](const Table& in) { return calc_ranks(in[0]); }},
      {"quantile", [](const Table& in) { return Numbers{calc_quantile(in[1], in[0][0])}; }},
      {"spread", list_spread},
      {"median_interval",
       [](const Table& in) {
         return list(calc_median_interval(in[0], in[1][0], static_cast<int>(in[1][1]), "median"));
       }},
      {"signed_rank", list_signed_rank},
      {"friedman", list_friedman},
      {"holm", [](const Table& in) { return adjust_holm(in[0]); }},
      {"a12", [](const Table& in) { return Numbers{calc_a12(in[0], in[1])}; }},
      {"kendall", [](const Table& in) { return Numbers{calc_kendall_tau(in[0], in[1])}; }},
      {"ranking_stability", list_stability},
      {"ert", [](const Table& in) { return Numbers{calc_expected_running_time(make_trials(in))}; }},
      {"resampled_interval",
       [](const Table& in) {
         return list(calc_resampled_running_time_interval(make_trials(in), in[2][0],
                                                          static_cast<int>(in[2][1]), "trials"));
       }},
      {"runtime_ecdf", [](const Table& in) { return calc_runtime_ecdf(in[1], in[0]); }},
      {"anytime_area",
       [](const Table& in) { return Numbers{calc_anytime_area(in[1], in[0][0], in[0][1])}; }},
      {"performance_profile",
       [](const Table& in) { return join(calc_performance_profiles(skip(in, 1), in[0])); }},
      {"data_profile", list_data_profile},
      {"non_dominated", list_non_dominated},
      {"hypervolume",
       [](const Table& in) { return Numbers{calc_hypervolume(skip(in, 1), in[0])}; }},
      {"attainment", list_attainment}};
  return table;
}

// The relative tolerance: the error in double precision of sums over some hundred numbers and of
// the tails of distributions. Infinities and zeros must be exact.
void expect_close(const Numbers& found, const Numbers& reference) {
  ASSERT_EQ(found.size(), reference.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double scale = std::max(std::abs(found[i]), std::abs(reference[i]));
    EXPECT_TRUE(found[i] == reference[i] || std::abs(found[i] - reference[i]) <= 1e-10 * scale)
        << "number " << i << " is " << found[i] << ", the reference " << reference[i];
  }
}

TEST(StatisticsReference, EveryStatisticIsWhatOthersCompute) {
  std::ifstream file(ARMWRIGHT_TEST_DATA "/statistics/reference.json");
  const nlohmann::json data = nlohmann::json::parse(file);
  std::set<std::string> tried;
  for (const nlohmann::json& one : data.at("cases")) {
    const std::string function = one.at("function");
    SCOPED_TRACE(function + ": " + one.at("name").get<std::string>());
    Table arguments;
    for (const nlohmann::json& numbers : one.at("arguments")) {
      arguments.push_back(read_numbers(numbers));
    }
    const Numbers found = functions().at(function)(arguments);
    expect_close(found, read_numbers(one.at("scipy")));
    if (one.contains("r")) {
      expect_close(found, read_numbers(one.at("r")));
    }
    tried.insert(function);
  }
  EXPECT_EQ(tried.size(), functions().size());
}

}  // namespace
}  // namespace armwright
