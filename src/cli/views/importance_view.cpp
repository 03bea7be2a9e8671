#include "cli/views/importance_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "base/text.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/table.hpp"

namespace armwright {
namespace {

// Variables with a smaller total index are counted, not listed.
constexpr double kLeastListed = 0.01;

std::string format_index(double value, const Interval& interval) {
  return fmt::format("{:.2f} ({:.2f} to {:.2f})", value, interval.lower, interval.upper);
}

std::string describe_part(const Importance& importance, const ImportancePart& part,
                          const Style& style) {
  const char* unit = part.region == ImportanceRegion::design ? "design" : "evaluation";
  std::string text =
      style.bold(fmt::format("Variables that matter {}", describe_region(part))) +
      fmt::format(" ({})\n  {}\n", format_count(part.points, unit), sanitize(part.judgement));
  std::vector<std::size_t> order(part.variables.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater<>{},
                           [&](std::size_t i) { return part.variables[i].total; });
  Table table({{"variable", false}, {"alone"}, {"with others"}});
  std::size_t small = 0;
  for (const std::size_t i : order) {
    const SobolIndices& one = part.variables[i];
    if (one.total < kLeastListed) {
      ++small;
      continue;
    }
    table.add_row({sanitize(importance.variables[i]), format_index(one.first, one.first_interval),
                   format_index(one.total, one.total_interval)});
  }
  text += table.format(style, 2);
  if (small > 0) {
    text += fmt::format("  and {} below {:.2f}\n", format_count(small, "variable"), kLeastListed);
  }
  return text;
}

}  // namespace

std::string describe_importance(const Importance& importance, const Style& style) {
  std::string text;
  for (const ImportancePart& part : importance.parts) {
    text += describe_part(importance, part, style) + "\n";
  }
  if (!importance.parts.empty()) {
    text += fmt::format(
        "Shares of the variance of {}, with 95 % intervals: of each variable alone, and with those "
        "that act\ntogether with it.\n",
        sanitize(describe_scale(importance)));
  }
  if (importance.left_out > 0) {
    text += fmt::format("{} left out, which failed or lost a race.\n",
                        importance.left_out == 1
                            ? "1 evaluation is"
                            : fmt::format("{} evaluations are", importance.left_out));
  }
  for (const std::string& note : importance.notes) {
    text += sanitize(note) + "\n";
  }
  return text;
}

}  // namespace armwright
