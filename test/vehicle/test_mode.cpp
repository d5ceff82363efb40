#include <gtest/gtest.h>

#include "snapwing/common/error.h"
#include "snapwing/vehicle/mode.h"

namespace snapwing::vehicle {
namespace {

TEST(Mode, NamesGoBothWays) {
  EXPECT_EQ(modeFromName(modeName(Mode::FIXED_WING)), Mode::FIXED_WING);
  EXPECT_EQ(modeFromName("QUADROTOR"), Mode::QUADROTOR);
  EXPECT_EQ(otherMode(Mode::QUADROTOR), Mode::FIXED_WING);
  EXPECT_THROW(modeFromName("hover"), common::Error);
  EXPECT_THROW(otherMode(Mode::UNKNOWN), common::Error);
}

}  // namespace
}  // namespace snapwing::vehicle
