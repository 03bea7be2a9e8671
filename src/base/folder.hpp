// Folders that are opened once. Files and folders are made, opened and renamed in them without
// following symbolic links, so that a link in a folder of results leads no write elsewhere. Every
// failure is an Error{io} with the path and the operating system's reason, unless stated otherwise.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/file_descriptor.hpp"

namespace armwright {

// An open folder. Copies share the descriptor.
class Folder {
 public:
  // Opens a folder that exists. Follows links, so `path` must be one that the user named; an empty
  // path is the current folder.
  explicit Folder(const std::filesystem::path& path);
  // Opens the folder `path`, which is `root` or lies in it, and makes what is missing of it, like
  // mkdir -p. Follows links on the way to `root`, which the user named, and none below it. An empty
  // `root` stands for `path`. Throws Error{bad_data}, which names the link, file or device that is
  // in the place of a folder.
  static Folder make(const std::filesystem::path& path, const std::filesystem::path& root);

  const std::filesystem::path& path() const { return path_; }
  int get() const { return descriptor_->get(); }

  // In the functions below, `name` is the name of a file in this folder.

  // Creates a file, open for reading and writing. Removes what has this name already: a file that a
  // killed process has left, or a link, whose target stays as it is.
  FileDescriptor create(const std::string& name) const;
  // Opens a file that the program keeps between its runs, or creates it if `flags`, which are those
  // of open(2), say so. Throws Error{bad_data} if it is not a regular file, or if it has a second
  // name (a hard link), through which another file would be changed.
  FileDescriptor open(const std::string& name, int flags) const;
  // Syncs a file that create() has made as `name`, closes it, renames it over `target` and syncs
  // the folder. Throws Error{busy} if another process has replaced it in the meantime.
  void put_in_place(FileDescriptor& file, const std::string& name, const std::string& target) const;
  // Removes a file or a link; ignores errors.
  void remove(const std::string& name) const;
  // Syncs the names of its files to the disk. Ignores errors: some file systems cannot do that.
  void sync() const;

 private:
  Folder(std::filesystem::path path, int descriptor);

  std::filesystem::path path_;
  std::shared_ptr<const FileDescriptor> descriptor_;
};

// Makes a folder and its parents, like mkdir -p; follows links. Throws Error{io} that says which
// folder could not be made and why.
void make_folder(const std::filesystem::path& path);

// Return whether the path leads to anything, to a regular file, or to a folder. They follow links.
// They throw Error{io} if that cannot be determined, for example because a folder's rights forbid
// it; std::filesystem would throw an exception in its own words.
bool path_exists(const std::filesystem::path& path);
bool regular_file_exists(const std::filesystem::path& path);
bool folder_exists(const std::filesystem::path& path);

// Returns the paths of what is in the folder, sorted.
std::vector<std::filesystem::path> list_folder(const std::filesystem::path& folder);
// Returns the paths of what is in the folder and in all folders below it, sorted. Follows no links
// below it.
std::vector<std::filesystem::path> list_tree(const std::filesystem::path& folder);

// Returns what a file of this type is ("a named pipe"), from the mode that fstat(2) gives.
const char* describe_file_type(unsigned mode);

}  // namespace armwright
