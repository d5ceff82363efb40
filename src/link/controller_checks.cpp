#include "controller_checks.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "snapwing/common/error.h"

namespace snapwing::link {
namespace {

constexpr int API_MAJOR = 1, OLDEST_API_MINOR = 44;    ///< release 4.3
constexpr double LONGEST_FAILSAFE_DELAY = 1.5 + 1e-9;  ///< [s]
constexpr int PROCEDURE_MOTORS_OFF = 1;
constexpr int ARM_FROM_LOW = 1300, ARM_FROM_HIGH = 1900;  ///< [us] where the range of ARM may begin
constexpr std::size_t RX_YAW = 2, RX_THROTTLE = 3, RX_AUX1 = 4;
constexpr const char* CHANNEL_NAMES[] = {"roll", "pitch", "yaw", "throttle", "AUX1"};

using Answers = ControllerAnswers;
using Rules = ControllerRules;

bool isVariant(const Answers& a, const char* name) { return std::memcmp(a.variant.data(), name, 4) == 0; }

bool rightMap(const Answers& a, const Rules&) { return a.rx_map.map == DEFAULT_RX_MAP; }

bool sticksAuto(const Answers& a, const Rules&) {
  const auto begin = a.rxfail.channels.begin();
  return std::all_of(begin, begin + RX_YAW + 1, [](const RxFailChannel& c) { return c.mode == RxFailMode::AUTO; });
}

bool aux1Harmless(const Answers& a, const Rules&) {
  const RxFailChannel& aux = a.rxfail.channels[RX_AUX1];
  return aux.mode != RxFailMode::SET || aux.value < ARM_FROM_LOW;
}

bool armsOnAux1Alone(const Answers& a, const Rules& rules) {
  int ranges = 0, good = 0;
  for (int i = 0; i < a.mode_ranges.count; ++i) {
    const ModeRange& r = a.mode_ranges.ranges[static_cast<std::size_t>(i)];
    if (r.box != BOX_ARM || !r.used()) continue;
    ++ranges;
    if (r.aux == 0 && r.from >= ARM_FROM_LOW && r.from <= ARM_FROM_HIGH && r.to > CHANNEL_HIGH) ++good;
  }
  return rules.pilot_override ? ranges > 0 : ranges == 1 && good == 1;  // under override the pilot arms, as he likes
}

/// Releases since 2025.12 name the MSP receiver otherwise; what no bit of the known ones denies is let pass.
bool mspReceiver(const Answers& a, const Rules& rules) {
  constexpr std::uint32_t OTHERS = FEATURE_RX_PPM | FEATURE_RX_SERIAL | FEATURE_RX_PARALLEL_PWM | FEATURE_RX_SPI;
  if (rules.pilot_override || (a.features.bits & FEATURE_RX_MSP) != 0) return true;
  return a.api.minor > 46 && (a.features.bits & OTHERS) == 0;
}

bool boxesThere(const Answers& a, const Rules&) {
  return a.boxes.find(BOX_ARM) >= 0 && a.boxes.find(BOX_FAILSAFE) >= 0;
}

std::string us(int microseconds) { return std::to_string(microseconds) + " us"; }

std::string foundMap(const Answers& a) {
  std::string text;
  for (int i = 0; i < a.rx_map.count; ++i) {
    text += (i == 0 ? "" : " ") + std::to_string(a.rx_map.map[static_cast<std::size_t>(i)]);
  }
  return "channel map " + text + " (AETR1234 is 0 1 3 2 ...)";
}

std::string foundRxFail(const Answers& a, std::size_t first, std::size_t last) {
  std::string text;
  for (std::size_t i = first; i <= last; ++i) {
    const RxFailChannel& c = a.rxfail.channels[i];
    const char* mode = c.mode == RxFailMode::AUTO ? "AUTO" : c.mode == RxFailMode::HOLD ? "HOLD" : "SET to ";
    text += (i == first ? "lost " : ", ") + std::string(CHANNEL_NAMES[i]) + ": " + mode;
    if (c.mode == RxFailMode::SET) text += us(c.value);
  }
  return text;
}

std::string foundArm(const Answers& a) {
  std::string text;
  for (int i = 0; i < a.mode_ranges.count; ++i) {
    const ModeRange& r = a.mode_ranges.ranges[static_cast<std::size_t>(i)];
    if (r.box != BOX_ARM || !r.used()) continue;
    text += (text.empty() ? "ARM on AUX" : ", on AUX") + std::to_string(r.aux + 1) + " from " + std::to_string(r.from) +
            " to " + us(r.to);
  }
  return text.empty() ? "ARM on no channel" : text;
}

std::string foundReceiver(const Answers& a) {
  const std::uint32_t bits = a.features.bits;
  if ((bits & FEATURE_RX_MSP) != 0) return "MSP receiver";
  if ((bits & FEATURE_RX_SERIAL) != 0) return "serial receiver";
  if ((bits & (FEATURE_RX_PPM | FEATURE_RX_PARALLEL_PWM)) != 0) return "PPM or PWM receiver";
  return (bits & FEATURE_RX_SPI) != 0 ? "SPI receiver" : "no receiver feature";
}

std::string foundThrottleLimit(const Answers& a) {
  if (a.throttle_limit.type == ThrottleLimitType::OFF) return "no throttle limit";
  return "throttle limit of " + std::to_string(a.throttle_limit.percent) + " %";
}

std::string foundApi(const Answers& a) {
  const char* release = a.api.minor == 44   ? "4.3"
                        : a.api.minor == 45 ? "4.4"
                        : a.api.minor == 46 ? "4.5"
                        : a.api.minor > 46  ? "2025.12 or later"
                                            : "older than 4.3";
  return "interface " + std::to_string(a.api.major) + "." + std::to_string(a.api.minor) + " (release " + release + ")";
}

std::string foundVariant(const Answers& a) {
  return "firmware " + std::string(a.variant.begin(), std::find(a.variant.begin(), a.variant.end(), '\0'));
}

std::string foundFailsafe(const Answers& a) {
  const long tenths = std::lround(10 * a.failsafe.delay);
  return "failsafe after " + std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " s";
}

std::string foundProcedure(const Answers& a) {
  const int procedure = a.failsafe.procedure;
  return "failsafe procedure " + std::string(procedure == 0   ? "AUTO-LAND"
                                             : procedure == 1 ? "DROP"
                                             : procedure == 2 ? "GPS-RESCUE"
                                                              : "unknown");
}

struct Rule {
  Check check;
  const char* name;        ///< "" = cannot be allowed
  std::uint16_t question;  ///< whose answer is judged
  bool (*passes)(const Answers&, const Rules&);
  std::string (*found)(const Answers&);
  const char* sentence;  ///< wrong, consequence, mend
};

const Rule RULES[] = {
    {Check::INAV, "", MSP_FC_VARIANT, [](const Answers& a, const Rules&) { return !isVariant(a, "INAV"); },
     foundVariant,
     "iNav is not read back: its status has no arming flags, and a dead bridge leaves full thrust for up to 0.92 s; "
     "use Betaflight 4.3 or later, or, at that price, run blind with --allow no-readback"},
    {Check::CONTROLLER, "controller", MSP_FC_VARIANT,
     [](const Answers& a, const Rules&) { return isVariant(a, "BTFL"); }, foundVariant,
     "the firmware is not Betaflight, so nothing is known of its failsafe; flash Betaflight 4.3 or later"},
    {Check::API_VERSION, "api-version", MSP_API_VERSION,
     [](const Answers& a, const Rules&) { return a.api.major == API_MAJOR && a.api.minor >= OLDEST_API_MINOR; },
     foundApi,
     "the firmware's interface is older than 1.44 (release 4.3), and its failsafe comes at other times; flash release "
     "4.3 "
     "or later (`version` shows it)"},
    {Check::RX_MAP, "rx-map", MSP_RX_MAP, rightMap, foundMap,
     "the channel map is not AETR, so throttle would land on another channel; `map AETR1234`, `save`"},
    {Check::FAILSAFE_DELAY, "failsafe-delay", MSP_FAILSAFE_CONFIG,
     [](const Answers& a, const Rules&) { return a.failsafe.delay <= LONGEST_FAILSAFE_DELAY; }, foundFailsafe,
     "the failsafe disarms later than 1.5 s after the last frame; `set failsafe_delay = 15`, `save`"},
    {Check::FAILSAFE_PROCEDURE, "failsafe-procedure", MSP_FAILSAFE_CONFIG,
     [](const Answers& a, const Rules&) { return a.failsafe.procedure == PROCEDURE_MOTORS_OFF; }, foundProcedure,
     "the failsafe does not stop the motors; `set failsafe_procedure = DROP`, `save`"},
    {Check::BOX_IDS, "", MSP_BOXIDS, boxesThere, [](const Answers&) { return std::string("modes ARM and FAILSAFE"); },
     "the controller lists no mode ARM or no mode FAILSAFE, so armed cannot be read; add a range for ARM with "
     "`aux 0 0 0 1700 2100 0 0`, `save`"},
    {Check::RXFAIL_THROTTLE, "rxfail-throttle", MSP_RXFAIL_CONFIG,
     [](const Answers& a, const Rules&) { return a.rxfail.channels[RX_THROTTLE].mode == RxFailMode::AUTO; },
     [](const Answers& a) { return foundRxFail(a, RX_THROTTLE, RX_THROTTLE); },
     "lost throttle is not on AUTO: a dead bridge would leave it on for 1.5 s; `rxfail 3 a`, `save`"},
    {Check::RXFAIL_STICKS, "rxfail-sticks", MSP_RXFAIL_CONFIG, sticksAuto,
     [](const Answers& a) { return foundRxFail(a, 0, RX_YAW); },
     "a lost stick is not on AUTO and would stay where it was; `rxfail 0 a`, `rxfail 1 a`, `rxfail 2 a`, `save`"},
    {Check::RXFAIL_AUX1, "rxfail-aux1", MSP_RXFAIL_CONFIG, aux1Harmless,
     [](const Answers& a) { return foundRxFail(a, RX_AUX1, RX_AUX1); },
     "lost AUX1 is set to a value that arms; `rxfail 4 h`, `save`"},
    {Check::ARM_RANGE, "arm-range", MSP_MODE_RANGES, armsOnAux1Alone, foundArm,
     "ARM is not on AUX1 from 1700 to 2100 us alone, so the bridge could not arm, or not disarm; remove other ranges "
     "of "
     "ARM (`aux` lists them), then `aux 0 0 0 1700 2100 0 0`, `save`"},
    {Check::MODE_3D, "feature-3d", MSP_FEATURE_CONFIG,
     [](const Answers& a, const Rules&) { return (a.features.bits & FEATURE_3D) == 0; },
     [](const Answers& a) {
       return std::string((a.features.bits & FEATURE_3D) != 0 ? "feature 3D on" : "feature 3D off");
     },
     "3D mode is on: throttle low may be full reverse (3d_switched_mode cannot be read: `get 3d_switched_mode`); "
     "`feature -3D`, `save`"},
    {Check::RECEIVER, "receiver", MSP_FEATURE_CONFIG, mspReceiver, foundReceiver,
     "the receiver is not MSP, so the bridge's frames are not heard; `feature RX_MSP`, `save` (releases 4.3 to 4.5; "
     "since "
     "2025.12 choose MSP as receiver mode in the Configurator's Receiver tab)"},
    {Check::MIN_CHECK, "min-check", MSP_RX_CONFIG,
     [](const Answers& a, const Rules& r) { return a.rx_config.min_check == r.min_check; },
     [](const Answers& a) { return "throttle is low below " + us(a.rx_config.min_check); },
     "throttle counts as low below another value than the vehicle file's radio.min_check, so thrust would be another "
     "than "
     "planned; `set min_check = 1050`, `save`, or correct the vehicle file"},
    {Check::RX_RANGE, "rx-range", MSP_RX_CONFIG,
     [](const Answers& a, const Rules& r) {
       return a.rx_config.shortest <= r.throttle_low && a.rx_config.longest >= r.throttle_high;
     },
     [](const Answers& a) {
       return "valid from " + std::to_string(a.rx_config.shortest) + " to " + us(a.rx_config.longest);
     },
     "the controller takes part of our throttle for invalid; `set rx_min_usec = 885`, `set rx_max_usec = 2115`, "
     "`save`"},
    {Check::THROTTLE_LIMIT, "throttle-limit", MSP_RC_TUNING,
     [](const Answers& a, const Rules&) {
       return a.throttle_limit.type == ThrottleLimitType::OFF || a.throttle_limit.percent >= 100;
     },
     foundThrottleLimit,
     "the rate profile limits throttle, which cuts pulses silently; `set throttle_limit_type = OFF`, `save`"},
    {Check::MOTOR_LIMIT, "motor-output-limit", MSP_PID_ADVANCED,
     [](const Answers& a, const Rules&) { return a.motor_limit.percent >= 100; },
     [](const Answers& a) { return "motor output limit of " + std::to_string(a.motor_limit.percent) + " %"; },
     "the PID profile limits the motors, which cuts pulses silently; `set motor_output_limit = 100`, `save`"},
    {Check::OVERRIDE_BOX, "", MSP_BOXIDS,
     [](const Answers& a, const Rules& r) { return !r.pilot_override || a.boxes.find(BOX_MSP_OVERRIDE) >= 0; },
     [](const Answers& a) {
       return std::string(a.boxes.find(BOX_MSP_OVERRIDE) >= 0 ? "mode MSP OVERRIDE there" : "no mode MSP OVERRIDE");
     },
     "there is no mode MSP OVERRIDE, so the pilot could not hand over; give it a switch with `aux` (mode id 50), "
     "`save`"},
};

const Rule* ruleOf(Check check) {
  for (const Rule& rule : RULES) {
    if (rule.check == check) return &rule;
  }
  return nullptr;
}

bool passes(const Rule& rule, const Answers& answers, const Rules& rules) {
  return answers.answer(rule.question) == Answer::GOOD && rule.passes(answers, rules);
}

bool isAllowed(const Rule& rule, const Rules& rules) {
  return (rules.allowed >> static_cast<int>(rule.check) & 1U) != 0;
}

}  // namespace

bool ControllerAnswers::take(const MspPacket& packet) {
  const auto place = std::find(QUESTIONS.begin(), QUESTIONS.end(), packet.id);
  if (place == QUESTIONS.end()) return false;
  bool good = packet.direction == '>';
  if (packet.id == MSP_FC_VARIANT && (good = good && packet.size >= variant.size())) {
    std::copy_n(packet.payload.begin(), variant.size(), variant.begin());
  }
  if (packet.id == MSP_API_VERSION) good = good && decode(packet, api);
  if (packet.id == MSP_RX_MAP) good = good && decode(packet, rx_map);
  if (packet.id == MSP_FAILSAFE_CONFIG) good = good && decode(packet, failsafe);
  if (packet.id == MSP_BOXIDS) good = good && decode(packet, boxes);
  if (packet.id == MSP_RXFAIL_CONFIG) good = good && decode(packet, rxfail);
  if (packet.id == MSP_MODE_RANGES) good = good && decode(packet, mode_ranges);
  if (packet.id == MSP_FEATURE_CONFIG) good = good && decode(packet, features);
  if (packet.id == MSP_RX_CONFIG) good = good && decode(packet, rx_config);
  if (packet.id == MSP_RC_TUNING) good = good && decode(packet, throttle_limit);
  if (packet.id == MSP_PID_ADVANCED) good = good && decode(packet, motor_limit);
  answers[static_cast<std::size_t>(place - QUESTIONS.begin())] = good ? Answer::GOOD : Answer::REFUSED;
  return true;
}

Answer ControllerAnswers::answer(std::uint16_t question) const {
  const auto place = std::find(QUESTIONS.begin(), QUESTIONS.end(), question);
  return answers[static_cast<std::size_t>(place - QUESTIONS.begin())];
}

bool ControllerAnswers::complete() const {
  return std::find(answers.begin(), answers.end(), Answer::MISSING) == answers.end();
}

const char* checkName(Check check) {
  const Rule* rule = ruleOf(check);
  return rule == nullptr ? "" : rule->name;
}

std::string allowableChecks() {
  std::string text;
  for (const Rule& rule : RULES) {
    if (rule.name[0] != '\0') text += (text.empty() ? "" : ", ") + std::string(rule.name);
  }
  return text;
}

unsigned allowedBit(const std::string& name) {
  for (const Rule& rule : RULES) {
    if (!name.empty() && name == rule.name) return 1U << static_cast<int>(rule.check);
  }
  throw common::SettingError("radio bridge", "allow", name, allowableChecks());
}

Check firstFailed(const ControllerAnswers& answers, const ControllerRules& rules) {
  const bool who_known = answers.answer(MSP_FC_VARIANT) != Answer::MISSING;
  const bool complete = answers.complete();
  for (const Rule& rule : RULES) {
    if (!complete && !(who_known && rule.question == MSP_FC_VARIANT)) continue;
    if (!passes(rule, answers, rules) && !isAllowed(rule, rules)) return rule.check;
  }
  return complete ? Check::NONE : Check::NOT_READ;
}

std::vector<Finding> findings(const ControllerAnswers& answers, const ControllerRules& rules) {
  std::vector<Finding> list;
  for (const Rule& rule : RULES) {
    if (rule.check == Check::INAV && isVariant(answers, "BTFL")) continue;  // one line about the firmware
    if (rule.check == Check::OVERRIDE_BOX && !rules.pilot_override) continue;
    const bool passed = passes(rule, answers, rules);
    const bool read = answers.answer(rule.question) == Answer::GOOD;
    list.push_back({rule.check, passed, !passed && isAllowed(rule, rules),
                    read ? rule.found(answers) : "cannot be read from this firmware"});
    if (!passed && rule.question == MSP_FC_VARIANT && !list.back().allowed) break;
  }
  return list;
}

std::vector<std::string> unreadableSettings(const ControllerRules& rules) {
  std::vector<std::string> list = {
      "limits of profiles that are not in force: `get motor_output_limit` and `get throttle_limit` in each `profile N` "
      "and "
      "`rateprofile N`",
      "smoothing of the pulse's edges (ramps of 12 to 18 ms by default): `get rc_smoothing`",
      "idle of the motors, which the vehicle file calls radio.motor_idle: `get min_throttle`, with DShot "
      "`get dshot_idle_value` or `get motor_idle`",
  };
  if (rules.pilot_override) {
    list.emplace_back(
        "channels that the computer may replace (throttle and pitch are 6): `get msp_override_channels_mask`");
    list.emplace_back("whether the computer may replace a lost receiver (must be OFF): `get msp_override_failsafe`");
  }
  return list;
}

std::string describe(Check check) {
  if (check == Check::NONE) return "";
  if (check == Check::NOT_READ) {
    return "the flight controller has not answered all questions yet (it is asked again; `radio_bridge --check` shows "
           "which)";
  }
  const Rule* rule = ruleOf(check);
  if (rule == nullptr) return "check " + std::to_string(static_cast<int>(check)) + " of a newer radio bridge failed";
  const std::string name = rule->name;
  return rule->sentence + (name.empty() ? std::string() : " (check " + name + ")");
}

}  // namespace snapwing::link
