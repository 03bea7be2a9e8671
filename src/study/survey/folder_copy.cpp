#include "study/survey/folder_copy.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "study/journal_file.hpp"

namespace armwright {
namespace {

void sync_folder(const std::filesystem::path& folder) {
  const FileDescriptor descriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!descriptor.is_open()) {
    fail_io(folder, "open it", errno);
  }
  ::fsync(descriptor.get());  // some file systems cannot
}

[[noreturn]] void refuse_target(const std::filesystem::path& target) {
  throw Error(ErrorKind::usage,
              fmt::format("{}: is there already, and nothing is overwritten; name another folder "
                          "with --out",
                          sanitize(target.string())));
}

}  // namespace

FolderCopy::FolderCopy(const std::filesystem::path& target, StopSignal& stop)
    : target_(target.lexically_normal()), stop_(stop) {
  if (!target_.has_filename()) {
    target_ = target_.parent_path();  // "results/mine/"
  }
  std::error_code ignored;
  if (std::filesystem::exists(std::filesystem::symlink_status(target_, ignored))) {
    refuse_target(target_);
  }
  if (target_.has_parent_path()) {
    armwright::make_folder(target_.parent_path());
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

FolderCopy::~FolderCopy() {
  if (!path_.empty()) {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
}

void FolderCopy::check_stop() {
  if (stop_.requested()) {
    throw CopyStopped();
  }
}

void FolderCopy::make_folder(const std::filesystem::path& name) {
  armwright::make_folder(path_ / name);
}

bool FolderCopy::add(const std::filesystem::path& source, const std::filesystem::path& name) {
  check_stop();
  const auto status = std::filesystem::symlink_status(source);
  if (std::filesystem::is_symlink(status)) {
    std::filesystem::copy_symlink(source, path_ / name);
    return true;
  }
  if (!std::filesystem::is_regular_file(status)) {
    return false;
  }
  const FileDescriptor file(::open(source.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  struct stat found {};
  if (!file.is_open() || ::fstat(file.get(), &found) != 0) {
    fail_io(source, "open it", errno);
  }
  add_file(name, [&](int fd) {
    copy_bytes(file.get(), 0, static_cast<std::uint64_t>(found.st_size), fd, source);
    if (::fchmod(fd, found.st_mode & 0777) != 0) {
      fail_io(path_ / name, "set its rights", errno);
    }
  });
  return true;
}

void FolderCopy::add_file(const std::filesystem::path& name,
                          const std::function<void(int fd)>& write) {
  const auto path = path_ / name;
  FileDescriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644));
  if (!file.is_open()) {
    fail_io(path, "write it", errno);
  }
  write(file.get());
  if (const int error = sync_data(file.get()); error != 0) {
    fail_io(path, "sync it to the disk", error);
  }
  if (file.close() != 0) {
    fail_io(path, "close it", errno);
  }
}

void FolderCopy::copy_bytes(int source, std::uint64_t offset, std::uint64_t bytes, int target,
                            const std::filesystem::path& source_name) {
  constexpr std::uint64_t kChunk_bytes = 1 << 20;
  std::string chunk(std::min(kChunk_bytes, bytes), '\0');
  while (bytes > 0) {
    check_stop();
    const ssize_t got = ::pread(source, chunk.data(), std::min<std::uint64_t>(chunk.size(), bytes),
                                static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) {
      continue;
    }
    if (got <= 0) {
      fail_io(source_name, "read it", got < 0 ? errno : EIO);
    }
    const auto part = static_cast<std::size_t>(got);
    if (const int error = write_fully(target, {chunk.data(), part}).error; error != 0) {
      fail_io(target_, "write a file of the copy", error);
    }
    offset += part;
    bytes -= part;
  }
}

void FolderCopy::put_in_place() {
  check_stop();
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path_)) {
    if (entry.is_directory() && !entry.is_symlink()) {
      sync_folder(entry.path());
    }
  }
  sync_folder(path_);
  if (::renameat2(AT_FDCWD, path_.c_str(), AT_FDCWD, target_.c_str(), RENAME_NOREPLACE) != 0) {
    const bool is_there = errno == EEXIST;
    // File systems that cannot refuse to replace: at most an empty folder would be.
    if (is_there || errno != EINVAL || ::rename(path_.c_str(), target_.c_str()) != 0) {
      if (is_there) {
        refuse_target(target_);
      }
      fail_io(target_, "put it in place", errno);
    }
  }
  path_.clear();
  sync_folder_of(target_);
}

}  // namespace armwright
