#include "study/journal/journal_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string>

#include "base/file.hpp"
#include "base/file_descriptor.hpp"

namespace armwright {
namespace {

// Copies the bytes behind `offset`. Holes stay holes.
void copy_from(int source, std::uint64_t offset, int target,
               const std::filesystem::path& source_name, const std::filesystem::path& target_name) {
  struct stat status {};
  if (::fstat(source, &status) != 0) {
    fail_io(source_name, "read its torn end", errno);
  }
  const std::uint64_t begin = offset;
  const auto size = static_cast<std::uint64_t>(status.st_size);
  if (::ftruncate(target, static_cast<off_t>(size - begin)) != 0) {
    fail_io(target_name, "save the torn end of the journal in it", errno);
  }
  std::string chunk(1 << 20, '\0');
  while ((offset = find_data(source, offset, size)) < size) {
    ::lseek(target, static_cast<off_t>(offset - begin), SEEK_SET);
    const ssize_t got = ::pread(source, chunk.data(), chunk.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) {
      continue;
    }
    if (got < 0) {
      fail_io(source_name, "read its torn end", errno);
    }
    if (got == 0) {
      break;
    }
    const auto bytes = static_cast<std::size_t>(got);
    if (const int error = write_fully(target, {chunk.data(), bytes}).error; error != 0) {
      fail_io(target_name, "save the torn end of the journal in it", error);
    }
    offset += bytes;
  }
  if (const int error = sync_data(target); error != 0) {
    fail_io(target_name, "sync it to the disk", error);
  }
}

// Saves the bytes behind `offset` in the first free "<journal>.torn-N".
void save_torn_end(int fd, std::uint64_t offset, const Folder& folder, const std::string& journal) {
  for (int n = 1;; ++n) {
    const std::string name = fmt::format("{}.torn-{}", journal, n);
    FileDescriptor target(::openat(folder.get(), name.c_str(),
                                   O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0644));
    if (!target.is_open() && errno == EEXIST) {
      continue;
    }
    const auto file = folder.path() / name;
    if (!target.is_open()) {
      fail_io(file, "save the torn end of the journal in it", errno);
    }
    try {
      copy_from(fd, offset, target.get(), folder.path() / journal, file);
      if (target.close() != 0) {
        fail_io(file, "close it", errno);
      }
    } catch (...) {
      folder.remove(name);  // the journal is still complete, so half a copy is removed
      throw;
    }
    return;
  }
}

}  // namespace

WriteResult write_fully(int fd, std::string_view bytes) {
  WriteResult result;
  while (result.written < bytes.size()) {
    const ssize_t put = ::write(fd, bytes.data() + result.written, bytes.size() - result.written);
    if (put < 0 && errno == EINTR) {
      continue;
    }
    if (put <= 0) {
      result.error = put < 0 ? errno : EIO;
      break;
    }
    result.written += static_cast<std::size_t>(put);
  }
  return result;
}

int sync_data(int fd) {
  return ::fdatasync(fd) == 0 || errno == EINVAL || errno == EROFS ? 0 : errno;
}

void sync_folder_of(const std::filesystem::path& file) {
  const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  const FileDescriptor descriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (descriptor.is_open()) {
    ::fsync(descriptor.get());
  }
}

std::uint64_t find_data(int fd, std::uint64_t offset, std::uint64_t size) {
  const off_t data = ::lseek(fd, static_cast<off_t>(offset), SEEK_DATA);
  if (data < 0) {
    return errno == ENXIO ? size : offset;  // ENXIO: there are no data behind the offset
  }
  return std::min(static_cast<std::uint64_t>(data), size);
}

bool is_deleted(int fd) {
  struct stat status {};
  return ::fstat(fd, &status) == 0 && status.st_nlink == 0;
}

void cut_torn_end(int fd, std::uint64_t offset, const Folder& folder, const std::string& name) {
  save_torn_end(fd, offset, folder, name);
  folder.sync();
  if (::ftruncate(fd, static_cast<off_t>(offset)) != 0) {
    fail_io(folder.path() / name, "cut off its torn end", errno);
  }
}

}  // namespace armwright
