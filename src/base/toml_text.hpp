// Text as TOML writes it.
#pragma once

#include <string>
#include <string_view>

namespace armwright {

// A string in quotation marks, which a TOML reader reads back as it is; what is not UTF-8 in it is
// replaced.
std::string quote_toml(std::string_view text);

}  // namespace armwright
