#include "snapwing/common/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "snapwing/common/error.h"

namespace snapwing::common {

FolderLock::FolderLock(const std::string& folder)
    : folder_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (folder_ < 0) throw FileError(folder, std::string("cannot be opened: ") + std::strerror(errno));
  if (::flock(folder_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  ::close(folder_);
  throw FileError(folder, "another run works in this folder now; wait for its end, or name another folder");
}

FolderLock::~FolderLock() { ::close(folder_); }

}  // namespace snapwing::common
