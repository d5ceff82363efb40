#pragma once
/// What a scene file states: bodies, how they are held, driven, joined and loaded, and the path to follow. SI inside;
/// the file's `length_unit` says what its lengths mean. Schema: docs/scenes.md.

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

/// Which mirror planes of a scene are looked for: none, z (half the thickness of a solid), or x, y and z. MIDDLE: z,
/// with the grid built from that plane on, so that it is there whether or not it lies between cells of the whole grid;
/// not in scene files.
enum class SymmetryUse { NONE, THICKNESS, ALL, MIDDLE };

/// Where a body's own coordinates lie: x = rotation X + origin [m]. All that a scene says of a body is in them.
struct Frame {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Point3 origin = Point3::Zero();
  bool moved() const { return rotation != Eigen::Matrix3d::Identity() || origin != Point3::Zero(); }
  /// A point [m] of the body's own coordinates in the world's, and back.
  Point3 toWorld(const Point3& own) const { return moved() ? Point3(rotation * own + origin) : own; }
  Point3 toOwn(const Point3& world) const { return moved() ? Point3(rotation.transpose() * (world - origin)) : world; }
};

/// A rigid body that is told by its mass and has no cells.
struct GivenMass {
  double mass = 0;                                    ///< [kg]; 0: it has cells
  Point3 centre = Point3::Zero();                     ///< [m]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< about the centre [kg m2]; planar: that about z, last entry
};

struct SceneBody {
  std::string name;
  Frame frame;
  GivenMass given;
  int copy_of = -1;               ///< body that it is a copy of; -1: none
  elasticity::Material material;  ///< of a rigid body only the mass density counts
  bool rigid = false;
  mpm::ShapePtr shape;                               ///< null if given by a density
  mpm::DensityField density;                         ///< empty value if given by a shape
  double thickness = 0;                              ///< [m] along z; planar: of the slice
  std::vector<std::pair<Box, double>> thickness_in;  ///< later ones win
  bool extruded = true;                              ///< volumetric: the shape bounds itself along z if false

  bool hasCells() const { return !(given.mass > 0); }
  double thicknessAt(double x, double y) const;  ///< [m], of a place in the plane [m]
};

/// Displacement components of the part of a body in a region: a face if the region is flat, else all within. Of a body
/// without cells those of a point.
struct SceneSupport {
  std::string name;
  int body = 0;
  Box region;
  std::vector<int> axes;
  Point3 at = Point3::Zero();  ///< of a body without cells
};

enum class PinKind { LINE, MEAN, CYLINDER };

/// An axle along z that the body may turn about.
struct ScenePin {
  std::string name;
  int body = 0;
  double x = 0, y = 0;
  PinKind kind = PinKind::LINE;
  double radius = 0;  ///< [m] of the section: what a mean is taken over, or what turns as a rigid cylinder
};

enum class JointKind { LINE, SEGMENT, FACE };

/// The same material point of two bodies (volumetric: a line along z through the thickness), or all points of a segment
/// or of a face, a cell apart. Places are in the coordinates of the first body.
struct SceneJoint {
  std::string name;
  int first = 0, second = 0;
  double x = 0, y = 0;
  JointKind kind = JointKind::LINE;
  Point3 from = Point3::Zero(), to = Point3::Zero();  ///< ends of the segment
  Box region;                                         ///< face: flat along one axis
};

/// A rigid face that moves by `control * direction`; cross motion is held or free.
struct ScenePort {
  std::string name;
  int body = 0;
  Box region;
  Point3 direction = Point3::Zero();
  bool cross_free = false;
  Point3 at = Point3::Zero();  ///< of a body without cells
};

/// Uniform traction on a face; `force` is its total: for control = 1, or whatever the control is if constant.
struct SceneLoad {
  std::string name;
  int body = 0;
  Box region;
  Point3 force = Point3::Zero();
  bool constant = false;
  Point3 at = Point3::Zero();  ///< of a body without cells
};

/// Displacement of a point, or best-fit rotation about it of what lies within a radius.
struct SceneMonitor {
  std::string name;
  int body = 0;
  Point3 at = Point3::Zero();
  Point3 direction = Point3::Zero();
  double radius = 0;  ///< [m] > 0: rotation about z
};

struct Scene {
  std::string name, file;
  std::vector<std::string> named_files;  ///< that the scene's file names: densities, STL
  std::string sha256;                    ///< of the file and of all that it names
  /// Hash of what is computed, not of how finely: bodies, materials, constraints, loads, length of the path. Names,
  /// kernel, cells, particles, steps, monitors and the way in which a pin holds its section do not count.
  std::string content_sha256;
  int dimension = 2;
  elasticity::Plane plane = elasticity::Plane::STRAIN;
  SceneKernel kernel = SceneKernel::LINEAR_REDUCED;
  double cell_size = 0;             ///< [m]
  int particles = 4;                ///< per axis in cut cells
  double smallest_fraction = 0.02;  ///< cells filled less are left out
  SymmetryUse use_symmetry = SymmetryUse::THICKNESS;
  elasticity::DensityInterpolation interpolation;
  std::vector<SceneBody> bodies;
  std::vector<SceneSupport> supports;
  std::vector<SceneSupport> symmetry;  ///< planes that the user states; each doubles forces and energy
  std::vector<ScenePin> pins;
  std::vector<SceneJoint> joints;
  int copies = 1;                ///< forces and energies of the result are of so many equal parts
  std::vector<ScenePort> ports;  ///< all follow the one control
  std::vector<SceneLoad> loads;
  Point3 gravity = Point3::Zero();  ///< [m/s2] on every body's mass, whatever the control is
  std::vector<SceneMonitor> monitors;
  bool control_is_length = true;  ///< else a load factor [1]
  double to = 0;                  ///< the path leads from 0 to here
  int steps = 0;
  double from = 0;     ///< [m] <= 0: from 0 to here as well, below `to` > 0; not in scene files
  int from_steps = 0;  ///< 0: not
  bool back = false;
  solver::Enforcement enforcement = solver::Enforcement::ELIMINATION;
  double perturbation = 0;  ///< [m] largest motion along the critical mode by which a bifurcation is left; 0: stay
};

/// Least number of equal steps along a length of either sign that are not longer than `step`.
int stepCount(double length, double step);
/// Number of the first monitor that is a rotation; -1: none.
int rotationMonitor(const Scene& scene);

/// True if the file holds a scene (has the key `scene`), false for anything else that is YAML.
bool isScene(const std::string& path);
/// @throws common::SettingError, common::FileError
Scene loadScene(const std::string& path);

}  // namespace snapwing::scene
