// Text as HTML, in an element or a quoted attribute.
#pragma once

#include <string>
#include <string_view>

namespace armwright {

std::string escape_html(std::string_view text);

}  // namespace armwright
