#include "snapwing/planning/accident_margins.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "snapwing/vehicle/pulse.h"

namespace snapwing::planning {

namespace {

constexpr double GRAVITY = 9.81;

/// Largest x in [0, top] that survives, by bisection; infinity if even top does.
template <typename Survives>
double largestSurvived(double top, const Survives& survives) {
  if (survives(top)) return std::numeric_limits<double>::infinity();
  double low = 0, high = top;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (survives(middle) ? low : high) = middle;
  }
  return low;
}

bool stays(const rom::LumpedModel& model, vehicle::Mode mode, double fraction, double duration,
           const vehicle::Trial& trial) {
  return model.predict(mode, fraction, duration, trial).end_mode == mode;
}

}  // namespace

std::vector<AccidentMargin> accidentMargins(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table,
                                            const std::optional<vehicle::WingTable>& wing) {
  const rom::LumpedModel model =
      rom::LumpedModel::fromVehicle(vehicle, table, vehicle::realise(vehicle, table), {}, wing);
  const vehicle::VehicleParameters& p = model.parameters();
  const double full = p.max_thrust;
  const double weight = (p.ring_mass + p.centre_mass) * GRAVITY;
  const vehicle::Mode F = vehicle::Mode::FIXED_WING, Q = vehicle::Mode::QUADROTOR;
  vehicle::Trial level;  // axis level, from rest
  vehicle::Trial upright;
  upright.gravity = GRAVITY;
  upright.horizon = 1.0;
  std::vector<AccidentMargin> list;

  AccidentMargin thrust{"sudden thrust in F", "throttle jumps from idle and stays for half a second", F, "N"};
  thrust.limit = full * largestSurvived(1.0, [&](double f) {
                   vehicle::Trial trial = level;
                   trial.final_thrust_fraction = f;  // stays: judged while it acts
                   return stays(model, F, f, 0.5, trial);
                 });
  thrust.occurs = weight;
  list.push_back(thrust);

  AccidentMargin cut{"hover thrust cut in Q", "steady thrust falls to idle at once, vehicle at rest", Q, "N"};
  cut.limit = full * largestSurvived(1.0, [&](double f) {
                vehicle::Trial trial = level;
                trial.initial_thrust_fraction = f;
                return stays(model, Q, model.idleFraction(), 0.0, trial);
              });
  cut.occurs = weight;
  list.push_back(cut);

  AccidentMargin climb{"thrust cut while climbing in Q", "steady climb along the axis, then motors at idle", Q, "m/s"};
  climb.limit = largestSurvived(40.0, [&](double speed) {
    vehicle::Trial trial = upright;
    trial.initial_speed = speed;
    const double drag = (p.ring_drag + p.centre_drag) * speed * speed;
    trial.initial_thrust_fraction = std::min(1.0, (weight + drag) / full);
    return stays(model, Q, model.idleFraction(), 0.0, trial);
  });
  climb.occurs = std::numeric_limits<double>::quiet_NaN();
  list.push_back(climb);

  vehicle::Trial grasped;
  grasped.mount = vehicle::Mount::HELD;
  const rom::LoadedBasins basins(model.potential(), model.inertiaOf(grasped));
  AccidentMargin held{"ring held upright in F", "the centre hangs in the arms with its weight", F, "N"};
  held.limit = basins.limit(F, GRAVITY);
  held.occurs = p.centre_mass * GRAVITY;
  list.push_back(held);

  AccidentMargin inverted{"ring held inverted in Q", "the centre's weight pulls it back to F", Q, "N"};
  inverted.limit = -basins.limit(Q, -GRAVITY);
  inverted.occurs = p.centre_mass * GRAVITY;
  list.push_back(inverted);

  AccidentMargin braked{"ring braked in Q", "a hand slows the ring down and the centre coasts on", Q, "m/s2"};
  braked.limit = largestSurvived(1000.0, [&](double b) { return -p.centre_mass * b > basins.limit(Q, -b); });
  braked.occurs = std::numeric_limits<double>::quiet_NaN();
  list.push_back(braked);

  for (AccidentMargin& margin : list) margin.holds = !(margin.occurs >= margin.limit);
  return list;
}

}  // namespace snapwing::planning
