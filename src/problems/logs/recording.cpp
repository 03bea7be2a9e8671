#include "problems/logs/recording.hpp"

#include <fmt/format.h>

#include "base/text.hpp"

namespace armwright {

std::string Recording::name_row(std::size_t sample) const {
  return fmt::format("{} {}", topic.empty() ? "line" : "message", first_row + sample);
}

std::string Recording::locate(std::size_t sample) const {
  return topic.empty() ? fmt::format("{}:{}", file, first_row + sample)
                       : fmt::format("{}, {} of {}", file, name_row(sample), quote_name(topic));
}

std::string quote_name(std::string_view name) {
  constexpr std::size_t kLongest = 60;
  return fmt::format("'{}{}'", sanitize(name.substr(0, kLongest)),
                     name.size() > kLongest ? "..." : "");
}

std::string list_quoted(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 40;
  std::string text;
  for (std::size_t i = 0; i < names.size() && i < kMost; ++i) {
    text += (i == 0 ? "" : ", ") + quote_name(names[i]);
  }
  return names.empty()          ? "none"
         : names.size() > kMost ? text + fmt::format(" and {} more", names.size() - kMost)
                                : text;
}

}  // namespace armwright
