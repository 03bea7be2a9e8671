#include "report/page/http_request.hpp"

#include <algorithm>
#include <utility>

namespace armwright {
namespace {

constexpr std::string_view kLineEnd = "\r\n";

// Returns the text before the next line end and removes both from `rest`.
std::string_view take_line(std::string_view& rest) {
  const std::size_t end = rest.find(kLineEnd);
  const std::string_view line = rest.substr(0, end);
  rest.remove_prefix(std::min(rest.size(), line.size() + kLineEnd.size()));
  return line;
}

bool is_control(char c) {
  return static_cast<unsigned char>(c) < 0x20 || c == 0x7F;
}

// Returns whether the character may stand in a method or in a header's name (RFC 9110, 5.6.2).
bool is_token(char c) {
  return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
         std::string_view("!#$%&'*+-.^_`|~").find(c) != std::string_view::npos;
}

std::string_view trim(std::string_view text) {
  constexpr std::string_view kBlanks = " \t";
  const std::size_t begin = std::min(text.size(), text.find_first_not_of(kBlanks));
  return text.substr(begin, text.find_last_not_of(kBlanks) + 1 - begin);
}

bool is_name(std::string_view text, std::string_view name) {
  return std::ranges::equal(text, name, [](char a, char b) {
    return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b;
  });
}

}  // namespace

std::optional<std::size_t> find_head_end(std::string_view received) {
  const std::size_t end = received.find("\r\n\r\n");
  return end == std::string_view::npos ? std::nullopt : std::optional(end + 4);
}

std::optional<HttpRequest> parse_request_head(std::string_view head) {
  HttpRequest request;
  const std::string_view first = take_line(head);
  const std::size_t method_end = std::min(first.size(), first.find(' '));
  const std::string_view behind = first.substr(std::min(first.size(), method_end + 1));
  const std::size_t target_end = std::min(behind.size(), behind.find(' '));
  const std::string_view version = behind.substr(target_end);
  request.method = first.substr(0, method_end);
  request.target = behind.substr(0, target_end);
  if (request.method.empty() || !std::ranges::all_of(request.method, is_token) ||
      !request.target.starts_with('/') || std::ranges::any_of(request.target, is_control) ||
      (version != " HTTP/1.1" && version != " HTTP/1.0")) {
    return std::nullopt;
  }
  for (std::string_view line = take_line(head); !line.empty(); line = take_line(head)) {
    const std::size_t colon = line.find(':');
    const std::string_view name = line.substr(0, colon);
    if (colon == std::string_view::npos || name.empty() || !std::ranges::all_of(name, is_token)) {
      return std::nullopt;
    }
    const std::string_view value = trim(line.substr(colon + 1));
    if (std::ranges::any_of(value, [](char c) { return is_control(c) && c != '\t'; })) {
      return std::nullopt;
    }
    if (is_name(name, "host")) {
      request.hosts.emplace_back(value);
    } else if (is_name(name, "if-none-match")) {
      request.if_none_match = value;
    }
  }
  return request;
}

}  // namespace armwright
