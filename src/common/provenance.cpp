#include "snapwing/common/provenance.h"

#include <sodium.h>

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

}  // namespace snapwing::common
