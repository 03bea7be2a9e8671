#include "base/folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "base/error.hpp"
#include "base/file.hpp"

namespace armwright {
namespace {

constexpr int kOpenFolder = O_RDONLY | O_DIRECTORY | O_CLOEXEC;

// Opens the folder `name` in an open folder, or makes it. `path` is its whole path, for messages.
FileDescriptor enter(int folder, const std::string& name, const std::filesystem::path& path) {
  const auto open_it = [&] {
    return FileDescriptor(::openat(folder, name.c_str(), kOpenFolder | O_NOFOLLOW));
  };
  FileDescriptor found = open_it();
  if (!found.is_open() && errno == ENOENT) {
    if (::mkdirat(folder, name.c_str(), 0777) != 0 && errno != EEXIST) {
      fail_io(path, "create this folder", errno);
    }
    found.reset(open_it().release());
  }
  if (found.is_open()) {
    return found;
  }
  const int error = errno;
  struct stat status {};
  if ((error == ENOTDIR || error == ELOOP) &&
      ::fstatat(folder, name.c_str(), &status, AT_SYMLINK_NOFOLLOW) == 0) {
    throw Error(
        ErrorKind::bad_data,
        fmt::format("{}: is {}, and must be a folder, because armwright follows no links in "
                    "a folder that it writes. Put a folder in its place, or choose another "
                    "one with --out",
                    path.string(), describe_file_type(status.st_mode)));
  }
  fail_io(path, "open this folder", error);
}

// Returns the status of what the path leads to; "not found" is no error.
std::filesystem::file_status find_status(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::none) {
    fail_io(path, "look for it", error.value());
  }
  return status;
}

template <class Iterator>
std::vector<std::filesystem::path> list_entries(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> entries;
  std::error_code error;
  for (Iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    entries.push_back(entry->path());
  }
  if (error) {
    fail_io(folder, "list it", error.value());
  }
  std::ranges::sort(entries);
  return entries;
}

}  // namespace

Folder::Folder(std::filesystem::path path, int descriptor)
    : path_(std::move(path)), descriptor_(std::make_shared<const FileDescriptor>(descriptor)) {}

Folder::Folder(const std::filesystem::path& path)
    : Folder(path, ::open(path.empty() ? "." : path.c_str(), kOpenFolder)) {
  if (!descriptor_->is_open()) {
    fail_io(path_, "open this folder", errno);
  }
}

Folder Folder::make(const std::filesystem::path& path, const std::filesystem::path& root) {
  const std::filesystem::path& begin = root.empty() ? path : root;
  std::error_code error;
  std::filesystem::create_directories(begin, error);
  if (error) {
    fail_io(path, "create this folder", error.value());
  }
  Folder folder(begin);
  const std::filesystem::path rest = path.lexically_relative(begin);
  if (rest.empty() || *rest.begin() == "..") {
    throw std::logic_error(fmt::format("{} is not in {}", path.string(), begin.string()));
  }
  for (const std::filesystem::path& name : rest) {
    if (!name.empty() && name != ".") {
      const auto inside = folder.path_ / name;
      folder = Folder(inside, enter(folder.get(), name.string(), inside).release());
    }
  }
  return folder;
}

FileDescriptor Folder::create(const std::string& name) const {
  // A process that makes the same name again and again could otherwise keep this one busy for ever.
  constexpr int kMostTries = 20;
  for (int tries = 0; tries < kMostTries; ++tries) {
    FileDescriptor file(
        ::openat(get(), name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0644));
    if (file.is_open()) {
      return file;
    }
    if (errno != EEXIST) {
      fail_io(path_ / name, "write it", errno);
    }
    if (::unlinkat(get(), name.c_str(), 0) != 0 && errno != ENOENT) {
      fail_io(path_ / name, "remove it, to write it anew", errno);
    }
  }
  throw Error(ErrorKind::busy, fmt::format("{}: another process makes this file again and again; "
                                           "stop it, or choose another folder with --out",
                                           (path_ / name).string()));
}

FileDescriptor Folder::open(const std::string& name, int flags) const {
  // Without O_NONBLOCK, opening a named pipe would block before it could be refused.
  FileDescriptor file(
      ::openat(get(), name.c_str(), flags | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC, 0644));
  const int error = errno;
  struct stat status {};
  const bool is_known = file.is_open()
                            ? ::fstat(file.get(), &status) == 0
                            : ::fstatat(get(), name.c_str(), &status, AT_SYMLINK_NOFOLLOW) == 0;
  const auto path = path_ / name;
  if (is_known && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode)) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: is {}, and armwright writes only regular files that it made "
                            "itself. Remove it, or choose another folder with --out",
                            path.string(), describe_file_type(status.st_mode)));
  }
  if (!file.is_open()) {
    fail_io(path, "open it", error);
  }
  if (status.st_nlink > 1) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: has {} names (hard links), and all of them would change with it. "
                            "Put a copy of the file in its place, or choose another folder with "
                            "--out",
                            path.string(), status.st_nlink));
  }
  return file;
}

void Folder::put_in_place(FileDescriptor& file, const std::string& name,
                          const std::string& target) const {
  // Some file systems cannot sync and return one of these errors; the file is still written.
  if (::fsync(file.get()) != 0 && errno != EINVAL && errno != EROFS) {
    fail_io(path_ / name, "sync it to the disk", errno);
  }
  struct stat ours {};
  struct stat named {};
  if (::fstat(file.get(), &ours) != 0) {
    fail_io(path_ / name, "find it", errno);
  }
  if (::fstatat(get(), name.c_str(), &named, AT_SYMLINK_NOFOLLOW) != 0) {
    fail_io(path_ / target, "put it in place", errno);
  }
  if (ours.st_dev != named.st_dev || ours.st_ino != named.st_ino) {
    throw Error(ErrorKind::busy, fmt::format("{}: another process has replaced this file while it "
                                             "was written; stop it, or choose another folder with "
                                             "--out",
                                             (path_ / name).string()));
  }
  if (file.close() != 0) {
    fail_io(path_ / name, "close it", errno);
  }
  if (::renameat(get(), name.c_str(), get(), target.c_str()) != 0) {
    fail_io(path_ / target, "put it in place", errno);
  }
  sync();
}

void Folder::remove(const std::string& name) const {
  ::unlinkat(get(), name.c_str(), 0);
}

void Folder::sync() const {
  ::fsync(get());
}

void make_folder(const std::filesystem::path& path) {
  Folder::make(path, path);
}

bool path_exists(const std::filesystem::path& path) {
  return std::filesystem::exists(find_status(path));
}

bool regular_file_exists(const std::filesystem::path& path) {
  return std::filesystem::is_regular_file(find_status(path));
}

bool folder_exists(const std::filesystem::path& path) {
  return std::filesystem::is_directory(find_status(path));
}

std::vector<std::filesystem::path> list_folder(const std::filesystem::path& folder) {
  return list_entries<std::filesystem::directory_iterator>(folder);
}

std::vector<std::filesystem::path> list_tree(const std::filesystem::path& folder) {
  return list_entries<std::filesystem::recursive_directory_iterator>(folder);
}

const char* describe_file_type(unsigned mode) {
  switch (mode & S_IFMT) {
    case S_IFREG:
      return "a file";
    case S_IFDIR:
      return "a folder";
    case S_IFLNK:
      return "a symbolic link";
    case S_IFIFO:
      return "a named pipe";
    case S_IFSOCK:
      return "a socket";
    default:
      return "a device";
  }
}

}  // namespace armwright
