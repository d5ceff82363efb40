#pragma once
/// A trial that is stopped and goes on from its last checkpoint, beside one that is not.

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "snapwing/motion/axis_trial.h"
#include "snapwing/motion/trial_record.h"

namespace snapwing::test {

struct Restarted {
  motion::AxisRun whole, resumed;
  int steps_of_checkpoint = 0;
  std::string checkpoint;  ///< file, owned by 64 times 'a'
};

/// Expects both to have the same series and the same end.
/// @param keep_every, stop  steps between checkpoints; steps after which it is stopped
/// @param last  steps after which both are ended; the largest int: by themselves
inline Restarted restarted(const motion::AxisVehicle& vehicle, const motion::AxisTrial& trial,
                           const motion::StepperSettings& steps, int keep_every, int stop, const std::string& name,
                           int last = std::numeric_limits<int>::max()) {
  Restarted out;
  out.checkpoint = ::testing::TempDir() + "/" + name;
  const std::string owner(64, 'a');
  const bool whole = last == std::numeric_limits<int>::max();
  motion::AxisRunHooks hooks;
  hooks.keep_every = keep_every;
  const auto run = [&](motion::AxisRun& r, int until) {
    hooks.stepped = [until](const motion::AxisRun& now) { return now.outcome.steps < until; };
    motion::Stepper stepper(vehicle.problem(), motion::Scheme(motion::SchemeKind::MIDPOINT), steps);
    return motion::runTrial(vehicle, stepper, trial, r, hooks);
  };
  EXPECT_EQ(run(out.whole, last), whole);
  hooks.keep = [&](const motion::AxisRun& now) { motion::saveTrialCheckpoint(now, owner, out.checkpoint); };
  motion::AxisRun part;
  EXPECT_FALSE(run(part, stop));
  hooks.keep = {};
  out.resumed = motion::loadTrialCheckpoint(out.checkpoint, owner);
  out.steps_of_checkpoint = out.resumed.outcome.steps;
  EXPECT_EQ(run(out.resumed, last), whole);
  EXPECT_EQ(motion::seriesCsv(out.resumed.samples), motion::seriesCsv(out.whole.samples));
  EXPECT_TRUE(out.resumed.state.y == out.whole.state.y);
  return out;
}

}  // namespace snapwing::test
