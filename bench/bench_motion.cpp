// The shipped vehicle on the boom, wings off, nominal: the shortest pulses that switch, by one soft arm in time, over
// cells and steps, beside the lumped model on the static curve of the same cells, and on the vehicle's shipped table.
// Makes docs/motion_thresholds.csv.
// usage: bench_motion [cell size in mm]... [step=MS] [volumetric] [kernel=NAME] [damping=LAW] [resolution=MS]
//   [arm_mass=SHARE] [lumped] [F] [Q]
// arm_mass: of the file's, for the arms' inertia alone; the vehicle's whole mass stays. The search begins at the lumped
// model's shortest pulse on the same curve; F, Q: of that start mode alone; lumped: no soft arm in time.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "snapwing/common/bisection.h"
#include "snapwing/common/error.h"
#include "snapwing/scene/rung.h"
#include "snapwing/validation/rung_trial.h"
#include "snapwing/vehicle/table_origin.h"
#include "support/paths.h"

using namespace snapwing;
using vehicle::Mode;

namespace {

vehicle::Trial boomFromRest() {
  vehicle::Trial trial;
  trial.mount = vehicle::Mount::BOOM;
  trial.wings = false;
  trial.initial_thrust_fraction = 0.0;
  return trial;
}

struct Asked {
  validation::RungTrial trial;
  std::vector<double> cells;  // [m]
  std::vector<std::pair<Mode, double>> cases;
  double arm_mass = 1;  // share
  bool lumped = false;  // no soft arm in time
};

Asked readOptions(int argc, char** argv) {
  Asked out;
  out.trial.rung = motion::TrialRung::PLANAR;
  out.trial.trial = boomFromRest();
  out.trial.resolution = 2e-5;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    const auto value = [&](const char* key) {
      const std::string head = std::string(key) + "=";
      return word.rfind(head, 0) == 0 ? word.substr(head.size()) : std::string();
    };
    if (word == "volumetric") {
      out.trial.rung = motion::TrialRung::VOLUMETRIC;
    } else if (word == "lumped") {
      out.lumped = true;
    } else if (word == "F") {
      out.cases.emplace_back(Mode::FIXED_WING, 0.5);
    } else if (word == "Q") {
      out.cases.emplace_back(Mode::QUADROTOR, 1.0);
    } else if (!value("step").empty()) {
      out.trial.step = 1e-3 * std::atof(value("step").c_str());
    } else if (!value("resolution").empty()) {
      out.trial.resolution = 1e-3 * std::atof(value("resolution").c_str());
    } else if (!value("arm_mass").empty()) {
      out.arm_mass = std::atof(value("arm_mass").c_str());
    } else if (!value("kernel").empty()) {
      out.trial.kernel = scene::kernelFromName(value("kernel"));
    } else if (!value("damping").empty()) {
      out.trial.damping = motion::dampingFromName(value("damping"));
    } else {
      out.cells.push_back(1e-3 * std::atof(word.c_str()));
    }
  }
  if (out.cases.empty()) out.cases = {{Mode::FIXED_WING, 0.5}, {Mode::QUADROTOR, 1.0}};
  return out;
}

/// Stick that asks for a share of the full thrust.
double throttleFor(const vehicle::Vehicle& vehicle, double quadratic_share, double fraction) {
  if (fraction >= 1) return 1;
  return common::bisect(
      [&](double stick) { return vehicle::thrustFraction(quadratic_share, vehicle.radio, stick) - fraction; }, 0.0, 1.0,
      60);
}

/// The arm of these cells as the runner has it, as a table.
vehicle::ForceTable curveOf(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table,
                            const validation::RungTrial& trial) {
  motion::AxisSettings axis;
  axis.dimension = trial.rung == motion::TrialRung::VOLUMETRIC ? 3 : 2;
  axis.cell_size = trial.cell_size;
  axis.kernel = trial.kernel;
  axis.coarsening = mpm::Coarsening::STIFFNESS;
  return motion::AxisVehicle(vehicle, vehicle::realise(vehicle, table), trial.trial, axis).staticTable();
}

void print(const validation::RungTrial& t, double shipped, double lumped, const validation::RungOutcome& found,
           const validation::RungOutcome& expected, const validation::RungOutcome& longer) {
  const bool planar = t.rung == motion::TrialRung::PLANAR;
  std::printf("%s,%s,%.2f,%.2f,%s,%s,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f,%.3f,%.3f,%.0f\n",
              planar ? "planar" : "volumetric", scene::kernelName(t.kernel).c_str(), 1e3 * t.cell_size, 1e3 * t.step,
              motion::dampingName(t.damping).c_str(), vehicle::modeName(t.start).c_str(), 1e3 * t.resolution,
              1e3 * shipped, 1e3 * lumped, 1e3 * found.threshold, 1e3 * t.pulse.duration, 1e3 * expected.snap_time,
              1e3 * longer.snap_time, 1e3 * expected.peak_travel, 1e3 * longer.peak_travel,
              found.cpu_seconds + longer.cpu_seconds);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  Asked asked = readOptions(argc, argv);
  vehicle::Vehicle vehicle = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  const vehicle::ForceTable table = vehicle::armTableOf(vehicle);
  vehicle.material.mass_density.value *= asked.arm_mass;
  const vehicle::VehicleParameters parameters = vehicle::realise(vehicle, table);
  const std::optional<vehicle::WingTable> no_wing;
  const validation::RungRunner runner(vehicle, table, no_wing);
  std::printf(
      "rung,kernel,cell_mm,step_ms,damping,start,resolution_ms,threshold_shipped_table_ms,threshold_lumped_ms,"
      "threshold_ms,pulse_ms,snap_lumped_ms,snap_ms,peak_lumped_mm,peak_mm,cpu_seconds\n");
  for (const double cell : asked.cells) {
    validation::RungTrial trial = asked.trial;
    trial.cell_size = cell;
    vehicle::ForceTable own;
    try {
      own = curveOf(vehicle, table, trial);
    } catch (const common::Error& e) {  // cells so coarse that the arm has no curve
      std::fprintf(stderr, "%.2f mm: %s\n", 1e3 * cell, e.what());
      continue;
    }
    for (const auto& [start, fraction] : asked.cases) {
      trial.start = start;
      trial.pulse.throttle = throttleFor(vehicle, parameters.quadratic_share, fraction);
      validation::RungTrial lumped = trial;
      lumped.rung = motion::TrialRung::LUMPED;
      lumped.resolution = 2e-5;
      const double shipped = runner.shortest(lumped).threshold;
      lumped.curve = own;
      const double expected = runner.shortest(lumped).threshold;
      trial.near = expected;
      trial.pulse.duration = lumped.pulse.duration = std::round(1e3 * expected + 20) / 1e3;
      if (asked.lumped) {
        print(trial, shipped, expected, {}, runner.run(lumped), {});
        continue;
      }
      const validation::RungOutcome found = runner.shortest(trial);
      if (!found.failure.empty()) {
        std::fprintf(stderr, "%.2f mm, from %s: %s\n", 1e3 * cell, vehicle::modeName(start).c_str(),
                     found.failure.c_str());
        continue;
      }
      print(trial, shipped, expected, found, runner.run(lumped), runner.run(trial));
    }
  }
  return 0;
}
