#include "snapwing/rom/ensemble.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>
#include <string>

#include "ensemble_run.h"
#include "snapwing/common/error.h"
#include "snapwing/common/require.h"

namespace snapwing::rom {

namespace {

const common::Require require("ensemble");
static_assert(Ensemble::SIDE_BY_SIDE == LANES, "the header says how many go together");

}  // namespace

struct Ensemble::Data {
  VehicleCurves curves;
  vehicle::Radio radio;
  EnsembleSettings settings;
  UniformCurves grid;
  std::vector<vehicle::VehicleParameters> vehicles;
  /// Made when first needed, without and with wings.
  mutable std::mutex guard;
  mutable std::unique_ptr<const BranchTable> branches[2];

  Data(const VehicleCurves& of, const vehicle::Radio& with, const EnsembleSettings& s);
  const BranchTable& branchesOf(bool wings) const;
  std::vector<int> byDamping(int first, int count) const;
  EnsembleOutcome askAgain(int vehicle, vehicle::Mode start, vehicle::Pulse pulse, const std::vector<double>& durations,
                           const vehicle::Trial& trial) const;
  EnsembleScene sceneOf(vehicle::Mode start, const vehicle::Trial& trial) const;
};

namespace {

UniformCurves gridOf(const VehicleCurves& curves) {
  const EnergySpline& spline = curves.spline();
  double low = spline.lowest(), high = spline.highest();
  if (curves.wing()) {
    low = std::min(low, curves.wing()->lowest());
    high = std::max(high, curves.wing()->highest());
  }
  return UniformCurves(spline, low, high, curves.arms(), curves.wing());
}

}  // namespace

Ensemble::Data::Data(const VehicleCurves& of, const vehicle::Radio& with, const EnsembleSettings& s)
    : curves(of), radio(with), settings(s), grid(gridOf(of)) {}

Ensemble::Ensemble(const VehicleCurves& curves, const vehicle::Radio& radio, const EnsembleSettings& settings) {
  settings.model.validate();
  if (!curves.spline().equilibria().bistable) {
    throw common::Error("the force curve is not bistable: there is no second mode");
  }
  data_ = std::make_unique<Data>(curves, radio, settings);
}

Ensemble::~Ensemble() = default;
Ensemble::Ensemble(Ensemble&&) noexcept = default;

void Ensemble::add(const vehicle::VehicleParameters& parameters) {
  data_->curves.model(data_->radio, parameters);  // checks them
  data_->vehicles.push_back(parameters);
  data_->branches[true].reset();  // its range may have become wider
}

int Ensemble::size() const { return static_cast<int>(data_->vehicles.size()); }

namespace {

void setLane(const vehicle::VehicleParameters& p, const vehicle::Radio& radio, const vehicle::Trial& trial,
             const vehicle::Pulse& pulse, double duration, int l, EnsembleBlock* a) {
  const bool boom = trial.mount == vehicle::Mount::BOOM, held = trial.mount == vehicle::Mount::HELD;
  const auto thrustOf = [&](double throttle) { return vehicle::thrustFraction(p.quadratic_share, radio, throttle); };
  const double idle = thrustOf(0.0);
  a->ring_mass.lane[l] = p.ring_mass + (boom ? p.boom_mass : 0.0);
  a->centre_mass.lane[l] = p.centre_mass;
  a->all.lane[l] = a->ring_mass.lane[l] + p.centre_mass;
  a->all_inverse.lane[l] = held ? 0.0 : 1.0 / a->all.lane[l];
  a->force_scale.lane[l] = p.force_scale;
  a->damping.lane[l] = p.damping;
  a->max_thrust.lane[l] = p.max_thrust;
  a->time_up.lane[l] = p.time_constant_up;
  a->time_down.lane[l] = p.time_constant_down;
  a->latency.lane[l] = p.latency;
  a->ring_drag.lane[l] = p.ring_drag + (boom ? p.boom_drag : 0.0);
  a->centre_drag.lane[l] = p.centre_drag;
  a->boom_friction.lane[l] = boom ? p.boom_friction : 0.0;
  a->wing_inertia.lane[l] = p.wing_inertia;
  a->wing_friction.lane[l] = p.wing_friction;
  a->before.lane[l] = trial.initial_thrust_fraction.value_or(idle);
  a->during.lane[l] = thrustOf(pulse.throttle);
  a->hold.lane[l] = thrustOf(pulse.hold_throttle);
  a->after.lane[l] = trial.final_thrust_fraction.value_or(idle);
  a->duration.lane[l] = duration;
  a->hold_duration.lane[l] = pulse.hold_duration;
}

}  // namespace

const BranchTable& Ensemble::Data::branchesOf(bool wings) const {
  const std::lock_guard<std::mutex> lock(guard);
  std::unique_ptr<const BranchTable>& table = branches[wings];
  if (!table) {
    double low = INFINITY, high = 0;
    for (const vehicle::VehicleParameters& p : vehicles) {
      low = std::min(low, p.wing_inertia);
      high = std::max(high, p.wing_inertia);
    }
    table = std::make_unique<const BranchTable>(grid, curves.spline().equilibria(), wings, low, high);
  }
  return *table;
}

EnsembleScene Ensemble::Data::sceneOf(vehicle::Mode start, const vehicle::Trial& trial) const {
  const bool wings = wingsAct(trial, curves.wing() != nullptr);
  EnsembleScene scene{grid.view(), branchesOf(wings).view(), curves.spline().equilibria(), start};
  scene.held = trial.mount == vehicle::Mount::HELD;
  scene.on_boom = trial.mount == vehicle::Mount::BOOM;
  scene.arms = curves.arms() != nullptr;
  scene.wings = wings;
  scene.gravity = trial.gravity;
  scene.push = trial.push;
  scene.initial_speed = trial.initial_speed;
  scene.horizon = trial.horizon;
  scene.friction_speed = settings.model.friction_speed;
  scene.settled_share = settings.model.settled_share;
  scene.step = settings.model.step;
  return scene;
}

/// Those that go side by side wait for the last of them, and who is damped least rings longest.
std::vector<int> Ensemble::Data::byDamping(int first, int count) const {
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), first);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return vehicles[a].damping < vehicles[b].damping; });
  return order;
}

