// Reads whole files with a size limit, and writes files so that a reader sees the old or the new
// content, never a mixture. Every failure is an Error{io} with the path and the operating system's
// reason.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/error.hpp"
#include "base/file_descriptor.hpp"
#include "base/folder.hpp"

namespace armwright {

// Throws Error{io} "PATH: cannot DOING: REASON", with the operating system's reason for the errno
// `error`.
[[noreturn]] void fail_io(const std::filesystem::path& path, std::string_view doing, int error);

// Opens a regular file for reading, at once: a named pipe without a writer would block the caller.
// Throws Error{unfit} for a pipe or a device, and Error{io}.
FileDescriptor open_to_read(const std::filesystem::path& path,
                            ErrorKind unfit = ErrorKind::bad_data);

// Returns the content of a regular file. Throws Error{unfit} if the file is larger than
// `limit_bytes` or no regular file, and Error{bad_data} if check_reading() does.
std::string read_file(const std::filesystem::path& path, std::size_t limit_bytes,
                      ErrorKind unfit = ErrorKind::bad_data);
// Does the same for an input that the user named, which may be a pipe, such as /dev/stdin. Blocks
// until the pipe has its end.
std::string read_input(const std::filesystem::path& path, std::size_t limit_bytes);

// Throws Error{io} if the rights of the file or of its folders forbid this process to read it.
void check_readable(const std::filesystem::path& path);

// A file that is written in pieces and appears in its folder only when it is complete. Until
// commit() it has the name "NAME.new"; without commit() the destructor removes it.
class AtomicFile {
 public:
  AtomicFile(const Folder& folder, const std::string& name);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::string_view content);
  void commit();  // syncs it and moves it to its name

 private:
  void write_buffer();

  Folder folder_;
  std::string name_;
  std::string new_name_;  // empty once it has been renamed
  FileDescriptor file_;
  std::string buffer_;
};

// Writes an AtomicFile with this content and commits it.
void write_file_atomically(const Folder& folder, const std::string& name, std::string_view content);
// Does the same in the folder of `path`. Follows links on the way to this folder, so that it must
// be one that the user named.
void write_file_atomically(const std::filesystem::path& path, std::string_view content);

}  // namespace armwright
