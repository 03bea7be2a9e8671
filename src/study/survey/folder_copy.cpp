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
#include "study/journal/journal_file.hpp"

namespace armwright {
namespace {

void sync_folder(const std::filesystem::path& folder) {
  const FileDescriptor descriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!descriptor.is_open()) {
    fail_io(folder, "open it", errno);
  }
  ::fsync(descriptor.get());  // ignored: some file systems cannot sync a folder
}

[[noreturn]] void refuse_target(const std::filesystem::path& target) {
  throw Error(ErrorKind::usage,
              fmt::format("{}: is there already, and nothing is overwritten; name another folder "
                          "with --out",
                          sanitize(target.string())));
}

std::filesystem::path claim(const std::filesystem::path& target) {
  const auto folder = normalize_folder(target);
  std::error_code ignored;
  if (std::filesystem::exists(std::filesystem::symlink_status(folder, ignored))) {
    refuse_target(folder);
  }
  return folder;
}

}  // namespace

FolderCopy::FolderCopy(const std::filesystem::path& target, StopSignal& stop)
    : folder_(claim(target)), stop_(stop) {}

void FolderCopy::check_stop() {
  if (stop_.requested()) {
    throw WorkStopped();
  }
}

void FolderCopy::make_folder(const std::filesystem::path& name) {
  armwright::make_folder(folder_.path() / name);
}

bool FolderCopy::add(const std::filesystem::path& source, const std::filesystem::path& name) {
  check_stop();
  std::error_code error;
  const auto status = std::filesystem::symlink_status(source, error);
  if (std::filesystem::is_symlink(status)) {
    std::filesystem::copy_symlink(source, folder_.path() / name, error);
  }
  if (error) {
    fail_io(source, "copy it", error.value());
  }
  if (std::filesystem::is_symlink(status)) {
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
      fail_io(folder_.path() / name, "set its rights", errno);
    }
  });
  return true;
}

void FolderCopy::add_file(const std::filesystem::path& name,
                          const std::function<void(int fd)>& write) {
  const auto path = folder_.path() / name;
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
      fail_io(folder_.target(), "write a file of the copy", error);
    }
    offset += part;
    bytes -= part;
  }
}

void FolderCopy::put_in_place() {
  check_stop();
  for (const auto& path : list_tree(folder_.path())) {
    std::error_code ignored;
    if (std::filesystem::is_directory(std::filesystem::symlink_status(path, ignored))) {
      sync_folder(path);
    }
  }
  sync_folder(folder_.path());
  if (::renameat2(AT_FDCWD, folder_.path().c_str(), AT_FDCWD, folder_.target().c_str(),
                  RENAME_NOREPLACE) != 0) {
    const bool is_there = errno == EEXIST;
    // EINVAL: the file system cannot refuse to replace. rename() replaces an empty folder at most.
    if (is_there || errno != EINVAL ||
        ::rename(folder_.path().c_str(), folder_.target().c_str()) != 0) {
      if (is_there) {
        refuse_target(folder_.target());
      }
      fail_io(folder_.target(), "put it in place", errno);
    }
  }
  folder_.release();
  sync_folder_of(folder_.target());
}

}  // namespace armwright
