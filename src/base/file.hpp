// Reads whole files with a size limit, and writes files so that a reader sees the old or the new
// content, never a mixture. Every failure is an Error{io} with the path and the operating system's
// reason.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/file_descriptor.hpp"

namespace armwright {

// Throws Error{io} "PATH: cannot DOING: REASON", with the operating system's reason for the errno
// `error`.
[[noreturn]] void fail_io(const std::filesystem::path& path, std::string_view doing, int error);

// Returns the content. Throws Error{bad_data} if the file is larger than `limit_bytes`.
std::string read_file(const std::filesystem::path& path, std::size_t limit_bytes);

// A file that is written in pieces and appears at its path only when it is complete. Until commit()
// it has the name "PATH.new"; without commit() the destructor removes it.
class AtomicFile {
 public:
  explicit AtomicFile(const std::filesystem::path& path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::string_view content);
  void commit();  // syncs it and moves it to its path

 private:
  void write_buffer();

  std::filesystem::path path_;
  std::filesystem::path new_path_;  // empty once it has been renamed
  FileDescriptor file_;
  std::string buffer_;
};

// Syncs the file, renames it over `path` and syncs the folder.
void put_in_place(const std::filesystem::path& file, const std::filesystem::path& path);

// Writes an AtomicFile with this content and commits it.
void write_file_atomically(const std::filesystem::path& path, std::string_view content);

// Makes a folder and its parents, like mkdir -p. Throws Error{io} that says which folder could not
// be made and why.
void make_folder(const std::filesystem::path& path);

}  // namespace armwright
