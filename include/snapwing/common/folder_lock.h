#pragma once
/// One run at a time in a folder: two would mix their files and take up each other's checkpoints.

#include <string>

namespace snapwing::common {

/// Held by the process: whatever ends it lets go. Where a file system knows no locks there is none.
class FolderLock {
 public:
  /// @param folder  must exist. @throws FileError while another one holds it
  explicit FolderLock(const std::string& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int folder_;  ///< descriptor; -1: none
};

}  // namespace snapwing::common
