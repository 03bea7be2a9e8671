// Opens an address in the user's web browser.
#pragma once

#include <string>

namespace armwright {

// Starts the user's browser with the address, if stdout is a terminal and the user has a display
// (DISPLAY or WAYLAND_DISPLAY) or names a browser in BROWSER. The first command of BROWSER is
// started, otherwise xdg-open; no shell is involved. The browser belongs to a session of its own and
// its output is dropped. Does nothing if it cannot be started.
void open_in_browser(const std::string& url);

}  // namespace armwright
