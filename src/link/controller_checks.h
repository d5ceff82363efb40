#pragma once
/// What a flight controller must have answered before it may be armed: who it is, and every setting on which the
/// promises of docs/safety.md rest. Each check has a name, by which it can be allowed, and a sentence that names the
/// mend.

#include <array>
#include <string>
#include <vector>

#include "snapwing/link/config_messages.h"

namespace snapwing::link {

/// The number is the detail of Refusal::CONTROLLER_UNKNOWN. They are judged in the order of checkOrder().
enum class Check : int {
  NONE = 0,
  NOT_READ = 1,            ///< answers are missing yet
  CONTROLLER = 2,          ///< variant is not BTFL
  API_VERSION = 3,         ///< older than 1.44 (release 4.3)
  RX_MAP = 4,              ///< not AETR1234: throttle would land on another channel
  FAILSAFE_DELAY = 5,      ///< longer than 1.5 s
  FAILSAFE_PROCEDURE = 6,  ///< not "motors off"
  BOX_IDS = 7,             ///< no ARM or FAILSAFE box: armed cannot be read
  OVERRIDE_BOX = 8,        ///< pilot's override asked for, and no MSP OVERRIDE box
  INAV = 9,                ///< iNav: no flags in its status, and thrust stays for up to 0.92 s
  RXFAIL_THROTTLE = 10,    ///< lost throttle is not AUTO: full thrust for 1.5 s
  RXFAIL_STICKS = 11,      ///< a lost stick is not AUTO
  RXFAIL_AUX1 = 12,        ///< lost AUX1 is set to the arming range
  ARM_RANGE = 13,          ///< ARM is not on AUX1 alone, from between low and high to high
  MODE_3D = 14,            ///< low throttle is full reverse
  RECEIVER = 15,           ///< not the MSP receiver
  MIN_CHECK = 16,          ///< the controller's low throttle is not that of the vehicle file
  RX_RANGE = 17,           ///< the controller takes our throttle for invalid
  THROTTLE_LIMIT = 18,     ///< of the rate profile in force
  MOTOR_LIMIT = 19,        ///< of the PID profile in force
};
constexpr int CHECK_COUNT = 20;

/// Questions by which a controller is known, in the order in which they are asked.
constexpr std::array<std::uint16_t, 11> QUESTIONS = {
    MSP_FC_VARIANT,  MSP_API_VERSION,    MSP_RX_MAP,    MSP_FAILSAFE_CONFIG, MSP_BOXIDS,      MSP_RXFAIL_CONFIG,
    MSP_MODE_RANGES, MSP_FEATURE_CONFIG, MSP_RX_CONFIG, MSP_RC_TUNING,       MSP_PID_ADVANCED};

enum class Answer : std::uint8_t { MISSING, GOOD, REFUSED };  ///< REFUSED also if it was too short

struct ControllerAnswers {
  std::array<Answer, QUESTIONS.size()> answers{};
  std::array<char, 4> variant{};
  ApiVersion api{-1, -1, -1};
  RxMap rx_map;
  FailsafeConfig failsafe;
  BoxIds boxes;
  RxFailConfig rxfail;
  ModeRanges mode_ranges;
  FeatureConfig features;
  RxConfig rx_config;
  ThrottleLimit throttle_limit;
  MotorOutputLimit motor_limit;

  /// Takes an answer to one of QUESTIONS. @return false if the packet is none of them
  bool take(const MspPacket& packet);
  Answer answer(std::uint16_t question) const;
  bool complete() const;
};

/// What the answers are held against.
struct ControllerRules {
  bool pilot_override = false;
  int throttle_low = 1000, throttle_high = 2000, min_check = 1050;  ///< [us] of the vehicle file
  unsigned allowed = 0;                                             ///< bit n: check n need not pass
};

/// Name by which a failed check can be allowed, e.g. "rx-map"; empty for those that cannot be.
const char* checkName(Check check);
/// All names, in words: "controller, api-version, ...".
std::string allowableChecks();
/// Bit mask of names. @throws common::SettingError for an unknown one
template <typename Names>
unsigned allowedMask(const Names& names);
unsigned allowedBit(const std::string& name);

/// The first check that does not pass and is not allowed. The variant is judged before all else, also while answers are
/// missing. Allocates nothing.
Check firstFailed(const ControllerAnswers& answers, const ControllerRules& rules);

/// One line of the list of `radio_bridge --check`.
struct Finding {
  Check check = Check::NONE;
  bool passed = false;
  bool allowed = false;  ///< failed, and allowed by name
  std::string found;     ///< what the controller says, e.g. "throttle on HOLD"
};
/// Every check that applies, in order; after a wrong variant only that one.
std::vector<Finding> findings(const ControllerAnswers& answers, const ControllerRules& rules);
/// Settings that no message reports, each with the firmware's command that shows it.
std::vector<std::string> unreadableSettings(const ControllerRules& rules);

/// A sentence for a failed check: what is wrong, what it would do, and the firmware's command that mends it.
std::string describe(Check check);

template <typename Names>
unsigned allowedMask(const Names& names) {
  unsigned mask = 0;
  for (const std::string& name : names) mask |= allowedBit(name);
  return mask;
}

}  // namespace snapwing::link
