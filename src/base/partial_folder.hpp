// A new folder that is whole or not there: it is filled under another name beside its own,
// NAME.partial-N, and renamed at the end. A kill leaves that one behind, which may be removed.
#pragma once

#include <filesystem>

namespace armwright {

// As PartialFolder wants a target to be named: without dots, and without a slash at its end, behind
// which there would be no name to put something beside.
std::filesystem::path normalize_folder(const std::filesystem::path& folder);

class PartialFolder {
 public:
  // Makes NAME.partial-N, with the folders above it. Error{io}.
  explicit PartialFolder(std::filesystem::path target);
  ~PartialFolder();  // removes it, unless it was released
  PartialFolder(const PartialFolder&) = delete;
  PartialFolder& operator=(const PartialFolder&) = delete;

  const std::filesystem::path& target() const { return target_; }
  const std::filesystem::path& path() const { return path_; }  // where to write until then
  void release() { path_.clear(); }                            // it is in place now

 private:
  std::filesystem::path target_;
  std::filesystem::path path_;
};

}  // namespace armwright
