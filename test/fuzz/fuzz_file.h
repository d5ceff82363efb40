#pragma once
/// What the fuzz targets of the readers share: bytes as a file, and the rule that a reader either takes them or throws
/// a common::Error.

#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "snapwing/common/error.h"

namespace snapwing::fuzz {

inline void require(bool good) {
  if (!good) std::abort();
}

/// The bytes as a file of this process, in memory where the machine has /dev/shm.
inline std::string asFile(const std::uint8_t* data, std::size_t size, const std::string& ending) {
  static const std::string FOLDER = ::access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp";
  const std::string path = FOLDER + "/snapwing_fuzz_" + std::to_string(::getpid()) + ending;
  std::FILE* file = std::fopen(path.c_str(), "wb");
  require(file != nullptr);
  require(std::fwrite(data, 1, size, file) == size);
  std::fclose(file);
  return path;
}

/// @return whether the bytes were taken; anything but a common::Error ends the run
template <class Read>
bool taken(const Read& read) {
  try {
    read();
    return true;
  } catch (const common::Error&) {
    return false;
  }
}

}  // namespace snapwing::fuzz
