#include <gtest/gtest.h>

#include <fstream>

#include "snapwing/common/error.h"
#include "snapwing/validation/plan_file.h"
#include "support/own_folder.h"

namespace snapwing::validation {
namespace {

const char* const GOOD = R"({
  "inputs": {"vehicle_sha256": "aa", "table_sha256": "bb"},
  "trial": {"mount": "boom", "wings": "auto", "gravity": 0.0, "initial_speed": 0.0, "push": 1.5, "horizon": 4.0,
            "initial_thrust_fraction": 0.0},
  "plan": {"start_mode": "Q", "accepted": true, "reason": "", "worst_margin": 0.2,
           "pulse": {"throttle": 0.998, "duration": 0.547}}
})";

std::string write(std::string text, const std::string& from = {}, const std::string& to = {}) {
  if (!from.empty()) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
  }
  const std::string path = test::ownFolder() + "plan.json";
  std::ofstream(path) << text;
  return path;
}

TEST(PlanFile, IsReadWhole) {
  const PlanFile plan = loadPlan(write(GOOD));
  EXPECT_EQ(plan.name(), "Q -> F");
  EXPECT_EQ(plan.pulse.throttle, 0.998);
  EXPECT_EQ(plan.pulse.duration, 0.547);
  EXPECT_EQ(plan.trial.mount, vehicle::Mount::BOOM);
  EXPECT_EQ(plan.trial.push, 1.5);
  EXPECT_EQ(plan.trial.initial_thrust_fraction, 0.0);
  EXPECT_FALSE(plan.trial.final_thrust_fraction.has_value());
  EXPECT_EQ(plan.table_sha256, "bb");
}

TEST(PlanFile, HoldIsRead) {
  const PlanFile plan = loadPlan(
      write(GOOD, "\"duration\": 0.547", "\"duration\": 0.147, \"hold_throttle\": 0.3, \"hold_duration\": 1.25"));
  EXPECT_EQ(plan.pulse.hold_throttle, 0.3);
  EXPECT_EQ(plan.pulse.hold_duration, 1.25);
  EXPECT_THROW(loadPlan(write(GOOD, "\"duration\": 0.547", "\"duration\": 0.547, \"hold_throttle\": 0.3")),
               common::SettingError);
  EXPECT_THROW(loadPlan(write(GOOD, "\"duration\": 0.547",
                              "\"duration\": 0.547, \"hold_throttle\": 0.0, \"hold_duration\": 1.25")),
               common::Error);
}

TEST(PlanFile, WhatIsWrongIsNamed) {
  const std::vector<std::array<std::string, 4>> cases = {
      {"0.547", "-1", "plan.pulse.duration", "0 .. 60 s"},
      {"0.998", "\"full\"", "plan.pulse.throttle", "0 .. 1"},
      {"\"mount\": \"boom\", ", "", "trial.mount", "text"},
      {"\"accepted\": true, \"reason\": \"\"", "\"accepted\": false, \"reason\": \"no pulse\"", "plan.accepted",
       "no pulse"},
  };
  for (const auto& [from, to, key, words] : cases) {
    try {
      loadPlan(write(GOOD, from, to));
      FAIL() << "taken: " << to;
    } catch (const common::SettingError& e) {
      EXPECT_EQ(e.key(), key);
      EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
    }
  }
}

TEST(PlanFile, WhatIsNoPlanIsRefused) {
  EXPECT_THROW(loadPlan(test::ownFolder() + "none.json"), common::FileError);
  EXPECT_THROW(loadPlan(write("{")), common::FileError);
  EXPECT_THROW(loadPlan(write("[1]")), common::FileError);
}

}  // namespace
}  // namespace snapwing::validation
