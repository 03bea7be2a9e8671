#include "base/file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "base/error.hpp"
#include "base/file_descriptor.hpp"

namespace armwright {
namespace {

FileDescriptor open_file(const std::filesystem::path& path, int flags, std::string_view doing) {
  const int fd = ::open(path.c_str(), flags | O_CLOEXEC, 0644);
  if (fd < 0) {
    fail_io(path, doing, errno);
  }
  return FileDescriptor(fd);
}

// Takes a half-written file away again, unless it was renamed into place.
class TemporaryFile {
 public:
  explicit TemporaryFile(std::filesystem::path path) : path_(std::move(path)) {}
  ~TemporaryFile() {
    if (!path_.empty()) {
      ::unlink(path_.c_str());
    }
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const std::filesystem::path& path() const { return path_; }
  void release() { path_.clear(); }

 private:
  std::filesystem::path path_;
};

}  // namespace

void fail_io(const std::filesystem::path& path, std::string_view doing, int error) {
  throw Error(ErrorKind::io,
              fmt::format("{}: cannot {}: {}", path.string(), doing, std::strerror(error)));
}

std::string read_file(const std::filesystem::path& path, std::size_t limit_bytes) {
  const FileDescriptor file = open_file(path, O_RDONLY, "open it");
  std::string content;
  char buffer[1 << 16];
  while (true) {
    const ssize_t got = ::read(file.get(), buffer, sizeof buffer);
    if (got < 0 && errno == EINTR) {
      continue;
    }
    if (got < 0) {
      fail_io(path, "read it", errno);
    }
    if (got == 0) {
      return content;
    }
    content.append(buffer, static_cast<std::size_t>(got));
    if (content.size() > limit_bytes) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("{}: is larger than the limit of {} bytes for such a file",
                              path.string(), limit_bytes));
    }
  }
}

void write_file_atomically(const std::filesystem::path& path, std::string_view content) {
  const std::filesystem::path new_path = path.string() + ".new";
  FileDescriptor file = open_file(new_path, O_WRONLY | O_CREAT | O_TRUNC, "write it");
  TemporaryFile temporary(new_path);
  while (!content.empty()) {
    const ssize_t put = ::write(file.get(), content.data(), content.size());
    if (put < 0 && errno == EINTR) {
      continue;
    }
    if (put < 0) {
      fail_io(temporary.path(), "write it", errno);
    }
    content.remove_prefix(static_cast<std::size_t>(put));
  }
  if (::fsync(file.get()) != 0 && errno != EINVAL && errno != EROFS) {
    fail_io(temporary.path(), "sync it to the disk", errno);
  }
  if (file.close() != 0) {
    fail_io(temporary.path(), "close it", errno);
  }
  if (::rename(temporary.path().c_str(), path.c_str()) != 0) {
    fail_io(path, "put it in place", errno);
  }
  temporary.release();
  const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  const FileDescriptor directory = open_file(folder, O_RDONLY | O_DIRECTORY, "open its folder");
  ::fsync(
      directory.get());  // some file systems cannot sync a folder; the rename itself has succeeded
}

void make_folder(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  std::error_code unknown;
  if (error || !std::filesystem::is_directory(path, unknown)) {
    fail_io(path, "create this folder", error ? error.value() : ENOTDIR);
  }
}

}  // namespace armwright
