// A new folder that appears only when it is complete. It is filled under another name beside its
// own, NAME.partial-N, and renamed at the end. After a kill, NAME.partial-N remains and may be
// removed.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <system_error>
#include <utility>

#include "base/file.hpp"

namespace armwright {

// Returns the path without dots and without a slash at its end, so that it has a last name.
// PartialFolder needs this form.
inline std::filesystem::path normalize_folder(const std::filesystem::path& folder) {
  const std::filesystem::path normal = folder.lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

class PartialFolder {
 public:
  // Makes NAME.partial-N and its parent folders. Throws Error{io}.
  explicit PartialFolder(std::filesystem::path target) : target_(std::move(target)) {
    if (target_.has_parent_path()) {
      make_folder(target_.parent_path());
    }
    for (int number = 1; path_.empty(); ++number) {
      const std::filesystem::path path = fmt::format("{}.partial-{}", target_.string(), number);
      std::error_code error;
      if (std::filesystem::create_directory(path, error)) {
        path_ = path;
      } else if (error) {
        fail_io(path, "create this folder", error.value());
      }
    }
  }
  // Removes the partial folder unless it was released.
  ~PartialFolder() {
    if (!path_.empty()) {
      std::error_code ignored;
      std::filesystem::remove_all(path_, ignored);
    }
  }
  PartialFolder(const PartialFolder&) = delete;
  PartialFolder& operator=(const PartialFolder&) = delete;

  const std::filesystem::path& target() const { return target_; }
  const std::filesystem::path& path() const { return path_; }  // write here
  void release() { path_.clear(); }                            // call it after the rename

 private:
  std::filesystem::path target_;
  std::filesystem::path path_;
};

}  // namespace armwright
