#include "standin_wrong.h"

#include "snapwing/common/error.h"

namespace snapwing::standin {
namespace {

struct Wrong {
  const char* name;
  void (*set)(StandinSettings&);
};

constexpr std::size_t RX_THROTTLE = 3, RX_PITCH = 1, RX_AUX1 = 4;  ///< places in the controller's own order

constexpr Wrong ALL[] = {
    {"other-variant",
     [](StandinSettings& s) {
       s.variant = {'C', 'L', 'F', 'L'};
     }},
    {"inav", [](StandinSettings& s) { s.becomeInav(); }},
    {"old-release", [](StandinSettings& s) { s.api.minor = 43; }},
    {"rx-map", [](StandinSettings& s) { s.rx_map.map = {1, 2, 3, 0, 4, 5, 6, 7}; }},
    {"failsafe-delay", [](StandinSettings& s) { s.failsafe.delay = 3.0; }},
    {"failsafe-procedure", [](StandinSettings& s) { s.failsafe.procedure = 0; }},
    {"rxfail-throttle-hold", [](StandinSettings& s) { s.rxfail.channels[RX_THROTTLE].mode = link::RxFailMode::HOLD; }},
    {"rxfail-throttle-set",
     [](StandinSettings& s) {
       s.rxfail.channels[RX_THROTTLE] = {link::RxFailMode::SET, 1600};
     }},
    {"rxfail-pitch-hold", [](StandinSettings& s) { s.rxfail.channels[RX_PITCH].mode = link::RxFailMode::HOLD; }},
    {"rxfail-aux1-set",
     [](StandinSettings& s) {
       s.rxfail.channels[RX_AUX1] = {link::RxFailMode::SET, 2000};
     }},
    {"arm-missing", [](StandinSettings& s) { s.mode_ranges.ranges[0] = {}; }},
    {"arm-aux2", [](StandinSettings& s) { s.mode_ranges.ranges[0].aux = 1; }},
    {"arm-always", [](StandinSettings& s) { s.mode_ranges.ranges[0].from = 900; }},
    {"feature-3d", [](StandinSettings& s) { s.features |= link::FEATURE_3D; }},
    {"receiver-serial", [](StandinSettings& s) { s.features ^= link::FEATURE_RX_MSP | link::FEATURE_RX_SERIAL; }},
    {"min-check", [](StandinSettings& s) { s.rx_config.min_check = s.min_check = 1200; }},
    {"throttle-limit",
     [](StandinSettings& s) {
       s.throttle_limit = {link::ThrottleLimitType::SCALE, 60};
     }},
    {"motor-output-limit", [](StandinSettings& s) { s.motor_output_limit = 70; }},
};

}  // namespace

std::vector<std::string> wrongConfigurations() {
  std::vector<std::string> names;
  for (const Wrong& wrong : ALL) names.emplace_back(wrong.name);
  return names;
}

void setWrongly(const std::string& name, StandinSettings& settings) {
  std::string known;
  for (const Wrong& wrong : ALL) {
    if (name == wrong.name) return wrong.set(settings);
    known += (known.empty() ? "" : ", ") + std::string(wrong.name);
  }
  throw common::SettingError("stand-in", "wrong", name, known);
}

}  // namespace snapwing::standin
