/// Clocks that jump, and what the log says.
#include "link_log.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "clock_watch.h"
#include "snapwing/common/error.h"

namespace snapwing::link {
namespace {

/// @return largest jump seen while the clocks advance by these rates for a second, looked at each 20 ms
double watched(ClockWatch& watch, ClockReading& now, double monotonic, double boottime, double wall) {
  double largest = 0;
  for (int i = 0; i < 50; ++i) {
    now.monotonic += 0.02 * monotonic;
    now.boottime += 0.02 * boottime;
    now.wall += 0.02 * wall;
    largest = std::max(largest, watch.look(now));
  }
  return largest;
}

class Clocks : public ::testing::Test {
 protected:
  Clocks() { watched(watch_, now_, 1, 1, 1); }
  ClockWatch watch_;
  ClockReading now_{100.0, 4000.0, 1.7e9};
};

TEST_F(Clocks, ThatAgreeAreSilent) {
  EXPECT_EQ(watched(watch_, now_, 1, 1, 1), 0.0);
  EXPECT_EQ(watched(watch_, now_, 1, 1, 1.08), 0.0) << "a wall clock that is slewed";
  EXPECT_EQ(watched(watch_, now_, 1, 1, 0.92), 0.0);
  now_.monotonic += 3.0;  // all of them: the loop itself was late, which it sees by its own clock
  now_.boottime += 3.0;
  now_.wall += 3.0;
  EXPECT_EQ(watch_.look(now_), 0.0);
}

TEST_F(Clocks, SuspendShows) {
  now_.boottime += 0.5;
  now_.wall += 0.5;
  EXPECT_NEAR(watch_.look(now_), 0.5, 1e-6);
  EXPECT_EQ(watched(watch_, now_, 1, 1, 1), 0.0) << "once";
}

TEST_F(Clocks, PausedMachineWhoseWallClockIsSetAfterwardsShows) {
  now_.wall += 0.1;
  EXPECT_NEAR(watch_.look(now_), 0.1, 1e-6);
  now_.wall -= 3600;
  EXPECT_NEAR(watch_.look(now_), 3600, 1e-3);
}

TEST_F(Clocks, MonotonicClockThatStandsStillShowsAtAnyRateOfLooks) {
  double jump = 0;
  int looks = 0;
  for (; jump == 0.0 && looks < 100000; ++looks) {
    now_.boottime += 1e-5;
    now_.wall += 1e-5;
    jump = watch_.look(now_);
  }
  EXPECT_LE(looks * 1e-5, 0.011);
  EXPECT_GT(watched(watch_, now_, 0, 1, 1), 0.01);
}

TEST_F(Clocks, BothStandStillAndTheWallClockGoesOn) { EXPECT_GT(watched(watch_, now_, 0, 0, 1), 0.02); }

TEST_F(Clocks, OnThisComputerAgree) {
  ClockWatch watch;
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(watch.look(readClocks()), 0.0);
}

class Told : public ::testing::Test {
 protected:
  std::string look() {
    text_.clear();
    watch_.look(status_, line_, now_ += 0.03125, this, [](void* owner, const LogEvent& event) {
      static_cast<Told*>(owner)->text_ += describe(event, "serial:/dev/x") + "\n";
    });
    return text_;
  }
  void open() {
    line_ = {true, 1, 0};
    look();
  }
  EventWatch watch_;
  BridgeStatus status_;
  EventWatch::Line line_;
  double now_ = 10;
  std::string text_;
};

TEST_F(Told, MissingDeviceOnce) {
  line_.error = ENOENT;
  EXPECT_EQ(look(), "cannot open serial:/dev/x: No such file or directory; trying on\n");
  for (int i = 0; i < 100; ++i) EXPECT_EQ(look(), "");
  line_.error = EACCES;
  EXPECT_EQ(look(), "cannot open serial:/dev/x: Permission denied; trying on\n");
  line_ = {true, 1, 0};
  EXPECT_EQ(look(), "serial:/dev/x is open\n");
  line_ = {false, 1, EIO};
  EXPECT_EQ(look(), "serial:/dev/x is lost: Input/output error; trying to open it again\n");
  line_.error = ENOENT;
  EXPECT_EQ(look(), "cannot open serial:/dev/x: No such file or directory; trying on\n");
  EXPECT_EQ(look(), "");
}

TEST_F(Told, SilentControllerOnce) {
  open();
  std::string all;
  for (int i = 0; i < 300; ++i) all += look();
  EXPECT_NE(all.find("does not answer"), std::string::npos);
  EXPECT_EQ(all.find('\n'), all.size() - 1) << all;
}

TEST_F(Told, RefusalsOnceASecond) {
  open();
  std::string all;
  status_.controller.connected = true;
  for (int i = 0; i < 65; ++i) {
    ++status_.commands_refused;
    status_.last_refusal = Refusal::STALE;
    status_.last_refusal_detail = 150000;
    all += look();
  }
  EXPECT_EQ(all,
            "refused: command is 150 ms old (1 refusals so far)\nrefused: command is 150 ms old (33 refusals so far)\n"
            "refused: command is 150 ms old (65 refusals so far)\n");
}

TEST_F(Told, ArmingPulseFaultAndReset) {
  open();
  status_.controller.connected = status_.controller.known = true;
  EXPECT_EQ(look(), "flight controller read, settings accepted\n");
  status_.state = BridgeState::ARMED;
  EXPECT_EQ(look(), "armed\n");
  status_.state = BridgeState::PULSE;
  status_.pulse_id = 4;
  status_.commanded_throttle = 0.7;
  EXPECT_EQ(look(), "") << "not written yet";
  status_.frames_sent = 1;
  status_.frame_time = 20.0;
  EXPECT_EQ(look(), "pulse 4 began: throttle 0.700\n");
  status_.state = BridgeState::FAULT;
  status_.fault = Fault::OPERATOR_LATE;
  status_.fault_detail = 150000;
  status_.frame_time = 20.123;
  EXPECT_EQ(look(),
            "fault latched: operator is late: its heartbeats arrive 150 ms old\n"
            "pulse 4 ended after 123 ms\n");
  status_.state = BridgeState::IDLE;
  status_.fault = Fault::NONE;
  EXPECT_EQ(look(), "fault reset\n");
  status_.state = BridgeState::ARMED;
  look();
  status_.state = BridgeState::IDLE;
  status_.last_disarming = Disarming::DEADMAN_RELEASED;
  EXPECT_EQ(look(), "disarmed: deadman released\n");
}

TEST_F(Told, NothingSentIsNotCalledSent) {
  EXPECT_EQ(describe({0, LogKind::ENDED, 0, 0, 0, 0.3}, "tcp:a:1"),
            "ended; nothing could be sent: tcp:a:1 was not open");
  EXPECT_EQ(describe({0, LogKind::ENDED, 0, 15, 0, 0.3}, "tcp:a:1"),
            "ended; throttle low and AUX1 low went out in 15 frames over 300 ms");
}

TEST(RotatingFile, StaysBelowTwiceItsLimit) {
  const std::string path = ::testing::TempDir() + "rotating.log";
  std::remove(path.c_str());
  std::remove((path + ".1").c_str());
  {
    RotatingFile file(path, 1000);
    for (int i = 0; i < 500; ++i) file.write("line " + std::to_string(i) + "\n");
  }
  const auto content = [](const std::string& name) {
    std::ostringstream text;
    text << std::ifstream(name).rdbuf();
    return text.str();
  };
  const std::string now = content(path), before = content(path + ".1");
  EXPECT_LE(now.size(), 1000U);
  EXPECT_LE(before.size(), 1000U);
  EXPECT_GT(before.size(), 980U);
  EXPECT_NE(now.find("line 499\n"), std::string::npos);
  EXPECT_EQ(before.back(), '\n');
  EXPECT_THROW(RotatingFile("/nonexistent/log", 1000), common::FileError);
}

}  // namespace
}  // namespace snapwing::link
