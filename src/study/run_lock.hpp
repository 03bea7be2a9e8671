// Keeps two processes from writing one run: an flock(2) on FOLDER/lock. It goes with its holder,
// however that ends; the file stays and tells who holds or last held it. A child that is forked and
// does not exec shares the lock.
#pragma once

#include <filesystem>

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

}  // namespace armwright
