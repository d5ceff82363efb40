#include "crc.h"

#include <array>

namespace snapwing::link {
namespace {

constexpr std::array<std::uint8_t, 256> makeTable() {
  std::array<std::uint8_t, 256> table{};
  for (unsigned value = 0; value < 256; ++value) {
    unsigned crc = value;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 0x80U) != 0 ? ((crc << 1) ^ 0xD5U) & 0xFFU : crc << 1;
    table[value] = static_cast<std::uint8_t>(crc);
  }
  return table;
}
constexpr std::array<std::uint8_t, 256> TABLE = makeTable();

}  // namespace

std::uint8_t crc8DvbS2(const std::uint8_t* bytes, std::size_t size, std::uint8_t crc) {
  for (std::size_t i = 0; i < size; ++i) crc = TABLE[crc ^ bytes[i]];
  return crc;
}

}  // namespace snapwing::link
