#include "base/partial_folder.hpp"

#include <fmt/format.h>

#include <system_error>
#include <utility>

#include "base/file.hpp"

namespace armwright {

std::filesystem::path normalize_folder(const std::filesystem::path& folder) {
  const std::filesystem::path normal = folder.lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

PartialFolder::PartialFolder(std::filesystem::path target) : target_(std::move(target)) {
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

PartialFolder::~PartialFolder() {
  if (!path_.empty()) {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
}

}  // namespace armwright
