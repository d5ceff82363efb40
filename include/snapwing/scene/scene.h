#pragma once
/// Contents of a scene file: bodies, supports, pins, joints, driven ports, loads, and the path to trace. SI units here;
/// `length_unit` in the file is the unit of its lengths. Schema: docs/scenes.md.

#include <map>
#include <string>
#include <vector>

#include "snapwing/elasticity/density_interpolation.h"
#include "snapwing/elasticity/material.h"
#include "snapwing/mpm/density_field.h"
#include "snapwing/mpm/shape.h"
#include "snapwing/solver/enforcement.h"

namespace snapwing::scene {

using mpm::Box;
using mpm::Point3;

enum class SceneKernel { LINEAR, LINEAR_REDUCED, QUADRATIC };

/// Mirror planes that are searched for: none, z (half the thickness of a solid), or x, y and z. MIDDLE: z, with the
/// grid starting at the plane, so that the plane need not lie between cells of the whole grid; not in scene files.
enum class SymmetryUse { NONE, THICKNESS, ALL, MIDDLE };

/// Placement of a body's own coordinates X in the world: x = rotation X + origin [m]. All data of a body in a scene
/// (shape, regions, directions) are in its own coordinates.
struct Frame {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Point3 origin = Point3::Zero();
  bool moved() const { return rotation != Eigen::Matrix3d::Identity() || origin != Point3::Zero(); }
  /// A point [m] from own to world coordinates, and back.
  Point3 toWorld(const Point3& own) const { return moved() ? Point3(rotation * own + origin) : own; }
  Point3 toOwn(const Point3& world) const { return moved() ? Point3(rotation.transpose() * (world - origin)) : world; }
};

/// Mass of a rigid body without cells. Own coordinates.
struct GivenMass {
  double mass = 0;                                    ///< [kg]; 0: it has cells
  Point3 centre = Point3::Zero();                     ///< [m]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< about the centre [kg m2]; planar: about z, last entry
};

struct SceneBody {
  std::string name;
  Frame frame;
  GivenMass given;
  int copy_of = -1;               ///< index of the original body; -1: no copy
  elasticity::Material material;  ///< of a rigid body only the mass density is used
  bool rigid = false;
  mpm::ShapePtr shape;                               ///< null if given by a density
  mpm::DensityField density;                         ///< no values if given by a shape
  double thickness = 0;                              ///< [m] along z; planar: of the slice
  std::vector<std::pair<Box, double>> thickness_in;  ///< other thickness [m] in a region; later entries override
  bool extruded = true;                              ///< volumetric: false if the shape itself is bounded along z

