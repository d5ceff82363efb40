#include "snapwing/statics/scene.h"

#include <cmath>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"
#include "snapwing/common/settings_reader.h"

namespace snapwing::statics {

namespace {

using common::Range;
using common::SettingsReader;

constexpr double HUGE_LENGTH = 1e6;  // in the file's unit

/// Reads lengths in the file's unit.
struct Reading {
  double unit = 1;  ///< [m]
  std::string unit_name;
  std::map<std::string, int> bodies;
  int dimension = 2;

  double length(SettingsReader& r, const std::string& key, double low = -HUGE_LENGTH) const {
    return unit * r.number(key, {low, HUGE_LENGTH}, unit_name);
  }
  double positive(SettingsReader& r, const std::string& key) const {
    const double value = length(r, key, 0);
    if (!(value > 0)) r.fail(key, "0", "> 0 " + unit_name);
    return value;
  }
  Point3 point(SettingsReader& r, const std::string& key, int count) const {
    Point3 p = Point3::Zero();
    const std::vector<double> values = r.numbers(key, count, {-HUGE_LENGTH, HUGE_LENGTH}, unit_name);
    for (int a = 0; a < count; ++a) p(a) = unit * values[a];
    return p;
  }
  Point3 vector(SettingsReader& r, const std::string& key, const std::string& what) const {
    Point3 p = Point3::Zero();
    const std::vector<double> values = r.numbers(key, dimension, {-1e12, 1e12}, what);
    for (int a = 0; a < dimension; ++a) p(a) = values[a];
    return p;
  }
  Box box(SettingsReader& r, const std::string& key, int axes = 3) const {
    SettingsReader m = r.map(key);
    Box result;
    const char* names[] = {"x", "y", "z"};
    for (int a = 0; a < axes; ++a) {
      if (!m.has(names[a])) continue;
      const std::vector<double> ends = m.numbers(names[a], 2, {-HUGE_LENGTH, HUGE_LENGTH}, unit_name);
      if (ends[1] < ends[0])
        m.fail(names[a], "[" + std::to_string(ends[0]) + ", " + std::to_string(ends[1]) + "]", "[low, high]");
      result.low(a) = unit * ends[0];
      result.high(a) = unit * ends[1];
    }
    m.finish();
    return result;
  }
  int body(SettingsReader& r, const std::string& key = "body") const {
    if (bodies.size() == 1 && !r.has(key)) return 0;
    const std::string name = r.text(key);
    const auto found = bodies.find(name);
    if (found == bodies.end()) r.fail(key, "'" + name + "'", "the name of a body");
    return found->second;
  }
};

mpm::ShapePtr readShape(SettingsReader& r, const Reading& in);

std::vector<mpm::ShapePtr> readParts(SettingsReader& r, const std::string& key, const Reading& in) {
  std::vector<mpm::ShapePtr> parts;
  for (SettingsReader& part : r.list(key)) {
    parts.push_back(readShape(part, in));
    part.finish();
  }
  if (parts.empty()) r.fail(key, "an empty list", "at least one shape");
  return parts;
}

mpm::ShapePtr readPolygon(SettingsReader& r, const Reading& in) {
  std::vector<Eigen::Vector2d> corners;
  for (SettingsReader& corner : r.list("polygon")) {
    corners.emplace_back(in.length(corner, "x"), in.length(corner, "y"));
    corner.finish();
  }
  if (corners.size() < 3) r.fail("polygon", std::to_string(corners.size()) + " corners", "at least 3");
  return mpm::makePolygon(corners);
}

mpm::ShapePtr readShape(SettingsReader& r, const Reading& in) {
  if (r.has("box")) return mpm::makeBox(in.box(r, "box", 3));
  if (r.has("polygon")) return readPolygon(r, in);
  if (r.has("disc")) {
    SettingsReader m = r.map("disc");
    const Point3 centre = in.point(m, "centre", 2);
    const double radius = in.positive(m, "radius");
    m.finish();
    return mpm::makeDisc(centre(0), centre(1), radius);
  }
  if (r.has("cosine_beam")) {
    SettingsReader m = r.map("cosine_beam");
    const double span = in.positive(m, "span"), thickness = in.positive(m, "thickness");
    const Point3 amplitudes = in.point(m, "amplitudes", 2);
    m.finish();
    return mpm::makeCosineBeam(span, {amplitudes(0), amplitudes(1)}, thickness);
  }
  if (r.has("union")) return mpm::makeUnion(readParts(r, "union", in));
  if (r.has("intersection")) return mpm::makeIntersection(readParts(r, "intersection", in));
  if (r.has("difference")) return mpm::makeDifference(readParts(r, "difference", in));
  r.fail("box", "no shape", "one of box, polygon, disc, cosine_beam, union, intersection, difference");
}

elasticity::Material readMaterial(SettingsReader& r) {
  SettingsReader m = r.map("material");
  elasticity::Material material;
  material.youngs_modulus = m.number("youngs_modulus", {1e-6, 1e15}, "Pa");
  material.poisson_ratio = m.number("poisson_ratio", {0, 0.49999}, "1");
  material.mass_density = m.numberOr("mass_density", 0, {0, 1e5}, "kg/m3");
  m.finish();
  return material;
}

SceneBody readBody(SettingsReader& r, const std::string& name, const Reading& in) {
  SceneBody body;
  body.name = name;
  body.material = readMaterial(r);
  if (r.has("density")) {
    SettingsReader m = r.map("density");
    const double length = in.positive(m, "length"), height = in.positive(m, "height");
    body.density = mpm::loadDensityCsv(m.resolvePath(m.text("file")), length, height);
    m.finish();
  } else {
    SettingsReader m = r.map("shape");
    body.shape = readShape(m, in);
    m.finish();
    const Box bounds = body.shape->bounds();
    for (int a = 0; a < 2; ++a) {
      if (!std::isfinite(bounds.low(a)) || !std::isfinite(bounds.high(a)))
        r.fail("shape", "unbounded", "a shape bounded along x and y");
    }
    body.extruded = !(std::isfinite(bounds.low(2)) && std::isfinite(bounds.high(2)));
  }
  if (in.dimension == 2 || body.extruded) body.thickness = in.positive(r, "thickness");
  if (r.has("thickness_in")) {
    for (SettingsReader& m : r.list("thickness_in")) {
      const Box region = in.box(m, "region");
      body.thickness_in.emplace_back(region, in.positive(m, "thickness"));
      m.finish();
    }
  }
  r.finish();
  return body;
}

std::vector<int> readAxes(SettingsReader& r, const std::string& key, int dimension) {
  // Axes are written as one word, e.g. "xy".
  const std::string word = r.text(key);
  std::vector<int> axes;
  for (const char c : word) {
    const int axis = c - 'x';
    if (axis < 0 || axis >= dimension)
      r.fail(key, "'" + word + "'", dimension == 2 ? "letters of xy" : "letters of xyz");
    axes.push_back(axis);
  }
  return axes;
}

void readSupports(SettingsReader& r, Scene& scene, const Reading& in) {
  if (r.has("supports")) {
    for (SettingsReader& m : r.list("supports")) {
      SceneSupport s;
      s.name = m.text("name");
      s.body = in.body(m);
      s.region = in.box(m, "region");
      s.axes = readAxes(m, "hold", in.dimension);
      m.finish();
      scene.supports.push_back(s);
    }
  }
  if (r.has("symmetry_planes")) {
    for (SettingsReader& m : r.list("symmetry_planes")) {
      SceneSupport s;
      s.name = m.text("name");
      s.body = in.body(m);
      s.axes = readAxes(m, "normal", in.dimension);
      if (s.axes.size() != 1) m.fail("normal", "several", "one axis");
      s.region.low(s.axes[0]) = s.region.high(s.axes[0]) = in.length(m, "at");
      m.finish();
      scene.symmetry.push_back(s);
    }
  }
}

void readPinsAndJoints(SettingsReader& r, Scene& scene, const Reading& in) {
  if (r.has("pins")) {
    for (SettingsReader& m : r.list("pins")) {
      ScenePin pin;
      pin.name = m.text("name");
      pin.body = in.body(m);
      const Point3 at = in.point(m, "at", 2);
      pin.x = at(0), pin.y = at(1);
      pin.kind = m.choice("kind", {"line", "mean"}) == "line" ? PinKind::LINE : PinKind::MEAN;
      if (pin.kind == PinKind::MEAN) pin.radius = in.positive(m, "radius");
      m.finish();
      scene.pins.push_back(pin);
    }
  }
  if (r.has("joints")) {
    for (SettingsReader& m : r.list("joints")) {
      SceneJoint joint;
      joint.name = m.text("name");
      joint.first = in.body(m, "first");
      joint.second = in.body(m, "second");
      const Point3 at = in.point(m, "at", 2);
      joint.x = at(0), joint.y = at(1);
      m.finish();
      scene.joints.push_back(joint);
    }
  }
}

void readDrives(SettingsReader& r, Scene& scene, const Reading& in) {
  if (r.has("ports")) {
    for (SettingsReader& m : r.list("ports")) {
      ScenePort port;
      port.name = m.text("name");
      port.body = in.body(m);
      port.region = in.box(m, "region");
      port.direction = in.vector(m, "direction", "1");
      if (!(port.direction.norm() > 0)) m.fail("direction", "zero", "a direction");
      port.direction.normalize();
      port.cross_free = m.choice("cross_motion", {"held", "free"}) == "free";
      m.finish();
      scene.ports.push_back(port);
    }
  }
  if (r.has("loads")) {
    for (SettingsReader& m : r.list("loads")) {
      SceneLoad load;
      load.name = m.text("name");
      load.body = in.body(m);
      load.region = in.box(m, "region");
      load.force = in.vector(m, "force", "N");
      m.finish();
      scene.loads.push_back(load);
    }
  }
  if (scene.ports.empty() == scene.loads.empty()) {
    r.fail("ports", scene.ports.empty() ? "neither ports nor loads" : "ports and loads",
           "driven ports, or loads: the path has one control");
  }
  scene.control_is_length = !scene.ports.empty();
}

void readMonitors(SettingsReader& r, Scene& scene, const Reading& in) {
  if (!r.has("monitors")) return;
  for (SettingsReader& m : r.list("monitors")) {
    SceneMonitor monitor;
    monitor.name = m.text("name");
    monitor.body = in.body(m);
    monitor.at = in.point(m, "at", in.dimension);
    if (m.has("radius")) {
      monitor.radius = in.positive(m, "radius");
    } else {
      monitor.direction = in.vector(m, "direction", "1");
      if (!(monitor.direction.norm() > 0)) m.fail("direction", "zero", "a direction");
      monitor.direction.normalize();
    }
    m.finish();
    scene.monitors.push_back(monitor);
  }
}

void readPath(SettingsReader& r, Scene& scene, const Reading& in) {
  SettingsReader m = r.map("path");
  const double unit = scene.control_is_length ? in.unit : 1;
  const std::string name = scene.control_is_length ? in.unit_name : "1";
  scene.to = unit * m.number("to", {-HUGE_LENGTH, HUGE_LENGTH}, name);
  scene.steps = m.integer("steps", 1, 100000);
  scene.back = m.booleanOr("back", false);
  if (m.has("perturb")) scene.perturbation = in.length(m, "perturb");
  m.finish();
  if (scene.to == 0) m.fail("to", "0", "another value: a path starts at 0");
}

void readNumerics(SettingsReader& r, Scene& scene, const Reading& in) {
  const std::string kernel = r.choice("kernel", {"linear", "linear_reduced", "quadratic"});
  scene.kernel = kernel == "linear"      ? SceneKernel::LINEAR
                 : kernel == "quadratic" ? SceneKernel::QUADRATIC
                                         : SceneKernel::LINEAR_REDUCED;
  scene.cell_size = in.positive(r, "cell_size");
  scene.particles = r.integerOr("particles", scene.dimension == 2 ? 4 : 3, 1, 16);
  scene.smallest_fraction = r.numberOr("smallest_fraction", 0.02, {0, 0.9}, "1");
  scene.drive = driveFromName(r.has("drive") ? r.choice("drive", {"elimination", "augmented_lagrangian", "multipliers"})
                                             : "elimination");
  scene.use_symmetry = r.booleanOr("use_symmetry", true);
  scene.interpolation.void_stiffness = r.numberOr("void_stiffness", 1e-6, {1e-12, 0.1}, "1");
}

}  // namespace

double SceneBody::thicknessAt(double x, double y) const {
  double result = thickness;
  for (const auto& [region, value] : thickness_in) {
    if (region.contains(Point3(x, y, 0))) result = value;
  }
  return result;
}

bool isScene(const std::string& path) { return SettingsReader::fromFile(path).has("scene"); }

Scene loadScene(const std::string& path) {
  SettingsReader r = SettingsReader::fromFile(path);
  Scene scene;
  scene.file = path;
  scene.sha256 = common::sha256OfFile(path);
  scene.name = r.text("scene");
  Reading in;
  in.unit_name = r.choice("length_unit", {"m", "mm"});
  in.unit = in.unit_name == "mm" ? 1e-3 : 1.0;
  in.dimension = scene.dimension = r.integer("dimension", 2, 3);
  if (scene.dimension == 2) {
    scene.plane =
        r.choice("plane", {"strain", "stress"}) == "strain" ? elasticity::Plane::STRAIN : elasticity::Plane::STRESS;
  }
  readNumerics(r, scene, in);
  if (scene.dimension == 2 && scene.plane == elasticity::Plane::STRESS && scene.kernel == SceneKernel::LINEAR_REDUCED) {
    r.fail("kernel", "'linear_reduced'", "linear or quadratic: plane stress has no volumetric locking");
  }
  SettingsReader bodies = r.map("bodies");
  for (const std::string& name : bodies.keys()) {
    in.bodies[name] = static_cast<int>(scene.bodies.size());
    SettingsReader body = bodies.map(name);
    scene.bodies.push_back(readBody(body, name, in));
  }
  if (scene.bodies.empty()) r.fail("bodies", "none", "at least one body");
  readSupports(r, scene, in);
  readPinsAndJoints(r, scene, in);
  readDrives(r, scene, in);
  readMonitors(r, scene, in);
  readPath(r, scene, in);
  r.finish();
  return scene;
}

}  // namespace snapwing::statics
