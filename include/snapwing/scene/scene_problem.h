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

/// Volume of the scene's material, each cell's weighted with its density as the scene gives it [m3].
struct SceneVolume {
  double modelled = 0;  ///< that of the cells' particles
  double bodies = 0;    ///< that of the bodies as stated, by far finer samples
};

/// Of one body at rest.
struct BodyMass {
  double mass = 0;                 ///< [kg]
  Point3 centre = Point3::Zero();  ///< in the world [m]
  Eigen::Matrix3d inertia =
      Eigen::Matrix3d::Zero();  ///< about the centre, in the world's axes [kg m2]; planar: about z
};

/// What a command needs to know, whatever the dimension. z are the problem's free coordinates, p its one control.
class CompiledScene : public common::Lender {
 public:
  virtual ~CompiledScene() = default;
  virtual const solver::Problem& problem() const = 0;
  /// The sum of terms that it is, without what is kept as an equation. Stays what it is when densities change.
  virtual const solver::TermProblem& terms() const = 0;
  virtual std::shared_ptr<const solver::TermProblem> sharedTerms() const = 0;
  /// Inertia of all bodies, rigid ones as well, at the densities of now: a term more for a problem in time.
  virtual std::shared_ptr<const solver::Term> inertia(mpm::MassKind kind) const = 0;
  /// Mass, centre and inertia of a body as it is modelled, at the densities of now.
  virtual BodyMass bodyMass(int body) const = 0;
  /// The solids of a planar or of a volumetric scene, null otherwise.
  virtual const mpm::Discretisation<2>* planar() const = 0;
  virtual const mpm::Discretisation<3>* volumetric() const = 0;
  /// Forces and energies of the whole are this times those of the problem.
  virtual double multiplicity() const = 0;
  /// What symmetry was used, in words; "none".
  virtual const std::string& symmetry() const = 0;
  virtual int cellCount() const = 0;
  /// New densities, one per cell of all bodies, in [0, 1]. What holds a state of the problem (a Newton, a path) must
  /// start anew. @throws common::Error for a wrong count or value
  virtual void setDensities(const std::vector<double>& densities) = 0;
  /// Values of the scene's monitors.
  virtual std::vector<double> monitors(const Eigen::VectorXd& z, double p) const = 0;
  /// One monitor at the full coordinates, or without bodies that have no cells at the solid's nodal displacements.
  /// Bodies with a frame move in its axes. @param gradient  if given, gets the derivative by them, (dofs x 1)
  virtual double monitor(int number, const Eigen::VectorXd& displacements,
                         Eigen::VectorXd* gradient = nullptr) const = 0;
  /// Inertia of the whole against the control, with `slope` dz/dp along the path. The axis points against the direction
  /// of the first port: what a frame feels whose port lags behind. Zero coupled mass without a port.
  virtual mpm::MovingMass movingMass(const Eigen::VectorXd& z, double p, const Eigen::VectorXd& slope) const = 0;
  /// Share of the material's volume in cells that were left out as slivers.
  virtual double droppedShare() const = 0;
  /// What cells, particles and left out slivers make of the bodies' volume. Costs up to seconds.
  virtual SceneVolume volume() const = 0;
  /// Derivatives at an equilibrium, whose `at` and `multipliers` must be those of a converged solve. The scene is lent
  /// to the result. @throws common::Error where there are none: a singular Hessian, rigid bodies or cylinder pins, a
  /// joint at the edge of a body
  virtual std::unique_ptr<SceneSensitivity> sensitivity(const solver::Equilibrium& x) const = 0;
  /// Deformed cells for ParaView, as the text of an unstructured-grid file (VTU).
  virtual std::string vtu(const Eigen::VectorXd& z, double p) const = 0;
  /// The same of nodal displacements in the axes of their bodies, whatever holds them.
  virtual std::string vtuOf(const Eigen::VectorXd& displacements) const = 0;
};

/// @param threads  for assembly
/// @throws common::Error naming the support, port, pin or joint that meets no material
std::unique_ptr<CompiledScene> compileScene(const Scene& scene, int threads);

}  // namespace snapwing::scene
