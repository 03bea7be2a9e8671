// A request to the server of `armwright watch`: what is read has a method and a path without control
// characters. Written and read back, the request is the same.
#include "report/page/http_request.hpp"

#include <algorithm>

#include "fuzz/harness.hpp"

namespace armwright::fuzz {
namespace {

void require_plain(const std::string& text) {
  require(
      std::ranges::none_of(text, [](unsigned char c) { return c == '\r' || c == '\n' || c == 0; }),
      "a line end within a value");
}

std::string write_request(const HttpRequest& request) {
  std::string text = request.method + " " + request.target + " HTTP/1.1\r\n";
  for (const std::string& host : request.hosts) {
    text += "Host: " + host + "\r\n";
  }
  return text + "If-None-Match: " + request.if_none_match + "\r\n\r\n";
}

}  // namespace

void fuzz_http_request(std::string_view input) {
  const auto end = find_head_end(input);
  require(!end || (*end >= 4 && *end <= input.size()), "an end outside the input");
  const auto request = parse_request_head(end ? input.substr(0, *end) : input);
  if (!request) {
    return;
  }
  require(!request->method.empty() && request->method.find(' ') == std::string::npos,
          "a method that is no word");
  require(request->target.starts_with('/'), "a target that is no path");
  require_plain(request->method);
  require_plain(request->target);
  require_plain(request->if_none_match);
  std::ranges::for_each(request->hosts, require_plain);
  const auto again = parse_request_head(write_request(*request));
  require(again && again->method == request->method && again->target == request->target &&
              again->hosts == request->hosts && again->if_none_match == request->if_none_match,
          "another request when written and read back");
}

}  // namespace armwright::fuzz
