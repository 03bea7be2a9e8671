// Makes a folder like one of version 1.0, which has no checksums, so that a test can change files in
// it and see what the other checks say.
#pragma once

#include <filesystem>
#include <vector>

#include "base/folder_checksums.hpp"

namespace armwright {

inline void remove_checksums(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> lists;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().filename() == kChecksumFile) {
      lists.push_back(entry.path());
    }
  }
  for (const auto& list : lists) {
    std::filesystem::remove(list);
  }
}

}  // namespace armwright
