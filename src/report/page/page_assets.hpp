// What web/ was built into, carried in the program as bytes.
#pragma once

#include <string_view>

namespace armwright {

struct PageAssets {
  std::string_view script;   // of the page, one classic script
  std::string_view style;    // CSS
  std::string_view figures;  // the figures without a browser, ES5 (report/page/plotter.hpp)
};

// Error{usage} if this build has none, with what to do about it.
PageAssets get_page_assets();

}  // namespace armwright
