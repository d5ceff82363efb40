#include "trials.h"

#include <cmath>
#include <cstdio>

#include "snapwing/common/error.h"
#include "snapwing/scene/arm_scene.h"
#include "snapwing/statics/scene_curve.h"

namespace snapwing::bench {

namespace {

vehicle::Trial boomFromRest() {
  vehicle::Trial trial;
  trial.mount = vehicle::Mount::BOOM;
  trial.initial_thrust_fraction = 0.0;
  return trial;
}

mpm::DensityField withoutLightCells(mpm::DensityField field, double least) {
  for (double& value : field.value) {
    if (value < least) value = -1;
  }
  return field;
}

/// Has the relative motion come to rest on a side that holds?
class EndRule {
 public:
  EndRule(const ArmBody& body, const rom::LumpedModel& model)
      : features_(vehicle::curveFeatures(body.table)), model_(model), trial_(boomFromRest()) {}
  bool ended(const SoftState& s, double demand) {
    const bool idle = std::abs(s.thrust / model_.parameters().max_thrust - demand) < 0.01;
    if (!idle || std::abs(s.travel_rate) > 0.06) since_ = s.time;
    if (s.time - since_ < 0.12) return false;
    if (s.travel < features_.barrier_travel - 0.012) return true;
    rom::LumpedState state;
    state.ring_speed = s.ring_speed;
    state.centre_speed = s.ring_speed - s.travel_rate;
    state.travel = s.travel;
    state.thrust = s.thrust;
    const rom::RelativeLoad load = model_.relativeLoad(state, trial_);
    const double coupled = model_.inertiaOf(trial_)->at(s.travel).coupled_mass;
    return s.travel > features_.valley_travel &&
           load.force - load.specific_force * coupled > 0.8 * features_.valley_force;
  }
  double barrier() const { return features_.barrier_travel; }

 private:
  vehicle::CurveFeatures features_;
  const rom::LumpedModel& model_;
  vehicle::Trial trial_;
  double since_ = 0;
};

}  // namespace

ArmBody::ArmBody(const vehicle::Vehicle& of, double cell_size, double least_density, double travel_step) : vehicle(of) {
  const vehicle::ArmSettings& a = vehicle.arm;
  mpm::DensityField design = mpm::loadDensityCsv(a.density_file, a.domain_length, a.domain_height);
  if (cell_size > 0) design = design.resampled(cell_size);
  scene::ArmSceneSettings settings;
  settings.from = -0.015;
  settings.to = 0.080;
  settings.step = travel_step;
  settings.back = false;
  const scene::Scene scene = scene::armScene(vehicle, withoutLightCells(design, least_density), settings);
  arm = scene::compileScene(scene, 1);
  const statics::SceneCurve curve = statics::traceScene(scene, *arm, {}, {});
  const statics::PathResult whole = curve.costs();
  if (whole.status != solver::SolveStatus::CONVERGED) throw common::Error("soft arm: " + whole.message);
  table = curve.table();
  table.arm_count = a.count;
  parameters = vehicle::realise(vehicle, table);
}

Outcome softTrial(const ArmBody& body, vehicle::Mode start, double fraction, double duration, double dt) {
  const vehicle::VehicleParameters& p = body.parameters;
  SoftArm soft(*body.arm, body.vehicle.material.mass_density.value, body.vehicle.arm.count, p, true);
  const rom::LumpedModel model = rom::LumpedModel::fromVehicle(body.vehicle, body.table, p);
  EndRule rule(body, model);
  const double second = vehicle::curveFeatures(body.table).second_travel;
  SoftState s = soft.start(start == vehicle::Mode::FIXED_WING ? 0.0 : second);
  Outcome out;
  out.peak = s.travel;
  const double idle = model.idleFraction(), begin = p.latency, end = begin + duration, last = end + 4.0;
  const std::pair<double, double> segments[] = {{begin, 0.0}, {end, fraction}, {last, idle}};
  for (const auto& [until, demand] : segments) {
    const int count = std::max(1, static_cast<int>(std::ceil((until - s.time) / dt - 1e-9)));
    const double each = (until - s.time) / count;
    for (int i = 0; i < count; ++i) {
      const SoftState before = s;
      if (!soft.step(&s, demand, each)) {
        out.failed = true;
        return out;
      }
      if ((before.travel < rule.barrier()) != (s.travel < rule.barrier())) {
        out.snap_time = before.time + each * (rule.barrier() - before.travel) / (s.travel - before.travel);
      }
      out.peak = std::max(out.peak, s.travel);
      if (until == last && rule.ended(s, demand)) {
        out.end = s.travel < rule.barrier() ? vehicle::Mode::FIXED_WING : vehicle::Mode::QUADROTOR;
        return out;
      }
    }
  }
  return out;
}

Outcome lumpedTrial(const rom::LumpedModel& model, vehicle::Mode start, double fraction, double duration) {
  const rom::SnapPrediction p = model.predict(start, fraction, duration, boomFromRest());
  Outcome out;
  out.end = p.end_mode;
  out.snap_time = p.snap_time;
  out.peak = p.peak_travel;
  return out;
}

double threshold(double low, double high, int halvings, const std::function<Outcome(double)>& trial,
                 vehicle::Mode start) {
  const auto switches = [&](double duration) {
    const Outcome outcome = trial(duration);
    std::fprintf(stderr, "  %.2f ms: %s\n", 1e3 * duration,
                 outcome.failed         ? "gave up"
                 : outcome.end == start ? "stays"
                                        : "switches");
    if (outcome.failed || outcome.end == vehicle::Mode::UNKNOWN) throw common::Error("soft arm: a trial did not end");
    return outcome.end != start;
  };
  const bool at_low = switches(low);
  if (at_low == switches(high)) return NAN;
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (low + high);
    (switches(middle) == at_low ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace snapwing::bench
