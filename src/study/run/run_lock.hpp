// Keeps two processes from writing one run: an flock(2) on FOLDER/lock. It goes with its holder,
// however that ends; the file stays and tells who holds or last held it. A child that is forked and
// does not exec shares the lock.
#pragma once

#include <filesystem>
#include <string>

#include "base/file_descriptor.hpp"

namespace armwright {

class RunLock {
 public:
  // Error{busy} names the process that has the lock; Error{io} if the folder's file system or
  // rights do not allow one.
  explicit RunLock(const std::filesystem::path& folder);

 private:
  FileDescriptor fd_;
};

// Keeps writers out of a folder while it is read, and leaves no trace in it. Where there is no lock
// file nobody has written yet, and nothing is held.
class ReadLock {
 public:
  // Error{busy} names the process that writes the folder; Error{io}.
  explicit ReadLock(const std::filesystem::path& folder);

 private:
  FileDescriptor fd_;
};

// Who writes the folder at this moment: "process 12 on HOST"; empty if nobody does, or if it cannot
// be told. Changes nothing.
std::string find_writer(const std::filesystem::path& folder);

// This machine's, as locks name it.
std::string get_host_name();

}  // namespace armwright
