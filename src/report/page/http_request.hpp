// Reads the head of an HTTP/1.1 request (RFC 9112), as much of it as the server of pages needs.
// The server answers only GET and HEAD, so the bytes behind the head are never looked at.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace armwright {

// The most bytes of a head: its first line and all headers. Browsers send less than 2 KiB.
inline constexpr std::size_t kRequestHeadLimit_bytes = std::size_t{16} << 10;

struct HttpRequest {
  std::string method;
  std::string target;              // begins with '/'
  std::vector<std::string> hosts;  // the value of every Host header
  std::string if_none_match;       // empty if there is no such header
};

// Returns the length of the head at the beginning of `received`, with the empty line that ends it.
// Returns nothing if the head is not complete.
std::optional<std::size_t> find_head_end(std::string_view received);

// Reads a complete head. Returns nothing if it is malformed: another version, a target that is no
// path, a line without a name, folded lines, control characters.
std::optional<HttpRequest> parse_request_head(std::string_view head);

}  // namespace armwright
