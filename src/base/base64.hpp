// Encodes bytes as text and decodes it (RFC 4648, with padding).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace armwright {

std::string to_base64(std::span<const std::uint8_t> bytes);
// Returns nothing if the text is not the base64 of any bytes.
std::optional<std::string> from_base64(std::string_view text);

}  // namespace armwright
