/// What must be right before arming: each wrong configuration is refused with a sentence that names the mend.
#include "controller_checks.h"

#include <gtest/gtest.h>

#include <map>

#include "controller_check.h"
#include "link/loop_simulation.h"
#include "snapwing/common/error.h"
#include "standin_wrong.h"

namespace snapwing::link {
namespace {

using test::Simulation;

struct Expected {
  Check check;
  const char* mend;  ///< of the sentence
};
/// Each of the stand-in's wrong configurations.
const std::map<std::string, Expected> EXPECTED = {
    {"other-variant", {Check::CONTROLLER, "flash Betaflight 4.3"}},
    {"inav", {Check::INAV, "--allow no-readback"}},
    {"old-release", {Check::API_VERSION, "flash release 4.3"}},
    {"rx-map", {Check::RX_MAP, "`map AETR1234`"}},
    {"failsafe-delay", {Check::FAILSAFE_DELAY, "`set failsafe_delay = 15`"}},
    {"failsafe-procedure", {Check::FAILSAFE_PROCEDURE, "`set failsafe_procedure = DROP`"}},
    {"rxfail-throttle-hold", {Check::RXFAIL_THROTTLE, "`rxfail 3 a`"}},
    {"rxfail-throttle-set", {Check::RXFAIL_THROTTLE, "`rxfail 3 a`"}},
    {"rxfail-pitch-hold", {Check::RXFAIL_STICKS, "`rxfail 1 a`"}},
    {"rxfail-aux1-set", {Check::RXFAIL_AUX1, "`rxfail 4 h`"}},
    {"arm-missing", {Check::ARM_RANGE, "`aux 0 0 0 1700 2100 0 0`"}},
    {"arm-aux2", {Check::ARM_RANGE, "`aux 0 0 0 1700 2100 0 0`"}},
    {"arm-always", {Check::ARM_RANGE, "`aux 0 0 0 1700 2100 0 0`"}},
    {"feature-3d", {Check::MODE_3D, "`feature -3D`"}},
    {"receiver-serial", {Check::RECEIVER, "`feature RX_MSP`"}},
    {"min-check", {Check::MIN_CHECK, "`set min_check = 1050`"}},
    {"throttle-limit", {Check::THROTTLE_LIMIT, "`set throttle_limit_type = OFF`"}},
    {"motor-output-limit", {Check::MOTOR_LIMIT, "`set motor_output_limit = 100`"}},
};

/// Answers of a stand-in, as the bridge reads them.
ControllerAnswers answersOf(const standin::StandinSettings& settings) {
  standin::StandinController fc(settings, 0.0);
  standin::StandinMsp port(fc, 0.0);
  ControllerAnswers answers;
  MspParser parser;
  double now = 0;
  for (const std::uint16_t question : QUESTIONS) {
    std::array<std::uint8_t, 512> bytes;
    port.receive(bytes.data(), encodeMsp(request(MspVersion::V2, question), bytes.data(), bytes.size()));
    const std::size_t size = port.step(now += 0.02, bytes.data(), bytes.size());
    for (std::size_t i = 0; i < size; ++i) {
      if (parser.push(bytes[i])) answers.take(parser.packet());
    }
  }
  return answers;
}

TEST(ControllerChecks, EveryWrongConfigurationIsNamedWithItsMend) {
  ASSERT_GE(standin::wrongConfigurations().size(), 12U);
  for (const std::string& name : standin::wrongConfigurations()) {
    SCOPED_TRACE(name);
    standin::StandinSettings settings;
    standin::setWrongly(name, settings);
    const ControllerAnswers answers = answersOf(settings);
    ASSERT_TRUE(answers.complete());
    const Expected& expected = EXPECTED.at(name);
    EXPECT_EQ(firstFailed(answers, {}), expected.check);
    EXPECT_NE(describe(expected.check).find(expected.mend), std::string::npos) << describe(expected.check);
    const CheckReport report = reportOn(answers, {}, 0.01);
    EXPECT_EQ(report.result, CheckResult::NOT_READY);
    EXPECT_NE(report.text.find("not ready: 1 to mend"), std::string::npos) << report.text;
    EXPECT_NE(report.text.find(expected.mend), std::string::npos) << report.text;
    const std::string refusal = describe(Refusal::CONTROLLER_UNKNOWN, static_cast<std::int64_t>(expected.check));
    EXPECT_NE(refusal.find(expected.mend), std::string::npos) << "the operator reads it too: " << refusal;
  }
}

TEST(ControllerChecks, EveryWrongConfigurationIsNeverArmed) {
  for (const std::string& name : standin::wrongConfigurations()) {
    SCOPED_TRACE(name);
    standin::StandinSettings settings = Simulation::quickStandin();
    standin::setWrongly(name, settings);
    Simulation s(settings);
    s.run(1.5);
    EXPECT_FALSE(s.bridge->core().status().controller.known);
    EXPECT_EQ(s.bridge->watch().failedCheck(), EXPECTED.at(name).check);
    s.arm_switch = true;
    s.run(0.5);
    EXPECT_FALSE(s.fc.armed());
    EXPECT_EQ(s.bridge->core().status().last_refusal, Refusal::CONTROLLER_UNKNOWN);
    EXPECT_EQ(s.bridge->core().status().last_refusal_detail, static_cast<std::int64_t>(EXPECTED.at(name).check));
  }
}

TEST(ControllerChecks, EachCanBeAllowedByItsNameOrSaysThatItCannot) {
  for (int number = 2; number < CHECK_COUNT; ++number) {
    const Check check = static_cast<Check>(number);
    SCOPED_TRACE(number);
    EXPECT_FALSE(describe(check).empty());
    const std::string name = checkName(check);
    if (name.empty()) continue;
    EXPECT_EQ(allowedBit(name), 1U << number);
    EXPECT_NE(allowableChecks().find(name), std::string::npos);
    EXPECT_NE(describe(check).find("(check " + name + ")"), std::string::npos);
  }
  EXPECT_THROW(allowedBit("everything"), common::SettingError);
  EXPECT_THROW(allowedBit(""), common::SettingError);
  for (const char* name : {"rxfail-throttle-hold", "feature-3d", "arm-aux2"}) {
    standin::StandinSettings settings;
    standin::setWrongly(name, settings);
    ControllerRules rules;
    rules.allowed = 1U << static_cast<int>(EXPECTED.at(name).check);
    EXPECT_EQ(firstFailed(answersOf(settings), rules), Check::NONE);
    EXPECT_EQ(reportOn(answersOf(settings), rules, 0.01).result, CheckResult::READY);
  }
}

/// 4.3 to today's, by what they answer; a map of four bytes is a map.
TEST(ControllerChecks, ReleasesAreAcceptedByWhatTheyAnswer) {
  for (const int minor : {44, 45, 46, 47, 48, 60}) {
    standin::StandinSettings settings = Simulation::quickStandin();
    settings.api.minor = minor;
    Simulation s(settings);
    s.arm();
    EXPECT_TRUE(s.fc.armed()) << minor;
  }
  standin::StandinSettings settings;
  settings.rx_map.count = 4;
  EXPECT_EQ(firstFailed(answersOf(settings), {}), Check::NONE);
  settings.rx_map.map = {0, 1, 2, 3, 4, 5, 6, 7};
  EXPECT_EQ(firstFailed(answersOf(settings), {}), Check::RX_MAP);
}

TEST(ControllerChecks, VariantIsJudgedBeforeTheOthersHaveAnswered) {
  ControllerAnswers answers;
  EXPECT_EQ(firstFailed(answers, {}), Check::NOT_READ);
  MspPacket packet = request(MspVersion::V2, MSP_FC_VARIANT);
  packet.direction = '>';
  packet.size = 4;
  std::copy_n("INAV", 4, packet.payload.begin());
  ASSERT_TRUE(answers.take(packet));
  EXPECT_EQ(firstFailed(answers, {}), Check::INAV);
  std::copy_n("BTFL", 4, packet.payload.begin());
  answers.take(packet);
  EXPECT_EQ(firstFailed(answers, {}), Check::NOT_READ);
}

/// A question that a firmware refuses, or answers too briefly, is asked once; its check fails and says so.
TEST(ControllerChecks, WhatCannotBeReadIsNotTakenForRight) {
  ControllerAnswers answers = answersOf({});
  ASSERT_EQ(firstFailed(answers, {}), Check::NONE);
  MspPacket packet = request(MspVersion::V2, MSP_RXFAIL_CONFIG);
  packet.direction = '!';
  answers.take(packet);
  EXPECT_TRUE(answers.complete());
  EXPECT_EQ(firstFailed(answers, {}), Check::RXFAIL_THROTTLE);
  EXPECT_NE(reportOn(answers, {}, 0.01).text.find("cannot be read from this firmware"), std::string::npos);
  packet.id = MSP_PID_ADVANCED;
  packet.direction = '>';
  packet.size = 40;
  answers = answersOf({});
  answers.take(packet);
  EXPECT_EQ(firstFailed(answers, {}), Check::MOTOR_LIMIT);
}

TEST(ControllerChecks, UnreadableSettingsNameTheCommandThatShowsThem) {
  for (const bool pilot_override : {false, true}) {
    ControllerRules rules;
    rules.pilot_override = pilot_override;
    const std::string text = reportOn(answersOf({}), rules, 0.01).text;
    for (const std::string& setting : unreadableSettings(rules)) {
      EXPECT_NE(setting.find("`get "), std::string::npos);
      EXPECT_NE(text.find("cannot be read: " + setting), std::string::npos);
    }
    EXPECT_EQ(text.find("msp_override_failsafe") != std::string::npos, pilot_override);
  }
}

TEST(ControllerChecks, SlowAnswersAreCalledSlow) {
  const CheckReport report = reportOn(answersOf({}), {}, 0.15);
  EXPECT_EQ(report.result, CheckResult::NOT_READY);
  EXPECT_NE(report.text.find("slow: an answer took 150 ms"), std::string::npos);
}

TEST(ControllerChecks, SettingsSurviveTheWire) {
  standin::StandinSettings settings;
  settings.features = 0xF0C01234;
  settings.rx_config = {1100, 1850, 900, 2100};
  settings.throttle_limit = {ThrottleLimitType::CLIP, 55};
  settings.motor_output_limit = 81;
  settings.mode_ranges.ranges[7] = {50, 3, 1325, 1675};
  settings.rxfail.channels[17] = {RxFailMode::SET, 1225};
  const ControllerAnswers a = answersOf(settings);
  EXPECT_EQ(a.features.bits, 0xF0C01234);
  EXPECT_EQ(a.rx_config.min_check, 1100);
  EXPECT_EQ(a.rx_config.max_check, 1850);
  EXPECT_EQ(a.rx_config.shortest, 900);
  EXPECT_EQ(a.rx_config.longest, 2100);
  EXPECT_EQ(a.throttle_limit.type, ThrottleLimitType::CLIP);
  EXPECT_EQ(a.throttle_limit.percent, 55);
  EXPECT_EQ(a.motor_limit.percent, 81);
  EXPECT_EQ(a.mode_ranges.count, 20);
  EXPECT_EQ(a.mode_ranges.ranges[7].box, 50);
  EXPECT_EQ(a.mode_ranges.ranges[7].aux, 3);
  EXPECT_EQ(a.mode_ranges.ranges[7].from, 1325);
  EXPECT_EQ(a.mode_ranges.ranges[7].to, 1675);
  EXPECT_EQ(a.rxfail.channels[17].mode, RxFailMode::SET);
  EXPECT_EQ(a.rxfail.channels[17].value, 1225);
}

}  // namespace
}  // namespace snapwing::link
