#include "snapwing/motion/trial_file.h"

#include <algorithm>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"
#include "snapwing/common/settings_reader.h"
#include "snapwing/scene/rung.h"
#include "snapwing/vehicle/vehicle_parameters.h"

namespace snapwing::motion {

namespace {

using common::SettingsReader;

/// `uncertain`: names of the vehicle file's uncertain numbers with their place in the box, or a seed that draws all.
void readBox(SettingsReader& reader, TrialFile& out) {
  if (!reader.has("uncertain")) return;
  SettingsReader box = reader.map("uncertain");
  const std::vector<std::string>& names = vehicle::uncertainNames();
  out.box.assign(names.size(), 0.0);
  if (box.has("seed")) {
    drawVehicle(box.integer("seed", 0, 1000000000), out);
  }
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (box.has(names[k])) out.box[k] = box.number(names[k], {-1, 1}, "half widths");
  }
  const auto memory = [&](const char* name, double& place) {
    if (!box.has(name)) return;
    if (out.rung == TrialRung::LUMPED) box.fail(name, "given", "with rung planar or volumetric only");
    place = box.number(name, {-1, 1}, "half widths");
  };
  memory("material.relaxation.share", out.axis.relaxation_share);
  memory("material.relaxation.time", out.axis.relaxation_time);
  box.finish();
}

TrialLevel readLevel(SettingsReader reader) {
  TrialLevel out;
  out.throttle = -1;
  if (reader.has("throttle") == reader.has("thrust")) {
    reader.fail("throttle", reader.has("throttle") ? "given beside thrust" : "missing",
                "exactly one of throttle, thrust");
  }
  if (reader.has("throttle")) {
    out.throttle = reader.number("throttle", {0, 1}, "1");
  } else {
    out.thrust = reader.number("thrust", {0, 1}, "1");
  }
  out.duration = reader.number("duration", {0, 60}, "s");
  reader.finish();
  return out;
}

void readLevels(SettingsReader& reader, TrialFile& out) {
  out.pulse = readLevel(reader.map("pulse"));
  if (!reader.has("then")) return;
  if (out.rung == TrialRung::LUMPED) reader.fail("then", "given", "with rung planar or volumetric only");
  for (SettingsReader& level : reader.list("then")) out.then.push_back(readLevel(std::move(level)));
}

void readSurroundings(SettingsReader& reader, TrialFile& out) {
  out.mount = reader.has("mount") ? reader.choice("mount", {"auto", "free", "boom", "held"}) : "auto";
  const std::string wings = reader.has("wings") ? reader.choice("wings", {"auto", "on", "off"}) : "auto";
  out.trial.wings = vehicle::wingsFromName(wings);
  out.trial.gravity = reader.numberOr("gravity", 0, {-100, 100}, "m/s2");
  out.trial.initial_speed = reader.numberOr("initial_speed", 0, {-200, 200}, "m/s");
  out.trial.push = reader.numberOr("push", 0, {-1000, 1000}, "N");
  if (reader.has("initial_thrust")) out.trial.initial_thrust_fraction = reader.number("initial_thrust", {0, 1}, "1");
  if (reader.has("final_thrust")) out.trial.final_thrust_fraction = reader.number("final_thrust", {0, 1}, "1");
  out.trial.horizon = reader.numberOr("horizon", out.trial.horizon, {0.01, 60}, "s");
}

void readSteps(SettingsReader& reader, TrialFile& out) {
  // docs/motion.md: what these steps cost in error.
  out.steps.largest_step = 0.002;
  out.steps.relative_tolerance = 1e-6;
  // A planar tangent costs little more than a residual, a solid's factor far more.
  out.steps.keep_factor = out.rung == TrialRung::VOLUMETRIC;
  if (!reader.has("time")) return;
  if (out.rung == TrialRung::LUMPED) reader.fail("time", "given", "with rung planar or volumetric only");
  SettingsReader time = reader.map("time");
  if (time.has("scheme")) {
    out.scheme =
        schemeFromName(time.choice("scheme", {"backward_euler", "midpoint", "average_force", "corrected_midpoint"}));
  }
  out.points = time.integerOr("points", out.points, 1, 4);
  out.bias = time.numberOr("bias", 0, {0, 0.5}, "1");
  if (out.bias > 0 && out.scheme != SchemeKind::MIDPOINT) {
    time.fail("bias", "more than 0 with scheme " + schemeName(out.scheme), "0, or scheme midpoint");
  }
  out.steps.largest_step = time.numberOr("step", out.steps.largest_step, {1e-6, 0.1}, "s");
  out.steps.error = time.numberOr("error", out.steps.error, {0, 1e-3}, "m");
  out.steps.smallest_step = std::min(out.steps.smallest_step, out.steps.largest_step);
  out.steps.relative_tolerance = time.numberOr("tolerance", out.steps.relative_tolerance, {1e-14, 1e-2}, "1");
  time.finish();
}

void readSolid(SettingsReader& reader, TrialFile& out) {
  if (reader.has("rung")) {
    const std::string rung = reader.choice("rung", {"lumped", "planar", "volumetric"});
    out.rung = rung == "lumped" ? TrialRung::LUMPED : rung == "planar" ? TrialRung::PLANAR : TrialRung::VOLUMETRIC;
  }
  out.axis.dimension = out.rung == TrialRung::VOLUMETRIC ? 3 : 2;
  if (!reader.has("solid")) return;
  SettingsReader solid = reader.map("solid");
  if (out.rung == TrialRung::LUMPED) reader.fail("solid", "given", "with rung planar or volumetric only");
  if (solid.has("kernel"))
    out.axis.kernel = scene::kernelFromName(solid.choice("kernel", {"linear", "linear_reduced", "quadratic"}));
  out.axis.cell_size = solid.numberOr("cell_size", 0, {0, 0.02}, "m");
  if (solid.has("coarsening")) {
    out.axis.coarsening = mpm::coarseningFromName(solid.choice("coarsening", {"stiffness", "mass"}));
  }
  out.axis.least_density = solid.numberOr("least_density", out.axis.least_density, {0, 0.99}, "1");
  if (solid.has("mass")) {
    out.axis.mass =
        solid.choice("mass", {"consistent", "lumped"}) == "lumped" ? mpm::MassKind::LUMPED : mpm::MassKind::CONSISTENT;
  }
  if (solid.has("damping")) {
    out.axis.damping =
        dampingFromName(solid.choice("damping", {"travel", "rayleigh", "rayleigh_projected", "kelvin_voigt"}));
  }
  if (solid.has("relaxation")) out.axis.relaxation = solid.choice("relaxation", {"on", "off"}) == "on";
  out.axis.stop_stiffness = solid.numberOr("stop_stiffness", out.axis.stop_stiffness, {1, 1e9}, "N/m");
  out.axis.stop_restitution = solid.numberOr("stop_restitution", out.axis.stop_restitution, {0.01, 1}, "1");
  out.axis.hub_stiffness = solid.numberOr("hub_stiffness", out.axis.hub_stiffness, {1, 1e6}, "N m");
  out.axis.hub_radius = solid.numberOr("hub_radius", out.axis.hub_radius, {1e-3, 0.1}, "m");
  if (solid.has("wing_stop")) out.axis.wing_stop = solid.number("wing_stop", {0, 1e5}, "N m");
  if (solid.has("wings_follow")) {
    out.axis.wings_follow_travel = solid.choice("wings_follow", {"arm", "travel"}) == "travel";
  }
  solid.finish();
}

/// `repeats` of the trial, and what differs between them.
void readRepeats(SettingsReader& reader, TrialFile& out) {
  out.repeats = reader.integerOr("repeats", 1, 1, 1000);
  if (reader.has("vary") != (out.repeats > 1)) {
    reader.fail("vary", reader.has("vary") ? "given with one repeat" : "missing",
                "with repeats of 2 or more, and only then");
  }
  if (out.repeats == 1) return;
  if (out.name.find('/') != std::string::npos) {
    reader.fail("trial", "'" + out.name + "'", "a name without '/', since each repeat has a folder of that name");
  }
  SettingsReader vary = reader.map("vary");
  out.vary.seed = vary.integer("seed", 0, 1000000000);
  out.vary.strength = vary.numberOr("strength", 0, {0, 1}, "1");
  out.vary.duration = vary.numberOr("duration", 0, {0, 10}, "s");
  if (vary.has("vehicle")) out.vary.vehicle = vary.choice("vehicle", {"on", "off"}) == "on";
  if (out.vary.strength == 0 && out.vary.duration == 0 && !out.vary.vehicle) {
    vary.fail("strength", "0, as duration, and vehicle off", "one of them that differs");
  }
  if (out.vary.vehicle && !out.box.empty()) vary.fail("vehicle", "on beside `uncertain`", "one of the two");
  vary.finish();
}

/// Six degrees of freedom, and what they have beside the axis.
void readSpace(SettingsReader& reader, TrialFile& out) {
  if (reader.has("freedom")) out.six = reader.choice("freedom", {"axis", "six"}) == "six";
  if (out.six && out.rung != TrialRung::VOLUMETRIC) {
    reader.fail("freedom", "six with rung " + rungName(out.rung), "with rung volumetric only");
  }
  for (const char* key : {"propellers", "gravity_across"}) {
    if (reader.has(key) && !out.six) reader.fail(key, "given", "with freedom: six only");
  }
  if (!out.six) return;
  const bool wings = out.trial.wings.value_or(false);
  if (wings && out.axis.wings_follow_travel) reader.fail("solid.wings_follow", "travel with freedom: six", "arm");
  if (out.axis.damping != DampingLaw::TRAVEL && out.axis.damping != DampingLaw::KELVIN_VOIGT) {
    reader.fail("solid.damping", dampingName(out.axis.damping), "travel, kelvin_voigt with freedom: six");
  }
  out.trial.wings = wings;
  out.space.gravity_across = reader.numberOr("gravity_across", 0, {-100, 100}, "m/s2");
  if (!reader.has("propellers")) return;
  SettingsReader propellers = reader.map("propellers");
  if (propellers.has("scale")) out.space.rotor_scale = propellers.numbers("scale", 0, {0, 2}, "1");
  out.space.rotor_angle = propellers.numberOr("angle", out.space.rotor_angle, {-10, 10}, "rad");
  out.space.moment_per_thrust = propellers.numberOr("moment_per_thrust", 0, {0, 1}, "m");
  out.space.no_thrust_speed = propellers.numberOr("no_thrust_speed", 0, {0, 1000}, "m/s");
  out.space.sag = propellers.numberOr("sag", 0, {0, 0.9}, "1");
  propellers.finish();
}

/// A hand that holds the ring and moves.
void readHand(SettingsReader& reader, TrialFile& out) {
  if (!reader.has("hand")) return;
  if (out.mount != "held") reader.fail("hand", "given with mount " + out.mount, "with mount: held only");
  if (out.rung == TrialRung::LUMPED || out.six)
    reader.fail("hand", "given", "with rung planar or volumetric, on the axis");
  SettingsReader hand = reader.map("hand");
  HandSettings settings;
  settings.noise = hand.numberOr("noise", 0, {0, 100}, "m/s2");
  settings.low = hand.numberOr("low", settings.low, {0.01, 1000}, "Hz");
  settings.high = hand.numberOr("high", settings.high, {0.01, 1000}, "Hz");
  if (!(settings.high > settings.low)) hand.fail("high", "not above low", "more than low");
  if (settings.noise > 0 && !hand.has("seed")) hand.fail("seed", "missing", "0 .. 1000000000, needed with noise");
  if (hand.has("seed")) settings.seed = static_cast<std::uint64_t>(hand.integer("seed", 0, 1000000000));
  settings.swing = hand.numberOr("swing", 0, {0, 1}, "m");
  settings.swing_frequency = hand.numberOr("swing_frequency", settings.swing_frequency, {0.01, 100}, "Hz");
  hand.finish();
  out.axis.hand = settings;
}

/// Friction of each wing's pins, times what the vehicle says.
void readFriction(SettingsReader& reader, TrialFile& out) {
  if (!reader.has("wing_friction")) return;
  SettingsReader friction = reader.map("wing_friction");
  if (out.rung == TrialRung::LUMPED) reader.fail("wing_friction", "given", "with rung planar or volumetric only");
  out.axis.friction_left = friction.numberOr("left", 1, {0, 100}, "1");
  out.axis.friction_right = friction.numberOr("right", 1, {0, 100}, "1");
  friction.finish();
}

/// What acts on the wings beside their pins and the stop at rest.
void readWingForces(SettingsReader& reader, TrialFile& out) {
  if (!reader.has("wing_forces")) return;
  SettingsReader forces = reader.map("wing_forces");
  if (out.rung == TrialRung::LUMPED) reader.fail("wing_forces", "given", "with rung planar or volumetric only");
  WingForces& of = out.axis.wing_forces;
  of.fold_bias = forces.numberOr("fold_bias", 0, {0, 10}, "N m");
  of.fold_stop = forces.numberOr("fold_stop", 0, {0, 1e5}, "N m");
  of.air = forces.numberOr("air", 0, {0, 1}, "N m s2");
  forces.finish();
}

}  // namespace

std::string rungName(TrialRung rung) {
  if (rung == TrialRung::LUMPED) return "lumped";
  return rung == TrialRung::PLANAR ? "planar" : "volumetric";
}

TrialFile loadTrial(const std::string& path) {
  SettingsReader reader = SettingsReader::fromFile(path);
  TrialFile out;
  out.file = path;
  out.sha256 = common::sha256OfFile(path);
  out.name = reader.text("trial");
  out.vehicle_file = reader.resolvePath(reader.text("vehicle"));
  readSurroundings(reader, out);
  out.start = vehicle::modeFromName(reader.choice("start", {"F", "Q"}));
  readSolid(reader, out);
  readLevels(reader, out);
  readFriction(reader, out);
  readWingForces(reader, out);
  readSpace(reader, out);
  readHand(reader, out);
  readSteps(reader, out);
  readBox(reader, out);
  readRepeats(reader, out);
  reader.finish();
  return out;
}

}  // namespace snapwing::motion