EnsembleOutcome Ensemble::Data::askAgain(int vehicle, vehicle::Mode start, vehicle::Pulse pulse,
                                         const std::vector<double>& durations, const vehicle::Trial& trial) const {
  LumpedSettings s = settings.model;
  s.step = std::min(s.step, 1e-3);
  pulse.duration = durations[vehicle];
  const SnapPrediction told = curves.model(radio, vehicles[vehicle], s).predict(start, pulse, radio, trial);
  return {told.energy_margin, told.peak_travel, told.snapped};
}

std::vector<EnsembleOutcome> Ensemble::predict(vehicle::Mode start, const vehicle::Pulse& pulse,
                                               const std::vector<double>& durations, const vehicle::Trial& trial,
                                               int first, int count) const {
  const Data& d = *data_;
  trial.validate();
  if (start == vehicle::Mode::UNKNOWN) throw common::Error("ensemble: the start mode is unknown; allowed: F or Q");
  require(pulse.throttle >= 0 && pulse.throttle <= 1, "throttle", pulse.throttle, "0 .. 1");
  pulse.validateHold();
  require(durations.size() == d.vehicles.size(), "number of durations", durations.size(), "one per vehicle");
  require(first >= 0 && count >= 0 && first + count <= size(), "end of the range", first + count, "up to the size");
  for (const double duration : durations) require(duration >= 0 && duration <= 60, "duration", duration, "0 .. 60 s");
  const EnsembleScene scene = d.sceneOf(start, trial);
  std::vector<EnsembleOutcome> outcomes(count);
  const RunBlock run = d.settings.vectors == Vectors::PLAIN ? runBlockPlain : widestRunBlock();
  const std::vector<int> order = d.byDamping(first, count);
  for (int begin = 0; begin < count; begin += LANES) {
    EnsembleBlock block;
    for (int l = 0; l < LANES; ++l) {
      const int i = order[std::min(begin + l, count - 1)];
      setLane(d.vehicles[i], d.radio, trial, pulse, durations[i], l, &block);
    }
    EnsembleResult results[LANES];
    run(scene, block, results);
    for (int l = 0; l < LANES && begin + l < count; ++l) {
      const int i = order[begin + l];
      EnsembleOutcome& out = outcomes[i - first];
      out = {results[l].margin, results[l].peak_travel, results[l].snapped};
      // No number: too violent for explicit steps. The implicit integrator is asked.
      const bool lost = !std::isfinite(out.energy_margin) || !std::isfinite(out.peak_travel);
      if (lost) out = d.askAgain(i, start, pulse, durations, trial);
    }
  }
  return outcomes;
}

}  // namespace snapwing::rom
