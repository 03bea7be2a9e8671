// The files of an export: the folder that appears whole or not at all (base/partial_folder.hpp),
// files that are written piece by piece, and names that every system accepts.
#pragma once

#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include "base/partial_folder.hpp"

namespace armwright {

// Returns the folder's path in the form that PartialFolder wants. Throws Error{usage} if there is
// anything but an empty folder at `target`.
std::filesystem::path check_export_folder(const std::filesystem::path& target);
// Renames the filled folder to its target. Throws Error{io}.
void put_in_place(PartialFolder& folder);

// A new file that is written piece by piece. Every failure is an Error{io} that names the file.
class OutputFile {
 public:
  // Creates the file and the folders above it.
  explicit OutputFile(std::filesystem::path path);
  void write(std::string_view text);
  // Writes everything to the disk. Without this call the file may be incomplete.
  void close();

 private:
  std::filesystem::path path_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
};

// Writes a whole new file. Throws Error{io}.
void write_output_file(const std::filesystem::path& path, std::string_view text);

// Returns a file name that every system accepts: letters, digits, '_', '-' and '.'; it never
// begins with one of the last two. '_' stands for every other character. The name has 1 to 80
// characters.
std::string escape_file_name(std::string_view name);

// Returns a column name for a table whose fields are separated by blanks: letters, digits and '_',
// beginning with a letter.
std::string escape_column_name(std::string_view name);

// Names that differ even where upper and lower case are the same. A name that is taken gets "-2",
// "-3", ...
class UniqueNames {
 public:
  explicit UniqueNames(char separator = '-') : separator_(separator) {}
  // Returns the name, changed if it was taken.
  std::string add(const std::string& name);

 private:
  char separator_;
  std::set<std::string> taken_;  // in lower case
};

// Returns one file name per name; different names get different file names.
std::map<std::string, std::string> make_file_names(std::span<const std::string> names);

}  // namespace armwright
