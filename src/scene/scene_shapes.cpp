// Reading of bodies: shapes, densities, materials.
#include <Eigen/Geometry>
#include <cmath>

#include "scene_reading.h"
#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"
#include "snapwing/mpm/density_file.h"
#include "snapwing/mpm/triangle_mesh.h"
#include "snapwing/solver/rigid_inertia_term.h"

namespace snapwing::scene {

namespace {

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

void requireSolid(SettingsReader& r, const std::string& key, const Reading& in) {
  if (in.dimension == 2) r.fail(key, "in a planar scene", "dimension: 3");
}

mpm::ShapePtr readCylinder(SettingsReader& r, const Reading& in) {
  requireSolid(r, "cylinder", in);
  SettingsReader m = r.map("cylinder");
  const Point3 from = in.point(m, "from", 3), to = in.point(m, "to", 3);
  const double radius = in.positive(m, "radius");
  if (from == to) m.fail("to", "equal to from", "another point: the axis' other end");
  m.finish();
  return mpm::makeCylinder(from, to, radius);
}

mpm::ShapePtr readExtrusion(SettingsReader& r, const Reading& in) {
  requireSolid(r, "extrude", in);
  SettingsReader m = r.map("extrude");
  const std::vector<double> ends = m.numbers("z", 2, {-HUGE_LENGTH, HUGE_LENGTH}, in.unit_name);
  if (!(ends[0] < ends[1])) m.fail("z", "empty", "[low, high]");
  SettingsReader inner = m.map("shape");
  const mpm::ShapePtr section = readShape(inner, in);
  inner.finish();
  m.finish();
  Box slab;
  slab.low(2) = in.unit * ends[0];
  slab.high(2) = in.unit * ends[1];
  return mpm::makeIntersection({section, mpm::makeBox(slab)});
}

mpm::ShapePtr readStl(SettingsReader& r, const Reading& in) {
  requireSolid(r, "stl", in);
  SettingsReader m = r.map("stl");
  const double unit = m.choice("length_unit", {"m", "mm"}) == "mm" ? 1e-3 : 1.0;
  const std::string file = m.resolvePath(m.text("file"));
  m.finish();
  return mpm::loadStl(file, unit);
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
  if (r.has("cylinder")) return readCylinder(r, in);
  if (r.has("extrude")) return readExtrusion(r, in);
  if (r.has("stl")) return readStl(r, in);
  if (r.has("union")) return mpm::makeUnion(readParts(r, "union", in));
  if (r.has("intersection")) return mpm::makeIntersection(readParts(r, "intersection", in));
  if (r.has("difference")) return mpm::makeDifference(readParts(r, "difference", in));
  r.fail("box", "no shape",
         "one of box, polygon, disc, cosine_beam, cylinder, extrude, stl, union, intersection, difference");
}

void readMaterial(SettingsReader& r, SceneBody& body) {
  SettingsReader m = r.map("material");
  body.rigid = m.booleanOr("rigid", false);
  if (body.rigid) {
    body.material = {1, 0, 0};  // a valid law that is never asked
  } else {
    body.material.youngs_modulus = m.number("youngs_modulus", {1e-6, 1e15}, "Pa");
    body.material.poisson_ratio = m.number("poisson_ratio", {0, 0.49999}, "1");
  }
  body.material.mass_density = m.numberOr("mass_density", 0, {0, 1e5}, "kg/m3");
  m.finish();
}

std::array<int, 2> readCells(SettingsReader& r) {
  const std::vector<double> given = r.numbers("cells", 2, {1, 20000}, "");
  for (const double n : given) {
    if (n != std::floor(n)) r.fail("cells", common::toText(n), "two whole numbers: cells along x and along y");
  }
  return {static_cast<int>(given[0]), static_cast<int>(given[1])};
}

mpm::DensityField readDensity(SettingsReader& r, const Reading& in) {
  SettingsReader m = r.map("density");
  const double length = in.positive(m, "length"), height = in.positive(m, "height");
  const std::string file = m.resolvePath(m.text("file"));
  const std::string ending = file.size() > 4 ? file.substr(file.rfind('.') + 1) : "";
  mpm::DensityField field;
  if (ending == "png") {
    field = mpm::loadDensityPng(file, length, height, m.choice("solid", {"dark", "light"}) == "dark");
  } else if (ending == "h5") {
    field = mpm::loadDensityHdf5(file, m.textOr("dataset", "density"), length, height);
  } else if (ending == "csv") {
    field = mpm::loadDensityCsv(file, length, height, m.has("cells") ? readCells(m) : std::array<int, 2>{0, 0});
  } else {
    m.fail("file", "'" + file + "'", "a name that ends in .csv, .h5 or .png");
  }
  const double least = m.numberOr("absent_below", 0, {0, 1}, "1");
  for (double& value : field.value) {
    if (value < least) value = -1;
  }
  m.finish();
  return field;
}

/// Rotation by a vector [rad]; what is a quarter turn to rounding is one.
Eigen::Matrix3d rotationBy(const Eigen::Vector3d& vector) {
  const double angle = vector.norm();
  if (angle == 0) return Eigen::Matrix3d::Identity();
  Eigen::Matrix3d r = Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix();
  const Eigen::Matrix3d whole = r.array().round();
  if ((r - whole).cwiseAbs().maxCoeff() < 1e-9) r = whole;
  return r;
}

Frame readFrame(SettingsReader& r, const Reading& in) {
  constexpr double TURNS = 20;  // [rad]
  SettingsReader m = r.map("frame");
  Frame frame;
  if (m.has("origin")) frame.origin = in.point(m, "origin", in.dimension);
  if (m.has("rotation")) {
    Eigen::Vector3d vector = Eigen::Vector3d::Zero();
    if (in.dimension == 2) {
      vector(2) = m.number("rotation", {-TURNS, TURNS}, "rad");
    } else {
      const std::vector<double> given = m.numbers("rotation", 3, {-TURNS, TURNS}, "rad");
      vector = Eigen::Vector3d(given[0], given[1], given[2]);
    }
    frame.rotation = rotationBy(vector);
  }
  m.finish();
  return frame;
}

/// `rigid: {mass: , centre: , inertia: }`.
void readGivenMass(SettingsReader& r, SceneBody& body, const Reading& in) {
  SettingsReader m = r.map("rigid");
  GivenMass& given = body.given;
  given.mass = m.number("mass", {1e-12, 1e9}, "kg");
  given.centre = in.point(m, "centre", in.dimension);
  if (in.dimension == 2) {
    given.inertia(2, 2) = m.number("inertia", {0, 1e12}, "kg m2");
  } else {
    const std::vector<double> i = m.numbers("inertia", 6, {-1e12, 1e12}, "kg m2");
    given.inertia << i[0], i[3], i[4], i[3], i[1], i[5], i[4], i[5], i[2];
    try {
      solver::RigidMass::of(given.mass, given.centre, given.inertia);
    } catch (const common::Error& e) {
      m.fail("inertia", e.what(), "[xx, yy, zz, xy, xz, yz] of a body");
    }
  }
  m.finish();
  body.rigid = true;
  body.material = {1, 0, 0};
  body.extruded = false;
}

SceneBody readCopy(SettingsReader& r, const Reading& in, const std::vector<SceneBody>& before) {
  const std::string original = r.text("copy_of");
  const auto found = in.bodies.find(original);
  if (found == in.bodies.end() || found->second >= static_cast<int>(before.size()) ||
      before[found->second].copy_of >= 0) {
    r.fail("copy_of", "'" + original + "'", "the name of a body above that is not itself a copy");
  }
  SceneBody body = before[found->second];
  body.copy_of = found->second;
  body.frame = readFrame(r, in);
  r.finish();
  return body;
}

}  // namespace

SceneBody readBody(SettingsReader& r, const std::string& name, const Reading& in,
                   const std::vector<SceneBody>& before) {
  SceneBody body;
  if (r.has("copy_of")) {
    body = readCopy(r, in, before);
    body.name = name;
    return body;
  }
  body.name = name;
  if (r.has("frame")) body.frame = readFrame(r, in);
  if (r.has("rigid")) {
    readGivenMass(r, body, in);
    r.finish();
    return body;
  }
  readMaterial(r, body);
  if (r.has("density")) {
    body.density = readDensity(r, in);
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

}  // namespace snapwing::scene
