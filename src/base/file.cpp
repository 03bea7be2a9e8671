#include "base/file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "base/error.hpp"
#include "base/read_limit.hpp"

namespace armwright {
namespace {

FileDescriptor open_file(const std::filesystem::path& path, int flags, std::string_view doing) {
  const int fd = ::open(path.c_str(), flags | O_CLOEXEC, 0644);
  if (fd < 0) {
    fail_io(path, doing, errno);
  }
  return FileDescriptor(fd);
}

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
    check_reading();
    if (content.size() > limit_bytes) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("{}: is larger than the limit of {} bytes for such a file",
                              path.string(), limit_bytes));
    }
  }
}

AtomicFile::AtomicFile(const std::filesystem::path& path)
    : path_(path),
      new_path_(path.string() + ".new"),
      file_(open_file(new_path_, O_WRONLY | O_CREAT | O_TRUNC, "write it")) {}

AtomicFile::~AtomicFile() {
  if (!new_path_.empty()) {
    ::unlink(new_path_.c_str());
  }
}

void AtomicFile::write(std::string_view content) {
  constexpr std::size_t kBufferBytes = std::size_t{256} << 10;
  buffer_ += content;
  if (buffer_.size() >= kBufferBytes) {
    write_buffer();
  }
}

void AtomicFile::write_buffer() {
  std::string_view content = buffer_;
  while (!content.empty()) {
    const ssize_t put = ::write(file_.get(), content.data(), content.size());
    if (put < 0 && errno == EINTR) {
      continue;
    }
    if (put < 0) {
      fail_io(new_path_, "write it", errno);
    }
    content.remove_prefix(static_cast<std::size_t>(put));
  }
  buffer_.clear();
}

void AtomicFile::commit() {
  write_buffer();
  if (file_.close() != 0) {
    fail_io(new_path_, "close it", errno);
  }
  put_in_place(new_path_, path_);
  new_path_.clear();
}

void put_in_place(const std::filesystem::path& file, const std::filesystem::path& path) {
  {
    const FileDescriptor descriptor = open_file(file, O_RDONLY, "open it");
    // Some file systems cannot sync and return one of these errors; the file is still written.
    if (::fsync(descriptor.get()) != 0 && errno != EINVAL && errno != EROFS) {
      fail_io(file, "sync it to the disk", errno);
    }
  }
  if (::rename(file.c_str(), path.c_str()) != 0) {
    fail_io(path, "put it in place", errno);
  }
  const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  const FileDescriptor directory = open_file(folder, O_RDONLY | O_DIRECTORY, "open its folder");
  // Errors are ignored: some file systems cannot sync a folder, and the rename has succeeded.
  ::fsync(directory.get());
}

void write_file_atomically(const std::filesystem::path& path, std::string_view content) {
  AtomicFile file(path);
  file.write(content);
  file.commit();
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
