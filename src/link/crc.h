#pragma once
/// CRC-8/DVB-S2 (polynomial 0xD5, initial value 0), used by MSP v2 and CRSF. "123456789" gives 0xBC.

#include <cstddef>
#include <cstdint>

namespace snapwing::link {

std::uint8_t crc8DvbS2(const std::uint8_t* bytes, std::size_t size, std::uint8_t crc = 0);

}  // namespace snapwing::link
