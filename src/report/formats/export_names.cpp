#include "report/formats/export_names.hpp"

#include <fmt/format.h>

namespace armwright {
namespace {

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

// Every character that is neither letter nor digit nor among `allowed` becomes one '_', however
// many bytes it has.
std::string replace_others(std::string_view text, std::string_view allowed) {
  std::string replaced;
  for (const char c : text) {
    const bool continues = (static_cast<unsigned char>(c) & 0xC0) == 0x80;
    if (is_letter(c) || is_digit(c) || allowed.find(c) != std::string_view::npos) {
      replaced += c;
    } else if (!continues) {
      replaced += '_';
    }
  }
  return replaced;
}

}  // namespace

std::string escape_file_name(std::string_view name) {
  constexpr std::size_t kLongest = 80;  // leaves room for what is put around it; 255 is the limit
  std::string escaped = replace_others(name, "_-.").substr(0, kLongest);
  if (escaped.empty()) {
    return "unnamed";
  }
  if (escaped.front() == '.' || escaped.front() == '-') {
    escaped.front() = '_';
  }
  return escaped;
}

std::string escape_column_name(std::string_view name) {
  std::string escaped = replace_others(name, "_");
  return escaped.empty() || !is_letter(escaped.front()) ? "c_" + escaped : escaped;
}

std::string UniqueNames::add(const std::string& name) {
  const auto take = [&](const std::string& one) {
    std::string small;
    for (const char c : one) {
      small += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    }
    return taken_.insert(small).second;
  };
  if (take(name)) {
    return name;
  }
  for (int number = 2;; ++number) {
    std::string other = fmt::format("{}{}{}", name, separator_, number);
    if (take(other)) {
      return other;
    }
  }
}

std::map<std::string, std::string> make_file_names(std::span<const std::string> names) {
  UniqueNames unique;
  std::map<std::string, std::string> files;
  for (const std::string& name : names) {
    if (!files.contains(name)) {
      files[name] = unique.add(escape_file_name(name));
    }
  }
  return files;
}

}  // namespace armwright
