#pragma once
/// Stand-in for a racing quadrotor's flight controller: receiver, arming, failsafe and throttle scaling as measured on
/// Betaflight 4.5.5 (docs/safety.md lists the rules). Pure: frames and times in, motor outputs and flags out.

#include <array>
#include <cstdint>

#include "snapwing/common/loan.h"
#include "snapwing/link/channels.h"
#include "snapwing/link/config_messages.h"
#include "snapwing/link/imu_question.h"
#include "snapwing/link/motor_stream.h"

namespace snapwing::standin {

/// Arming-disable bits of release 4.5 that the stand-in can raise.
enum ArmingFlag : std::uint32_t {
  FLAG_FAILSAFE = 1U << 1,
  FLAG_RXLOSS = 1U << 2,
  FLAG_NOT_DISARMED = 1U << 3,
  FLAG_THROTTLE = 1U << 7,
  FLAG_BOOTGRACE = 1U << 9,
  FLAG_ARMSWITCH = 1U << 25,
};
constexpr int ARMING_FLAG_COUNT = 26;

/// Defaults are the measured ones. [s] and [us]
struct StandinSettings {
  double boot_grace = 5.0;
  double rxloss_after = 0.1;          ///< without a frame
  double rxloss_clear = 0.5;          ///< of frames
  double look_period = 0.1;           ///< without frames the receiver is looked at this often
  double throttle_hold = 0.3;         ///< the first look at or after this finds the last throttle too old
  double look_late = 0.006;           ///< that look comes up to this late
  double early_look_share = 0.05;     ///< of cases in which the third look comes a hair early, and the fourth decides
  double early_look_late = 0.002;     ///< the fourth comes up to this late
  double channel_hold = 0.3;          ///< an invalid channel keeps its last value this long, then all four are replaced
  double failsafe_delay = 1.5;        ///< then motors off, disarmed
  double failsafe_recovery = 1.0;     ///< of frames before failsafe clears
  double ramp = 0.021;                ///< the motors' way to a new throttle (RC smoothing), 13 ms of it from 10 to 90 %
  int disarm_turns = 4;               ///< frames with AUX1 off, after the first, that disarm
  double msp_rate = 96.0;             ///< [1/s] commands served
  std::size_t receive_buffer = 1400;  ///< [bytes] that wait; one more and all of them are lost
  int arm_threshold = 1700;           ///< AUX1 at or above
  int min_check = 1050;               ///< throttle below is low
  int motor_idle = 1070;
  int motor_off = 1000;
  /// MSP override: not 0 makes the pilot's receiver the main one. Frames of onFrame() then replace the channels of this
  /// mask (bit n = n-th wire channel), while the pilot's override channel is high.
  unsigned override_mask = 0;
  int override_channel = 5;     ///< wire channel of the pilot's switch, AUX2
  double override_hold = 1e18;  ///< release 4.5 uses the last MSP value for ever; later ones age it
  link::ApiVersion api{0, 1, 46};
  std::array<char, 4> variant{'B', 'T', 'F', 'L'};
  link::FailsafeConfig failsafe{1.5, 1.0, 1000, 0, 10.0, 1};
  link::RxMap rx_map{link::DEFAULT_RX_MAP, 8};
  link::RxFailConfig rxfail = link::defaultRxFail();
  link::ModeRanges mode_ranges = link::defaultModeRanges();
  std::uint32_t features = link::FEATURE_RX_MSP | link::FEATURE_AIRMODE;
  link::RxConfig rx_config;
  link::ThrottleLimit throttle_limit;
  int motor_output_limit = 100;  ///< [%]
  bool accelerometer = true;     ///< false: MSP_RAW_IMU is refused

  /// iNav 9.0: four bytes of RX_MAP, a STATUS of eleven, and full throttle for up to 0.92 s after the last frame.
  void becomeInav();
};

class StandinController : public common::Lender {
 public:
  /// @param now  [s] power on
  StandinController(const StandinSettings& settings, double now);

