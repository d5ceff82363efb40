#include "snapwing/scene/scene.h"

#include <algorithm>
#include <cmath>

#include "scene_reading.h"
#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"

namespace snapwing::scene {

namespace {

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

/// A region, or of a body without cells a point.
template <class Entry>
void readPlace(SettingsReader& m, const Scene& scene, const Reading& in, Entry& entry) {
  if (scene.bodies[entry.body].hasCells()) {
    entry.region = in.box(m, "region");
  } else {
    entry.at = in.point(m, "at", in.dimension);
  }
}

void readSupports(SettingsReader& r, Scene& scene, const Reading& in) {
  if (r.has("supports")) {
    for (SettingsReader& m : r.list("supports")) {
      SceneSupport s;
      s.name = m.text("name");
      s.body = in.body(m);
      readPlace(m, scene, in, s);
      s.axes = readAxes(m, "hold", in.dimension);
      m.finish();
      scene.supports.push_back(s);
    }
  }
  if (r.has("symmetry_planes")) {
    const auto given = [](const SceneBody& b) { return !b.hasCells(); };
    if (std::any_of(scene.bodies.begin(), scene.bodies.end(), given)) {
      r.fail("symmetry_planes", "given", "scenes without rigid bodies of given mass");
    }
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
      const std::string kind = m.choice("kind", {"line", "mean", "cylinder"});
      pin.kind = kind == "line" ? PinKind::LINE : kind == "mean" ? PinKind::MEAN : PinKind::CYLINDER;
      if (pin.kind != PinKind::LINE) pin.radius = in.positive(m, "radius");
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
      if (m.has("region")) {
        joint.kind = JointKind::FACE;
        joint.region = in.box(m, "region");
      } else if (m.has("from")) {
        joint.kind = JointKind::SEGMENT;
        joint.from = in.point(m, "from", in.dimension);
        joint.to = in.point(m, "to", in.dimension);
      } else {
        const Point3 at = in.point(m, "at", 2);
        joint.x = at(0), joint.y = at(1);
      }
      if (joint.first == joint.second) m.fail("second", "the first body", "another body");
      m.finish();
      scene.joints.push_back(joint);
    }
  }
}

void readPorts(SettingsReader& r, Scene& scene, const Reading& in) {
  if (!r.has("ports")) return;
  for (SettingsReader& m : r.list("ports")) {
    ScenePort port;
    port.name = m.text("name");
    port.body = in.body(m);
    readPlace(m, scene, in, port);
    port.direction = in.direction(m);
    port.cross_free = m.choice("cross_motion", {"held", "free"}) == "free";
    m.finish();
    scene.ports.push_back(port);
  }
}

void readLoads(SettingsReader& r, Scene& scene, const Reading& in) {
  if (r.has("loads")) {
    for (SettingsReader& m : r.list("loads")) {
      SceneLoad load;
      load.name = m.text("name");
      load.body = in.body(m);
      readPlace(m, scene, in, load);
      load.force = in.vector(m, "force", "N");
      load.constant = m.booleanOr("constant", false);
      if (!scene.ports.empty() && !load.constant) {
        m.fail("constant", "false",
               "true: beside driven ports the control is their travel, and loads stay as they are");
      }
      m.finish();
      scene.loads.push_back(load);
    }
  }
  if (r.has("gravity")) {
    scene.gravity = in.vector(r, "gravity", "m/s2");
    const auto weighs = [](const SceneBody& b) { return b.material.mass_density > 0 || b.given.mass > 0; };
    if (std::none_of(scene.bodies.begin(), scene.bodies.end(), weighs)) {
      r.fail("gravity", "given", "a mass_density > 0 in the material of some body");
    }
  }
}

void readDrives(SettingsReader& r, Scene& scene, const Reading& in) {
  readPorts(r, scene, in);
  readLoads(r, scene, in);
  const auto scales = [](const SceneLoad& l) { return !l.constant; };
  if (scene.ports.empty() && std::none_of(scene.loads.begin(), scene.loads.end(), scales)) {
    r.fail("ports", "neither ports nor loads that grow with the control", "driven ports, or loads: the path needs one");
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
      monitor.direction = in.direction(m);
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
  scene.enforcement = solver::enforcementFromName(
      r.has("drive") ? r.choice("drive", {"elimination", "augmented_lagrangian", "multipliers"}) : "elimination");
  scene.copies = r.integerOr("copies", 1, 1, 1000);
  if (r.has("use_symmetry")) {
    const std::string use = r.choice("use_symmetry", {"true", "false", "all"});
    scene.use_symmetry = use == "all" ? SymmetryUse::ALL : use == "false" ? SymmetryUse::NONE : SymmetryUse::THICKNESS;
  }
  scene.interpolation.void_stiffness = r.numberOr("void_stiffness", 1e-6, {1e-12, 0.1}, "1");
}

/// Copies take along what holds, drives, loads and joins their original.
void placeCopies(Scene& scene) {
  for (int copy = 0; copy < static_cast<int>(scene.bodies.size()); ++copy) {
    const int original = scene.bodies[copy].copy_of;
    if (original < 0) continue;
    const std::string name = " of " + scene.bodies[copy].name;
    const auto place = [&](auto& entries) {
      const std::size_t count = entries.size();
      for (std::size_t k = 0; k < count; ++k) {
        if (entries[k].body != original) continue;
        entries.push_back(entries[k]);
        entries.back().body = copy;
        entries.back().name += name;
      }
    };
    place(scene.supports);
    place(scene.pins);
    place(scene.ports);
    place(scene.loads);
    const std::size_t joints = scene.joints.size();
    for (std::size_t k = 0; k < joints; ++k) {
      if (scene.joints[k].first != original || scene.bodies[scene.joints[k].second].copy_of == original) continue;
      scene.joints.push_back(scene.joints[k]);
      scene.joints.back().first = copy;
      scene.joints.back().name += name;
    }
  }
}

void identify(const SettingsReader& r, Scene& scene) {
  scene.named_files = r.namedFiles();
  scene.sha256 = common::sha256OfInputs(scene.file, scene.named_files);
  std::string content =
      r.content({"scene", "kernel", "cell_size", "particles", "smallest_fraction", "drive", "use_symmetry", "monitors",
                 "path.steps", "path.back", "pins[].kind", "pins[].radius", "*.name", "*.file"});
  for (const std::string& file : scene.named_files) content += common::sha256OfFile(file);
  scene.content_sha256 = common::sha256(content);
}

}  // namespace

double SceneBody::thicknessAt(double x, double y) const {
  double result = thickness;
  for (const auto& [region, value] : thickness_in) {
    if (region.contains(Point3(x, y, 0))) result = value;
  }
  return result;
}

int stepCount(double length, double step) { return static_cast<int>(std::ceil(std::abs(length) / step - 1e-9)); }

int rotationMonitor(const Scene& scene) {
  const auto found = std::find_if(scene.monitors.begin(), scene.monitors.end(),
                                  [](const SceneMonitor& monitor) { return monitor.radius > 0; });
  return found == scene.monitors.end() ? -1 : static_cast<int>(found - scene.monitors.begin());
}

bool isScene(const std::string& path) { return SettingsReader::fromFile(path).has("scene"); }

Scene loadScene(const std::string& path) {
  SettingsReader r = SettingsReader::fromFile(path);
  Scene scene;
  scene.file = path;
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
    scene.bodies.push_back(readBody(body, name, in, scene.bodies));
  }
  if (scene.bodies.empty()) r.fail("bodies", "none", "at least one body");
  const auto filled = [](const SceneBody& b) { return b.hasCells(); };
  if (std::none_of(scene.bodies.begin(), scene.bodies.end(), filled)) {
    r.fail("bodies", "none with a shape or a density", "at least one");
  }
  readSupports(r, scene, in);
  readPinsAndJoints(r, scene, in);
  readDrives(r, scene, in);
  readMonitors(r, scene, in);
  readPath(r, scene, in);
  r.finish();
  placeCopies(scene);
  identify(r, scene);
  return scene;
}

}  // namespace snapwing::scene
