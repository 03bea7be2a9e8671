// Opens an address in the user's web browser.
#pragma once

#include <memory>
#include <string>

#include "base/temporary_folder.hpp"

namespace armwright {

// An object of this class is an address that was opened in a browser. All users of a machine can read
// the command lines of its processes. The browser therefore gets the name of a file that leads to
// the address. Only the user can read this file; the destructor removes it.
class OpenedAddress {
 public:
  // Starts the user's browser, if stdout is a terminal and the user has a display (DISPLAY or
  // WAYLAND_DISPLAY) or names a browser in BROWSER. The first command of BROWSER is started,
  // otherwise xdg-open; no shell is involved. The browser belongs to a session of its own and its
  // output is dropped. Does nothing if the file cannot be written or the browser cannot be started.
  // The address must need no escapes in HTML.
  explicit OpenedAddress(const std::string& url);

 private:
  std::unique_ptr<TemporaryFolder> folder_;  // null if nothing was opened
};

}  // namespace armwright
