// A recorded hello has a good seal for ever: it must take no living operator's answers away.
#include "greetings.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace snapwing::link {
namespace {

std::int64_t challengeOf(const Greetings& greetings, std::int64_t sender) {
  const auto& all = greetings.all();
  const auto it = std::find_if(all.begin(), all.end(), [&](const auto& g) { return g.sender == sender; });
  return it == all.end() ? 0 : it->challenge;
}

TEST(Greetings, RepeatedAndOlderHellosHaveNoEffect) {
  Greetings greetings;
  EXPECT_TRUE(greetings.take(7, 1, 100.0));
  EXPECT_TRUE(greetings.take(7, 5, 100.02));
  EXPECT_FALSE(greetings.take(7, 5, 100.03));
  EXPECT_FALSE(greetings.take(7, 1, 100.03));
  EXPECT_EQ(challengeOf(greetings, 7), 5);
  EXPECT_FALSE(greetings.take(7, 4, 200.0)) << "nor after a long silence";
  EXPECT_TRUE(greetings.take(7, 6, 200.0));
}

TEST(Greetings, ASenderThatIsHeardKeepsItsPlace) {
  Greetings greetings;
  double now = 100;
  std::int64_t challenge = 0;
  for (int frame = 0; frame < 200; ++frame, now += 0.02) {
    ASSERT_TRUE(greetings.take(7, ++challenge, now));
    for (std::int64_t recorded = 1000; recorded < 1020; ++recorded) greetings.take(recorded, frame + 1, now + 0.01);
    ASSERT_EQ(challengeOf(greetings, 7), challenge);
  }
}

TEST(Greetings, ASilentSenderMakesPlaceForANewOne) {
  Greetings greetings;
  for (std::int64_t sender = 1; sender <= 8; ++sender) EXPECT_TRUE(greetings.take(sender, 1, 100.0 + 0.01 * sender));
  EXPECT_FALSE(greetings.take(9, 1, 100.2)) << "all are living";
  EXPECT_TRUE(greetings.take(9, 1, 100.01 + Greetings::LIFE + 0.001));
  EXPECT_EQ(challengeOf(greetings, 1), 0) << "who was silent for longest";
  EXPECT_EQ(challengeOf(greetings, 9), 1);
}

TEST(Greetings, NobodyIsNoSender) {
  Greetings greetings;
  EXPECT_FALSE(greetings.take(0, 1, 100.0));
  EXPECT_FALSE(greetings.take(7, 0, 100.0));
}

}  // namespace
}  // namespace snapwing::link