  /// A good frame from the computer. Channels beyond its count keep their values; those outside 885..2115 are invalid.
  void onFrame(const link::Channels& channels, double now);
  /// A frame of the pilot's own receiver, with an override mask only.
  void onPilotFrame(const link::Channels& channels, double now);
  /// What the accelerometer measures from now on. [m/s2] its own axes, z up; at first the vehicle rests upright
  void feel(const std::array<double, 3>& specific_force) { specific_force_ = specific_force; }
  const std::array<double, 3>& specificForce() const { return specific_force_; }
  /// Advances timers; call at least every few milliseconds.
  void step(double now);

  bool armed() const { return armed_; }
  bool failsafe() const { return failsafe_; }
  bool overrideActive() const { return override_active_; }
  std::uint32_t armingFlags() const { return flags_; }
  /// [us] of each motor; equal, since the stand-in has no attitude loop.
  int motorMicroseconds() const { return static_cast<int>(motor_); }
  link::MotorOutputs motorOutputs() const;
  /// Channels as MSP_RC shows them: roll, pitch, yaw, throttle, AUX1 ...
  link::Channels seenChannels(double now) const;
  std::int64_t frames() const { return frames_; }
  const StandinSettings& settings() const { return settings_; }

 private:
  void receive(const link::Channels& channels, double now);
  bool flightChannelsValid(double now) const;
  void drawHold();
  void turn(double now, bool frame);
  void tryToArm(double now, bool frame);
  bool signalLost(double now) const { return now - last_frame_ > hold_ || channels_lost_; }
  int lostThrottle() const;
  void updateMotor(double now);
  void updateFailsafe(double now);
  std::uint32_t computeFlags(double now) const;
  int throttleInForce(double now) const;
  int motorFor(int throttle) const;

  StandinSettings settings_;
  double boot_time_;
  link::Channels values_;  ///< wire order, held
  std::array<double, link::MAX_CHANNELS> valid_time_{};
  bool any_frame_ = false;
  double last_frame_ = -1e9;  ///< any frame
  double last_good_ = -1e9;   ///< frame while all flight channels were valid or held
  double good_since_ = 1e18;  ///< unbroken good frames since
  double hold_ = 0;           ///< [s] after the last frame until its throttle counts as too old
  std::uint32_t draw_ = 0;
  bool channels_lost_ = false;  ///< a flight channel was invalid for too long
  double next_look_;
  bool armed_ = false, failsafe_ = false;
  bool switch_seen_ = false;  ///< AUX1 on, as of the turn before
  bool not_disarmed_ = false, arm_switch_latched_ = false;
  int disarm_turns_ = 0;
  std::uint32_t flags_ = 0;
  double motor_;                                             ///< [us]
  double ramp_from_ = 0, ramp_to_ = -1, ramp_begin_ = -1e9;  ///< [us], [us], [s]
  std::int64_t frames_ = 0;
  link::Channels computer_;  ///< with an override mask: last values of its frames, wire order
  std::array<double, link::MAX_CHANNELS> computer_time_{};
  bool override_active_ = false;
  std::array<double, 3> specific_force_{0, 0, link::STANDARD_GRAVITY};
};

/// The serial port of the stand-in: bytes wait in a ring, one MSP command is served per turn of a fixed-rate task.
class StandinMsp {
 public:
  StandinMsp(StandinController& controller, double now);

  void receive(const std::uint8_t* bytes, std::size_t size);
  /// Serves what is due and steps the controller to `now`.
  /// @param out  answers are written here. @return bytes written
  std::size_t step(double now, std::uint8_t* out, std::size_t capacity);
  std::int64_t lostBytes() const { return lost_; }
  std::int64_t served() const { return served_; }
  std::uint64_t badFrames() const { return parser_.badFrames(); }
  void reset();

 private:
  bool nextCommand();
  void serve(const link::MspPacket& packet, double now, link::MspPacket& reply);
  bool serveSetting(link::MspPacket& reply) const;
  void serveImu(link::MspPacket& reply) const;

  common::Loan<StandinController> controller_;
  link::MspParser parser_;
  std::array<std::uint8_t, 1400> ring_;
  std::size_t size_, head_ = 0, count_ = 0;
  double next_turn_;
  std::int64_t lost_ = 0, served_ = 0;
};

}  // namespace snapwing::standin
