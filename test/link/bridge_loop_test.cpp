/// Bridge and stand-in together: what the motors do when something dies, stops or blocks in the middle of a pulse.
#include "bridge_loop.h"

#include <gtest/gtest.h>

#include <random>

#include "link/loop_simulation.h"

namespace snapwing::link {
namespace {

using test::Simulation;

constexpr int IDLE_OUTPUT = 1070;  ///< [us]
constexpr double RAMP = 0.021;     ///< [s] the motors' way to idle

TEST(BridgeLoop, ReadsTheControllerBeforeArming) {
  Simulation s;
  s.run(0.7);
  const ControllerTelemetry& telemetry = s.bridge->watch().telemetry();
  EXPECT_TRUE(s.bridge->core().status().controller.known);
  EXPECT_EQ(telemetry.api.minor, 46);
  EXPECT_DOUBLE_EQ(telemetry.failsafe.delay, 1.5);
  EXPECT_EQ(s.port.lostBytes(), 0);
}

TEST(BridgeLoop, StaysWithinTheControllersRate) {
  Simulation s;
  s.arm();
  const std::int64_t served = s.port.served();
  s.run(10.0);
  EXPECT_LE(static_cast<double>(s.port.served() - served) / 10.0, 80.0);
  EXPECT_EQ(s.port.lostBytes(), 0);
  EXPECT_EQ(s.bridge->watch().telemetry().reply_errors, 0);
  EXPECT_LT(s.now - s.bridge->watch().telemetry().status_time, 0.25);
  EXPECT_LT(s.now - s.bridge->watch().telemetry().rc_time, 0.5);
}

BridgeSettings askingTheImu() {
  BridgeSettings settings;
  settings.imu.ask = true;
  return settings;
}

TEST(BridgeLoop, AsksTheAccelerometerBesideTheFrames) {
  Simulation s(Simulation::quickStandin(), askingTheImu());
  s.arm();
  const auto reading = [&] { return s.bridge->watch().telemetry().imu; };
  const std::int64_t served = s.port.served(), frames = s.fc.frames(), readings = reading().number;
  double oldest = 0, oldest_status = 0;
  s.run(10.0, [&] {
    oldest = std::max(oldest, s.now - reading().time);
    oldest_status = std::max(oldest_status, s.now - s.bridge->watch().telemetry().status_time);
  });
  EXPECT_LE(static_cast<double>(s.port.served() - served) / 10.0, 92.0);  // of 96
  EXPECT_GE(static_cast<double>(s.fc.frames() - frames) / 10.0, 49.5);
  EXPECT_NEAR(static_cast<double>(reading().number - readings) / 10.0, 20.0, 1.0);
  EXPECT_LT(oldest, 0.1);
  EXPECT_LT(oldest_status, 0.25);
  EXPECT_EQ(s.port.lostBytes(), 0);
  EXPECT_EQ(s.bridge->watch().telemetry().reply_errors, 0);
  EXPECT_NEAR(reading().acceleration[2], 9.81, 0.02);
  s.fc.feel({-9.80665, 4.903325, -19.6133});
  s.run(0.2);
  EXPECT_NEAR(reading().acceleration[0], -9.81, 0.02);
  EXPECT_NEAR(reading().acceleration[1], 4.90, 0.02);
  EXPECT_NEAR(reading().acceleration[2], -19.61, 0.02);
}

TEST(BridgeLoop, ReadingsGoOnInAPulseAndItsLengthStays) {
  Simulation s(Simulation::quickStandin(), askingTheImu());
  s.arm();
  for (const double duration : {0.16, 0.6, 0.95}) {
    s.run(0.3);
    s.command(1.0, duration);
    double high = 0;
    const std::int64_t before = s.bridge->watch().telemetry().imu.number;
    s.run(duration + 0.2, [&] { high += s.fc.motorMicroseconds() > 1535 ? 1e-3 : 0; });  // half of full
    EXPECT_NEAR(high, duration, 0.015);
    EXPECT_GE(static_cast<double>(s.bridge->watch().telemetry().imu.number - before), 15.0 * (duration + 0.2));
    EXPECT_EQ(s.bridge->core().status().fault, Fault::NONE);
  }
  EXPECT_EQ(s.port.lostBytes(), 0);
}

TEST(BridgeLoop, LateAnswersAreNoMissingConnection) {
  ControllerWatch watch(MspVersion::V2, {});
  watch.connected(10.0);
  MspPacket question;
  for (double now = 10.0; now < 13.0; now += 0.25) {  // each is answered when the next was asked already
    MspPacket late = question;
    ASSERT_TRUE(watch.nextRequest(now, question, true));
    late.direction = '!';
    if (now > 10.1) watch.onPacket(late, now + 0.001);
  }
  EXPECT_NEAR(watch.state().slowest_answer, 0.251, 1e-6);
  EXPECT_EQ(describe(Refusal::NOT_CONNECTED, 251000), "the flight controller is slow: an answer took 251 ms");
  EXPECT_EQ(describe(Refusal::NOT_CONNECTED, 0), "no connection to the flight controller");
}

TEST(BridgeLoop, AControllerWithoutAccelerometerIsAskedOnce) {
  auto settings = Simulation::quickStandin();
  settings.accelerometer = false;
  Simulation s(settings, askingTheImu());
  s.arm();
  s.run(5.0);
  EXPECT_EQ(s.bridge->watch().telemetry().imu.number, 0);
  EXPECT_EQ(s.bridge->watch().telemetry().reply_errors, 1);
}

TEST(BridgeLoop, UnsafeControllersAreRefusedUnlessAllowedByName) {
  struct Case {
    const char* name;
    std::function<void(standin::StandinSettings&)> spoil;
  };
  const std::vector<Case> cases = {
      {"failsafe-procedure", [](standin::StandinSettings& s) { s.failsafe.procedure = 0; }},
      {"failsafe-delay", [](standin::StandinSettings& s) { s.failsafe.delay = 3.0; }},
      {"rx-map", [](standin::StandinSettings& s) { s.rx_map.map = {0, 1, 2, 3, 4, 5, 6, 7}; }},
      {"api-version", [](standin::StandinSettings& s) { s.api.minor = 43; }},
      {"controller", [](standin::StandinSettings& s) {
         s.variant = {'C', 'L', 'F', 'L'};
       }}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    standin::StandinSettings standin = Simulation::quickStandin();
    c.spoil(standin);
    Simulation refused(standin);
    refused.run(1.5);
    EXPECT_FALSE(refused.bridge->core().status().controller.known);
    EXPECT_STREQ(checkName(refused.bridge->watch().failedCheck()), c.name);
    refused.arm_switch = true;
    refused.run(1.0);
    EXPECT_FALSE(refused.fc.armed());
    Simulation allowed(standin, {}, {c.name});
    allowed.arm();
    EXPECT_TRUE(allowed.fc.armed());
  }
}

TEST(BridgeLoop, PulseReachesTheMotors) {
  Simulation s;
  s.arm();
  ASSERT_EQ(s.pulse(0.5, 0.2), Refusal::NONE);
  ASSERT_TRUE(s.runUntil(0.05, [&] { return s.fc.motorMicroseconds() == 1509; }));
  const double start = s.now;
  ASSERT_TRUE(s.runUntil(1.0, [&] { return s.fc.motorMicroseconds() == IDLE_OUTPUT; }));
  // The controller's serial task turns every 10.4 ms, so each edge may lie up to one turn late.
  EXPECT_NEAR(s.now - start, 0.2, 0.0125);
}

/// Command in the inbox to frame on the line, at any phase of frames, answers and questions: not even a period when the
/// controller must be asked as well; and the frame is served in one turn, since nothing stands before it.
TEST(BridgeLoop, CommandReachesTheLineWithinAPeriod) {
  std::mt19937 rng(11);
  std::uniform_real_distribution<double> moment(0.2, 0.4);
  Simulation s;
  s.arm();
  double worst = 0, worst_motor = 0;
  for (int trial = 0; trial < 300; ++trial) {
    s.run(moment(rng));
    const double commanded = s.now;
    s.command(0.5, 0.05);
    ASSERT_TRUE(s.runUntil(0.1, [&] { return s.bridge->core().status().commanded_throttle > 0; }));
    worst = std::max(worst, s.now - commanded);
    ASSERT_TRUE(s.runUntil(0.1, [&] { return s.fc.motorMicroseconds() > IDLE_OUTPUT; }));
    worst_motor = std::max(worst_motor, s.now - commanded);
  }
  EXPECT_LT(worst, 0.0135);  // a question's turn of 10.4 ms, steps of 1 ms
  EXPECT_LT(worst_motor, 0.0245);
  EXPECT_EQ(s.port.lostBytes(), 0);
}

/// Pulses of any length at any phase of frames, answers and questions, between the motors' crossings of half of the
/// thrust: both edges wait for a turn of the controller (10.4 ms), and for nothing else.
TEST(BridgeLoop, PulsesOverMspHaveTheirLength) {
  std::mt19937 rng(13);
  std::uniform_real_distribution<double> moment(0.2, 0.4), length(0.05, 0.4);
  Simulation s;
  s.arm();
  int near = 0;
  constexpr int TRIALS = 300, HALF = (1070 + 1509) / 2;
  for (int trial = 0; trial < TRIALS; ++trial) {
    s.run(moment(rng));
    const double wanted = length(rng);
    s.command(0.5, wanted);
    ASSERT_TRUE(s.runUntil(0.1, [&] { return s.fc.motorMicroseconds() > HALF; }));
    const double rise = s.now;
    ASSERT_TRUE(s.runUntil(1.0, [&] { return s.fc.motorMicroseconds() <= HALF; }));
    const double off = s.now - rise - wanted;
    EXPECT_GT(off, -0.015);
    EXPECT_LT(off, 0.015);
    if (std::abs(off) <= 0.010) ++near;
  }
  EXPECT_GE(near, 0.95 * TRIALS);
}

/// kill -9 at 100 moments of a pulse: idle after 350 ms typically and 450 ms at worst, failsafe at 1.5 s, and nothing
/// comes back.
TEST(BridgeLoop, KilledBridge) {
  std::mt19937 rng(7);
  std::uniform_real_distribution<double> moment(0.0, 0.5);
  int late = 0;
  for (int trial = 0; trial < 100; ++trial) {
    SCOPED_TRACE(trial);
    Simulation s;
    s.arm();
    ASSERT_EQ(s.pulse(1.0, 0.6), Refusal::NONE);
    s.run(moment(rng));
    s.bridge_runs = false;
    const double killed = s.now;
    ASSERT_TRUE(s.runUntil(0.45, [&] { return s.fc.motorMicroseconds() <= IDLE_OUTPUT; }));
    if (s.now - killed > 0.35) ++late;
    s.highest_motor = 0;
    ASSERT_TRUE(s.runUntil(2.0, [&] { return s.fc.failsafe(); }));
    EXPECT_NEAR(s.now - killed, 1.5, 0.035);
    EXPECT_EQ(s.fc.motorMicroseconds(), 1000);
    s.restartBridge();  // supervisor starts a new one; the operator's switch is still on
    s.run(4.0);
    EXPECT_LE(s.highest_motor, IDLE_OUTPUT);
    EXPECT_FALSE(s.fc.armed());
  }
  EXPECT_LE(late, 10) << "of 100; the controller's third look comes too early in 5 % of cases";
}

/// A new bridge within the gap in which the controller would take thrust back at once.
TEST(BridgeLoop, RestartWithinTheGapBringsNoThrustBack) {
  for (const double gap : {0.05, 0.2, 0.35, 0.8, 1.4}) {
    SCOPED_TRACE(gap);
    Simulation s;
    s.arm();
    ASSERT_EQ(s.pulse(1.0, 1.5), Refusal::NONE);
    s.run(0.1);
    s.bridge_runs = false;
    s.run(gap);
    s.restartBridge();
    s.run(0.05);
    s.highest_motor = 0;
    s.run(3.0);
    EXPECT_LE(s.highest_motor, IDLE_OUTPUT);
    EXPECT_FALSE(s.fc.armed()) << "the first frame of a new bridge disarms";
  }
}

/// SIGSTOP and SIGCONT at 100 moments, for any time: never thrust again after the motors were at idle, and never longer
/// than the pulse's own end plus one frame.
TEST(BridgeLoop, StoppedAndContinuedBridge) {
  std::mt19937 rng(8);
  std::uniform_real_distribution<double> moment(0.0, 0.8), pause(0.0, 2.5);
  for (int trial = 0; trial < 100; ++trial) {
    SCOPED_TRACE(trial);
    Simulation s;
    s.arm();
    ASSERT_EQ(s.pulse(1.0, 1.0), Refusal::NONE);
    const double pulse_end = s.now + 1.0;
    s.run(moment(rng));
    s.bridge_runs = false;
    const double stopped = s.now;
    bool was_idle = false, came_back = false;
    const auto watch = [&] {
      if (s.fc.motorMicroseconds() <= IDLE_OUTPUT) was_idle = true;
      if (was_idle && s.fc.motorMicroseconds() > IDLE_OUTPUT) came_back = true;
    };
    const double length = pause(rng);
    s.run(length, watch);
    s.bridge_runs = true;
    s.run(2.0, watch);
    EXPECT_TRUE(was_idle);
    EXPECT_FALSE(came_back) << "stopped for " << length << " s at " << stopped - (pulse_end - 1.0);
    EXPECT_TRUE(length < 0.12 || s.bridge->core().status().state == BridgeState::FAULT);
  }
}

TEST(BridgeLoop, OperatorDies) {
  std::mt19937 rng(9);
  std::uniform_real_distribution<double> moment(0.0, 0.5);
  for (int trial = 0; trial < 100; ++trial) {
    Simulation s;
    s.arm();
    ASSERT_EQ(s.pulse(1.0, 1.0), Refusal::NONE);
    s.run(moment(rng));
    s.operator_runs = false;
    const double died = s.now;
    ASSERT_TRUE(s.runUntil(0.5, [&] { return s.fc.motorMicroseconds() <= IDLE_OUTPUT; }));
    EXPECT_LE(s.now - died, 0.2 + 0.02 + 0.0125 + RAMP);
    s.operator_runs = true;
    s.highest_motor = 0;
    s.run(2.0);
    EXPECT_LE(s.highest_motor, IDLE_OUTPUT);
    EXPECT_EQ(s.bridge->core().status().fault, Fault::HEARTBEAT_LOST);
  }
}

/// At whatever moment of a frame's period he falls silent, in the pulse (frames wait for a proof) and at rest.
TEST(BridgeLoop, SilenceIsNoticedWhenItsTimeIsOver) {
  constexpr double SHORTEST_GAP = 0.007, CLOCK = 0.001;
  for (const bool in_pulse : {true, false}) {
    for (int moment = 0; moment < 40; moment += 3) {
      SCOPED_TRACE("ms after 100: " + std::to_string(moment));
      Simulation s;
      s.arm();
      if (in_pulse) s.command(1.0, 0.9);
      s.run(0.1 + 1e-3 * moment);
      s.operator_runs = false;
      const double last = s.now;
      ASSERT_TRUE(s.runUntil(1.0, [&] { return s.bridge->core().status().fault == Fault::HEARTBEAT_LOST; }));
      EXPECT_LE(s.now - last, 0.2 + SHORTEST_GAP + 2 * CLOCK);
    }
  }
}

TEST(BridgeLoop, UnpluggedLineNeverResumes) {
  for (const double gap : {0.1, 0.3, 0.7, 1.2}) {
    SCOPED_TRACE(gap);
    Simulation s;
    s.arm();
    ASSERT_EQ(s.pulse(1.0, 1.5), Refusal::NONE);
    s.run(0.1);
    s.line.plugged = false;
    s.line.unplug();
    const double cut = s.now;
    ASSERT_TRUE(s.runUntil(gap + 0.5, [&] {
      if (s.now - cut > gap) s.line.plugged = true;
      return s.fc.motorMicroseconds() <= IDLE_OUTPUT;
    }));
    EXPECT_LE(s.now - cut, 0.45);
    s.line.plugged = true;
    s.highest_motor = 0;
    s.run(3.0);
    EXPECT_LE(s.highest_motor, IDLE_OUTPUT);
    EXPECT_EQ(s.bridge->core().status().fault, Fault::LINE_LOST);
    EXPECT_GE(s.line.connections(), 2);
  }
}

TEST(BridgeLoop, BlockedLineDeliversNoStaleThrust) {
  // Shorter than the line's timeout the pulse goes on to its own deadline; longer, it is over.
  for (const double blocked : {0.2, 0.3, 0.6, 1.2}) {
    SCOPED_TRACE(blocked);
    Simulation s;
    s.arm();
    ASSERT_EQ(s.pulse(1.0, 1.5), Refusal::NONE);
    s.run(0.1);
    s.line_open = false;
    const double start = s.now;
    s.run(blocked);
    s.line_open = true;
    ASSERT_TRUE(s.runUntil(0.5, [&] { return s.fc.motorMicroseconds() <= IDLE_OUTPUT; }));
    EXPECT_LE(s.now - start, std::max(0.45, blocked + 0.04 + RAMP));
    s.highest_motor = 0;
    s.run(3.0);
    EXPECT_LE(s.highest_motor, IDLE_OUTPUT);
    EXPECT_EQ(s.bridge->core().status().fault, Fault::LINE_LOST);
  }
}

/// The controller stands still and the line hides how much it holds: only few frames may be on their way.
TEST(BridgeLoop, LineThatHidesItsBacklogHoldsFewFrames) {
  Simulation s;
  s.line.hides_backlog = true;
  s.arm();
  ASSERT_EQ(s.pulse(1.0, 1.5), Refusal::NONE);
  s.run(0.1);
  s.line_open = false;
  s.run(0.7);
  EXPECT_EQ(s.bridge->core().status().fault, Fault::LINE_LOST);
  EXPECT_LE(s.line.waiting(), 3 * 25 + 9);
  s.highest_motor = 0;
  s.line_open = true;
  s.run(2.0);
  EXPECT_LE(s.highest_motor, IDLE_OUTPUT) << "stale frames were thrown away";
}

/// The same without the line's help: nothing can be flushed, and all of it arrives at once. Thrust leaves right behind
/// an answer, so such a line mostly holds a question and no thrust. Where it stopped between answer and frame (here
/// within a step of 1 ms, of 21 ms), one frame is old, and the controller returns its thrust at once; the safe one
/// behind it is served a turn later. No program can call back what such a line holds, so this is the bound that
/// remains: half of the thrust, for 40 ms.
TEST(BridgeLoop, LineThatKeepsEverythingReturnsOneFrameAtMost) {
  std::mt19937 rng(12);
  std::uniform_real_distribution<double> moment(0.0, 0.3), blocked(0.431, 1.4);
  int returned = 0;
  for (int trial = 0; trial < 100; ++trial) {
    SCOPED_TRACE(trial);
    Simulation s;
    s.line.hides_backlog = s.line.keeps_all = true;
    s.arm();
    ASSERT_EQ(s.pulse(1.0, 1.5), Refusal::NONE);
    s.run(moment(rng));
    s.line_open = false;
    s.run(blocked(rng) + 0.02);
    ASSERT_LE(s.fc.motorMicroseconds(), IDLE_OUTPUT);
    s.highest_motor = 0;
    double above = 0;
    s.line_open = true;
    s.run(2.0, [&] { above += s.fc.motorMicroseconds() > IDLE_OUTPUT ? 0.001 : 0.0; });
    EXPECT_LE(s.highest_motor, IDLE_OUTPUT + 930 / 2);
    EXPECT_LE(above, 0.04);
    if (above > 0) ++returned;
  }
  EXPECT_LE(returned, 2 * 100 / 21) << "twice what steps of 1 ms explain";
}

/// A line that takes only a few bytes at a time: frames are completed or dropped, never mixed.
TEST(BridgeLoop, HalfWrittenFramesAreCompletedBeforeOthers) {
  for (const std::size_t taken : {1, 7, 13, 24}) {
    SCOPED_TRACE(taken);
    Simulation s;
    s.line.takes = taken;
    s.run(5.0);
    EXPECT_EQ(s.port.badFrames(), 0U);
    EXPECT_GT(s.bridge->core().status().frames_dropped, 10);
    EXPECT_GT(s.fc.frames(), 1);
  }
}

TEST(BridgeLoop, ResetAfterFailsafeArmsAgainWithoutThePulse) {
  Simulation s;
  s.arm();
  ASSERT_EQ(s.pulse(1.0, 1.0), Refusal::NONE);
  s.bridge_runs = false;
  s.run(2.0);
  ASSERT_TRUE(s.fc.failsafe());
  s.bridge_runs = true;
  s.arm_switch = false;
  s.run(1.5);
  s.reset = true;
  s.run(0.1);
  s.reset = false;
  s.highest_motor = 0;
  s.arm();
  s.run(0.5);
  EXPECT_EQ(s.highest_motor, IDLE_OUTPUT);
  EXPECT_EQ(s.bridge->core().status().state, BridgeState::ARMED);
}

TEST(BridgeLoop, NoiseFromTheControllerChangesNothing) {
  std::mt19937 rng(5);
  Simulation s;
  s.arm();
  s.run(2.0, [&] {
    std::uint8_t noise[3];
    for (auto& byte : noise) byte = static_cast<std::uint8_t>(rng());
    if (rng() % 8 == 0) s.line.farWrite(noise, sizeof noise);
  });
  EXPECT_EQ(s.bridge->core().status().channels.us[THROTTLE], 1000);
  EXPECT_GT(s.bridge->watch().telemetry().replies, 20);
}

}  // namespace
}  // namespace snapwing::link
