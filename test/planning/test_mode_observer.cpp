// The mode estimate when clocks jump, readings stop, come late or never come.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "snapwing/common/error.h"
#include "snapwing/planning/mode_observer.h"
#include "standin_controller.h"
#include "support/example_table.h"
#include "support/paths.h"

namespace snapwing::planning {
namespace {

using common::StampVerdict;
using vehicle::Mode;

/// A node's life: readings at 200 Hz, link statuses and updates at 50 Hz, both clocks under the test's hand.
class ObserverTest : public ::testing::Test {
 protected:
  ObserverTest()
      : vehicle_(vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml")),
        observer_(makeEstimator(), settingsWith(Mode::FIXED_WING)) {}

  ModeEstimator makeEstimator() const {
    EstimatorSettings settings;
    settings.particles = 200;
    return ModeEstimator(vehicle_, snapwing::testing::exampleTable(), settings);
  }
  static ObserverSettings settingsWith(Mode stated) {
    ObserverSettings settings;
    settings.stated = stated;
    return settings;
  }

  void run(double seconds) {
    for (const double end = steady_ + seconds - 1e-9; steady_ < end;) {
      steady_ += 0.005;
      if (clock_runs_) now_ += 0.005;
      if (imu_) observer_.reading(now_ - imu_late_, reading_, now_, steady_);
      if (++ticks_ % 4 != 0) continue;
      if (link_) observer_.motors(now_, output_, 0.0, now_, steady_);
      report_ = observer_.update(now_, steady_);
      told_ += report_.fresh;
      sure_ += report_.estimate.mode != Mode::UNKNOWN;
    }
  }
  Mode mode() const { return report_.estimate.mode; }
  const std::string& reason() const { return report_.estimate.reason; }
  void expectReason(const std::string& words) {
    EXPECT_EQ(mode(), Mode::UNKNOWN);
    EXPECT_NE(reason().find(words), std::string::npos) << reason();
  }

  vehicle::Vehicle vehicle_;
  ModeObserver observer_;
  ModeReport report_;
  double now_ = 1000.0, steady_ = 5.0, reading_ = 0.0, output_ = 0.0, imu_late_ = 0.0;
  bool imu_ = true, link_ = true, clock_runs_ = true;
  long ticks_ = 0, told_ = 0, sure_ = 0;
};

TEST_F(ObserverTest, CaseA_TheClockBeginsLateAndWhatWasStatedHolds) {
  now_ = 0.0;
  clock_runs_ = false;
  run(2.0);
  expectReason("there is no clock yet");
  EXPECT_EQ(told_, 0);
  now_ = 1.5e9;
  clock_runs_ = true;
  run(6.0);
  EXPECT_EQ(mode(), Mode::FIXED_WING);
  EXPECT_GT(report_.estimate.probability_fixed_wing, 0.95);
  EXPECT_NEAR(report_.estimate.travel, 0.0, 1e-3);
  EXPECT_EQ(observer_.jumps(), 0u);
}

TEST_F(ObserverTest, CaseB_AfterAJumpBackNothingIsKnownAndReadingsAreTaken) {
  run(2.0);
  ASSERT_EQ(mode(), Mode::FIXED_WING);
  now_ -= 80.0;
  sure_ = told_ = 0;
  const unsigned long before = observer_.readings().count(StampVerdict::GOOD);
  run(3.0);  // at rest as before: nothing shows which mode it is in
  EXPECT_EQ(sure_, 0);
  expectReason("jumped back");
  EXPECT_GT(told_, 140);
  EXPECT_GE(observer_.readings().count(StampVerdict::GOOD), before + 590);
  EXPECT_EQ(observer_.jumps(), 1u);
  EXPECT_LT(report_.stamp, 1000.0);
}

TEST_F(ObserverTest, CaseB_AReadingThatNoRestExplainsMakesNobodySure) {
  run(2.0);
  now_ -= 80.0;
  reading_ = 8.0;
  sure_ = 0;
  run(8.0);
  EXPECT_EQ(sure_, 0);
}

TEST_F(ObserverTest, CaseC_AJumpAheadTakesNoTimeAndEndsWhatWasKnown) {
  run(2.0);
  ASSERT_EQ(mode(), Mode::FIXED_WING);
  now_ += 600.0;
  sure_ = 0;
  const auto begin = std::chrono::steady_clock::now();
  run(0.04);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  EXPECT_LT(took.count(), 5.0);  // 300 thousand steps of 200 particles would take a minute
  run(3.0);
  EXPECT_EQ(sure_, 0);
  expectReason("jumped ahead");
}

TEST_F(ObserverTest, CaseD_WithoutAnyImuNothingIsKnown) {
  imu_ = false;
  run(25.0);
  EXPECT_EQ(sure_, 0);
  EXPECT_GT(told_, 1200);
  expectReason("the IMU never came");
  EXPECT_EQ(report_.estimate.probability_fixed_wing, 0.5);
  EXPECT_TRUE(std::isnan(report_.reading_age));
}

TEST_F(ObserverTest, SilenceIsUnknownAndAShortOneIsForgiven) {
  run(1.0);
  ASSERT_EQ(mode(), Mode::FIXED_WING);
  imu_ = false;
  run(0.5);
  expectReason("the IMU stopped");
  EXPECT_GT(report_.reading_age, 0.3);
  imu_ = true;
  run(0.3);
  EXPECT_EQ(mode(), Mode::FIXED_WING);
  EXPECT_EQ(reason(), "");
}

TEST_F(ObserverTest, ALongSilenceEndsWhatWasKnown) {
  run(1.0);
  imu_ = false;
  run(2.0);
  EXPECT_EQ(report_.estimate.probability_fixed_wing, 0.5);
  imu_ = true;
  run(2.0);
  expectReason("the IMU readings stopped");
  observer_.state(Mode::FIXED_WING);  // the operator looks
  run(0.5);
  EXPECT_EQ(mode(), Mode::FIXED_WING);
}

TEST_F(ObserverTest, AClockThatStandsIsASilence) {
  run(1.0);
  clock_runs_ = false;
  run(1.0);
  EXPECT_EQ(mode(), Mode::UNKNOWN);
}

TEST_F(ObserverTest, WhatWasStatedFallsWhenMotorsTurnUnseen) {
  imu_ = false;
  output_ = 0.8;
  run(0.2);
  output_ = 0.0;
  run(1.0);
  imu_ = true;
  run(2.0);
  expectReason("the motors turned while no reading came");
}

TEST_F(ObserverTest, ReadingsOfTheFutureOrThePastAndWithoutANumberAreNotUsed) {
  imu_late_ = -3.0;
  run(1.0);
  expectReason("is stamped 3.0 s ahead of the clock");
  imu_late_ = 3.0;
  run(1.0);
  expectReason("is stamped 3.0 s behind the clock");
  imu_late_ = 0.0;
  reading_ = NAN;
  run(1.0);
  EXPECT_EQ(mode(), Mode::UNKNOWN);
  EXPECT_EQ(observer_.notNumbers(), 200u);
  reading_ = 0.0;
  run(1.0);
  EXPECT_EQ(mode(), Mode::FIXED_WING);
}

TEST_F(ObserverTest, AClockOfTenHertzRepeatsNoStamp) {
  double last = 0;
  for (int i = 1; i <= 400; ++i) {
    steady_ += 0.005;
    now_ = 1000.0 + 0.1 * std::floor(0.005 * i / 0.1);
    observer_.reading(now_, 0.0, now_, steady_);
    report_ = observer_.update(now_, steady_);
    if (!report_.fresh) continue;
    ++told_;
    EXPECT_GT(report_.stamp, last);
    last = report_.stamp;
  }
  EXPECT_GE(told_, 19);
  EXPECT_GE(observer_.readings().count(StampVerdict::REPEATED), 350u);
  expectReason("10 times a second");
}

TEST_F(ObserverTest, ReadingsThatAreTooFewSayWhy) {
  const auto readAt = [&](double rate) {
    sure_ = told_ = 0;
    for (int i = 1; i <= static_cast<int>(4.0 * rate); ++i) {
      now_ += 1.0 / rate, steady_ += 1.0 / rate;
      observer_.reading(now_, 0.0, now_, steady_);
      report_ = observer_.update(now_, steady_);
      if (i < 2.0 * rate) continue;
      ++told_;
      sure_ += report_.estimate.mode != Mode::UNKNOWN;
    }
  };
  readAt(20.0);  // as the flight controller gives them
  EXPECT_EQ(sure_, told_) << reason();
  EXPECT_NEAR(observer_.readingRate(), 20.0, 0.1);
  readAt(10.0);
  EXPECT_EQ(sure_, 0);
  expectReason("read 10 times a second, 15 are needed");
  readAt(20.0);
  EXPECT_EQ(sure_, told_) << reason();
}

TEST_F(ObserverTest, AStalledProgramTakesUpItsLateReadings) {
  run(1.0);
  ASSERT_EQ(mode(), Mode::FIXED_WING);
  // A second and a half went by unseen; then all readings of it arrive at once, after the first update.
  now_ += 1.5;
  steady_ += 1.5;
  report_ = observer_.update(now_, steady_);
  EXPECT_EQ(mode(), Mode::UNKNOWN);
  for (double back = 1.495; back >= 0; back -= 0.005) observer_.reading(now_ - back, 0.0, now_, steady_);
  report_ = observer_.update(now_, steady_);
  EXPECT_EQ(mode(), Mode::FIXED_WING) << reason();
}

/// A computer that takes `step_time` [s] for each step of the particles, and what it makes of 200 readings a second.
struct SlowComputer {
  ModeObserver* observer;
  double step_time;
  double now = 1000.0, heard = 1000.0;  ///< [s]
  double worst_age = 0;                 ///< [s] of an estimate as it is told
  long sure = 0, told = 0;
  std::string reason = {};

