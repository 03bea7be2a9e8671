// A folder that is made as a copy of another: whole or not there (base/partial_folder.hpp), and
// synced to the disk before it gets its name. The original is only read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "base/file_descriptor.hpp"
#include "base/partial_folder.hpp"
#include "base/stop_signal.hpp"

namespace armwright {

struct CopyStopped {};  // thrown where `stop` ends a copy

class FolderCopy {
 public:
  // Error{usage} if there is anything at `target`; Error{io}.
  FolderCopy(const std::filesystem::path& target, StopSignal& stop);

  const std::filesystem::path& target() const { return folder_.target(); }
  // All below are given names as seen from the new folder. Error{io}; CopyStopped.
  void make_folder(const std::filesystem::path& name);
  // A file, or a symbolic link as such. False for anything else, which is left out.
  bool add(const std::filesystem::path& source, const std::filesystem::path& name);
  // A new file, of which `write` gets the descriptor, open for writing.
  void add_file(const std::filesystem::path& name, const std::function<void(int fd)>& write);
  // What was filled before is in place now. Error{usage} if something is there meanwhile.
  void put_in_place();

  // Appends a part of an open file. Error{io} names the one at fault.
  void copy_bytes(int source, std::uint64_t offset, std::uint64_t bytes, int target,
                  const std::filesystem::path& source_name);

 private:
  void check_stop();

  PartialFolder folder_;
  StopSignal& stop_;
};

}  // namespace armwright
