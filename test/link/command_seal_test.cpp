/// The door for commands that come over ROS.
#include "snapwing/link/command_seal.h"

#include <gtest/gtest.h>

namespace snapwing::link {
namespace {

constexpr std::int64_t SESSION = 42;
constexpr double MAX_AGE = 0.1;

Key someKey(std::uint8_t seed) {
  Key key;
  key.fill(seed);
  return key;
}

class Door : public ::testing::Test {
 protected:
  /// The node publishes a status every 20 ms.
  void run(double seconds) {
    for (const double end = now_ + seconds; now_ < end - 1e-9; now_ += 0.02) {
      door_.noteStatus(SESSION, ++number_, now_);
    }
  }
  CommandSeal seal() const { return sealer_.seal(content_, SESSION, number_); }
  std::string judge(const CommandSeal& seal) { return door_.judge(content_, seal, MAX_AGE, now_); }

  double now_ = 1000.0;
  std::int64_t number_ = 0;
  std::string content_ = pulseContent(7, {0.9, 0.5, 0, 0, 0.0, false});
  CommandSealer sealer_{someKey(1), "a"};
  CommandDoor door_{someKey(1), "a"};
};

TEST_F(Door, LetsInWhatIsSealedAndFreshOnce) {
  run(0.2);
  const CommandSeal good = seal();
  EXPECT_EQ(judge(good), "");
  EXPECT_NE(judge(good).find("used before"), std::string::npos);
  EXPECT_EQ(judge(seal()), "") << "another seal for the same command";
}

TEST_F(Door, RefusesWhatHasNoSealOrAWrongOne) {
  run(0.2);
  EXPECT_NE(judge({}).find("no seal"), std::string::npos);
  CommandSeal bad = CommandSealer(someKey(2), "a").seal(content_, SESSION, number_);
  EXPECT_NE(judge(bad).find("wrong"), std::string::npos) << "another key";
  bad = CommandSealer(someKey(1), "b").seal(content_, SESSION, number_);
  EXPECT_NE(judge(bad).find("wrong"), std::string::npos) << "another vehicle";
  for (const std::string& other :
       {pulseContent(8, {0.9, 0.5, 0, 0, 0.0, false}), pulseContent(7, {1.0, 0.5, 0, 0, 0.0, false}),
        pulseContent(7, {0.9, 0.6, 0, 0, 0.0, false}), pulseContent(7, {0.9, 0.5, 0, 0, 0.0, true}),
        pulseContent(7, {0.9, 0.5, 0, 0, 0.1, false}), pulseContent(7, {0.9, 0.5, 0.2, 0, 0.0, false}),
        pulseContent(7, {0.9, 0.5, 0, 0.2, 0.0, false}), armContent(true), resetContent()}) {
    EXPECT_NE(door_.judge(other, seal(), MAX_AGE, now_).find("wrong"), std::string::npos);
  }
  for (std::size_t part = 0; part < 4; ++part) {
    CommandSeal changed = seal();
    if (part == 0) changed.session ^= 1;
    if (part == 1) changed.status_number -= 1;
    if (part == 2) changed.nonce ^= 1;
    if (part == 3) changed.code[31] ^= 1;
    EXPECT_NE(judge(changed).find("wrong"), std::string::npos) << part;
  }
}

TEST_F(Door, RefusesWhatIsOldRecordedOrFromAnotherRun) {
  run(0.2);
  const CommandSeal recorded = seal();
  run(0.06);
  CommandSeal late = seal();
  run(0.1 - 0.02);
  EXPECT_EQ(judge(late), "") << "just in time";
  EXPECT_NE(judge(recorded).find("ms old"), std::string::npos);
  run(10.0);
  EXPECT_NE(judge(recorded).find("not published here lately"), std::string::npos);
  const CommandSeal future = sealer_.seal(content_, SESSION, number_ + 1);
  EXPECT_NE(judge(future).find("not published"), std::string::npos);
  EXPECT_NE(judge(sealer_.seal(content_, SESSION, 0)).find("not published"), std::string::npos);
  const CommandSeal before = seal();
  for (int i = 1; i <= 300; ++i) door_.noteStatus(SESSION + 1, i, now_);  // numbers as in the recording
  EXPECT_NE(judge(before).find("another run"), std::string::npos);
}

/// The same bytes as python/snapwing_tools/seal.py makes (test/python/test_seal.py).
TEST_F(Door, CodeIsTheAgreedOne) {
  const std::string content = pulseContent(7, {0.9, 0.5, 0.2, 1.3, -0.25, true});
  CommandSeal seal{SESSION, 5, 6, {}};
  const Key key = someKey(1);
  std::string when;
  for (const std::int64_t value : {seal.session, seal.status_number, seal.nonce}) {
    for (int i = 0; i < 8; ++i) when += static_cast<char>(value >> 8 * i & 0xFF);
  }
  const auto code = authenticationCode(key, "snapwing ROS command 2", {"a", content, when});
  std::string hex;
  for (const std::uint8_t byte : code) {
    char two[3];
    std::snprintf(two, sizeof two, "%02x", byte);
    hex += two;
  }
  EXPECT_EQ(hex, "ce753d3c840d3721a19f6dd363942d2cf8d6987d7918df33118c392b68cd5cc9");
  seal.code = code;
  door_.noteStatus(SESSION, 5, now_);
  EXPECT_EQ(door_.judge(content, seal, MAX_AGE, now_), "");
}

}  // namespace
}  // namespace snapwing::link
