// Arrays of numbers for the page: little-endian, in base64 (RFC 4648, section 4, with padding), as
// Packed in web/src/data.ts.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>

namespace armwright {

nlohmann::json pack_f32(std::span<const float> values);          // {"f32": ...}
nlohmann::json pack_u32(std::span<const std::uint32_t> values);  // {"u32": ...}

}  // namespace armwright
