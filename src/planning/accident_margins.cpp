#include "snapwing/planning/accident_margins.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "snapwing/vehicle/pulse.h"

namespace snapwing::planning {

namespace {

constexpr double GRAVITY = 9.81;

/// Largest x in [0, top] that survives, by bisection; infinity if even top does.
/// @param step  of a search from below, where what is lost may come back beyond; 0: at once the whole
template <typename Survives>
double largestSurvived(double top, const Survives& survives, double step = 0) {
  double low = 0, high = step > 0 ? 0 : top;
  while (survives(high)) {
    if (high >= top) return std::numeric_limits<double>::infinity();
    low = high, high = std::min(top, high + step);
  }
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

/// Wind jumps by `wind` [m/s] against the thrust, while the vehicle is at rest under `fraction` of the full thrust.
bool staysInGust(const rom::LumpedModel& model, vehicle::Mode mode, double wind, double fraction,
                 vehicle::Trial trial) {
  constexpr double WATCHED = 1.5;  // [s]
  trial.initial_thrust_fraction = fraction;
  rom::LumpedState state = model.startState(mode, trial);
  // Seen from the air, the vehicle has begun to move.
  state.ring_speed += wind, state.centre_speed += wind;
  const double step = model.settings().step;
  for (int k = 0; k * step < WATCHED; ++k) state = model.step(state, fraction, step, trial);
  return (state.travel < model.potential().equilibria().barrier) == (mode == vehicle::Mode::FIXED_WING);
}

/// Both gusts of accidentMargins.
void addGusts(const rom::LumpedModel& model, double weight, std::vector<AccidentMargin>& list) {
  constexpr double STRONGEST = 40;  // [m/s]
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  vehicle::Trial upright;
  upright.gravity = GRAVITY;
  const vehicle::Mode F = vehicle::Mode::FIXED_WING, Q = vehicle::Mode::QUADROTOR;
  AccidentMargin hover{"gust against the thrust in Q", "wind from above begins at once on a hovering vehicle", Q,
                       "m/s"};
  hover.limit = largestSurvived(
      STRONGEST, [&](double w) { return staysInGust(model, Q, w, weight / model.parameters().max_thrust, upright); });
  AccidentMargin behind{"gust from behind in F", "wind along the thrust begins at once, axis level, motors at idle", F,
                        "m/s"};
  behind.limit =
      largestSurvived(STRONGEST, [&](double w) { return staysInGust(model, F, -w, model.idleFraction(), {}); });
  hover.occurs = behind.occurs = nothing;
  list.push_back(hover);
  list.push_back(behind);
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
  addGusts(model, weight, list);

  for (AccidentMargin& margin : list) margin.holds = !(margin.occurs >= margin.limit);
  return list;
}

std::vector<AccidentMargin> faultMargins(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table,
                                         const std::optional<vehicle::WingTable>& wing,
                                         const std::vector<AskedSwitch>& switches) {
  constexpr double STIFFEST = 4;  // times the others' stiffness more
  constexpr double STEP = 0.05;   // a pulse that is too weak for one arm may throw a stiffer one back and over
  const vehicle::VehicleParameters nominal = vehicle::realise(vehicle, table);
  const auto switchesWith = [&](const AskedSwitch& asked, const vehicle::VehicleParameters& p) {
    const rom::LumpedModel model = rom::LumpedModel::fromVehicle(vehicle, table, p, {}, wing);
    return model.predict(asked.start, asked.pulse, vehicle.radio, asked.trial).snapped;
  };
  AccidentMargin motor{"one weak motor", "share of its thrust that is missing in a switch", vehicle::Mode::UNKNOWN,
                       "1"};
  AccidentMargin arm{"one stiff arm", "share by which it is stiffer than the others in a switch",
                     vehicle::Mode::UNKNOWN, "1"};
  motor.limit = arm.limit = std::numeric_limits<double>::infinity();
  motor.occurs = vehicle.rotors.max_thrust.plus_minus / vehicle.rotors.max_thrust.value;
  arm.occurs = vehicle.arm.force_scale.plus_minus / vehicle.arm.force_scale.value;
  const auto note = [](AccidentMargin& margin, const AskedSwitch& asked, double limit) {
    const std::string way = asked.start == vehicle::Mode::FIXED_WING ? "F -> Q" : "Q -> F";
    margin.explanation += "; " + way + ": " + (std::isinf(limit) ? "no limit" : std::to_string(limit).substr(0, 5));
    if (limit < margin.limit || margin.mode == vehicle::Mode::UNKNOWN) margin.limit = limit, margin.mode = asked.start;
  };
  for (const AskedSwitch& asked : switches) {
    note(motor, asked,
         largestSurvived(
             1.0,
             [&](double missing) {
               vehicle::VehicleParameters p = nominal;
               p.max_thrust *= 1 - missing / vehicle.rotors.count;
               return switchesWith(asked, p);
             },
             STEP));
    note(arm, asked,
         largestSurvived(
             STIFFEST,
             [&](double more) {
               vehicle::VehicleParameters p = nominal;
               p.force_scale *= 1 + more / vehicle.arm.count;
               return switchesWith(asked, p);
             },
             STEP));
  }
  for (AccidentMargin* margin : {&motor, &arm}) {
    margin->explanation += "; tilt and moments are left out";
    margin->holds = !(margin->occurs >= margin->limit);
  }
  return {motor, arm};
}

}  // namespace snapwing::planning
