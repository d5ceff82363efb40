#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "link/hex.h"
#include "snapwing/link/crsf.h"
#include "snapwing/link/motor_stream.h"
#include "snapwing/link/sbus.h"

namespace snapwing::link {
namespace {

using test::fromHex;
using test::toHex;

Channels centred() {
  Channels channels;
  channels.count = MAX_CHANNELS;
  channels.us.fill(1500);
  return channels;
}

int framesIn(const std::vector<std::uint8_t>& bytes, SbusParser& parser, double now) {
  int count = 0;
  for (const std::uint8_t byte : bytes) count += parser.push(byte, now) ? 1 : 0;
  return count;
}

TEST(Sbus, VectorsAcceptedByTheFirmware) {
  const WireFrame centre = encodeSbus(centred());
  EXPECT_EQ(toHex(centre.bytes.data(), centre.size), "0fe0031ff8c0073ef0810f7ce0031ff8c0073ef0810f7c0000");
  const WireFrame safe = encodeSbus(safeChannels());
  EXPECT_EQ(toHex(safe.bytes.data(), safe.size), "0fe0031f30c0070c60000318e0031ff8c0073ef0810f7c0000");
}

TEST(Sbus, TicksAsMeasured) {
  EXPECT_EQ(sbusMicroseconds(172), 988);
  EXPECT_EQ(sbusMicroseconds(192), 1000);
  EXPECT_EQ(sbusMicroseconds(992), 1500);
  EXPECT_EQ(sbusMicroseconds(1792), 2000);
  for (int us = 885; us <= 2115; ++us) EXPECT_LE(std::abs(sbusMicroseconds(sbusTick(us)) - us), 1) << us;
}

TEST(Sbus, RandomRoundTrip) {
  std::mt19937 rng(11);
  SbusParser parser;
  for (int i = 0; i < 500; ++i) {
    Ticks ticks;
    for (auto& tick : ticks) tick = static_cast<std::uint16_t>(rng() % 2048);
    std::vector<std::uint8_t> bytes(25, 0);
    bytes[0] = 0x0F;
    packTicks(ticks, &bytes[1]);
    ASSERT_EQ(framesIn(bytes, parser, 0.014 * i), 1);
    EXPECT_EQ(parser.frame().ticks, ticks);
  }
}

TEST(Sbus, LostAndFailsafeFlagsAreSilence) {
  SbusParser parser;
  const WireFrame lost = encodeSbus(centred(), SBUS_FRAME_LOST);
  ASSERT_EQ(framesIn({lost.bytes.begin(), lost.bytes.begin() + 25}, parser, 0.0), 1);
  EXPECT_FALSE(parser.frame().usable());
  const WireFrame failsafe = encodeSbus(centred(), SBUS_FAILSAFE);
  ASSERT_EQ(framesIn({failsafe.bytes.begin(), failsafe.bytes.begin() + 25}, parser, 1.0), 1);
  EXPECT_FALSE(parser.frame().usable());
}

TEST(Sbus, BurstRules) {
  const WireFrame wire = encodeSbus(centred());
  const std::vector<std::uint8_t> frame(wire.bytes.begin(), wire.bytes.begin() + 25);
  SbusParser parser;
  EXPECT_EQ(framesIn(frame, parser, 0.0), 1);
  EXPECT_EQ(framesIn(frame, parser, 0.001), 0) << "a second frame in the same burst is ignored";
  EXPECT_EQ(framesIn(frame, parser, 0.010), 1);
  // Half a frame, then silence, then a whole one: the half is forgotten.
  EXPECT_EQ(framesIn({frame.begin(), frame.begin() + 12}, parser, 0.030), 0);
  EXPECT_EQ(framesIn(frame, parser, 0.044), 1);
  EXPECT_EQ(parser.badFrames(), 1U);
  // A frame drawn out over more than the burst's length is no frame.
  int count = 0;
  for (std::size_t i = 0; i < frame.size(); ++i)
    count += parser.push(frame[i], 1.0 + 0.0002 * static_cast<double>(i)) ? 1 : 0;
  EXPECT_EQ(count, 0);
}

TEST(Crsf, VectorAcceptedByTheFirmware) {
  Channels channels = centred();
  channels.count = 0;  // all at 992
  const WireFrame frame = encodeCrsf(channels);
  EXPECT_EQ(toHex(frame.bytes.data(), frame.size), "c81816e0031ff8c0073ef0810f7ce0031ff8c0073ef0810f7cad");
}

TEST(Crsf, RoundTripAndEveryFlippedBitRejected) {
  const WireFrame wire = encodeCrsf(safeChannels());
  CrsfParser parser;
  int count = 0;
  for (std::size_t i = 0; i < wire.size; ++i) count += parser.push(wire.bytes[i]) ? 1 : 0;
  ASSERT_EQ(count, 1);
  for (int i = 0; i < FRAME_CHANNELS; ++i) {
    const auto k = static_cast<std::size_t>(i);
    EXPECT_LE(std::abs(crsfMicroseconds(parser.ticks()[k]) - safeChannels().us[k]), 1);
  }
  for (std::size_t bit = 8 * 2; bit < 8 * wire.size; ++bit) {
    CrsfParser fresh;
    int found = 0;
    for (std::size_t i = 0; i < wire.size; ++i) {
      const unsigned flip = i == bit / 8 ? 1U << bit % 8 : 0U;
      found += fresh.push(static_cast<std::uint8_t>(wire.bytes[i] ^ flip)) ? 1 : 0;
    }
    EXPECT_EQ(found, 0) << "bit " << bit;
  }
}

TEST(Channels, StickConversionsClampAndTakeNoNonsense) {
  EXPECT_EQ(travelToMicroseconds(0.5, {}), 1500);
  EXPECT_EQ(travelToMicroseconds(7.0, {}), 2000);
  EXPECT_EQ(travelToMicroseconds(-1.0, {}), 1000);
  EXPECT_EQ(travelToMicroseconds(std::nan(""), {}), 1000);
  EXPECT_EQ(stickToMicroseconds(-1.0), 1000);
  EXPECT_EQ(stickToMicroseconds(std::nan("")), 1500);
}

TEST(MotorStream, LayoutAndRefusals) {
  const MotorPacket packet = encodeMotors({0.0, 0.5, 1.0, 2.0});
  EXPECT_EQ(toHex(packet.data(), packet.size()),
            "00000000"
            "0000003f"
            "0000803f"
            "0000803f");
  MotorOutputs read{};
  ASSERT_TRUE(decodeMotors(packet.data(), packet.size(), read));
  EXPECT_EQ(read, (MotorOutputs{0.0, 0.5, 1.0, 1.0}));
  const MotorOutputs before = read;
  EXPECT_FALSE(decodeMotors(packet.data(), 15, read));
  std::vector<std::uint8_t> bad = fromHex(
      "0000c07f"
      "00000000"
      "00000000"
      "00000000");  // NaN
  EXPECT_FALSE(decodeMotors(bad.data(), bad.size(), read));
  bad = fromHex(
      "0000c03f"
      "00000000"
      "00000000"
      "00000000");  // 1.5
  EXPECT_FALSE(decodeMotors(bad.data(), bad.size(), read));
  EXPECT_EQ(read, before);
}

TEST(MotorStream, TheAccelerometersWayBack) {
  const ImuPacket packet = encodeImu({0.0, -0.5, 9.80665});
  EXPECT_EQ(toHex(packet.data(), packet.size()),
            "00000000"
            "000000bf"
            "0ae81c41");
  std::array<double, 3> read{};
  ASSERT_TRUE(decodeImu(packet.data(), packet.size(), read));
  EXPECT_EQ(read[1], -0.5);
  EXPECT_NEAR(read[2], 9.80665, 1e-6);
  EXPECT_FALSE(decodeImu(packet.data(), 11, read));
  const std::vector<std::uint8_t> bad = fromHex("0000c07f0000000000000000");  // NaN
  EXPECT_FALSE(decodeImu(bad.data(), bad.size(), read));
  EXPECT_EQ(read[1], -0.5);
}

}  // namespace
}  // namespace snapwing::link