  void run(double seconds) {
    worst_age = 0;
    sure = told = 0;
    for (const double end = now + seconds; now < end;) {
      while (heard + 0.005 <= now) observer->reading(heard += 0.005, 0.0, now, now);
      const long before = observer->estimator().steps();
      const ModeReport report = observer->update(now, now);
      now += 1e-3 + step_time * static_cast<double>(observer->estimator().steps() - before);
      if (report.fresh) worst_age = std::max(worst_age, now - report.stamp), ++told;
      sure += report.estimate.mode != Mode::UNKNOWN;
      reason = report.estimate.reason;
    }
  }
};

TEST_F(ObserverTest, AComputerOfHalfTheSpeedStaysCurrentAndSure) {
  SlowComputer computer{&observer_, 2.0 / 600};  // 200 Hz are 600 steps a second
  computer.run(3.0);
  computer.run(10.0);
  EXPECT_LT(computer.worst_age, 0.6);
  EXPECT_EQ(computer.sure, computer.told);
  EXPECT_EQ(observer_.skipped(), 0u);
}

TEST_F(ObserverTest, AComputerOfATwentiethOfTheSpeedIsUnsureButNotSecondsBehind) {
  SlowComputer computer{&observer_, 20.0 / 600};
  computer.run(5.0);
  computer.run(20.0);
  EXPECT_LT(computer.worst_age, 2.0);
  EXPECT_EQ(computer.sure, 0);
  EXPECT_GT(computer.told, 5);
  EXPECT_GT(observer_.skipped(), 1000u);
  EXPECT_NE(computer.reason.find("this computer fell behind"), std::string::npos) << computer.reason;
}

TEST_F(ObserverTest, RefusesBadSettings) {
  ObserverSettings settings;
  settings.silence = 0;
  EXPECT_THROW(ModeObserver(makeEstimator(), settings), common::Error);
  settings = {};
  settings.input_delay = NAN;
  EXPECT_THROW(ModeObserver(makeEstimator(), settings), common::Error);
  settings = {};
  settings.most_behind = 0.1;  // less than hurry
  EXPECT_THROW(ModeObserver(makeEstimator(), settings), common::Error);
}

/// [s] from a frame with full throttle to half of it at the motors of the stand-in.
double halfOfAnEdge() {
  standin::StandinSettings settings;
  settings.boot_grace = 0.1;
  standin::StandinController controller(settings, 0.0);
  link::Channels channels = link::safeChannels();
  double now = 0;
  const auto stream = [&](int throttle, int aux1, double seconds) {
    channels.us[link::THROTTLE] = static_cast<std::uint16_t>(throttle);
    channels.us[link::AUX1] = static_cast<std::uint16_t>(aux1);
    for (const double end = now + seconds - 1e-9; now < end;) {
      controller.onFrame(channels, now);
      for (int i = 0; i < 200; ++i) controller.step(now += 1e-4);
    }
  };
  stream(1000, 1000, 1.0);
  stream(1000, 2000, 0.2);
  EXPECT_TRUE(controller.armed());
  channels.us[link::THROTTLE] = 2000;
  const double begin = now;
  controller.onFrame(channels, now);
  while (controller.motorMicroseconds() < 1535 && now < begin + 0.1) controller.step(now += 1e-4);
  return now - begin;
}

TEST(ObserverSettings, BelievedDelayCoversTheStandIn) {
  constexpr double MSP_TURN = 0.0104;    // [s] until the controller serves a frame, at most (docs/safety.md)
  constexpr double STATUS_LATE = 0.005;  // [s] by which the status may be later than its frame
  const double half = halfOfAnEdge(), earliest = ObserverSettings().frame_delay;
  EXPECT_GT(half, 0.008);
  EXPECT_LE(earliest, half - STATUS_LATE);
  EXPECT_GE(earliest + EstimatorSettings().output_delay, half + MSP_TURN);
}

}  // namespace
}  // namespace snapwing::planning
