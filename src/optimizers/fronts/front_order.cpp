#include "optimizers/fronts/front_order.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <tuple>

namespace armwright {

bool equals_or_dominates(const FrontMember& a, const FrontMember& b) {
  return a.violation != b.violation
             ? a.violation < b.violation
             : std::ranges::equal(a.objectives, b.objectives, std::less_equal<>{});
}

bool dominates(const FrontMember& a, const FrontMember& b) {
  return equals_or_dominates(a, b) && !equals_or_dominates(b, a);
}

std::vector<std::vector<std::size_t>> sort_into_fronts(std::span<const FrontMember> members) {
  std::vector<std::size_t> order(members.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  // In this order no member dominates an earlier one.
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return std::tie(members[a].violation, members[a].objectives) <
           std::tie(members[b].violation, members[b].objectives);
  });
  std::vector<std::vector<std::size_t>> fronts;
  for (const std::size_t member : order) {
    const auto front = std::ranges::find_if(fronts, [&](const std::vector<std::size_t>& earlier) {
      // The members that came last are the nearest ones and the likeliest to dominate.
      return std::none_of(earlier.rbegin(), earlier.rend(), [&](std::size_t other) {
        return dominates(members[other], members[member]);
      });
    });
    if (front == fronts.end()) {
      fronts.push_back({member});
    } else {
      front->push_back(member);
    }
  }
  return fronts;
}

std::vector<double> calc_crowding(std::span<const FrontMember> members,
                                  std::span<const std::size_t> front) {
  constexpr double kEnd = std::numeric_limits<double>::infinity();
  std::vector<double> crowding(front.size(), 0.0);
  const std::size_t objectives = front.empty() ? 0 : members[front.front()].objectives.size();
  std::vector<std::size_t> order(front.size());  // places in `front`
  for (std::size_t m = 0; m < objectives; ++m) {
    const auto get = [&](std::size_t place) { return members[front[place]].objectives[m]; };
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, get);
    crowding[order.front()] = crowding[order.back()] = kEnd;
    const double range = get(order.back()) - get(order.front());
    if (!(range > 0 && std::isfinite(range))) {
      continue;  // all are equal, or the penalty of a failed evaluation is among them
    }
    for (std::size_t i = 1; i + 1 < order.size(); ++i) {
      crowding[order[i]] += (get(order[i + 1]) - get(order[i - 1])) / range;
    }
  }
  return crowding;
}

}  // namespace armwright
