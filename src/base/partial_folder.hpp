// A new folder that appears only when it is complete. It is filled under another name beside its
// own, NAME.partial-N, and renamed at the end. After a kill, NAME.partial-N remains and may be
// removed.
#pragma once

#include <filesystem>

namespace armwright {

// Returns the path without dots and without a slash at its end, so that it has a last name.
// PartialFolder needs this form.
std::filesystem::path normalize_folder(const std::filesystem::path& folder);

class PartialFolder {
 public:
  // Makes NAME.partial-N and its parent folders. Throws Error{io}.
  explicit PartialFolder(std::filesystem::path target);
  ~PartialFolder();  // removes the partial folder unless it was released
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
