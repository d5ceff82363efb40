#include "snapwing/vehicle/vehicle.h"

#include <cmath>
#include <cstdio>
#include <utility>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"

namespace snapwing::vehicle {

namespace {

// Ranges are those of anything that could fly with such a mechanism: wide enough for other vehicles, narrow enough
// to catch a wrong unit (mm for m, MPa for Pa, grams for kg).
const common::Range MASS{0.01, 50.0};
const common::Range LENGTH{1e-4, 5.0};
const common::Range SHARE{0.0, 1.0};

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

Masses readMasses(common::SettingsReader reader) {
  Masses m;
  m.total = reader.quantity("total", "kg", MASS);
  m.centre = reader.quantity("centre", "kg", MASS);
  reader.finish();
  if (m.centre.high() >= m.total.low()) {
    reader.fail("centre", std::to_string(m.centre.high()) + " kg at most",
                "less than the least total mass, " + std::to_string(m.total.low()) + " kg");
  }
  return m;
}

Geometry readGeometry(common::SettingsReader reader) {
  Geometry g;
  g.ring_radius = reader.quantity("ring_radius", "m", LENGTH).value;
  g.ring_thickness = reader.quantity("ring_thickness", "m", LENGTH).value;
  g.ring_width = reader.quantity("ring_width", "m", LENGTH).value;
  g.housing_radius = reader.quantity("housing_radius", "m", LENGTH).value;
  g.housing_height = reader.quantity("housing_height", "m", LENGTH).value;
  g.axle_below_ring = reader.quantity("axle_below_ring", "m", {0.0, 1.0}).value;
  g.rotor_radius = reader.quantity("rotor_radius", "m", LENGTH).value;
  reader.finish();
  if (g.housing_radius >= g.ring_radius) {
    reader.fail("housing_radius", std::to_string(g.housing_radius) + " m", "less than ring_radius");
  }
  return g;
}

std::string metres(double value) { return number(value) + " m"; }

/// Pin and clamp must be where the L-shaped domain has material.
void checkShape(const ArmSettings& a, const common::SettingsReader& reader) {
  if (a.pin_x > a.leg_width && a.pin_y > a.bar_height) {
    reader.fail("pin_y", metres(a.pin_y) + " with pin_x " + metres(a.pin_x),
                "within the L: pin_x <= leg_width (" + metres(a.leg_width) + ") or pin_y <= bar_height (" +
                    metres(a.bar_height) + ")");
  }
  if (!(a.clamp_y_high - a.clamp_y_low >= LENGTH.low)) {
    reader.fail("clamp_y_high", metres(a.clamp_y_high),
                "above clamp_y_low, " + metres(a.clamp_y_low) + ", by at least " + metres(LENGTH.low));
  }
}

ArmSettings readArm(common::SettingsReader reader) {
  ArmSettings a;
  a.count = reader.integer("count", 1, 16);
  a.domain_length = reader.quantity("domain_length", "m", LENGTH).value;
  a.domain_height = reader.quantity("domain_height", "m", LENGTH).value;
  a.leg_width = reader.quantity("leg_width", "m", {LENGTH.low, a.domain_length}).value;
  a.bar_height = reader.quantity("bar_height", "m", {LENGTH.low, a.domain_height}).value;
  a.leg_thickness = reader.quantity("leg_thickness", "m", LENGTH).value;
  a.bar_thickness = reader.quantity("bar_thickness", "m", LENGTH).value;
  a.pin_x = reader.quantity("pin_x", "m", {0.0, a.domain_length}).value;
  a.pin_y = reader.quantity("pin_y", "m", {0.0, a.domain_height}).value;
  a.clamp_y_low = reader.quantity("clamp_y_low", "m", {0.0, a.domain_height}).value;
  a.clamp_y_high = reader.quantity("clamp_y_high", "m", {a.clamp_y_low, a.domain_height}).value;
  checkShape(a, reader);
  a.force_scale = reader.quantity("force_scale", "1", {0.01, 100.0});
  a.density_file = reader.resolvePath(reader.text("density_file"));
  a.table_file = reader.resolvePath(reader.text("table_file"));
  reader.finish();
  return a;
}

Relaxation readRelaxation(common::SettingsReader reader) {
  Relaxation out;
  out.modulus_is_fast = reader.choice("modulus", {"slow", "fast"}) == "fast";
  double sum = 0;
  for (common::SettingsReader& entry : reader.list("terms")) {
    Relaxation::Term term;
    term.share = entry.quantity("share", "1", {1e-6, 0.999999});
    term.time = entry.quantity("time", "s", {1e-6, 1e8});
    sum += term.share.value;
    if (!(sum < 1)) entry.fail("share", "makes the sum of the shares " + std::to_string(sum), "a sum below 1");
    entry.finish();
    out.terms.push_back(term);
  }
  if (out.terms.empty()) reader.fail("terms", "empty", "one or more terms, or no relaxation");
  reader.finish();
  return out;
}

Material readMaterial(common::SettingsReader reader) {
  Material m;
  m.youngs_modulus = reader.quantity("youngs_modulus", "Pa", {1e4, 1e12});
  m.poisson_ratio = reader.quantity("poisson_ratio", "1", {0.0, 0.4999});
  m.mass_density = reader.quantity("mass_density", "kg/m3", {10.0, 25e3});
  if (reader.has("relaxation")) m.relaxation = readRelaxation(reader.map("relaxation"));
  if (reader.has("strain_limit")) m.strain_limit = reader.quantity("strain_limit", "1", {1e-4, 100.0});
  reader.finish();
  return m;
}

Rotors readRotors(common::SettingsReader reader) {
  Rotors r;
  r.count = reader.integer("count", 1, 32);
  r.max_thrust = reader.quantity("max_thrust", "N", {0.01, 1000.0});
  r.time_constant_up = reader.quantity("time_constant_up", "s", {1e-4, 5.0});
  r.time_constant_down = reader.quantity("time_constant_down", "s", {1e-4, 5.0});
  r.quadratic_share = reader.quantity("quadratic_share", "1", SHARE);
  reader.finish();
  return r;
}

Battery readBattery(common::SettingsReader reader) {
  Battery b;
  b.cells = reader.integer("cells", 1, 24);
  b.capacity = reader.quantity("capacity", "A s", {1.0, 1e6});
  b.voltage = reader.quantity("voltage", "V", {1.0, 120.0});
  reader.finish();
  return b;
}

Drag readDrag(common::SettingsReader reader) {
  Drag d;
  d.air_density = reader.quantity("air_density", "kg/m3", {0.1, 2.0});
  d.ring_cda = reader.quantity("ring_cda", "m2", {0.0, 10.0});
  d.centre_cda = reader.quantity("centre_cda", "m2", {0.0, 10.0});
  reader.finish();
  return d;
}

Boom readBoom(common::SettingsReader reader) {
  Boom b;
  b.given = true;
  b.length = reader.quantity("length", "m", {0.05, 20.0});
  b.inertia = reader.quantity("inertia", "kg m2", {0.0, 1000.0});
  b.cda = reader.quantity("cda", "m2", {0.0, 10.0});
  b.friction = reader.quantity("friction", "N", {0.0, 100.0});
  reader.finish();
  return b;
}

Radio readRadio(common::SettingsReader reader) {
  const common::Range pulse{885.0, 2115.0};
  Radio r;
  r.frame_rate = reader.quantity("frame_rate", "Hz", {20.0, 1000.0}).value;
  r.latency = reader.quantity("latency", "s", {0.0, 1.0});
  r.throttle_low = reader.quantity("throttle_low", "us", pulse).value;
  r.throttle_high = reader.quantity("throttle_high", "us", pulse).value;
  if (!(r.throttle_high > r.throttle_low)) {
    reader.fail("throttle_high", number(r.throttle_high) + " us",
                "above throttle_low, " + number(r.throttle_low) + " us");
  }
  r.min_check = reader.quantity("min_check", "us", {r.throttle_low, r.throttle_high}).value;
  r.motor_idle = reader.quantity("motor_idle", "us", pulse).value;
  r.motor_full = reader.quantity("motor_full", "us", {r.motor_idle, pulse.high}).value;
  reader.finish();
  if (!(r.motor_full > r.motor_idle)) {
    reader.fail("motor_full", number(r.motor_full) + " us", "above motor_idle, " + number(r.motor_idle) + " us");
  }
  return r;
}

Limits readLimits(common::SettingsReader reader) {
  Limits l;
  l.travel_min = reader.quantity("travel_min", "m", {-1.0, 0.0}).value;
  l.travel_max = reader.quantity("travel_max", "m", {LENGTH.low, 1.0}).value;
  reader.finish();
  return l;
}

VehicleWing readWing(common::SettingsReader reader) {
  VehicleWing w;
  w.layout_file = reader.resolvePath(reader.text("layout_file"));
  w.table_file = reader.resolvePath(reader.text("table_file"));
  w.inertia_scale = reader.quantity("inertia_scale", "1", {0.01, 100.0});
  w.friction_scale = reader.quantity("friction_scale", "1", {0.0, 100.0});
  if (reader.has("stop")) w.stop = reader.quantity("stop", "N m", {0.0, 1e5});
  reader.finish();
  return w;
}

VehicleResults readResults(common::SettingsReader reader) {
  VehicleResults r;
  for (const auto& [key, path] : {std::pair("plan_f_to_q", &r.plan_f_to_q), std::pair("plan_q_to_f", &r.plan_q_to_f),
                                  std::pair("validation", &r.validation)}) {
    if (reader.has(key)) *path = reader.resolvePath(reader.text(key));
  }
  reader.finish();
  return r;
}

/// What each key alone cannot tell: parts that do not meet, or do not fit.
void refuseImpossible(const Vehicle& v, const common::SettingsReader& reader) {
  const Geometry& g = v.geometry;
  const double reach = g.housing_radius + v.arm.pin_x;
  if (std::abs(reach - g.ring_radius) > g.ring_width) {
    reader.fail("arm.pin_x", metres(v.arm.pin_x),
                "an axle at the ring: geometry.housing_radius + arm.pin_x is " + metres(reach) +
                    ", geometry.ring_radius is " + metres(g.ring_radius) + ", and they may differ by ring_width, " +
                    metres(g.ring_width));
  }
  const double around = 2 * M_PI * g.housing_radius;
  if (v.arm.count * v.arm.leg_thickness > around) {
    reader.fail("arm.count", std::to_string(v.arm.count) + " legs of " + metres(v.arm.leg_thickness),
                "as many as fit around the housing, " + metres(around));
  }
  const double farthest = v.arm.domain_length + v.arm.domain_height;
  for (const auto& [key, value] :
       {std::pair("limits.travel_min", v.limits.travel_min), std::pair("limits.travel_max", v.limits.travel_max)}) {
    if (std::abs(value) <= farthest) continue;
    reader.fail(key, metres(value),
                "within what the arm can reach, domain_length + domain_height = " + metres(farthest));
  }
  if (v.boom.given && v.boom.length.low() < g.ring_radius) {
    reader.fail("boom.length", metres(v.boom.length.low()) + " at least", "above geometry.ring_radius");
  }
}

}  // namespace

void Vehicle::requireBoom(const std::string& who) const {
  if (boom.given) return;
  throw common::SettingError(file, "boom", "not given",
                             "numbers of the stand, because " + who +
                                 " asks for the mount boom; or the mount free (--mount free, mount:=free)");
}

Vehicle loadVehicle(const std::string& path) {
  common::SettingsReader reader = common::SettingsReader::fromFile(path);
  Vehicle v;
  v.file = path;
  v.sha256 = common::sha256OfFile(path);
  v.name = reader.text("name");
  v.masses = readMasses(reader.map("masses"));
  v.geometry = readGeometry(reader.map("geometry"));
  v.arm = readArm(reader.map("arm"));
  v.material = readMaterial(reader.map("material"));
  v.damping_ratio = reader.quantity("damping_ratio", "1", {0.0, 2.0});
  v.rotors = readRotors(reader.map("rotors"));
  if (reader.has("battery")) v.battery = readBattery(reader.map("battery"));
  v.drag = readDrag(reader.map("drag"));
  if (reader.has("boom")) v.boom = readBoom(reader.map("boom"));
  v.radio = readRadio(reader.map("radio"));
  v.limits = readLimits(reader.map("limits"));
  if (reader.has("wing")) v.wing = readWing(reader.map("wing"));
  if (reader.has("must_survive")) v.must_survive = reader.texts("must_survive");
  if (reader.has("results")) v.results = readResults(reader.map("results"));
  reader.finish();
  refuseImpossible(v, reader);
  return v;
}

}  // namespace snapwing::vehicle
