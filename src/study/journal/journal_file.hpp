// The file operations of a journal (journal.hpp): whole writes, syncs, and cutting off a torn end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/folder.hpp"

namespace armwright {

struct WriteResult {
  std::size_t written = 0;  // bytes
  int error = 0;            // an errno; 0 if all bytes were written
};
// Writes all bytes, or stops at the first error.
WriteResult write_fully(int fd, std::string_view bytes);

// Syncs the data of the file to the disk. Returns 0 or an errno. A file system that cannot sync is
// not an error.
int sync_data(int fd);

// Syncs the folder of a new file, so that its name survives a power cut. Ignores errors.
void sync_folder_of(const std::filesystem::path& file);

// Returns whether the file has no name any more.
bool is_deleted(int fd);

// Returns the first offset in [offset, size) at which the file may hold data, or `size` if a hole
// reaches to it. A hole reads as zeros and takes no space, so that a file of a few KiB can be a TiB
// long. A file system without holes returns `offset`.
std::uint64_t find_data(int fd, std::uint64_t offset, std::uint64_t size);

// Cuts the file `name` of the folder off at `offset`, after saving the bytes behind it in the first
// free "<name>.torn-N" and syncing that to the disk. `fd` must be open for reading and writing.
// Throws Error{io}, which names the file at fault.
void cut_torn_end(int fd, std::uint64_t offset, const Folder& folder, const std::string& name);

}  // namespace armwright
