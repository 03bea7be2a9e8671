// What a page is made with, whatever it shows.
#pragma once

#include <string>
#include <vector>

namespace armwright {

struct PageOptions {
  unsigned jobs = 1;               // threads
  std::vector<std::string> cases;  // "test/2:17": to record beside the usual
  bool simulate = true;  // false: nothing is simulated, parts that need it are left out with a note
};

}  // namespace armwright
