#pragma once
/// A scene compiled to an equilibrium problem on background grids, in two or three dimensions.

#include <memory>
#include <string>
#include <vector>

#include "snapwing/common/loan.h"
#include "snapwing/mpm/mass.h"
#include "snapwing/mpm/moving_mass.h"
#include "snapwing/scene/scene.h"
#include "snapwing/scene/scene_sensitivity.h"
#include "snapwing/solver/term_problem.h"

namespace snapwing::scene {

/// Volume of the whole scene's material, density times volume [m3].
struct SceneVolume {
  double modelled = 0;  ///< of the cells' particles
  double bodies = 0;    ///< of the bodies as stated in the scene, by much finer sampling
};

/// Mass of one body at rest, as modelled: without the multiplicity.
struct BodyMass {
  double mass = 0;                 ///< [kg]
  Point3 centre = Point3::Zero();  ///< world [m]
  Eigen::Matrix3d inertia =
      Eigen::Matrix3d::Zero();  ///< about the centre, world axes [kg m2]; planar: about z, last entry
};

/// A compiled scene of either dimension. z: the problem's free coordinates, (free x 1) [m]; p: its one control.
class CompiledScene : public common::Lender {
 public:
  virtual ~CompiledScene() = default;
  virtual const solver::Problem& problem() const = 0;
  /// The same problem as a TermProblem, kept constraints included. The object stays valid when densities change.
  virtual const solver::TermProblem& terms() const = 0;
  virtual std::shared_ptr<const solver::TermProblem> sharedTerms() const = 0;
  /// Inertia of all bodies, rigid ones included, at the current densities: a further term for a problem in time.
  virtual std::shared_ptr<const solver::Term> inertia(mpm::MassKind kind) const = 0;
  /// Mass, centre and inertia of a body at the current densities. @param body  index in Scene::bodies
  virtual BodyMass bodyMass(int body) const = 0;
  /// The solids of a planar or of a volumetric scene, else null.
  virtual const mpm::Discretisation<2>* planar() const = 0;
  virtual const mpm::Discretisation<3>* volumetric() const = 0;
  /// Forces and energies of the whole scene / those of the problem [1].
  virtual double multiplicity() const = 0;
  /// Symmetry planes used, in words, or "none".
  virtual const std::string& symmetry() const = 0;
  virtual int cellCount() const = 0;
  /// Sets the densities, one per cell of all bodies, in [0, 1]. Objects with a state of the problem (Newton, path) must
  /// be created again. @throws common::Error for a wrong count or value
  virtual void setDensities(const std::vector<double>& densities) = 0;
  /// Values of the scene's monitors, (monitors) [m] or [rad].
  virtual std::vector<double> monitors(const Eigen::VectorXd& z, double p) const = 0;
  /// One monitor [m] or [rad], from the full coordinates, or if all bodies have cells from the nodal displacements
  /// alone. Each body's displacements are in the axes of its frame.
  /// @param gradient  if given: derivative with respect to the nodal displacements, (dofs x 1)
  /// @throws common::Error for a point outside its body
  virtual double monitor(int number, const Eigen::VectorXd& displacements,
                         Eigen::VectorXd* gradient = nullptr) const = 0;
  /// Inertia of the whole scene with respect to the control, as seen by a frame whose motion is positive against the
  /// direction of the first port. Without a port the coupled mass is zero. @param slope  dz/dp along the path
  virtual mpm::MovingMass movingMass(const Eigen::VectorXd& z, double p, const Eigen::VectorXd& slope) const = 0;
  /// Share of the material's volume in dropped cells [1] (Scene::smallest_fraction).
  virtual double droppedShare() const = 0;
  /// Volume as modelled and as stated. Takes up to seconds.
  virtual SceneVolume volume() const = 0;
  /// Derivatives at an equilibrium, whose `at` and `multipliers` must be those of a converged solve. The scene is lent
  /// to the result. @throws common::Error for a singular Hessian, rigid bodies or cylinder pins, and for a joint at the
  /// edge of a body
  virtual std::unique_ptr<SceneSensitivity> sensitivity(const solver::Equilibrium& x) const = 0;
  /// Deformed cells for ParaView: text of an unstructured-grid file (VTU).
  virtual std::string vtu(const Eigen::VectorXd& z, double p) const = 0;
  /// Likewise of nodal displacements [m] in the axes of their bodies, (dofs x 1).
  virtual std::string vtuOf(const Eigen::VectorXd& displacements) const = 0;
};

/// Compiles a scene. @param threads  of assembly, >= 1
/// @throws common::Error naming the support, port, pin, joint or load that meets no material or contradicts another
std::unique_ptr<CompiledScene> compileScene(const Scene& scene, int threads);

}  // namespace snapwing::scene
