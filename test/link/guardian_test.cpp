/// The guardian's logic on counted wakings, and the process itself with a socket as its line.
#include "guardian.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "guardian_process.h"
#include "snapwing/link/clock.h"

namespace snapwing::link {
namespace {

class Watching : public ::testing::Test {
 protected:
  Watching() {
    seen_.active = true;
    seen_.line_open = true;
  }
  GuardianAction wake(bool bridge_moves) {
    if (bridge_moves) ++seen_.beat;
    return core_.step(seen_);
  }
  void expectQuiet(int wakings, bool bridge_moves) {
    for (int i = 0; i < wakings; ++i) ASSERT_EQ(wake(bridge_moves && i % 4 == 0), GuardianAction::NONE) << i;
  }
  GuardianCore core_{GuardianSettings{}};
  GuardianSeen seen_;
};

TEST_F(Watching, LeavesABridgeThatMovesAlone) { expectQuiet(1000, true); }

TEST_F(Watching, KillsWhatHasNotMovedForTwelveWakingsAndWaitsForItsEnd) {
  expectQuiet(5, true);  // the last beat is the one of the fifth waking
  expectQuiet(11, false);
  EXPECT_EQ(wake(false), GuardianAction::KILL);
  expectQuiet(3, false);
  seen_.bridge_ended = true;
  seen_.waking = false;
  EXPECT_EQ(wake(false), GuardianAction::CLEAR_AND_SEND);
  EXPECT_EQ(core_.reason(), GuardianReason::BRIDGE_STOOD_STILL);
}

/// A machine that stood still as a whole: one waking, however late.
TEST_F(Watching, CountsItsOwnWakingsAndNotTime) {
  expectQuiet(1, true);
  expectQuiet(11, false);
  expectQuiet(400, true);
  seen_.waking = false;  // something came in between: no time has passed
  expectQuiet(100, false);
}

TEST_F(Watching, BridgeThatIsNotArmedMayStandStill) {
  seen_.active = false;
  expectQuiet(1000, false);
  seen_.active = true;
  expectQuiet(11, false);
  EXPECT_EQ(wake(false), GuardianAction::KILL);
}

TEST_F(Watching, DeadBridgeIsFollowedAtOnceAndForASecond) {
  expectQuiet(8, true);
  seen_.bridge_ended = true;
  seen_.waking = false;
  ASSERT_EQ(wake(false), GuardianAction::CLEAR_AND_SEND);
  core_.onSent(true);
  seen_.waking = true;
  int frames = 1, wakings = 0;
  for (GuardianAction action = GuardianAction::NONE; action != GuardianAction::FINISHED; ++wakings) {
    action = wake(false);
    ASSERT_NE(action, GuardianAction::KILL);
    ASSERT_LT(wakings, 1000);
    if (action != GuardianAction::SEND) continue;
    core_.onSent(true);
    ++frames;
  }
  EXPECT_EQ(wakings, 200);
  EXPECT_EQ(frames, 50);
  EXPECT_EQ(wake(true), GuardianAction::FINISHED) << "nothing leads back";
}

TEST_F(Watching, BlockedLineIsClearedAgainAndNeverGivenUp) {
  seen_.bridge_ended = true;
  ASSERT_EQ(wake(false), GuardianAction::CLEAR_AND_SEND);
  core_.onSent(false);
  int cleared = 0;
  for (int i = 0; i < 2000; ++i) {
    const GuardianAction action = wake(false);
    ASSERT_NE(action, GuardianAction::FINISHED);
    if (action == GuardianAction::CLEAR_AND_SEND) ++cleared;
    core_.onSent(false);
  }
  EXPECT_EQ(cleared, 100);
  for (int i = 0; i < 100; ++i) core_.onSent(true);
  seen_.backlog = 25;
  EXPECT_NE(wake(false), GuardianAction::FINISHED) << "what waits may be thrust";
  seen_.backlog = 0;
  EXPECT_EQ(wake(false), GuardianAction::FINISHED);
}

TEST_F(Watching, EndInOrderIsNotFollowed) {
  seen_.bridge_ended = seen_.orderly_end = true;
  EXPECT_EQ(wake(false), GuardianAction::FINISHED);
  EXPECT_EQ(core_.reason(), GuardianReason::NONE);
}

TEST_F(Watching, WithoutALineThereIsNothingToSendOn) {
  seen_.bridge_ended = true;
  seen_.line_open = false;
  EXPECT_EQ(wake(false), GuardianAction::FINISHED);
}

TEST(GuardianSettings, LeaveRoomBeyondAPeriod) {
  EXPECT_EQ(GuardianSettings::forPeriod(0.02).still_limit, 12);
  EXPECT_EQ(GuardianSettings::forPeriod(0.05).still_limit, 18);
  EXPECT_EQ(GuardianSettings::forPeriod(0.007).wakings_per_frame, 2);
}

/// A process in the bridge's place with a guardian and a line (a socket pair) whose far end the test holds.
class OwnProcess : public ::testing::Test {
 protected:
  /// @param end  what the bridge does once the guardian holds the line
  void start(Protocol protocol, void (*end)(Guardian& guardian, int line)) {
    int ends[2];
    ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends), 0);
    far_ = ends[0];
    bridge_ = fork();
    ASSERT_GE(bridge_, 0);
    if (bridge_ == 0) {
      close(far_);
      const LogWriter log("", 1000, "line");
      Guardian guardian(protocol, 0.02, 0, log);
      guardian.holdLine(ends[1], 1);
      for (int i = 0; i < 2000 && !guardian.guards(1); ++i) usleep(1000);
      end(guardian, ends[1]);
      _exit(0);
    }
    close(ends[1]);
  }
  /// All bytes that came until the line was closed.
  std::vector<std::uint8_t> bytesUntilClosed() {
    std::vector<std::uint8_t> all;
    pollfd waiting{far_, POLLIN, 0};
    std::uint8_t bytes[256];
    while (poll(&waiting, 1, 10000) > 0) {
      const ssize_t got = read(far_, bytes, sizeof bytes);
      if (got <= 0) return all;
      all.insert(all.end(), bytes, bytes + got);
    }
    ADD_FAILURE() << "the line was never closed";
    return all;
  }
  ~OwnProcess() override {
    if (far_ >= 0) close(far_);
    if (bridge_ > 0) waitpid(bridge_, nullptr, 0);
  }
  int far_ = -1;
  pid_t bridge_ = -1;
};

