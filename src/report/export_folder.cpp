#include "report/export_folder.hpp"

#include <fmt/format.h>
#include <stdio.h>
#include <unistd.h>

#include <cerrno>

#include "base/error.hpp"
#include "base/file.hpp"

namespace armwright {

ExportFolder::ExportFolder(const std::filesystem::path& target)
    : target_(std::filesystem::absolute(target).lexically_normal()) {
  // "out/" has no name of its own to put something beside.
  if (!target_.has_filename()) {
    target_ = target_.parent_path();
  }
  std::error_code ignored;
  if (std::filesystem::exists(std::filesystem::symlink_status(target_, ignored)) &&
      !(std::filesystem::is_directory(target_) && std::filesystem::is_empty(target_))) {
    throw Error(ErrorKind::usage,
                fmt::format("{}: is there already, and nothing is overwritten; choose another "
                            "folder with --out",
                            target.string()));
  }
  make_folder(target_.parent_path());
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

ExportFolder::~ExportFolder() {
  if (!path_.empty()) {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
}

void ExportFolder::put_in_place() {
  if (::rename(path_.c_str(), target_.c_str()) != 0) {
    fail_io(target_, "put it in place", errno);
  }
  path_.clear();
}

OutputFile::OutputFile(std::filesystem::path path) : path_(std::move(path)) {
  make_folder(path_.parent_path());
  file_.reset(std::fopen(path_.c_str(), "wxe"));
  if (file_ == nullptr) {
    fail_io(path_, "write it", errno);
  }
}

void OutputFile::write(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size()) {
    fail_io(path_, "write it", errno);
  }
}

void OutputFile::close() {
  const bool whole = std::fflush(file_.get()) == 0 &&
                     (::fsync(::fileno(file_.get())) == 0 || errno == EINVAL || errno == EROFS);
  const int error = errno;
  if (std::fclose(file_.release()) != 0 || !whole) {
    fail_io(path_, "write it", whole ? errno : error);
  }
}

void write_output_file(const std::filesystem::path& path, std::string_view text) {
  OutputFile file(path);
  file.write(text);
  file.close();
}

}  // namespace armwright
