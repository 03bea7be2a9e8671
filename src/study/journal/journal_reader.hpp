// Reads a journal and tells a torn end (what a kill or a power cut leaves) from damage
// (study/journal.hpp).
#pragma once

#include <cstdint>
#include <filesystem>

#include "base/file_descriptor.hpp"
#include "study/journal/journal.hpp"

namespace armwright {

struct JournalScan {
  JournalContent content;
  std::uint64_t good_bytes =
      0;  // where the last intact record ends; 0 if not even the magic is whole
};

// `descriptor` is open for reading and goes to the content; the file is not changed. Error{io} if
// it cannot be read or is no regular file, Error{bad_data} if it is not a journal or is damaged
// before its end.
JournalScan scan_journal(FileDescriptor descriptor, const std::filesystem::path& file);

}  // namespace armwright
