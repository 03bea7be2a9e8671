// The checks of system_check.hpp that ask the operating system.

#include <fcntl.h>
#include <fmt/format.h>
#include <langinfo.h>
#include <locale.h>
#include <sched.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/statfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <thread>

#include "base/build_info.hpp"
#include "base/file_descriptor.hpp"
#include "base/text.hpp"
#include "cli/commands/system_check.hpp"
#include "cli/terminal/terminal.hpp"

namespace armwright {
namespace {

using Checks = std::vector<SystemCheck>;

constexpr double kMebi = 1024.0 * 1024.0;

std::string format_bytes(double bytes) {
  return bytes >= 1024 * kMebi ? fmt::format("{:.1f} GiB", bytes / (1024 * kMebi))
                               : fmt::format("{:.0f} MiB", bytes / kMebi);
}

// statfs(2) and linux/magic.h.
std::string name_file_system(long type) {
  struct Name {
    long type;
    const char* name;
  };
  constexpr Name kNames[] = {
      {0xEF53, "ext4"},       {0x58465342, "xfs"},       {0x9123683E, "btrfs"},
      {0x01021994, "tmpfs"},  {0x794C7630, "overlayfs"}, {0x6969, "nfs"},
      {0x2FC12FC1, "zfs"},    {0xFF534D42, "cifs"},      {0xFE534D42, "smb2"},
      {0x65735546, "fuse"},   {0xF2F52010, "f2fs"},      {0x4D44, "vfat"},
      {0x01021997, "9p"},     {0x00C36400, "ceph"},      {0x0BD00BD0, "lustre"},
      {0x5346544E, "ntfs"},   {0x9FA0, "proc"},          {0x62656572, "sysfs"},
      {0x2011BAB0L, "exfat"},
  };
  for (const Name& one : kNames) {
    if (one.type == type) {
      return one.name;
    }
  }
  return fmt::format("file system {:#x}", static_cast<unsigned long>(type));
}

// Does with a file what a run does with the files of its folder. Returns the error, or an empty
// text.
std::string try_writing(const std::filesystem::path& folder) {
  std::string name = (folder / ".armwright-doctor-XXXXXX").string();
  FileDescriptor file(::mkostemp(name.data(), O_CLOEXEC));
  if (!file.is_open()) {
    return fmt::format("a file cannot be made: {}", std::strerror(errno));
  }
  ::unlink(name.c_str());
  if (::write(file.get(), "armwright", 9) != 9) {
    return fmt::format("a file cannot be written: {}", std::strerror(errno));
  }
  if (::fdatasync(file.get()) != 0 && errno != EINVAL && errno != EROFS) {
    return fmt::format("a file cannot be synced to the disk: {}", std::strerror(errno));
  }
  if (::flock(file.get(), LOCK_EX | LOCK_NB) != 0) {
    return fmt::format("a file cannot be locked: {}", std::strerror(errno));
  }
  return "";
}

// Returns the value of "KEY:   123 kB" in /proc/meminfo.
std::optional<double> read_meminfo_bytes(std::string_view key) {
  std::ifstream meminfo("/proc/meminfo");
  for (std::string line; std::getline(meminfo, line);) {
    if (line.starts_with(key) && line.size() > key.size() && line[key.size()] == ':') {
      return std::strtod(line.c_str() + key.size() + 1, nullptr) * 1024;
    }
  }
  return std::nullopt;
}

// Returns the limit of a container. The file has a number, or "max" for no limit.
std::optional<double> read_memory_limit_bytes() {
  std::ifstream file("/sys/fs/cgroup/memory.max");
  double bytes = 0;
  return file >> bytes ? std::optional(bytes) : std::nullopt;
}

void check_memory(Checks& checks) {
  constexpr double kLittle_bytes = 256 * kMebi;
  const auto total = read_meminfo_bytes("MemTotal");
  auto available = read_meminfo_bytes("MemAvailable");
  if (!total || !available) {
    return;
  }
  std::string found = fmt::format("{} free of {}", format_bytes(*available), format_bytes(*total));
  if (const auto limit = read_memory_limit_bytes(); limit && *limit < *total) {
    found += fmt::format("; this container may use {}", format_bytes(*limit));
    available = std::min(*available, *limit);
  }
  const bool is_little = *available < kLittle_bytes;
  checks.push_back({"machine", "memory", is_little ? CheckState::bad : CheckState::good, found,
                    is_little ? "end other programs, or use fewer --jobs" : ""});
}

void check_processors(Checks& checks) {
  checks.push_back({"machine", "cpu", CheckState::good, describe_build()["cpu"]});
  const unsigned there = std::max(1U, std::thread::hardware_concurrency());
  cpu_set_t set;
  CPU_ZERO(&set);
  const bool known = ::sched_getaffinity(0, sizeof set, &set) == 0;
  const auto usable = known ? static_cast<unsigned>(CPU_COUNT(&set)) : there;
  std::string found = fmt::format("{} usable, which is the default of --jobs", usable);
  std::ifstream file("/sys/fs/cgroup/cpu.max");
  double quota_us = 0;
  double period_us = 0;
  std::string remedy;
  if (file >> quota_us >> period_us && period_us > 0 && quota_us < period_us * usable) {
    found += fmt::format("; this container may use the time of {:.1f}", quota_us / period_us);
    remedy = fmt::format("--jobs {:.0f} is as fast", std::max(1.0, quota_us / period_us));
  }
  checks.push_back({"machine", "processors", CheckState::good, found, remedy});
}

void check_limit(Checks& checks, const char* name, decltype(RLIMIT_NOFILE) resource, rlim_t least,
                 const char* option, const char* what) {
  rlimit limit{};
  if (::getrlimit(resource, &limit) != 0) {
    return;
  }
  const bool is_low = limit.rlim_cur != RLIM_INFINITY && limit.rlim_cur < least;
  const std::string found =
      limit.rlim_cur == RLIM_INFINITY
          ? "no limit"
          : fmt::format("at most {}", static_cast<std::uint64_t>(limit.rlim_cur));
  checks.push_back({"limits", name, is_low ? CheckState::lacking : CheckState::good,
                    is_low ? fmt::format("{}: {}", found, what) : found,
                    is_low
                        ? fmt::format("ulimit -{} {}", option,
                                      least == RLIM_INFINITY ? "unlimited" : std::to_string(least))
                        : ""});
}

void check_limits(Checks& checks) {
  check_limit(checks, "open files", RLIMIT_NOFILE, 256, "n",
              "too few for studies with many --jobs and for plugins");
  check_limit(checks, "processes", RLIMIT_NPROC, 64, "u", "too few for --jobs and for plugins");
  check_limit(checks, "size of a file", RLIMIT_FSIZE, RLIM_INFINITY, "f",
              "a run ends when its journal exceeds this");
  check_limit(checks, "address space", RLIMIT_AS, RLIM_INFINITY, "v",
              "a run ends when it needs more");
}

void check_locale(Checks& checks) {
  const locale_t named = ::newlocale(LC_ALL_MASK, "", nullptr);
  if (named == nullptr) {
    checks.push_back({"terminal", "locale", CheckState::lacking,
                      "the locale that LC_ALL, LC_* or LANG names is not installed",
                      "export LC_ALL=C.UTF-8"});
    return;
  }
  const std::string codeset = ::nl_langinfo_l(CODESET, named);
  const std::string point = ::nl_langinfo_l(RADIXCHAR, named);
  ::freelocale(named);
  const bool is_utf8 = codeset == "UTF-8";
  checks.push_back({"terminal", "locale", is_utf8 ? CheckState::good : CheckState::lacking,
                    fmt::format("characters as {}{}; armwright reads and writes '.' for the "
                                "decimal point whatever the locale{}",
                                sanitize(codeset), is_utf8 ? "" : ", and armwright writes UTF-8",
                                point == "." ? "" : fmt::format(", here '{}'", sanitize(point))),
                    is_utf8 ? "" : "export LC_ALL=C.UTF-8"});
}

void check_terminal(Checks& checks) {
  const char* term = std::getenv("TERM");
  checks.push_back(
      {"terminal", "standard output", CheckState::good,
       is_terminal(Stream::out)
           ? fmt::format("a terminal ({}), {} columns",
                         sanitize(term != nullptr ? term : "unknown"), get_width(Stream::out))
           : "no terminal: no colour unless --color always"});
}

}  // namespace

void check_machine(Checks& checks) {
  check_processors(checks);
  check_memory(checks);
  check_limits(checks);
  check_locale(checks);
  check_terminal(checks);
}

void check_results_folder(Checks& checks) {
  constexpr const char* kGroup = "results";
  constexpr double kLittle_bytes = 100 * kMebi;
  constexpr const char* kElsewhere = "work in another folder, or name one with --out";
  std::error_code ignored;
  const std::filesystem::path folder =
      std::filesystem::exists("results", ignored) ? "results" : ".";
  const std::string shown =
      sanitize(std::filesystem::absolute(folder, ignored).lexically_normal().string());
  struct statfs disk {};
  if (::statfs(folder.c_str(), &disk) != 0) {
    checks.push_back({kGroup, "folder", CheckState::bad,
                      fmt::format("{}: {}", shown, std::strerror(errno)), kElsewhere});
    return;
  }
  const std::string system = name_file_system(static_cast<long>(disk.f_type));
  const std::string fault = try_writing(folder);
  if (fault.empty()) {
    checks.push_back({kGroup, "folder", CheckState::good,
                      fmt::format("{}: on {}; can be written, synced and locked", shown, system)});
  } else {
    checks.push_back({kGroup, "folder", CheckState::bad,
                      fmt::format("{}: on {}; {}", shown, system, fault), kElsewhere});
  }
  const double free = static_cast<double>(disk.f_bavail) * static_cast<double>(disk.f_bsize);
  const bool is_little = free < kLittle_bytes;
  checks.push_back(
      {kGroup, "free space", is_little ? CheckState::bad : CheckState::good,
       fmt::format(
           "{} of {}", format_bytes(free),
           format_bytes(static_cast<double>(disk.f_blocks) * static_cast<double>(disk.f_bsize))),
       is_little ? "free some space, or name a folder on another disk with --out" : ""});
}

}  // namespace armwright
