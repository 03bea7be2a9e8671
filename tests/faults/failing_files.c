// A disk that fails, between the program and the C library (LD_PRELOAD): the n-th call of one kind on
// a file below one folder fails, alone or with all that follow. Environment variables set the fault:
//   FAILING_FILES_FOLDER  only files below it count, however they are named
//   FAILING_FILES_CALL    open, write, fsync, fdatasync, ftruncate, rename or close
//   FAILING_FILES_AT      n, from 1; 0: no call fails
//   FAILING_FILES_ERROR   the errno
//   FAILING_FILES_FOREVER set: all later calls fail as well
//   FAILING_FILES_KILL    set: no failure; the process is killed during the call, when half of the bytes
//                         are written
//   FAILING_FILES_COUNT   a file of 8 bytes that counts the calls, shared by all processes
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

static const char* g_folder = NULL;
static const char* g_call = NULL;
static uint64_t g_at = 0;
static int g_error = EIO;
static bool g_forever = false;
static bool g_kill = false;
static _Atomic uint64_t* g_count = NULL;

__attribute__((constructor)) static void begin(void) {
  const char* const file = getenv("FAILING_FILES_COUNT");
  const char* const at = getenv("FAILING_FILES_AT");
  const char* const error = getenv("FAILING_FILES_ERROR");
  g_folder = getenv("FAILING_FILES_FOLDER");
  g_call = getenv("FAILING_FILES_CALL");
  g_at = at == NULL ? 0 : strtoull(at, NULL, 10);
  g_error = error == NULL ? EIO : atoi(error);
  g_forever = getenv("FAILING_FILES_FOREVER") != NULL;
  g_kill = getenv("FAILING_FILES_KILL") != NULL;
  if (file == NULL || g_folder == NULL || g_call == NULL) {
    return;
  }
  const int fd = (int)syscall(SYS_openat, AT_FDCWD, file, O_RDWR | O_CLOEXEC, 0);
  if (fd < 0) {
    return;
  }
  void* const shared = mmap(NULL, sizeof(uint64_t), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  syscall(SYS_close, fd);
  g_count = shared == MAP_FAILED ? NULL : shared;
}

static bool is_below(const char* path) {
  const size_t length = strlen(g_folder);
  return strncmp(path, g_folder, length) == 0 && (path[length] == '/' || path[length] == '\0');
}

static bool is_ours(const char* path) {
  if (path[0] == '/') {
    return is_below(path);
  }
  char whole[2 * PATH_MAX];
  char here[PATH_MAX];
  if (getcwd(here, sizeof here) == NULL) {
    return false;
  }
  snprintf(whole, sizeof whole, "%s/%s", here, path);
  return is_below(whole);
}

static bool is_our_descriptor(int fd) {
  char link[64];
  char path[PATH_MAX];
  snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  const ssize_t length = readlink(link, path, sizeof path - 1);
  if (length <= 0) {
    return false;
  }
  path[length] = '\0';
  return is_below(path);
}

static void die(void) {
  syscall(SYS_kill, getpid(), SIGKILL);
  for (;;) {
    pause();
  }
}

// Counts the call and returns whether it fails; sets errno then.
static bool counts_and_fails(void) {
  const uint64_t number = atomic_fetch_add(g_count, 1) + 1;
  const bool fails = g_at != 0 && (number == g_at || (g_forever && number > g_at));
  if (fails) {
    errno = g_error;
  }
  return fails;
}
static bool watched(const char* call) {
  return g_count != NULL && strcmp(g_call, call) == 0;
}
static bool path_fails(const char* call, const char* path) {
  const bool fails = watched(call) && is_ours(path) && counts_and_fails();
  if (fails && g_kill) {
    die();
  }
  return fails;
}
static bool fails_here(const char* call, int fd) {
  const int before = errno;
  const bool ours = watched(call) && is_our_descriptor(fd);
  errno = before;
  return ours && counts_and_fails();
}
static bool descriptor_fails(const char* call, int fd) {
  const bool fails = fails_here(call, fd);
  if (fails && g_kill) {
    die();
  }
  return fails;
}

static mode_t take_mode(int flags, va_list arguments) {
  return (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(arguments, mode_t) : 0;
}

int open(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = take_mode(flags, arguments);
  va_end(arguments);
  return path_fails("open", path) ? -1 : (int)syscall(SYS_openat, AT_FDCWD, path, flags, mode);
}
int open64(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = take_mode(flags, arguments);
  va_end(arguments);
  return path_fails("open", path) ? -1 : (int)syscall(SYS_openat, AT_FDCWD, path, flags, mode);
}

int close(int fd) {
  const bool fails = descriptor_fails("close", fd);
  const int error = errno;
  const int result = (int)syscall(SYS_close, fd);  // the file is closed even if close() fails, as in the system
  if (fails) {
    errno = error;
    return -1;
  }
  return result;
}

ssize_t write(int fd, const void* bytes, size_t size) {
  if (!fails_here("write", fd)) {
    return syscall(SYS_write, fd, bytes, size);
  }
  if (g_kill) {
    syscall(SYS_write, fd, bytes, size / 2);
    die();
  }
  return -1;
}
ssize_t pwrite(int fd, const void* bytes, size_t size, off_t offset) {
  if (!fails_here("write", fd)) {
    return syscall(SYS_pwrite64, fd, bytes, size, offset);
  }
  if (g_kill) {
    syscall(SYS_pwrite64, fd, bytes, size / 2, offset);
    die();
  }
  return -1;
}
ssize_t pwrite64(int fd, const void* bytes, size_t size, off64_t offset) {
  return pwrite(fd, bytes, size, offset);
}

int fsync(int fd) {
  return descriptor_fails("fsync", fd) ? -1 : (int)syscall(SYS_fsync, fd);
}
int fdatasync(int fd) {
  return descriptor_fails("fdatasync", fd) ? -1 : (int)syscall(SYS_fdatasync, fd);
}
int ftruncate(int fd, off_t size) {
  return descriptor_fails("ftruncate", fd) ? -1 : (int)syscall(SYS_ftruncate, fd, size);
}
int ftruncate64(int fd, off64_t size) {
  return descriptor_fails("ftruncate", fd) ? -1 : (int)syscall(SYS_ftruncate, fd, size);
}
// Opens in a folder that is open already count like those with a whole path.
static bool place_fails(const char* call, int folder, const char* path) {
  if (folder == AT_FDCWD || path[0] == '/') {
    return path_fails(call, path);
  }
  return descriptor_fails(call, folder);
}
int openat(int folder, const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = take_mode(flags, arguments);
  va_end(arguments);
  return place_fails("open", folder, path) ? -1
                                           : (int)syscall(SYS_openat, folder, path, flags, mode);
}
int openat64(int folder, const char* path, int flags, ...) __attribute__((alias("openat")));
int renameat(int from_folder, const char* from, int to_folder, const char* to) {
  return place_fails("rename", to_folder, to)
             ? -1
             : (int)syscall(SYS_renameat, from_folder, from, to_folder, to);
}
int rename(const char* from, const char* to) {
  return path_fails("rename", to) ? -1 : (int)syscall(SYS_renameat, AT_FDCWD, from, AT_FDCWD, to);
}
