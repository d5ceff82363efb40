#include "snapwing/vehicle/vehicle_parameters.h"

#include <algorithm>
#include <cmath>

#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"

namespace snapwing::vehicle {

namespace {

struct Uncertain {
  std::string name;
  common::Quantity (*of)(const Vehicle&);
};

// The order is the order of the coordinates: append only, recorded plans and seeds depend on it.
const std::vector<Uncertain>& uncertain() {
  static const std::vector<Uncertain> list = {
      {"masses.total", [](const Vehicle& v) { return v.masses.total; }},
      {"masses.centre", [](const Vehicle& v) { return v.masses.centre; }},
      {"arm.force_scale", [](const Vehicle& v) { return v.arm.force_scale; }},
      {"damping_ratio", [](const Vehicle& v) { return v.damping_ratio; }},
      {"rotors.max_thrust", [](const Vehicle& v) { return v.rotors.max_thrust; }},
      {"rotors.time_constant_up", [](const Vehicle& v) { return v.rotors.time_constant_up; }},
      {"rotors.time_constant_down", [](const Vehicle& v) { return v.rotors.time_constant_down; }},
      {"rotors.quadratic_share", [](const Vehicle& v) { return v.rotors.quadratic_share; }},
      {"radio.latency", [](const Vehicle& v) { return v.radio.latency; }},
      {"drag.air_density", [](const Vehicle& v) { return v.drag.air_density; }},
      {"drag.ring_cda", [](const Vehicle& v) { return v.drag.ring_cda; }},
      {"drag.centre_cda", [](const Vehicle& v) { return v.drag.centre_cda; }},
      {"boom.length", [](const Vehicle& v) { return v.boom.length; }},
      {"boom.inertia", [](const Vehicle& v) { return v.boom.inertia; }},
      {"boom.cda", [](const Vehicle& v) { return v.boom.cda; }},
      {"boom.friction", [](const Vehicle& v) { return v.boom.friction; }},
      {"wing.inertia_scale", [](const Vehicle& v) { return v.wing.inertia_scale; }},
      {"wing.friction_scale", [](const Vehicle& v) { return v.wing.friction_scale; }},
  };
  return list;
}

// Stiffness of one arm at the table's second equilibrium, where the force rises through zero.
double secondStiffness(const ForceTable& table) {
  const CurveFeatures features = curveFeatures(table);
  if (!features.bistable) throw common::Error("force table has no second equilibrium; damping ratio has no meaning");
  const auto above = std::upper_bound(table.travel.begin(), table.travel.end(), features.second_travel);
  const auto k = std::clamp<std::ptrdiff_t>(above - table.travel.begin() - 1, 0, table.travel.size() - 2);
  const double h = table.travel[k + 1] - table.travel[k];
  const double t = (features.second_travel - table.travel[k]) / h;
  // Slope of the cubic through both forces and stiffnesses.
  const double stiffness = 6.0 * t * (1.0 - t) * (table.force[k + 1] - table.force[k]) / h +
                           (1.0 - t) * (1.0 - 3.0 * t) * table.stiffness[k] +
                           t * (3.0 * t - 2.0) * table.stiffness[k + 1];
  if (!(stiffness > 0))
    throw common::Error("stiffness at the second equilibrium is not positive; refine the force table");
  return stiffness;
}

}  // namespace

const std::vector<std::string>& uncertainNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Uncertain& item : uncertain()) list.push_back(item.name);
    return list;
  }();
  return names;
}

VehicleParameters realise(const Vehicle& vehicle, const ForceTable& table, const std::vector<double>& xi) {
  const auto& list = uncertain();
  if (!xi.empty() && xi.size() != list.size()) {
    throw common::Error("realise: " + std::to_string(xi.size()) + " coordinates; allowed: none or " +
                        std::to_string(list.size()));
  }
  std::vector<double> x(list.size());
  for (std::size_t i = 0; i < list.size(); ++i) {
    const double coordinate = xi.empty() ? 0.0 : xi[i];
    if (!(coordinate >= -1.0 && coordinate <= 1.0)) {
      throw common::Error("realise: coordinate of " + list[i].name + " is " + common::toText(coordinate) +
                          "; allowed: -1 .. 1");
    }
    const common::Quantity quantity = list[i].of(vehicle);
    x[i] = quantity.value + coordinate * quantity.plus_minus;
  }
  enum {
    TOTAL,
    CENTRE,
    SCALE,
    RATIO,
    THRUST,
    UP,
    DOWN,
    SHARE,
    LATENCY,
    AIR,
    RING,
    MIDDLE,
    LENGTH,
    INERTIA,
    BOOM,
    RUB,
    WING_INERTIA,
    WING_FRICTION
  };
  VehicleParameters p;
  p.centre_mass = x[CENTRE];
  p.ring_mass = x[TOTAL] - x[CENTRE];
  // The arms' mass is part of the ring side's; K and S of the table say how it moves.
  const double arms = table.arm_count * table.mass;
  if (!(p.ring_mass > arms)) {
    throw common::Error("masses.centre is " + std::to_string(p.centre_mass) + " kg of masses.total " +
                        std::to_string(x[TOTAL]) +
                        " kg at a point of the uncertainty; allowed: less by more than the arms' mass, " +
                        std::to_string(arms) + " kg");
  }
  p.force_scale = x[SCALE];
  const double stiffness = table.arm_count * p.force_scale * secondStiffness(table);
  const double relative_mass = p.ring_mass * p.centre_mass / (p.ring_mass + p.centre_mass);
  p.damping = 2.0 * x[RATIO] * std::sqrt(stiffness * relative_mass);
  p.max_thrust = vehicle.rotors.count * x[THRUST];
  p.time_constant_up = x[UP];
  p.time_constant_down = x[DOWN];
  p.quadratic_share = x[SHARE];
  p.latency = x[LATENCY];
  p.ring_drag = 0.5 * x[AIR] * x[RING];
  p.centre_drag = 0.5 * x[AIR] * x[MIDDLE];
  p.boom_mass = x[INERTIA] / (x[LENGTH] * x[LENGTH]);
  p.boom_drag = 0.5 * x[AIR] * x[BOOM];
  p.boom_friction = x[RUB];
  p.wing_inertia = x[WING_INERTIA];
  p.wing_friction = x[WING_FRICTION];
  return p;
}

}  // namespace snapwing::vehicle
