/// libFuzzer: PNG as a density. A mutation mends the chunks' checksums, without which libpng would see none of it.
#include <zlib.h>

#include <cstring>

#include "fuzz_file.h"
#include "snapwing/mpm/density_file.h"

using namespace snapwing;

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace {

std::uint32_t bigEndian(const std::uint8_t* p) {
  return std::uint32_t{p[0]} << 24 | std::uint32_t{p[1]} << 16 | std::uint32_t{p[2]} << 8 | p[3];
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most,
                                               unsigned int seed) {
  size = LLVMFuzzerMutate(data, size, most);
  if (seed % 8 == 0) return size;
  constexpr std::size_t SIGNATURE = 8, HEAD = 8, TAIL = 4;
  for (std::size_t at = SIGNATURE; at + HEAD + TAIL <= size;) {
    const std::size_t length = bigEndian(data + at);
    if (length > size - at - HEAD - TAIL) break;
    const auto sum = static_cast<std::uint32_t>(crc32(0, data + at + 4, static_cast<uInt>(length + 4)));
    std::uint8_t* tail = data + at + HEAD + length;
    for (int k = 0; k < 4; ++k) tail[k] = static_cast<std::uint8_t>(sum >> (24 - 8 * k));
    at += HEAD + length + TAIL;
  }
  return size;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t HEADER = 33;
  double width = 1, height = 1;
  if (size >= HEADER) {
    // The domain that the header's pixels fill; pictures that only take memory are left to the test of the limit.
    width = bigEndian(data + 16), height = bigEndian(data + 20);
    if (width * height > 1e6) return -1;
  }
  const std::string path = fuzz::asFile(data, size, ".png");
  fuzz::taken([&] {
    for (const double rho : mpm::loadDensityPng(path, 1e-3 * width, 1e-3 * height, size % 2 == 0).value) {
      fuzz::require(rho >= 0 && rho <= 1);
    }
  });
  return 0;
}
