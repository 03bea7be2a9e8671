// The checksums of a folder's files: the file SHA256SUMS, in the format of sha256sum, sorted by
// name. `sha256sum -c SHA256SUMS` checks the folder without armwright. A study lists the SHA256SUMS
// of its cells, so one file covers the whole study.
//
// A kill at any moment leaves no file that differs from its line: the line of a file that is going
// to change is removed before, and added after. A file without a line is not covered. That is no
// fault, and folders of version 1.0 have no SHA256SUMS at all.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "base/folder.hpp"

namespace armwright {

inline constexpr const char* kChecksumFile = "SHA256SUMS";

// Not thread-safe. Two processes must not change the checksums of one folder at the same time; the
// folder's lock (study/run/run_lock.hpp) prevents this.
class FolderChecksums {
 public:
  // Reads SHA256SUMS; without that file, no file is covered. Throws Error{bad_data} if it is not a
  // list as armwright writes it, and Error{io}.
  explicit FolderChecksums(std::filesystem::path folder);
  // Does the same. Files are written into the open folder, without following links.
  explicit FolderChecksums(const Folder& folder);

  bool is_there() const { return is_there_; }
  bool covers(const std::string& name) const { return lines_.contains(name); }
  // Returns the SHA-256 of every covered file, as 64 hexadecimal digits, by its name relative to
  // the folder.
  const std::map<std::string, std::string>& lines() const { return lines_; }

  // Reads a file, covered or not. Throws Error{bad_data} if it differs from its line or is larger
  // than `limit_bytes`, and Error{io}.
  std::string read(const std::string& name, std::size_t limit_bytes) const;
  // Throws Error{bad_data} if the file is covered, and is missing or differs from its line.
  void check(const std::string& name) const;
  // Returns how a covered file differs from its line, or an empty text. Reads files of any size.
  // Throws Error{io} if the file is missing or cannot be read.
  std::string find_change(const std::string& name) const;

  // Removes the lines of these files. Writes SHA256SUMS if it had one of them.
  void drop(std::span<const std::string> names);
  // Writes files (name, content) in this order, and covers them. Before that it drops those that
  // change. Makes missing folders below the folder and follows no link there. The caller calls
  // save() after it.
  void write(std::span<const std::pair<std::string, std::string>> files);
  // Covers a file with this content, which the caller writes after save().
  void cover(const std::string& name, std::string_view content);
  // Covers a file as it is now. Does nothing if it is covered already or does not exist.
  void cover(const std::string& name);
  // Writes SHA256SUMS if a line has changed. Throws Error{io}.
  void save();

 private:
  std::string describe_change(const std::string& name, const std::string& sha256) const;

  void write_file(const std::string& name, std::string_view content) const;

  std::filesystem::path folder_;
  std::optional<Folder> open_;  // the same folder, if the caller had opened it
  std::map<std::string, std::string> lines_;
  bool is_there_ = false;
  bool has_changed_ = false;
};

// Returns the text of SHA256SUMS with these lines.
std::string format_checksums(const std::map<std::string, std::string>& lines);

// Reads a file of a run's folder and compares it with the folder's checksums, as
// FolderChecksums::read() does.
std::string read_checked_file(const std::filesystem::path& file, std::size_t limit_bytes);
// Reads a JSON file in the same way and checks its depth (json_text.hpp).
std::string read_checked_json(const std::filesystem::path& file, std::size_t limit_bytes);

}  // namespace armwright
