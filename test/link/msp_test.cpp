#include "snapwing/link/msp.h"

#include <gtest/gtest.h>

#include <random>

#include "crc.h"
#include "link/hex.h"
#include "snapwing/link/imu_question.h"
#include "snapwing/link/msp_messages.h"

namespace snapwing::link {
namespace {

using test::fromHex;
using test::toHex;

std::string encoded(const MspPacket& packet) {
  std::array<std::uint8_t, MSP_MAX_FRAME> bytes{};
  return toHex(bytes.data(), encodeMsp(packet, bytes.data(), bytes.size()));
}

int packetsIn(const std::vector<std::uint8_t>& bytes, MspParser& parser) {
  int count = 0;
  for (const std::uint8_t byte : bytes) count += parser.push(byte) ? 1 : 0;
  return count;
}

Channels vectorChannels() {
  Channels channels = safeChannels();
  return channels;  // 1500 1500 1000 1500 1000 1000 1000 1000
}

TEST(Crc8, CheckValue) {
  const std::string text = "123456789";
  EXPECT_EQ(crc8DvbS2(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()), 0xBC);
}

TEST(Msp, VectorsAcceptedByTheFirmware) {
  EXPECT_EQ(encoded(request(MspVersion::V1, MSP_API_VERSION)), "244d3c000101");
  EXPECT_EQ(encoded(request(MspVersion::V2, MSP_API_VERSION)), "24583c000100000045");
  EXPECT_EQ(encoded(request(MspVersion::V1, MSP_STATUS)), "244d3c006565");
  EXPECT_EQ(encoded(request(MspVersion::V2, MSP_STATUS)), "24583c0065000000ca");
  EXPECT_EQ(encoded(setRawRc(MspVersion::V1, vectorChannels())), "244d3c10c8dc05dc05e803dc05e803e803e803e803ea");
  EXPECT_EQ(encoded(setRawRc(MspVersion::V2, vectorChannels())), "24583c00c8001000dc05dc05e803dc05e803e803e803e803f4");
}

TEST(Msp, RoundTripOfEverySizeInBothVersions) {
  std::mt19937 rng(7);
  for (const MspVersion version : {MspVersion::V1, MspVersion::V2}) {
    MspParser parser;
    for (std::size_t size = 0; size <= 254; ++size) {
      MspPacket packet = request(version, 119);
      packet.direction = size % 2 == 0 ? '>' : '!';
      packet.size = size;
      for (std::size_t i = 0; i < size; ++i) packet.payload[i] = static_cast<std::uint8_t>(rng());
      std::array<std::uint8_t, MSP_MAX_FRAME> bytes{};
      const std::size_t length = encodeMsp(packet, bytes.data(), bytes.size());
      ASSERT_GT(length, size);
      int count = 0;
      for (std::size_t i = 0; i < length; ++i) count += parser.push(bytes[i]) ? 1 : 0;
      ASSERT_EQ(count, 1) << size;
      EXPECT_EQ(parser.packet().id, packet.id);
      EXPECT_EQ(parser.packet().direction, packet.direction);
      ASSERT_EQ(parser.packet().size, size);
      EXPECT_TRUE(std::equal(packet.payload.begin(), packet.payload.begin() + static_cast<long>(size),
                             parser.packet().payload.begin()));
    }
    EXPECT_EQ(parser.badFrames(), 0U);
  }
}

TEST(Msp, EncoderRefusesWhatDoesNotFit) {
  std::array<std::uint8_t, MSP_MAX_FRAME> bytes{};
  MspPacket packet = request(MspVersion::V1, 300);
  EXPECT_EQ(encodeMsp(packet, bytes.data(), bytes.size()), 0U);
  packet = request(MspVersion::V1, 1);
  packet.size = 255;
  EXPECT_EQ(encodeMsp(packet, bytes.data(), bytes.size()), 0U);
  packet.size = 10;
  EXPECT_EQ(encodeMsp(packet, bytes.data(), 15), 0U);
  EXPECT_EQ(encodeMsp(packet, bytes.data(), 16), 16U);
}

TEST(Msp, EveryFlippedBitIsRejected) {
  for (const char* vector :
       {"244d3c10c8dc05dc05e803dc05e803e803e803e803ea", "24583c00c8001000dc05dc05e803dc05e803e803e803e803f4"}) {
    const std::vector<std::uint8_t> good = fromHex(vector);
    for (std::size_t bit = 8 * 3; bit < 8 * good.size(); ++bit) {
      std::vector<std::uint8_t> bad = good;
      bad[bit / 8] = static_cast<std::uint8_t>(bad[bit / 8] ^ (1U << bit % 8));
      MspParser parser;
      EXPECT_EQ(packetsIn(bad, parser), 0) << "bit " << bit;
    }
  }
}

TEST(Msp, FindsFramesInNoise) {
  std::mt19937 rng(3);
  MspParser parser;
  const std::vector<std::uint8_t> frame = fromHex("24583c0065000000ca");
  int found = 0;
  for (int i = 0; i < 200; ++i) {
    // Noise without '$' cannot hold a frame begun, so every real one must be found.
    for (int k = 0; k < 20; ++k) {
      const auto byte = static_cast<std::uint8_t>(rng());
      found += parser.push(byte == '$' ? 0 : byte) ? 1 : 0;
    }
    found += packetsIn(frame, parser);
  }
  EXPECT_EQ(found, 200);
}

TEST(Msp, OversizedSecondVersionFrameIsDropped) {
  MspParser parser;
  EXPECT_EQ(packetsIn(fromHex("24583c006500ffff"), parser), 0);
  EXPECT_EQ(parser.badFrames(), 1U);
  EXPECT_EQ(packetsIn(fromHex("24583c0065000000ca"), parser), 1);
}

TEST(MspMessages, StatusRoundTripWithModesBeyond32) {
  StatusReply status;
  status.cycle_time = 125;
  status.modes = (1ULL << 35) | 1ULL;
  status.arming_flags = 0x02000204;
  status.arming_flag_count = 26;
  MspPacket packet = request(MspVersion::V2, MSP_STATUS);
  encode(status, packet);
  StatusReply read;
  ASSERT_TRUE(decode(packet, read));
  EXPECT_EQ(read.modes, status.modes);
  EXPECT_EQ(read.arming_flags, status.arming_flags);
  EXPECT_EQ(read.cycle_time, 125);
}

TEST(MspMessages, StatusByHand) {
  // cycle 125, i2c 0, sensors 3, modes 9, profile 0, load 20, 0, 1 byte more (0x02), 26 flags, flags 0x204, config 0,
  // temp 25
  const std::vector<std::uint8_t> bytes = fromHex(
      "7d0000000300090000000014000000"
      "0102"
      "1a04020000"
      "001900");
  MspPacket packet = request(MspVersion::V1, MSP_STATUS);
  packet.size = bytes.size();
  std::copy(bytes.begin(), bytes.end(), packet.payload.begin());
  StatusReply read;
  ASSERT_TRUE(decode(packet, read));
  EXPECT_EQ(read.modes, 9ULL | (2ULL << 32));
  EXPECT_EQ(read.arming_flags, 0x204U);
}

TEST(MspMessages, TruncatedPayloadsAreRefusedAndLeaveTheResultAlone) {
  MspPacket packet = request(MspVersion::V1, MSP_STATUS);
  encode(StatusReply{}, packet);
  // Config state and temperature at the end are not needed.
  for (std::size_t size = 0; size + 3 < packet.size; ++size) {
    MspPacket cut = packet;
    cut.size = size;
    StatusReply read;
    read.cycle_time = 77;
    EXPECT_FALSE(decode(cut, read)) << size;
    EXPECT_EQ(read.cycle_time, 77);
  }
  encode(FailsafeConfig{}, packet);
  for (std::size_t size = 0; size < packet.size; ++size) {
    MspPacket cut = packet;
    cut.size = size;
    FailsafeConfig read;
    EXPECT_FALSE(decode(cut, read)) << size;
  }
}

TEST(MspMessages, RawImuByHand) {
  // 1/2 g back, 0, 1 g up; 10 deg/s about x, -1 about z; without and with a magnetometer
  const std::vector<std::uint8_t> bytes = fromHex("00ff000000020a000000ffff");
  MspPacket packet = request(MspVersion::V2, MSP_RAW_IMU);
  packet.size = bytes.size();
  std::copy(bytes.begin(), bytes.end(), packet.payload.begin());
  RawImu read;
  ASSERT_TRUE(decode(packet, read));
  EXPECT_EQ(read.acceleration, (std::array<int, 3>{-256, 0, 512}));
  EXPECT_EQ(read.rotation, (std::array<int, 3>{10, 0, -1}));
  MspPacket again = request(MspVersion::V2, MSP_RAW_IMU);
  encode(read, again);
  EXPECT_EQ(again.size, 18u);
  EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), again.payload.begin()));
  packet.direction = '>';
  ImuQuestion question({true, 512.0});
  EXPECT_TRUE(question.take(packet, 3.0));
  EXPECT_NEAR(question.reading().acceleration[0], -4.903325, 1e-9);
  EXPECT_NEAR(question.reading().acceleration[2], 9.80665, 1e-9);
  packet.size = 11;
  EXPECT_FALSE(question.take(packet, 3.1));
  EXPECT_FALSE(question.next());
  EXPECT_EQ(question.reading().number, 1);
}

TEST(MspMessages, FailsafeConfigByHand) {
  const std::vector<std::uint8_t> bytes = fromHex("0f0ae80300640001");
  MspPacket packet = request(MspVersion::V1, MSP_FAILSAFE_CONFIG);
  packet.size = bytes.size();
  std::copy(bytes.begin(), bytes.end(), packet.payload.begin());
  FailsafeConfig read;
  ASSERT_TRUE(decode(packet, read));
  EXPECT_DOUBLE_EQ(read.delay, 1.5);
  EXPECT_DOUBLE_EQ(read.landing_time, 1.0);
  EXPECT_EQ(read.throttle, 1000);
  EXPECT_DOUBLE_EQ(read.low_throttle_delay, 10.0);
  EXPECT_EQ(read.procedure, 1);
}

}  // namespace
}  // namespace snapwing::link
