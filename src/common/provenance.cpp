#include "snapwing/common/provenance.h"

#include <fcntl.h>
#include <sodium.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "snapwing/common/error.h"

namespace snapwing::common {

std::string sha256(const std::string& bytes) {
  unsigned char hash[crypto_hash_sha256_BYTES];
  crypto_hash_sha256(hash, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  char hex[2 * crypto_hash_sha256_BYTES + 1];
  sodium_bin2hex(hex, sizeof(hex), hash, sizeof(hash));
  return hex;
}

std::string sha256OfFile(const std::string& path) { return sha256(readFile(path)); }

std::string version() { return SNAPWING_VERSION; }

std::string readFile(const std::string& path) {
  if (std::filesystem::is_directory(path)) throw FileError(path, "is a folder, not a file");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw FileError(path, std::string("cannot be opened: ") + std::strerror(errno));
  std::ostringstream bytes;
  bytes << in.rdbuf();
  if (in.bad()) throw FileError(path, "cannot be read to its end");
  return bytes.str();
}

namespace {

/// Writes and flushes to the disk, so that the rename that follows cannot leave an empty file after a power cut.
void writeThrough(const std::string& path, const std::string& bytes) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (fd < 0) throw FileError(path, std::string("cannot be written: ") + std::strerror(errno));
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t n = ::write(fd, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    done += static_cast<std::size_t>(n);
  }
  const bool flushed = done == bytes.size() && ::fsync(fd) == 0;
  const int error = errno;
  ::close(fd);
  if (flushed) return;
  ::unlink(path.c_str());
  throw FileError(path, std::string("cannot be written: ") + std::strerror(error));
}

}  // namespace

void writeFileAtomically(const std::string& path, const std::string& bytes) {
  const std::string part = path + ".part" + std::to_string(::getpid());
  writeThrough(part, bytes);
  if (std::rename(part.c_str(), path.c_str()) == 0) return;
  const int error = errno;
  ::unlink(part.c_str());
  throw FileError(path, std::string("cannot be replaced: ") + std::strerror(error));
}

void requireFolderOf(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
  if (!std::filesystem::is_directory(folder)) throw FileError(path, "its folder does not exist");
  if (::access(folder.c_str(), W_OK) != 0) throw FileError(path, "its folder cannot be written to");
}

}  // namespace snapwing::common
