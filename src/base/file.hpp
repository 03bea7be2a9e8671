// Whole files, read with a size limit and written so that a reader sees the old content or the new,
// never a mixture. Every failure is an Error{io} that names the path and the operating system's
// reason.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/file_descriptor.hpp"

namespace armwright {

// Throws Error{io} "PATH: cannot DOING: the operating system's reason" for an errno.
[[noreturn]] void fail_io(const std::filesystem::path& path, std::string_view doing, int error);

// Error{bad_data} if the file is larger than `limit_bytes`.
std::string read_file(const std::filesystem::path& path, std::size_t limit_bytes);

// A file that is written piece by piece and takes its place only as a whole: until commit() it
// bears the name "PATH.new", and without it it is taken away again.
class AtomicFile {
 public:
  explicit AtomicFile(const std::filesystem::path& path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::string_view content);
  void commit();  // put_in_place()

 private:
  void write_buffer();

  std::filesystem::path path_;
  std::filesystem::path new_path_;  // empty once it has been renamed
  FileDescriptor file_;
  std::string buffer_;
};

// Syncs the file, renames it over `path` and syncs the folder.
void put_in_place(const std::filesystem::path& file, const std::filesystem::path& path);

// The whole of an AtomicFile at once.
void write_file_atomically(const std::filesystem::path& path, std::string_view content);

// As mkdir -p; an Error{io} says which folder could not be made and why.
void make_folder(const std::filesystem::path& path);

}  // namespace armwright
