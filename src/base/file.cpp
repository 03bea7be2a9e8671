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

std::string read_all(const FileDescriptor& file, const std::filesystem::path& path,
                     std::size_t limit_bytes, ErrorKind unfit) {
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
      throw Error(unfit, fmt::format("{}: is larger than the limit of {} bytes for such a file",
                                     path.string(), limit_bytes));
    }
  }
}

}  // namespace

void fail_io(const std::filesystem::path& path, std::string_view doing, int error) {
  throw Error(ErrorKind::io,
              fmt::format("{}: cannot {}: {}", path.string(), doing, std::strerror(error)));
}

FileDescriptor open_to_read(const std::filesystem::path& path, ErrorKind unfit) {
  FileDescriptor file(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  struct stat status {};
  if (!file.is_open() || ::fstat(file.get(), &status) != 0) {
    fail_io(path, "open it", errno);
  }
  if (S_ISDIR(status.st_mode)) {
    fail_io(path, "read it", EISDIR);
  }
  if (!S_ISREG(status.st_mode)) {
    throw Error(unfit, fmt::format("{}: is {}; it must be a regular file", path.string(),
                                   describe_file_type(status.st_mode)));
  }
  return file;
}

std::string read_file(const std::filesystem::path& path, std::size_t limit_bytes, ErrorKind unfit) {
  return read_all(open_to_read(path, unfit), path, limit_bytes, unfit);
}

std::string read_input(const std::filesystem::path& path, std::size_t limit_bytes) {
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.is_open()) {
    fail_io(path, "open it", errno);
  }
  return read_all(file, path, limit_bytes, ErrorKind::bad_data);
}

void check_readable(const std::filesystem::path& path) {
  if (::faccessat(AT_FDCWD, path.c_str(), R_OK, AT_EACCESS) != 0 && errno == EACCES) {
    fail_io(path, "read it", errno);
  }
}

AtomicFile::AtomicFile(const Folder& folder, const std::string& name)
    : folder_(folder), name_(name), new_name_(name + ".new"), file_(folder.create(new_name_)) {}

AtomicFile::~AtomicFile() {
  if (!new_name_.empty()) {
    folder_.remove(new_name_);
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
      fail_io(folder_.path() / new_name_, "write it", errno);
    }
    content.remove_prefix(static_cast<std::size_t>(put));
  }
  buffer_.clear();
}

void AtomicFile::commit() {
  write_buffer();
  folder_.put_in_place(file_, new_name_, name_);
  new_name_.clear();
}

void write_file_atomically(const Folder& folder, const std::string& name,
                           std::string_view content) {
  AtomicFile file(folder, name);
  file.write(content);
  file.commit();
}

void write_file_atomically(const std::filesystem::path& path, std::string_view content) {
  write_file_atomically(Folder(path.parent_path()), path.filename().string(), content);
}

}  // namespace armwright
