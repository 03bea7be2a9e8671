// What a look at a folder found: every word of it is for people.
#pragma once

#include <filesystem>
#include <string>
#include <system_error>

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

// Something bears this name, were it a link to nothing.
inline bool is_there(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::exists(std::filesystem::symlink_status(path, ignored));
}

}  // namespace armwright
