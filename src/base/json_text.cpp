#include "base/json_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

using nlohmann::json;

// Returns the beginning of a recorded value, safe to print in one line.
std::string cut(std::string_view text) {
  constexpr std::size_t kLongest_bytes = 200;
  return sanitize(text.substr(0, kLongest_bytes)) + (text.size() > kLongest_bytes ? "..." : "");
}

// Returns whether a value is a text that is a JSON object, such as the description of a problem.
bool has_object(const json& value) {
  if (!value.is_string() || !value.get_ref<const std::string&>().starts_with('{')) {
    return false;
  }
  try {
    check_json_depth(value.get_ref<const std::string&>(), "");
    return json::accept(value.get_ref<const std::string&>());
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

// Brackets within strings do not count. The depth is exact up to the first syntax error; the parser
// does not read beyond it.
void check_json_depth(std::string_view text, const std::string& name) {
  std::size_t depth = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    switch (text[at]) {
      case '[':
      case '{':
        if (++depth > kJsonDepthLimit) {
          const auto line =
              1 + std::count(text.begin(), text.begin() + static_cast<long>(at), '\n');
          throw Error(ErrorKind::bad_data,
                      fmt::format("{}:{}: arrays and objects nest deeper than {} levels",
                                  sanitize(name), line, kJsonDepthLimit));
        }
        break;
      case ']':
      case '}':
        depth -= depth > 0 ? 1 : 0;
        break;
      case '"':
        for (++at; at < text.size() && text[at] != '"'; ++at) {
          at += text[at] == '\\' ? 1 : 0;
        }
        break;
      default:
        break;
    }
  }
}

std::string read_json_file(const std::filesystem::path& file, std::size_t limit_bytes) {
  std::string text = read_file(file, limit_bytes);
  check_json_depth(text, file.string());
  return text;
}

std::string describe_json_error(std::string_view message) {
  constexpr std::string_view kEnd = "] ";
  const std::size_t end = message.find(kEnd);
  if (message.starts_with("[json.exception.") && end != std::string_view::npos) {
    message.remove_prefix(end + kEnd.size());
  }
  return sanitize(message);
}

std::vector<std::string> describe_differences(const std::string& recorded_json,
                                              const std::string& now_json) {
  constexpr std::size_t kMostShown = 50;
  const json recorded = json::parse(recorded_json).flatten();
  const json now = json::parse(now_json).flatten();
  std::vector<std::string> differences;
  const auto name = [](const std::string& text) {
    std::vector<std::string> keys;
    for (json::json_pointer pointer(text); !pointer.empty(); pointer.pop_back()) {
      keys.insert(keys.begin(), pointer.back());
    }
    return cut(join(keys, "."));
  };
  const auto show = [](const json& value) { return cut(value.dump()); };
  for (const auto& [key, value] : recorded.items()) {
    if (!now.contains(key)) {
      differences.push_back(fmt::format("{}: recorded {}, now absent", name(key), show(value)));
    } else if (now[key] != value) {
      if (has_object(value) && has_object(now[key])) {
        const auto inner =
            describe_differences(value.get<std::string>(), now[key].get<std::string>());
        for (const std::string& one : inner) {
          differences.push_back(fmt::format("{}.{}", name(key), one));
        }
        if (!inner.empty()) {
          continue;
        }
      }
      differences.push_back(
          fmt::format("{}: recorded {}, now {}", name(key), show(value), show(now[key])));
    }
  }
  for (const auto& [key, value] : now.items()) {
    if (!recorded.contains(key)) {
      differences.push_back(fmt::format("{}: recorded absent, now {}", name(key), show(value)));
    }
  }
  if (differences.size() > kMostShown) {
    const std::size_t left = differences.size() - kMostShown;
    differences.resize(kMostShown);
    differences.push_back(fmt::format("and {} more", left));
  }
  return differences;
}

}  // namespace armwright
