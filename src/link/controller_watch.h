#pragma once
/// Reads a flight controller over MSP: first who it is and how its failsafe is set, then its state, over and over,
/// within the about 96 commands a second that it serves (50 frames + 25 questions). Pure: packets in, packets out.

#include <array>
#include <cstdint>
#include <string>

#include "controller_checks.h"
#include "snapwing/link/bridge_types.h"
#include "snapwing/link/imu_question.h"

namespace snapwing::link {

struct ControllerTelemetry {
  ApiVersion api{-1, -1, -1};
  std::array<char, 4> variant{};
  FailsafeConfig failsafe;
  bool failsafe_read = false;
  StatusReply status;
  Channels motors, rc;
  double status_time = -1e9, motor_time = -1e9, rc_time = -1e9;  ///< [s]
  std::int64_t requests = 0, replies = 0, reply_errors = 0;
  ImuReading imu;
};

class ControllerWatch {
 public:
  /// @param rules  what the controller must answer, and which checks need not pass
  /// @param imu    whether its accelerometer is asked too
  ControllerWatch(MspVersion version, const ControllerRules& rules, const ImuSettings& imu = {});

  /// A new connection: everything must be read again.
  void connected(double now);
  void disconnected();

  /// What to ask now. Call once for each answered frame; every other time there is a question, with the accelerometer
  /// four times of five.
  /// @return false if nothing is to be asked now
  /// @param always  each time
  bool nextRequest(double now, MspPacket& out, bool always = false);
  void onPacket(const MspPacket& packet, double now);

  const ControllerState& state() const { return state_; }
  /// A question is on its way and its answer may still come.
  bool asking(double now) const;
  const ControllerTelemetry& telemetry() const { return telemetry_; }
  const ControllerAnswers& answers() const { return answers_; }
  /// [s] from question to answer, the longest since the connection; 0 before the first
  double slowestAnswer() const { return slowest_answer_; }
  /// First check that failed although its answer has come.
  Check failedCheck() const { return static_cast<Check>(state_.failed_check); }
  /// Frames sent that no answer has come for. Each answer to a frame counts for all before it.
  int unansweredFrames() const { return unanswered_frames_; }
  void noteFrame() { ++unanswered_frames_; }
  void forgetFrames() { unanswered_frames_ = 0; }
  /// [s] when the controller last answered anything; the time of connecting before the first answer
  double lastAnswer() const { return last_answer_; }

 private:
  void judge();
  bool takeState(const MspPacket& packet, double now);
  bool onStatus(const MspPacket& packet, double now);

  MspVersion version_;
  ControllerRules rules_;
  ControllerState state_;
  ControllerTelemetry telemetry_;
  ControllerAnswers answers_;
  int arm_bit_ = -1, failsafe_bit_ = -1, override_bit_ = -1;
  unsigned frame_ = 0, turn_ = 0;
  ImuQuestion imu_;
  std::uint16_t asked_ = 0;  ///< 0 = no question open
  std::uint16_t late_ = 0;   ///< the last one that timed out: its answer may still come
  double late_time_ = 0;
  double asked_time_ = 0, slowest_answer_ = 0;
  int unanswered_frames_ = 0;
  double last_answer_ = -1e9;
};

}  // namespace snapwing::link
