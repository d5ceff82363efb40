#include <gtest/gtest.h>

#include <cmath>

#include "snapwing/common/error.h"
#include "snapwing/common/time_watch.h"

namespace snapwing::common {
namespace {

TEST(ClockWatch, KnowsAClockThatIsNotThereYet) {
  ClockWatch watch;
  EXPECT_EQ(watch.look(0.0, 1.0), ClockEvent::MISSING);
  EXPECT_EQ(watch.look(NAN, 1.0), ClockEvent::MISSING);
  EXPECT_EQ(watch.look(1.5e9, 2.0), ClockEvent::ON);  // the first time is no jump, wherever it begins
  EXPECT_EQ(watch.jumps(), 0u);
}

TEST(ClockWatch, SeesJumpsBothWaysAndGoesOnFromThere) {
  ClockWatch watch(0.5);
  EXPECT_EQ(watch.look(100.0, 1.0), ClockEvent::ON);
  EXPECT_EQ(watch.look(100.1, 1.1), ClockEvent::ON);
  EXPECT_EQ(watch.look(20.0, 1.2), ClockEvent::BACK);
  EXPECT_EQ(watch.look(20.1, 1.3), ClockEvent::ON);
  EXPECT_EQ(watch.look(620.1, 1.4), ClockEvent::AHEAD);
  EXPECT_EQ(watch.look(620.2, 1.5), ClockEvent::ON);
  EXPECT_EQ(watch.jumps(), 2u);
}

TEST(ClockWatch, APauseOfTheProgramOrOfTheClockIsNoJump) {
  ClockWatch watch(0.5);
  watch.look(100.0, 1.0);
  EXPECT_EQ(watch.look(130.0, 31.0), ClockEvent::ON);  // nobody looked for half a minute
  EXPECT_EQ(watch.look(130.0, 61.0), ClockEvent::ON);  // the clock stood
  EXPECT_EQ(watch.look(130.1, 61.1), ClockEvent::ON);
  EXPECT_EQ(watch.look(131.1, 61.2), ClockEvent::AHEAD);  // the pause before does not excuse this
}

TEST(ClockWatch, SmallStepsBackAddUp) {
  ClockWatch watch(0.5);
  watch.look(100.0, 1.0);
  EXPECT_EQ(watch.look(99.7, 1.1), ClockEvent::ON);
  EXPECT_EQ(watch.look(99.4, 1.2), ClockEvent::BACK);
}

TEST(ClockWatch, RefusesAToleranceOfNothing) {
  EXPECT_THROW(ClockWatch(0.0), Error);
  EXPECT_THROW(ClockWatch{NAN}, Error);
}

TEST(StampWatch, TakesEachStampOnceAndInOrder) {
  StampWatch watch;
  EXPECT_EQ(watch.take(10.0, 10.1, 1.0), StampVerdict::GOOD);
  EXPECT_EQ(watch.take(10.0, 10.1, 1.0), StampVerdict::REPEATED);
  EXPECT_EQ(watch.take(9.9, 10.1, 1.0), StampVerdict::OLDER);
  EXPECT_EQ(watch.take(10.1, 10.1, 1.0), StampVerdict::GOOD);
  EXPECT_EQ(watch.last(), 10.1);
  EXPECT_EQ(watch.count(StampVerdict::GOOD), 2u);
  EXPECT_EQ(watch.count(StampVerdict::REPEATED), 1u);
}

TEST(StampWatch, RefusesWhatIsStaleAheadOrUnstamped) {
  StampWatch watch({0.5, 0.25});
  EXPECT_EQ(watch.take(10.0, 10.6, 1.0), StampVerdict::STALE);
  EXPECT_EQ(watch.take(10.0, 9.7, 1.0), StampVerdict::FUTURE);
  EXPECT_EQ(watch.take(0.0, 9.7, 1.0), StampVerdict::UNSTAMPED);
  EXPECT_EQ(watch.take(NAN, 9.7, 1.0), StampVerdict::UNSTAMPED);
  EXPECT_EQ(watch.take(10.0, 0.0, 1.0), StampVerdict::NO_CLOCK);
  EXPECT_EQ(watch.last(), 0.0);
  EXPECT_TRUE(std::isinf(watch.age(10.0, 1.0)));
}

TEST(StampWatch, AMessageGrowsOldByBothClocks) {
  StampWatch watch;
  watch.take(10.0, 10.0, 1.0);
  EXPECT_NEAR(watch.age(10.2, 1.1), 0.2, 1e-12);
  EXPECT_DOUBLE_EQ(watch.age(10.0, 4.0), 3.0);  // the clock stands
  watch.restart();
  EXPECT_TRUE(std::isinf(watch.age(10.0, 4.0)));
  EXPECT_EQ(watch.take(2.0, 2.1, 4.0), StampVerdict::GOOD);  // after a jump back
}

TEST(StampWatch, SaysWhatIsWrong) {
  StampWatch watch;
  EXPECT_EQ(watch.trouble(0.0, 1.0, 0.5), "cannot be judged: there is no clock yet");
  EXPECT_EQ(watch.trouble(10.0, 1.0, 0.5), "never came");
  watch.take(13.0, 10.0, 1.0);
  EXPECT_EQ(watch.trouble(10.0, 1.0, 0.5), "is stamped 3.0 s ahead of the clock");
  watch.take(10.0, 10.0, 1.0);
  EXPECT_EQ(watch.trouble(10.1, 1.1, 0.5), "");
  EXPECT_EQ(watch.trouble(12.0, 3.0, 0.5), "stopped 2.0 s ago");
  watch.take(10.0, 12.0, 3.0);
  EXPECT_EQ(watch.trouble(12.0, 3.0, 0.5), "is stamped 2.0 s behind the clock");
}

TEST(StampWatch, RefusesLimitsOfNothing) {
  EXPECT_THROW(StampWatch({0.0, 0.1}), Error);
  EXPECT_THROW(StampWatch({0.5, -1.0}), Error);
}

}  // namespace
}  // namespace snapwing::common