  bool hasCells() const { return !(given.mass > 0); }
  double thicknessAt(double x, double y) const;  ///< [m] at a point in the plane [m]
};

/// Zero displacement components of the part of a body in a region: a face if the region is flat, else all nodes within.
/// Of a body without cells: of the point `at`. Members `body` here and below: index in Scene::bodies.
struct SceneSupport {
  std::string name;
  int body = 0;
  Box region;
  std::vector<int> axes;       ///< 0: x, 1: y, 2: z
  Point3 at = Point3::Zero();  ///< [m] of a body without cells
};

enum class PinKind { LINE, MEAN, CYLINDER };

/// A pin with its axis along z, about which the body may rotate.
struct ScenePin {
  std::string name;
  int body = 0;
  double x = 0, y = 0;  ///< [m]
  PinKind kind = PinKind::LINE;
  double radius = 0;  ///< [m] MEAN: of the section whose mean is held; CYLINDER: of the rigid cylinder
};

enum class JointKind { LINE, SEGMENT, FACE };

/// Equal displacement of two bodies at a point (volumetric: on a line along z through the thickness), or at points one
/// cell apart on a segment or a face. Positions are in the coordinates of the first body.
struct SceneJoint {
  std::string name;
  int first = 0, second = 0;
  double x = 0, y = 0;  ///< [m] LINE
  JointKind kind = JointKind::LINE;
  Point3 from = Point3::Zero(), to = Point3::Zero();  ///< [m] ends of the segment
  Box region;                                         ///< face: flat along one axis
};

/// Driven face: its displacement is control * direction. With cross_free only the component along `direction` is
/// prescribed.
struct ScenePort {
  std::string name;
  int body = 0;
  Box region;
  Point3 direction = Point3::Zero();  ///< unit vector
  bool cross_free = false;
  Point3 at = Point3::Zero();  ///< [m] of a body without cells
};

/// Uniform traction on a face. `force`: its resultant at control = 1, or at any control if `constant`.
struct SceneLoad {
  std::string name;
  int body = 0;
  Box region;
  Point3 force = Point3::Zero();  ///< [N]
  bool constant = false;
  Point3 at = Point3::Zero();  ///< [m] of a body without cells
};

/// Displacement [m] of a point along `direction`, or the least-squares rotation [rad] about it of the nodes within a
/// radius.
struct SceneMonitor {
  std::string name;
  int body = 0;
  Point3 at = Point3::Zero();         ///< [m]
  Point3 direction = Point3::Zero();  ///< unit vector; not of a rotation
  double radius = 0;                  ///< [m] > 0: rotation about z
};

struct Scene {
  std::string name, file;
  std::vector<std::string> named_files;  ///< files named in the scene file: densities, STL
  std::string sha256;                    ///< of the file and of all named files
  /// Hash of the mechanical problem, not of its discretisation: bodies, materials, constraints, loads, end of the path.
  /// Names, kernel, cell size, particles, steps, monitors, enforcement and kinds of pins are left out.
  std::string content_sha256;
  int dimension = 2;
  elasticity::Plane plane = elasticity::Plane::STRAIN;
  SceneKernel kernel = SceneKernel::LINEAR_REDUCED;
  double cell_size = 0;             ///< [m]
  int particles = 4;                ///< per axis in cut cells
  double smallest_fraction = 0.02;  ///< [1] cells filled less are dropped
  SymmetryUse use_symmetry = SymmetryUse::THICKNESS;
  elasticity::DensityInterpolation interpolation;
  std::vector<SceneBody> bodies;
  std::vector<SceneSupport> supports;
  std::vector<SceneSupport> symmetry;  ///< symmetry planes stated in the file; each doubles forces and energy
  std::vector<ScenePin> pins;
  std::vector<SceneJoint> joints;
  int copies = 1;                ///< forces and energies of the result are of this many equal parts
  std::vector<ScenePort> ports;  ///< all driven by the one control
  std::vector<SceneLoad> loads;
  Point3 gravity = Point3::Zero();  ///< [m/s2] world axes, on every body's mass, at any control
  std::vector<SceneMonitor> monitors;
  bool control_is_length = true;  ///< [m], travel of the ports; else a load factor [1]
  double to = 0;                  ///< end of the path, which starts at 0 [unit of the control]
  int steps = 0;                  ///< equal steps of the path
  double from = 0;                ///< [m] <= 0: a second path from 0 to here; not in scene files
  int from_steps = 0;             ///< its steps; 0: no second path
  bool back = false;              ///< also trace from `to` to 0
  solver::Enforcement enforcement = solver::Enforcement::ELIMINATION;
  double perturbation = 0;  ///< [m] statics::PathSettings::perturbation; 0: stay on the primary branch
};

/// Least number of equal steps along a length [m] of either sign that are not longer than `step` [m].
int stepCount(double length, double step);
/// Index of the first monitor that is a rotation; -1: none.
int rotationMonitor(const Scene& scene);

/// True if the file holds a scene (has the key `scene`), false for anything else that is YAML.
bool isScene(const std::string& path);
/// Reads a scene file. @throws common::SettingError naming key, value and range; common::FileError
Scene loadScene(const std::string& path);

}  // namespace snapwing::scene