std::vector<Channels> framesIn(const std::vector<std::uint8_t>& bytes) {
  std::vector<Channels> frames;
  MspParser parser;
  for (const std::uint8_t byte : bytes) {
    Channels channels;
    if (parser.push(byte) && decode(parser.packet(), channels)) frames.push_back(channels);
  }
  return frames;
}

TEST_F(OwnProcess, DeadBridgesLineGetsSafeFramesAlone) {
  start(Protocol::MSP2, [](Guardian&, int) { raise(SIGKILL); });
  const std::vector<std::uint8_t> bytes = bytesUntilClosed();
  const std::vector<Channels> frames = framesIn(bytes);
  EXPECT_GE(frames.size(), 25U);
  EXPECT_EQ(bytes.size(), frames.size() * BridgeLoop::safeFrame(Protocol::MSP2).size) << "whole frames, nothing else";
  for (const Channels& frame : frames) {
    EXPECT_EQ(frame.us[THROTTLE], CHANNEL_LOW);
    EXPECT_EQ(frame.us[AUX1], CHANNEL_LOW);
    EXPECT_EQ(frame.count, FRAME_CHANNELS);
  }
}

/// Killed in the middle of a frame: the guardian fills it up, so that its own first frame is understood.
TEST_F(OwnProcess, HalfAFrameIsFilledUp) {
  start(Protocol::MSP2, [](Guardian& guardian, int line) {
    const WireFrame frame = BridgeLoop::safeFrame(Protocol::MSP2);
    guardian.record()->open_bytes = static_cast<std::uint32_t>(frame.size);
    if (write(line, frame.bytes.data(), 11) != 11) _exit(1);
    raise(SIGKILL);
  });
  const std::vector<std::uint8_t> bytes = bytesUntilClosed();
  const std::size_t size = BridgeLoop::safeFrame(Protocol::MSP2).size;
  const std::size_t whole = (bytes.size() - 11 - Transport::PADDING) / size;
  EXPECT_EQ(bytes.size(), 11 + Transport::PADDING + whole * size);
  EXPECT_EQ(framesIn(bytes).size(), whole) << "the first one too";
}

TEST_F(OwnProcess, StoppedBridgeIsKilled) {
  start(Protocol::MSP2, [](Guardian& guardian, int) {
    guardian.record()->active = true;
    raise(SIGSTOP);
  });
  EXPECT_GE(framesIn(bytesUntilClosed()).size(), 25U);
  int status = 0;
  ASSERT_EQ(waitpid(bridge_, &status, 0), bridge_);
  bridge_ = -1;
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
}

TEST_F(OwnProcess, OrderlyEndBringsNoFrame) {
  start(Protocol::MSP2, [](Guardian& guardian, int) { guardian.endInOrder(); });
  EXPECT_TRUE(bytesUntilClosed().empty());
}

TEST_F(OwnProcess, ItsOwnDeathIsNoticed) {
  start(Protocol::MSP2, [](Guardian& guardian, int) {
    if (!guardian.guards(1)) _exit(1);
    kill(guardian.pid(), SIGKILL);
    usleep(100000);
    _exit(guardian.guards(1) ? 2 : 3);
  });
  int status = 0;
  ASSERT_EQ(waitpid(bridge_, &status, 0), bridge_);
  bridge_ = -1;
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 3);
}

TEST_F(OwnProcess, AStoppedGuardianIsNoticedToo) {
  start(Protocol::MSP2, [](Guardian& guardian, int) {
    kill(guardian.pid(), SIGSTOP);
    bool guards = true;
    for (int i = 0; i < 10; ++i) {
      usleep(20000);
      guards = guardian.guards(1);
    }
    kill(guardian.pid(), SIGKILL);
    _exit(guards ? 2 : 3);
  });
  int status = 0;
  ASSERT_EQ(waitpid(bridge_, &status, 0), bridge_);
  bridge_ = -1;
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 3);
}

}  // namespace
}  // namespace snapwing::link
