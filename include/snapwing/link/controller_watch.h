#pragma once
/// Reads a flight controller over MSP: first who it is and how its failsafe is set, then its state, over and over,
/// within the about 96 commands a second that it serves (50 frames + 25 questions). Pure: packets in, packets out.

#include <array>
#include <cstdint>
#include <set>
#include <string>

#include "snapwing/link/bridge_types.h"
#include "snapwing/link/msp_messages.h"

namespace snapwing::link {

/// What must be right before arming. The number is the detail of Refusal::CONTROLLER_UNKNOWN.
enum class Check : int {
  NONE = 0,
  NOT_READ = 1,            ///< answers are missing yet
  CONTROLLER = 2,          ///< variant is not BTFL
  API_VERSION = 3,         ///< not 1.46 (release 4.5): flag numbers and timing unknown
  RX_MAP = 4,              ///< not AETR1234: throttle would land on another channel
  FAILSAFE_DELAY = 5,      ///< longer than 1.5 s
  FAILSAFE_PROCEDURE = 6,  ///< not "motors off"
  BOX_IDS = 7,             ///< no ARM or FAILSAFE box: armed cannot be read
  OVERRIDE_BOX = 8,        ///< pilot's override asked for, and no MSP OVERRIDE box
};
/// Name by which a failed check can be allowed: "controller", "api-version", "rx-map", "failsafe-delay",
/// "failsafe-procedure"; empty for those that cannot be.
const char* checkName(Check check);

struct ControllerTelemetry {
  ApiVersion api{-1, -1, -1};
  std::array<char, 4> variant{};
  FailsafeConfig failsafe;
  bool failsafe_read = false;
  StatusReply status;
  Channels motors, rc;
  double status_time = -1e9, motor_time = -1e9, rc_time = -1e9;  ///< [s]
  std::int64_t requests = 0, replies = 0, reply_errors = 0;
};

class ControllerWatch {
 public:
  /// @param allowed  names of checks that need not pass. @throws common::Error for an unknown name
  /// @param pilot_override  an MSP OVERRIDE box must be there
  ControllerWatch(MspVersion version, const std::set<std::string>& allowed, bool pilot_override = false);

  /// A new connection: everything must be read again.
  void connected(double now);
  void disconnected();

  /// What to ask now. Call once for each answered frame; every other time there is a question.
  /// @return false if nothing is to be asked now
  bool nextRequest(double now, MspPacket& out);
  void onPacket(const MspPacket& packet, double now);

  const ControllerState& state() const { return state_; }
  /// A question is on its way and its answer may still come.
  bool asking(double now) const;
  const ControllerTelemetry& telemetry() const { return telemetry_; }
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
  Check judgeIdentity() const;
  bool allowed(Check check) const { return (allowed_mask_ >> static_cast<int>(check) & 1U) != 0; }
  void onStatus(const MspPacket& packet, double now);

  MspVersion version_;
  unsigned allowed_mask_ = 0;
  bool pilot_override_;
  ControllerState state_;
  ControllerTelemetry telemetry_;
  BoxIds boxes_;
  RxMap rx_map_;
  std::array<bool, 5> identity_read_{};
  int arm_bit_ = -1, failsafe_bit_ = -1, override_bit_ = -1;
  unsigned frame_ = 0, turn_ = 0;
  std::uint16_t asked_ = 0;  ///< 0 = no question open
  double asked_time_ = 0;
  int unanswered_frames_ = 0;
  double last_answer_ = -1e9;
};

}  // namespace snapwing::link
