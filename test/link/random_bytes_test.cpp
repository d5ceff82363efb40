/// 100 million random bytes into each parser: what is accepted stays within what the protocol's checksum allows.
#include <gtest/gtest.h>

#include <cstdint>

#include "snapwing/link/crsf.h"
#include "snapwing/link/msp.h"
#include "snapwing/link/sbus.h"

namespace snapwing::link {
namespace {

constexpr long BYTES = 100'000'000;

/// xorshift64*: the same bytes everywhere and fast.
class Noise {
 public:
  std::uint8_t next() {
    state_ ^= state_ >> 12;
    state_ ^= state_ << 25;
    state_ ^= state_ >> 27;
    return static_cast<std::uint8_t>((state_ * 0x2545F4914F6CDD1DULL) >> 56);
  }

 private:
  std::uint64_t state_ = 88172645463325252ULL;
};

TEST(RandomBytes, Msp) {
  // Half of the bytes come from the letters of headers, so that headers are found all the time.
  const std::uint8_t letters[] = {'$', 'M', 'X', '<', '>', '$', 'M', 0};
  Noise noise;
  MspParser parser;
  long accepted = 0;
  for (long i = 0; i < BYTES; ++i) {
    const std::uint8_t byte = noise.next();
    accepted += parser.push((byte & 8) != 0 ? letters[byte & 7] : byte) ? 1 : 0;
    ASSERT_LE(parser.packet().size, MSP_MAX_PAYLOAD + 65280);  // size is unchecked until the header is complete
  }
  const double candidates = static_cast<double>(accepted) + static_cast<double>(parser.badFrames());
  EXPECT_GT(candidates, 1e5) << "the noise must reach the checksum";
  EXPECT_LT(static_cast<double>(accepted) / candidates, 2.5 / 256) << "one in 256 passes an 8-bit check by chance";
}

TEST(RandomBytes, Crsf) {
  Noise noise;
  CrsfParser parser;
  long accepted = 0;
  for (long i = 0; i < BYTES; ++i) {
    const std::uint8_t byte = noise.next();
    const std::uint8_t biased = i % 64 == 0 ? 0xC8 : i % 64 == 1 ? 24 : i % 64 == 2 ? 0x16 : byte;
    accepted += parser.push(biased) ? 1 : 0;
  }
  const double candidates = static_cast<double>(accepted) + static_cast<double>(parser.badFrames());
  EXPECT_GT(candidates, 1e5);
  EXPECT_LT(static_cast<double>(accepted) / candidates, 2.0 / 256);
}

TEST(RandomBytes, Sbus) {
  Noise noise;
  SbusParser parser;
  long accepted = 0, bursts = 0;
  for (long i = 0; i < BYTES; ++i) {
    if (i % 25 == 0) ++bursts;
    const std::uint8_t byte = i % 25 == 0 ? 0x0F : noise.next();
    if (!parser.push(byte, 0.014 * static_cast<double>(bursts))) continue;
    ++accepted;
    ASSERT_EQ(byte, 0x00) << "the tail";
    for (const std::uint16_t tick : parser.frame().ticks) ASSERT_LT(tick, 2048);
  }
  // The tail is all that there is: 8 bits, no checksum.
  EXPECT_NEAR(static_cast<double>(accepted) / static_cast<double>(bursts), 1.0 / 256, 1e-4);
}

}  // namespace
}  // namespace snapwing::link
