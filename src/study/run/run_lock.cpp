#include "study/run/run_lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <string>
#include <string_view>
#include <thread>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

// Returns the name that the holder has written, or "another process" if it has not written it yet.
std::string read_holder(int fd) {
  std::array<char, 512> text{};
  const ssize_t got = ::pread(fd, text.data(), text.size(), 0);
  std::string_view line(text.data(), got > 0 ? static_cast<std::size_t>(got) : 0);
  line = line.substr(0, line.find('\n'));
  return line.empty() ? "another process" : sanitize(line);
}

void write_holder(int fd, const std::filesystem::path& file) {
  const std::string line = fmt::format("process {} on {}\n", ::getpid(), get_host_name());
  if (::ftruncate(fd, 0) != 0) {
    fail_io(file, "empty it", errno);
  }
  const ssize_t put = ::pwrite(fd, line.data(), line.size(), 0);
  if (put != static_cast<ssize_t>(line.size())) {
    fail_io(file, "write it", put < 0 ? errno : ENOSPC);
  }
}

// Returns 0 or an errno.
int try_lock(int fd, int operation) {
  while (::flock(fd, operation | LOCK_NB) != 0) {
    if (errno != EINTR) {
      return errno;
    }
  }
  return 0;
}

int open_for_reading(const std::filesystem::path& folder) {
  return ::open((folder / "lock").c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
}

}  // namespace

std::string get_host_name() {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0 || name[0] == '\0') {
    return "an unnamed host";
  }
  return name.data();
}

RunLock::RunLock(const Folder& folder) : fd_(folder.open("lock", O_RDWR | O_CREAT)) {
  const auto file = folder.path() / "lock";
  // find_writer() holds the lock for an instant, so a busy lock is tried again.
  constexpr int kTries = 5;
  constexpr std::chrono::milliseconds kPause{2};
  for (int tries = 1; true; ++tries) {
    const int error = try_lock(fd_.get(), LOCK_EX);
    if (error == 0) {
      break;
    }
    if (error == EWOULDBLOCK && tries < kTries) {
      std::this_thread::sleep_for(kPause);
      continue;
    }
    if (error == EWOULDBLOCK) {
      throw Error(ErrorKind::busy, fmt::format("{} is in use by {}; wait for it, stop it, or use "
                                               "--out/--new for another folder",
                                               folder.path().string(), read_holder(fd_.get())));
    }
    fail_io(file, "lock it (a folder on a local disk always can; choose one with --out)", error);
  }
  write_holder(fd_.get(), file);
}

RunLock RunLock::for_reading(const std::filesystem::path& folder) {
  FileDescriptor fd(open_for_reading(folder));
  if (!fd.is_open()) {
    if (errno != ENOENT) {
      fail_io(folder / "lock", "open it", errno);
    }
    return RunLock(std::move(fd));
  }
  const int error = try_lock(fd.get(), LOCK_SH);
  if (error == EWOULDBLOCK) {
    throw Error(ErrorKind::busy, fmt::format("{} is being written by {}; wait for it, or stop it",
                                             folder.string(), read_holder(fd.get())));
  }
  if (error != 0) {
    fail_io(folder / "lock", "lock it", error);
  }
  return RunLock(std::move(fd));
}

std::string find_writer(const std::filesystem::path& folder) {
  const FileDescriptor file(open_for_reading(folder));
  if (!file.is_open() || try_lock(file.get(), LOCK_SH) != EWOULDBLOCK) {
    return "";
  }
  return read_holder(file.get());
}

}  // namespace armwright
