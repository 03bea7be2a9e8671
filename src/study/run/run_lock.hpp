// Keeps two processes from writing one run, with an flock(2) on the file FOLDER/lock. The system
// releases the lock when its holder ends in any way. The file stays and names the last holder. A
// forked child that does not call exec shares the lock.
#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "base/file_descriptor.hpp"
#include "base/folder.hpp"

namespace armwright {

// A RunLock holds the lock of one folder as long as it lives.
class RunLock {
 public:
  // Takes the lock for writing. Throws Error{busy}, which names the process that has the lock,
  // Error{io} if the file system or the rights of the folder do not allow a lock, and
  // Error{bad_data} if the lock is a link or another file that this program must not write.
  explicit RunLock(const Folder& folder);
  // Returns a lock that keeps writers out, and creates no file. If the
  // folder has no lock file, no process has ever written it; the returned lock then locks nothing.
  // Throws Error{busy}, which names the process that
  // writes the folder, and Error{io}.
  static RunLock for_reading(const std::filesystem::path& folder);

 private:
  explicit RunLock(FileDescriptor fd) : fd_(std::move(fd)) {}

  FileDescriptor fd_;
};

// Returns the process that writes the folder now, as "process 12 on HOST"; empty if there is none
// or if it cannot be determined. Changes nothing.
std::string find_writer(const std::filesystem::path& folder);

// Returns the name of this machine, as locks record it.
std::string get_host_name();

}  // namespace armwright
