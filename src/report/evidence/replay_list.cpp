#include "report/evidence/replay_list.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "base/text.hpp"

namespace armwright {

void ReplayList::add(const std::string& set, std::uint64_t number, const std::string& why) {
  const auto is_it = [&](const ReplayRequest& request) {
    return request.number == number && request.set.name() == set;
  };
  if (std::ranges::none_of(requests_, is_it)) {
    requests_.push_back({problem_.get_set(set), number,
                         fmt::format("{}, case {}: {}", sanitize(set), number, why)});
  }
}

void ReplayList::add(const std::string& set_and_number, const std::string& why) {
  const auto colon = set_and_number.rfind(':');
  const std::string set = set_and_number.substr(0, std::min(colon, set_and_number.size()));
  constexpr long long kMost = 1'000'000'000;
  const long long number = colon == std::string::npos
                               ? -1
                               : parse_integer(set_and_number.substr(colon + 1)).value_or(-1);
  if (set.find('/') == std::string::npos || set.front() == '/' || set.back() == '/' || number < 0 ||
      number > kMost) {
    throw Error(ErrorKind::usage,
                fmt::format("case '{}' is none: it must be SET:NUMBER with the name of a set of "
                            "test cases and a number from 0, as in test/2:17",
                            sanitize(set_and_number)));
  }
  add(set, static_cast<std::uint64_t>(number), why);
}

std::size_t find_worst_case(std::span<const double> errors) {
  const auto worst = std::ranges::max_element(errors, {}, [](double error) {
    return std::isnan(error) ? std::numeric_limits<double>::infinity() : error;
  });
  return static_cast<std::size_t>(worst - errors.begin());
}

}  // namespace armwright
