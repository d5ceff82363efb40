#include "snapwing/common/provenance.h"

#include <sodium.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <mutex>

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

std::string sha256OfInputs(const std::string& path, const std::vector<std::string>& named) {
  std::string hashes = sha256OfFile(path);
  if (named.empty()) return hashes;
  for (const std::string& file : named) hashes += sha256OfFile(file);
  return sha256(hashes);
}

std::string version() { return SNAPWING_VERSION; }

namespace {

constexpr std::size_t LARGEST_FROM_PIPE = std::size_t{256} << 20;  // bytes: what never ends is refused

std::string readToEnd(const std::string& path, std::size_t most) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw FileError(path, std::string("cannot be opened: ") + std::strerror(errno));
  std::string bytes;
  std::array<char, 1 << 16> block{};
  while (in.read(block.data(), block.size()) || in.gcount() > 0) {
    bytes.append(block.data(), static_cast<std::size_t>(in.gcount()));
    if (bytes.size() > most) throw FileError(path, "delivers more than 256 MiB and is not a file; allowed: a file");
  }
  if (in.bad()) throw FileError(path, "cannot be read to its end");
  return bytes;
}

/// A pipe gives its bytes once, and an input is looked at more than once (what kind it is, its hash, its content).
std::string readPipe(const std::string& path) {
  static std::mutex guard;
  static std::map<std::string, std::string> taken;
  const std::lock_guard<std::mutex> lock(guard);
  const auto known = taken.find(path);
  if (known != taken.end()) return known->second;
  return taken[path] = readToEnd(path, LARGEST_FROM_PIPE);
}

}  // namespace

std::string readFile(const std::string& path) {
  std::error_code none;
  const std::filesystem::file_status status = std::filesystem::status(path, none);
  if (std::filesystem::is_directory(status)) throw FileError(path, "is a folder, not a file");
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) return readPipe(path);
  return readToEnd(path, std::numeric_limits<std::size_t>::max());
}

}  // namespace snapwing::common
