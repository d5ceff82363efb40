/// Keys, envelopes and the LCM types: what is not ours does not get in.
#include "snapwing/link/sealing.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <random>

#include "lcm_messages.h"
#include "snapwing/common/error.h"
#include "snapwing_lcm/hello_t.hpp"
#include "spsc_ring.h"

namespace snapwing::link {
namespace {

class KeyFile : public ::testing::Test {
 protected:
  KeyFile() {
    std::string pattern = ::testing::TempDir() + "snapwing_key_XXXXXX";
    folder_ = mkdtemp(pattern.data());
    path_ = folder_ + "/key";
  }
  ~KeyFile() override {
    unlink(path_.c_str());
    rmdir(folder_.c_str());
  }
  std::string folder_, path_;
};

TEST_F(KeyFile, CreatedForTheOwnerOnlyAndReadBack) {
  createKeyFile(path_);
  struct stat info {};
  ASSERT_EQ(stat(path_.c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777U, 0600U);
  const Key key = loadKeyFile(path_);
  EXPECT_EQ(key, loadKeyFile(path_));
  EXPECT_THROW(createKeyFile(path_), common::FileError) << "an existing key is never replaced";
}

TEST_F(KeyFile, TwoKeysDiffer) {
  createKeyFile(path_);
  const Key first = loadKeyFile(path_);
  unlink(path_.c_str());
  createKeyFile(path_);
  EXPECT_NE(first, loadKeyFile(path_));
}

TEST_F(KeyFile, RefusesOpenShortAndMissingKeys) {
  EXPECT_THROW(loadKeyFile(path_), common::FileError);
  createKeyFile(path_);
  chmod(path_.c_str(), 0640);
  EXPECT_THROW(loadKeyFile(path_), common::FileError);
  chmod(path_.c_str(), 0600);
  EXPECT_NO_THROW(loadKeyFile(path_));
  std::ofstream(path_) << "00112233";
  EXPECT_THROW(loadKeyFile(path_), common::FileError);
  std::ofstream(path_) << std::string(64, 'x');
  EXPECT_THROW(loadKeyFile(path_), common::FileError);
}

Key someKey(std::uint8_t seed) {
  Key key;
  key.fill(seed);
  return key;
}

snapwing_lcm::pulse_command_t somePulse() {
  PulseCommand command;
  command.stamp = {11, 22, 33, 44.5, 0.1, 55, 0.01};
  command.pulse_id = 5;
  command.throttle = 0.5;
  command.duration = 0.25;
  command.hold_throttle = 0.25;
  command.hold_duration = 1.125;
  command.pitch = -0.1;
  command.mixed = true;
  return toLcm(command);
}

TEST(Sealing, RoundTrip) {
  const Sealer sealer(someKey(1));
  const auto bytes = sealer.wrap(CHANNEL_PULSE, somePulse());
  ASSERT_FALSE(bytes.empty());
  EXPECT_LT(bytes.size(), 1400U) << "one datagram, one packet";
  snapwing_lcm::pulse_command_t wire;
  ASSERT_TRUE(sealer.unwrap(CHANNEL_PULSE, bytes.data(), bytes.size(), wire));
  PulseCommand read;
  ASSERT_TRUE(fromLcm(wire, read));
  EXPECT_EQ(read.stamp.sender_id, 11);
  EXPECT_EQ(read.stamp.session, 22);
  EXPECT_EQ(read.stamp.number, 33);
  EXPECT_NEAR(read.stamp.time, 44.5, 1e-6);
  EXPECT_NEAR(read.stamp.expiry, 0.1, 1e-6);
  EXPECT_EQ(read.stamp.status_number, 55);
  EXPECT_NEAR(read.stamp.held, 0.01, 1e-6);
  EXPECT_EQ(read.pulse_id, 5);
  EXPECT_EQ(read.throttle, 0.5);
  EXPECT_EQ(read.duration, 0.25);
  EXPECT_EQ(read.hold_throttle, 0.25);
  EXPECT_EQ(read.hold_duration, 1.125);
  EXPECT_EQ(read.pitch, -0.1);
  EXPECT_TRUE(read.mixed);
}

TEST(Sealing, ForgedMovedAndForeignMessagesAreRefused) {
  const Sealer sealer(someKey(1));
  auto bytes = sealer.wrap(CHANNEL_PULSE, somePulse());
  snapwing_lcm::pulse_command_t pulse;
  snapwing_lcm::heartbeat_t heartbeat;
  EXPECT_FALSE(Sealer(someKey(2)).unwrap(CHANNEL_PULSE, bytes.data(), bytes.size(), pulse)) << "another key";
  EXPECT_FALSE(Sealer(someKey(1), "b").unwrap(CHANNEL_PULSE, bytes.data(), bytes.size(), pulse)) << "another vehicle";
  EXPECT_FALSE(sealer.unwrap(CHANNEL_ABORT, bytes.data(), bytes.size(), pulse)) << "another channel";
  EXPECT_FALSE(sealer.unwrap(CHANNEL_PULSE, bytes.data(), bytes.size(), heartbeat)) << "another type";
  EXPECT_FALSE(sealer.unwrap(CHANNEL_PULSE, bytes.data(), bytes.size() - 1, pulse)) << "cut";
  auto longer = bytes;
  longer.push_back(0);
  EXPECT_FALSE(sealer.unwrap(CHANNEL_PULSE, longer.data(), longer.size(), pulse)) << "drawn out";
  EXPECT_FALSE(sealer.unwrap(CHANNEL_PULSE, bytes.data(), 0, pulse));
}

TEST(Sealing, EveryFlippedBitOfTheUsedPartIsNoticed) {
  const Sealer sealer(someKey(3));
  const auto good = sealer.wrap(CHANNEL_HEARTBEAT, toLcm(Heartbeat{{1, 2, 3, 4.0, 0.1, 1, 0.0}, true, true, false}));
  const std::size_t used = 8 + 4 + 4 + 32 + static_cast<std::size_t>(snapwing_lcm::heartbeat_t().getEncodedSize());
  snapwing_lcm::heartbeat_t out;
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    if (bit / 8 >= used && bit / 8 < good.size() - 32) continue;  // padding carries nothing
    auto bad = good;
    bad[bit / 8] = static_cast<std::uint8_t>(bad[bit / 8] ^ (1U << bit % 8));
    EXPECT_FALSE(sealer.unwrap(CHANNEL_HEARTBEAT, bad.data(), bad.size(), out)) << bit;
  }
}

TEST(Sealing, RandomBytesNeverGetIn) {
  std::mt19937 rng(7);
  const Sealer sealer(someKey(4));
  const auto good = sealer.wrap(CHANNEL_PULSE, somePulse());
  snapwing_lcm::pulse_command_t out;
  for (int i = 0; i < 20000; ++i) {
    std::vector<std::uint8_t> bytes = good;
    const std::size_t from = i % 2 == 0 ? 0 : 8;  // half of them with the right fingerprint
    for (std::size_t k = from; k < bytes.size(); ++k) bytes[k] = static_cast<std::uint8_t>(rng());
    EXPECT_FALSE(sealer.unwrap(CHANNEL_PULSE, bytes.data(), bytes.size(), out));
  }
}

TEST(Messages, AllFitTheEnvelopeAndOtherVersionsAreRefused) {
  const Sealer sealer(someKey(5));
  const Stamp stamp{1, 2, 3, 4.0, 0.2, 1, 0.0};
  EXPECT_FALSE(sealer.wrap(CHANNEL_STATUS, toLcm(BridgeStatus{}, stamp, 0)).empty());
  EXPECT_FALSE(sealer.wrap(CHANNEL_TELEMETRY, toLcm(ControllerTelemetry{}, stamp, 4.0)).empty());
  EXPECT_FALSE(sealer.wrap(CHANNEL_ABORT, toLcm(Abort{stamp, 1})).empty());
  auto pulse = somePulse();
  PulseCommand out;
  EXPECT_TRUE(fromLcm(pulse, out));
  ++pulse.stamp.version;
  EXPECT_FALSE(fromLcm(pulse, out));
  pulse = somePulse();
  pulse.stamp.expiry_us = 0;
  EXPECT_FALSE(fromLcm(pulse, out));
}

/// Programs of two releases name each other: any change of a message counts the envelope's version up. If this fails,
/// a message has changed: count VERSION up in lcm/sealed_t.lcm, unless that release has not gone out yet, and write
/// the new sum here.
TEST(Messages, AChangedMessageIsAnotherVersion) {
  constexpr std::uint64_t KNOWN = 9706456399828378147U;
  const std::int64_t sum = snapwing_lcm::pulse_command_t::getHash() ^ snapwing_lcm::heartbeat_t::getHash() ^
                           snapwing_lcm::abort_t::getHash() ^ snapwing_lcm::link_status_t::getHash() ^
                           snapwing_lcm::telemetry_t::getHash() ^ snapwing_lcm::hello_t::getHash() ^
                           snapwing_lcm::sealed_t::getHash();
  EXPECT_EQ(snapwing_lcm::sealed_t::VERSION, 4);
  EXPECT_EQ(static_cast<std::uint64_t>(sum), KNOWN);
}

TEST(Messages, EnvelopesOfOtherReleasesAndVehiclesAreNamed) {
  const Sealer sealer(someKey(1), "a");
  auto bytes = sealer.wrap(CHANNEL_PULSE, somePulse());
  snapwing_lcm::sealed_t sealed;
  const auto opened = [&](const Sealer& by) { return by.open(CHANNEL_PULSE, bytes.data(), bytes.size(), sealed); };
  EXPECT_EQ(opened(sealer), Envelope::GOOD);
  EXPECT_EQ(opened(Sealer(someKey(2), "b")), Envelope::OTHER_VEHICLE);
  EXPECT_EQ(vehicleOf(sealed), "a");
  EXPECT_EQ(opened(Sealer(someKey(2), "a")), Envelope::BAD);
  // The envelope of the first release: fingerprint, 1, size, 512 bytes, code.
  bytes.assign(8 + 4 + 4 + 512 + 32, 0);
  bytes[0] = 0x77;
  bytes[11] = 1;
  EXPECT_EQ(opened(sealer), Envelope::OTHER_VERSION);
  EXPECT_EQ(Sealer::claimedVersion(bytes.data(), bytes.size()), 1);
  bytes[8] = 0x10;
  EXPECT_EQ(opened(sealer), Envelope::BAD) << "no release has that number";
  bytes.resize(40);
  EXPECT_EQ(opened(sealer), Envelope::BAD) << "too short";
}

TEST(Sealing, VehicleIdsAreShortAndPlain) {
  for (const std::string& id : {std::string(), std::string(33, 'x'), std::string("a b"), std::string("\xc3\xa4")})
    EXPECT_THROW(Sealer(someKey(1), id), common::SettingError) << id;
  EXPECT_NO_THROW(Sealer(someKey(1), std::string(32, 'x')));
  EXPECT_NE(defaultKeyFile("lab/a").find("/.ros/snapwing_link_lab_a.key"), std::string::npos);
  EXPECT_NE(defaultKeyFile("a"), defaultKeyFile("b"));
}

TEST(Messages, StatusRoundTrip) {
  BridgeStatus status;
  status.state = BridgeState::FAULT;
  status.fault = Fault::LINE_LOST;
  status.channels = safeChannels();
  status.frame_time = 12.25;
  status.period_histogram = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
  status.controller.arming_flags = 0x82000204;
  BridgeStatus read;
  ASSERT_TRUE(fromLcm(toLcm(status, {9, 9, 1, status.frame_time, 0.2, 1, 0.0}, 4), read));
  EXPECT_EQ(read.state, status.state);
  EXPECT_EQ(read.fault, status.fault);
  ASSERT_EQ(read.channels.count, FRAME_CHANNELS);
  EXPECT_TRUE(
      std::equal(read.channels.us.begin(), read.channels.us.begin() + FRAME_CHANNELS, status.channels.us.begin()));
  EXPECT_EQ(read.period_histogram, status.period_histogram);
  EXPECT_EQ(read.controller.arming_flags, status.controller.arming_flags);
  EXPECT_NEAR(read.frame_time, 12.25, 1e-6);
}

TEST(SpscRing, FirstInFirstOutAndKeepsPlacesFree) {
  SpscRing<int, 8> ring;
  int pushed = 0;
  while (ring.push(pushed, 3)) ++pushed;
  EXPECT_EQ(pushed, 5);
  while (ring.push(pushed)) ++pushed;
  EXPECT_EQ(pushed, 8);
  int item = -1;
  for (int i = 0; i < 8; ++i) {
    ASSERT_TRUE(ring.pop(item));
    EXPECT_EQ(item, i);
  }
  EXPECT_FALSE(ring.pop(item));
}

}  // namespace
}  // namespace snapwing::link
