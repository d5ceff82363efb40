// The ensemble against the lumped model, as tables: microseconds a prediction of all vehicles, by the widest vectors of
// the processor and by plain ones, and the error of the margins, of the first of them.
// usage: bench_ensemble [COUNT [TRUTHS [STEP_MS]]]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "snapwing/planning/uncertainty_points.h"
#include "snapwing/rom/ensemble.h"
#include "snapwing/vehicle/table_origin.h"
#include "support/paths.h"

namespace {

using namespace snapwing;

double cpuSeconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return t.tv_sec + 1e-9 * t.tv_nsec;
}

struct Case {
  const char* name;
  vehicle::Mode start;
  vehicle::Mount mount;
  bool wings;
  vehicle::Pulse pulse;
};

struct Vehicles {
  std::vector<vehicle::VehicleParameters> parameters;
  std::vector<double> errors;  ///< of the pulse's length [s]
};

Vehicles draw(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table, int count) {
  Vehicles drawn;
  const int n = static_cast<int>(vehicle::uncertainNames().size()) + 1;
  for (const auto& point : planning::sobolPoints(n, count, 1)) {
    drawn.parameters.push_back(vehicle::realise(vehicle, table, std::vector<double>(point.begin(), point.end() - 1)));
    drawn.errors.push_back(point.back() / vehicle.radio.frame_rate);
  }
  return drawn;
}

struct Margins {
  std::vector<double> margins;
  double seconds = 0;  ///< of one core, per vehicle
};

Margins byLumped(const rom::VehicleCurves& curves, const vehicle::Vehicle& vehicle, const Vehicles& drawn,
                 const Case& c, const vehicle::Trial& trial, double step, int count) {
  rom::LumpedSettings settings;
  settings.step = step;
  Margins result;
  for (int i = 0; i < count; ++i) {
    const rom::LumpedModel model = curves.model(vehicle.radio, drawn.parameters[i], settings);
    const vehicle::Pulse pulse{c.pulse.throttle, c.pulse.duration + drawn.errors[i]};
    const double begin = cpuSeconds();
    result.margins.push_back(model.predict(c.start, pulse, vehicle.radio, trial).energy_margin);
    result.seconds += (cpuSeconds() - begin) / count;
  }
  return result;
}

Margins byEnsemble(const rom::VehicleCurves& curves, const vehicle::Vehicle& vehicle, const Vehicles& drawn,
                   const Case& c, const vehicle::Trial& trial, double step, rom::Vectors vectors) {
  rom::EnsembleSettings settings;
  settings.vectors = vectors;
  settings.model.step = step;
  rom::Ensemble ensemble(curves, vehicle.radio, settings);
  std::vector<double> durations;
  for (std::size_t i = 0; i < drawn.parameters.size(); ++i) {
    ensemble.add(drawn.parameters[i]);
    durations.push_back(c.pulse.duration + drawn.errors[i]);
  }
  Margins result;
  result.seconds = INFINITY;
  for (int repeat = 0; repeat < 5; ++repeat) {
    const double begin = cpuSeconds();
    const auto outcomes = ensemble.predict(c.start, c.pulse, durations, trial, 0, ensemble.size());
    result.seconds = std::min(result.seconds, (cpuSeconds() - begin) / ensemble.size());
    result.margins.clear();
    for (const auto& outcome : outcomes) result.margins.push_back(outcome.energy_margin);
  }
  return result;
}

void compare(const char* name, const Margins& tried, const Margins& truth) {
  double squares = 0, worst = 0;
  int flips = 0;
  for (std::size_t i = 0; i < truth.margins.size(); ++i) {
    const double error = std::abs(tried.margins[i] - truth.margins[i]);
    squares += error * error;
    worst = std::max(worst, error);
    flips += (tried.margins[i] > 0) != (truth.margins[i] > 0) && std::abs(truth.margins[i]) > 5e-3;
  }
  std::printf("| %s | %.1f | %.2g | %.2g | %d | %.4f |\n", name, 1e6 * tried.seconds,
              std::sqrt(squares / truth.margins.size()), worst, flips,
              *std::min_element(tried.margins.begin(), tried.margins.begin() + truth.margins.size()));
}

}  // namespace

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 10000;
  const int truths = std::min(count, argc > 2 ? std::atoi(argv[2]) : 512);
  const double step = argc > 3 ? 1e-3 * std::atof(argv[3]) : rom::EnsembleSettings().model.step;
  const auto vehicle = vehicle::loadVehicle(snapwing::test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  const auto table = vehicle::armTableOf(vehicle);
  const rom::VehicleCurves curves(table, vehicle::wingTableOf(vehicle, table));
  const Vehicles drawn = draw(vehicle, table, count);
  const auto F = vehicle::Mode::FIXED_WING, Q = vehicle::Mode::QUADROTOR;
  const Case cases[] = {{"boom F", F, vehicle::Mount::BOOM, false, {0.61, 0.16}},
                        {"boom Q", Q, vehicle::Mount::BOOM, false, {1.0, 0.60}},
                        {"free F, no wings", F, vehicle::Mount::FREE, false, {0.61, 0.16}},
                        {"free Q, no wings", Q, vehicle::Mount::FREE, false, {1.0, 0.60}},
                        {"free F, wings", F, vehicle::Mount::FREE, true, {0.61, 0.20}},
                        {"free Q, wings", Q, vehicle::Mount::FREE, true, {1.0, 0.75}}};
  for (const Case& c : cases) {
    vehicle::Trial trial;
    trial.mount = c.mount;
    trial.wings = c.wings;
    std::printf("\n%s, throttle %.2f for %.2f s: %d vehicles, margins of the first %d\n\n", c.name, c.pulse.throttle,
                c.pulse.duration, count, truths);
    std::printf(
        "| | us a prediction | RMS of margin | largest | other sign | worst margin |\n|---|---|---|---|---|---|\n");
    const Margins truth = byLumped(curves, vehicle, drawn, c, trial, 1e-4, truths);
    compare("lumped .1 ms", truth, truth);
    compare("lumped 1 ms", byLumped(curves, vehicle, drawn, c, trial, 1e-3, truths), truth);
    compare("lumped 2 ms", byLumped(curves, vehicle, drawn, c, trial, 2e-3, truths), truth);
    compare("ensemble", byEnsemble(curves, vehicle, drawn, c, trial, step, rom::Vectors::WIDEST), truth);
    compare("ensemble, plain vectors", byEnsemble(curves, vehicle, drawn, c, trial, step, rom::Vectors::PLAIN), truth);
  }
  return 0;
}
