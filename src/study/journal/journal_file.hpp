// What a journal (study/journal.hpp) asks of the operating system: whole writes, syncs, and a safe
// place for what is cut off its end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string_view>

namespace armwright {

struct WriteResult {
  std::size_t written = 0;
  int error = 0;  // an errno; 0: all was written
};
WriteResult write_fully(int fd, std::string_view bytes);

// 0 or an errno. Some file systems cannot sync; what they can do is then all there is to have.
int sync_data(int fd);

// Makes the names of new files survive a power cut.
void sync_folder_of(const std::filesystem::path& file);

// Nobody can open it any more.
bool is_deleted(int fd);

// Cuts the file off at `offset` and keeps what was behind in the first free "<file>.torn-N", which
// is on the disk before. `fd` is open for reading and writing. Error{io} names the file at fault.
void cut_torn_end(int fd, std::uint64_t offset, const std::filesystem::path& file);

}  // namespace armwright
