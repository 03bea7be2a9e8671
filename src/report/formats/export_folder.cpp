#include "report/formats/export_folder.hpp"

#include <fmt/format.h>
#include <stdio.h>
#include <unistd.h>

#include <cerrno>

#include "base/error.hpp"
#include "base/file.hpp"

namespace armwright {

namespace {

std::filesystem::path claim(const std::filesystem::path& target) {
  const auto folder = normalize_folder(std::filesystem::absolute(target));
  std::error_code ignored;
  if (std::filesystem::exists(std::filesystem::symlink_status(folder, ignored)) &&
      !(std::filesystem::is_directory(folder) && std::filesystem::is_empty(folder))) {
    throw Error(ErrorKind::usage,
                fmt::format("{}: is there already, and nothing is overwritten; choose another "
                            "folder with --out",
                            target.string()));
  }
  return folder;
}

}  // namespace

ExportFolder::ExportFolder(const std::filesystem::path& target) : folder_(claim(target)) {}

void ExportFolder::put_in_place() {
  if (::rename(folder_.path().c_str(), folder_.target().c_str()) != 0) {
    fail_io(folder_.target(), "put it in place", errno);
  }
  folder_.release();
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
