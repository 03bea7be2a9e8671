// The script and the style of pages, which the build puts into the program.

#include "base/error.hpp"
#include "report/page/page_file.hpp"

#ifdef ARMWRIGHT_WITH_PAGE

extern "C" {
extern const char armwright_page_js_begin[];
extern const char armwright_page_js_end[];
extern const char armwright_page_css_begin[];
extern const char armwright_page_css_end[];
extern const char armwright_figures_js_begin[];
extern const char armwright_figures_js_end[];
}

namespace armwright {

PageAssets get_page_assets() {
  return {{armwright_page_js_begin, armwright_page_js_end},
          {armwright_page_css_begin, armwright_page_css_end},
          {armwright_figures_js_begin, armwright_figures_js_end}};
}

}  // namespace armwright

#else

namespace armwright {

PageAssets get_page_assets() {
  throw Error(
      ErrorKind::usage,
      "this build has no page: it was configured with -DARMWRIGHT_WITH_PAGE=OFF; install the "
      "Debian packages nodejs, npm and duktape-dev and configure it with ON");
}

}  // namespace armwright

#endif
