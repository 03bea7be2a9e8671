// Copies a folder completely or not at all (base/partial_folder.hpp). The copy is synced to the
// disk before it gets its name. The original is only read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "base/file_descriptor.hpp"
#include "base/partial_folder.hpp"
#include "base/stop_signal.hpp"

namespace armwright {

// A folder under construction. The destructor removes it unless put_in_place() was called.
class FolderCopy {
 public:
  // Throws Error{usage} if `target` exists, or Error{io}. Keeps a reference to `stop`.
  FolderCopy(const std::filesystem::path& target, StopSignal& stop);

  const std::filesystem::path& target() const { return folder_.target(); }
  // In the functions below `name` is relative to the new folder. They throw Error{io} or
  // WorkStopped.
  void make_folder(const std::filesystem::path& name);
  // Copies a file, or a symbolic link without following it. Returns false for anything else, which
  // is not copied.
  bool add(const std::filesystem::path& source, const std::filesystem::path& name);
  // Creates a file. `write` gets its descriptor, open for writing.
  void add_file(const std::filesystem::path& name, const std::function<void(int fd)>& write);
  // Renames the new folder to `target`. Throws Error{usage} if another process created `target` in
  // the meantime.
  void put_in_place();

  // Appends `bytes` bytes of the open file `source`, from `offset` on, to the open file `target`.
  // Throws Error{io} with the name of the file that failed.
  void copy_bytes(int source, std::uint64_t offset, std::uint64_t bytes, int target,
                  const std::filesystem::path& source_name);

 private:
  void check_stop();

  PartialFolder folder_;
  StopSignal& stop_;
};

}  // namespace armwright
