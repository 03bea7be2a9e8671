// What a look at a folder found: every word of it is for people.
#pragma once

#include <filesystem>
#include <string>

namespace armwright {

struct Finding {
  enum class Kind {
    note,    // nothing is wrong
    damage,  // repair makes a copy without it
    loss     // damage that no repair mends
  };
  Kind kind = Kind::note;
  std::filesystem::path file;  // as seen from the folder that was asked about
  std::string what;
};

}  // namespace armwright
