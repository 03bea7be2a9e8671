// Writes text as TOML.
#pragma once

#include <string>
#include <string_view>

namespace armwright {

// Returns a quoted TOML string that reads back as the same text. Bytes that are not UTF-8 are
// replaced.
std::string quote_toml(std::string_view text);

}  // namespace armwright
