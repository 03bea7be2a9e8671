// The page as one HTML file that needs nothing else: script, style and data stand in it.
//
// Nothing in the data can become markup or code: it is JSON in a block that browsers do not run,
// with every '<' written as \u003c, and a content security policy names the one script and the one
// style by their SHA-256 and forbids all else, the network included.
#pragma once

#include <string>
#include <string_view>

namespace armwright {

// What such a file has near its beginning, and what stands before its data.
inline constexpr const char* kPageMark = "<meta name=\"generator\" content=\"armwright\">";
inline constexpr const char* kPageDataBegin = "<script type=\"application/json\" id=\"data\">";

// `data`: JSON (web/src/data.ts). `live_tag`: not empty for a page that the program serves itself,
// and that asks it for newer data than those with this tag (report/page/page_server.hpp).
std::string make_page_html(std::string_view title, std::string_view data,
                           std::string_view live_tag = {});

}  // namespace armwright
