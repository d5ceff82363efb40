// The shipped vehicle on the boom, wings off, nominal: the shortest pulses that switch, by one soft arm in time, over
// cells and steps, beside the lumped model on the static curve of the same cells,
// and on the vehicle's shipped table. Makes docs/motion_thresholds.csv.
// usage: bench_motion [cell size in mm]... [step=MS] [volumetric] [damping=LAW]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "snapwing/motion/axis_trial.h"
#include "snapwing/rom/lumped_model.h"
#include "snapwing/solver/sparse.h"
#include "snapwing/vehicle/table_origin.h"
#include "support/paths.h"

using namespace snapwing;
using vehicle::Mode;

namespace {

struct Case {
  Mode start;
  double fraction;
};

vehicle::Trial boomFromRest() {
  vehicle::Trial trial;
  trial.mount = vehicle::Mount::BOOM;
  trial.wings = false;
  trial.initial_thrust_fraction = 0.0;
  return trial;
}

/// The shortest pulse of all that switch, to .02 ms. @param switches  asked of pulses [s]
template <class Switches>
double threshold(double low, double high, const Switches& switches) {
  while (high - low > 2e-5) {
    const double middle = 0.5 * (low + high);
    (switches(middle) ? high : low) = middle;
  }
  return high;
}

}  // namespace

int main(int argc, char** argv) {
  motion::AxisSettings axis;
  motion::StepperSettings steps;
  steps.largest_step = 2e-3;
  steps.relative_tolerance = 1e-6;
  std::vector<double> cells;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    if (word == "volumetric") {
      axis.dimension = 3;
      steps.keep_factor = true;
    } else if (word.rfind("step=", 0) == 0) {
      steps.largest_step = 1e-3 * std::atof(word.c_str() + 5);
    } else if (word.rfind("damping=", 0) == 0) {
      axis.damping = motion::dampingFromName(word.substr(8));
    } else {
      cells.push_back(1e-3 * std::atof(argv[k]));
    }
  }
  const vehicle::Vehicle vehicle = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  const vehicle::ForceTable table = vehicle::armTableOf(vehicle);
  const vehicle::VehicleParameters parameters = vehicle::realise(vehicle, table);
  const vehicle::Trial trial = boomFromRest();
  const rom::LumpedModel lumped = rom::LumpedModel::fromVehicle(vehicle, table, parameters);
  const double idle = lumped.idleFraction();
  std::printf(
      "rung,cell_mm,step_ms,damping,start,thrust,threshold_shipped_table_ms,threshold_lumped_ms,threshold_ms,pulse_ms,"
      "snap_lumped_ms,snap_ms,"
      "peak_lumped_mm,peak_mm,trials,seconds\n");
  for (const double cell : cells) {
    const double begin = solver::secondsNow();
    axis.cell_size = cell;
    const motion::AxisVehicle soft(vehicle, parameters, trial, axis);
    const rom::LumpedModel own = rom::LumpedModel::fromVehicle(vehicle, soft.staticTable(), parameters);
    for (const Case& c : {Case{Mode::FIXED_WING, 0.5}, Case{Mode::QUADROTOR, 1.0}}) {
      const auto lumpedThreshold = [&](const rom::LumpedModel& model) {
        const auto snaps = [&](double d) { return model.predict(c.start, c.fraction, d, trial).snapped; };
        double first = 0.005;
        while (!snaps(first) && first < 1.5) first += 0.005;
        return threshold(first - 0.005, first, snaps);
      };
      const double shipped = lumpedThreshold(lumped), expected = lumpedThreshold(own);
      int trials = 0;
      const auto inTime = [&](double duration) {
        motion::Stepper stepper(soft.problem(), motion::Scheme(motion::SchemeKind::MIDPOINT), steps);
        motion::AxisRun run;
        motion::runTrial(soft, stepper, motion::AxisTrial::of(c.start, c.fraction, duration, parameters, idle, trial),
                         run);
        ++trials;
        return run.outcome;
      };
      double low = expected - 0.004, high = expected + 0.004;
      while (inTime(low).snapped) low -= 0.004;
      while (!inTime(high).snapped) high += 0.004;
      const double found = threshold(low, high, [&](double d) { return inTime(d).snapped; });
      const double pulse = expected + 0.02;
      const rom::SnapPrediction a = own.predict(c.start, c.fraction, pulse, trial);
      const motion::AxisOutcome b = inTime(pulse);
      std::printf("%s,%.2f,%.2f,%s,%s,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f,%.3f,%.3f,%d,%.0f\n",
                  axis.dimension == 2 ? "planar" : "volumetric", 1e3 * cell, 1e3 * steps.largest_step,
                  motion::dampingName(axis.damping).c_str(), vehicle::modeName(c.start).c_str(), c.fraction,
                  1e3 * shipped, 1e3 * expected, 1e3 * found, 1e3 * pulse, 1e3 * a.snap_time, 1e3 * b.snap_time,
                  1e3 * a.peak_travel, 1e3 * b.peak_travel, trials, solver::secondsNow() - begin);
      std::fflush(stdout);
    }
  }
  return 0;
}
