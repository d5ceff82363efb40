#pragma once
/// Allows only one run at a time in a folder: two would mix their files and resume from each other's checkpoints.

#include <string>

namespace snapwing::common {

/// Advisory lock (flock), released when the process ends, in any way. On file systems without locks it has no effect.
class FolderLock {
 public:
  /// @param folder  must exist. @throws FileError if it cannot be opened, or while another run holds the lock
  explicit FolderLock(const std::string& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int folder_;  ///< descriptor; -1: none
};

}  // namespace snapwing::common
