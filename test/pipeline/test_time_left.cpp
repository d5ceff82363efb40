#include <gtest/gtest.h>

#include <cmath>

#include "snapwing/pipeline/time_left.h"

namespace snapwing::pipeline {
namespace {

TEST(TimeLeft, IsWhatTheRateSoFarSays) {
  TimeLeft left;
  EXPECT_TRUE(std::isnan(left.after(0, 10)));
  EXPECT_DOUBLE_EQ(left.after(0.25, 20), 30);
  EXPECT_DOUBLE_EQ(left.after(0.5, 40), 30);
  EXPECT_DOUBLE_EQ(left.after(1, 70), 0);
}

TEST(TimeLeft, WhatWasKeptTellsNothingOfTheRate) {
  TimeLeft left;
  left.after(0, 0);
  left.after(0.3, 0.001);  // found
  left.after(0.5, 0.002);
  EXPECT_NEAR(left.after(0.75, 10.002), 10, 1e-9);
}

TEST(TimeLeft, AShareThatFallsBackBeginsAnew) {
  TimeLeft left;
  left.after(0, 0);
  left.after(0.9, 9);
  EXPECT_TRUE(std::isnan(left.after(0.1, 10)));
  EXPECT_DOUBLE_EQ(left.after(0.6, 15), 4);
  EXPECT_TRUE(std::isnan(left.after(NAN, 20)));
}

}  // namespace
}  // namespace snapwing::pipeline
