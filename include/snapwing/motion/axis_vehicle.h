#pragma once
/// The vehicle along its thrust axis (y): a rigid ring and a rigid centre, connected by soft arms as solids. One arm
/// represents all arms that move alike, and masses and forces are scaled to its share. Without wings there is one arm.
/// With wings, arms with and without a wing are modelled separately; so are left and right if their friction differs.
/// Full coordinates: nodal displacements in space, displacements and rotations of the wings' bars, then the positions
/// of ring and centre along the axis [m]. Every mass is constant in them.
///
/// Included: the arm's inertia, large rotation and all its modes; rotor lag; gravity along the axis; drag of ring and
/// centre; on a boom its inertia, drag and friction at the tip; the upper stop with restitution; damping of the travel
/// or of the material; the wings' linkages, which load the arms. leftOut() lists what is neglected.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "snapwing/elasticity/prony_series.h"
#include "snapwing/motion/hand_motion.h"
#include "snapwing/motion/trial_vehicle.h"
#include "snapwing/motion/wing_assembly.h"
#include "snapwing/mpm/coarsening.h"
#include "snapwing/scene/arm_scene.h"
#include "snapwing/solver/row.h"
#include "snapwing/vehicle/force_table.h"
#include "snapwing/vehicle/mode.h"
#include "snapwing/vehicle/trial.h"
#include "snapwing/vehicle/vehicle_parameters.h"

namespace snapwing::motion {

class ArmStrain;

/// Law of damping; each is scaled to the vehicle file's damping ratio in Q.
enum class DampingLaw {
  TRAVEL,              ///< c u' on the travel, as in the lumped model
  RAYLEIGH,            ///< the paper's: lagged, exact tangent; ADDS energy on the branch of negative stiffness
  RAYLEIGH_PROJECTED,  ///< lagged, each particle's tangent projected
  KELVIN_VOIGT,        ///< beta C : rate of Green's strain
};
/// @param name  travel, rayleigh, rayleigh_projected or kelvin_voigt. @throws common::Error
DampingLaw dampingFromName(const std::string& name);
std::string dampingName(DampingLaw law);

struct AxisSettings {
  int dimension = 2;  ///< 2: plane stress; 3: half the arm's thickness by symmetry
  scene::SceneKernel kernel = scene::SceneKernel::LINEAR;
  double cell_size = 0;                                ///< [m]; 0: that of the arm's density
  mpm::Coarsening coarsening = mpm::Coarsening::MASS;  ///< what coarser cells conserve of the density
  double least_density = 0.2;  ///< [1] cells below are left out: light cells invert in violent trials
  mpm::MassKind mass = mpm::MassKind::CONSISTENT;
  DampingLaw damping = DampingLaw::TRAVEL;
  bool relaxation = true;         ///< use material.relaxation of the vehicle file, if given
  double relaxation_share = 0;    ///< [-1, 1] position of its shares within their half widths
  double relaxation_time = 0;     ///< [-1, 1] position of its times within their half widths
  double stop_stiffness = 5e4;    ///< [N/m] of the upper stop; an assumption, as the restitution
  double stop_restitution = 0.5;  ///< [1] in (0, 1]
  double hub_stiffness = 1000;    ///< [N m] coupling of a wing's crank to its arm (HubTerm); assumed, stiff
  double hub_radius = 0.004;      ///< [m] about the axle: the crank follows the mean rotation of the arm's nodes within
  bool wings_follow_travel = false;  ///< true: the crank follows the static path's rotation, as in the lumped model
  std::optional<double> wing_stop;   ///< [N m/rad] instead of the vehicle's wing.stop; 0: none
  double friction_left = 1, friction_right = 1;  ///< [1] factors of the friction of each wing's pins
  WingForces wing_forces;                        ///< except rest_stop, which is `wing_stop`
  /// For motion in space: nodes cannot slide along an axle, and light cells have no linear part
  /// (elasticity::DensityInterpolation), which would not be invariant to rotations.
  bool in_space = false;
  bool whole_thickness = false;      ///< the whole solid instead of half of it by symmetry
  std::optional<HandSettings> hand;  ///< moves the ring, with mount HELD; unset: the ring stands still
  int threads = 1;
  std::function<bool()> cancelled;  ///< polled while the static curve is traced; true ends it with an error
};

class AxisVehicle : public TrialVehicle {
 public:
  /// @param parameters  of this vehicle, from vehicle::realise: masses, drag, damping c, force_scale
  /// @param trial       mount, gravity, push; wings only if on
  /// @param wing        table of the wings, required if they are on
  /// @throws common::Error for wings on a boom, a ring side that is lighter than arms and wings, an arm that is not
  /// bistable, and a relaxation with more loss than the damping ratio
  AxisVehicle(const vehicle::Vehicle& vehicle, const vehicle::VehicleParameters& parameters,
              const vehicle::Trial& trial, const AxisSettings& settings,
              const std::optional<vehicle::WingTable>& wing = {});

  std::shared_ptr<const solver::TermProblem> problem() const override { return problem_; }
  /// Controls: thrust of the whole vehicle [N]; with a hand also its acceleration [m/s2].
  double shareOfVehicle() const override { return share_; }
  const StaticCurve& curve() const override { return *curve_; }
  double lowerBarrier() const override;
  double valleyForce() const override { return curve_->valleyForce() / share_; }
  double armMass() const override { return arm_mass_; }
  /// Damping c of the travel, of the vehicle, without the loss of the relaxation [N s/m].
  double travelDamping() const { return rest_of_damping_; }
  const elasticity::PronySeries& series() const { return series_; }  ///< of the relaxation; empty: none
  double materialTime() const { return material_time_; }  ///< beta [s] of the material's damping law; 0: TRAVEL

  /// The static curve with the arm's inertia as a table of one arm, without provenance: input for a lumped model of the
  /// same solid.
  vehicle::ForceTable staticTable() const override;
  /// Likewise a table of the wings as modelled here. @throws common::Error without wings
  vehicle::WingTable staticWingTable() const;
  const WingLinkage* linkage() const override { return linkage_.get(); }

  MotionState start(vehicle::Mode mode, double thrust, bool* held = nullptr) const override;
  Eigen::VectorXd controls(double from, double h, double thrust) const override;
  AxisSample sample(const MotionState& s) const override;

  double ringPosition(const MotionState& s) const { return ring_ < 0 ? 0.0 : s.y(ring_); }  ///< [m]
  double ringSpeed(const MotionState& s) const { return ring_ < 0 ? 0.0 : s.v(ring_); }     ///< [m/s]
  double centreSpeed(const MotionState& s) const { return s.v(centre_); }                   ///< [m/s]
  double travel(const MotionState& s) const { return ringPosition(s) - s.y(centre_); }      ///< u [m]
  double travelRate(const MotionState& s) const { return ringSpeed(s) - centreSpeed(s); }   ///< u' [m/s]
  /// Rotation of the (left) arm about its axle, relative to the ring [rad].
  double armRotation(const MotionState& s) const;
  /// Rotation of a wing from rest [rad]; NaN without wings.
  double wingAngle(const MotionState& s, bool left) const;
  /// Largest angle between a crank and its arm [rad]; 0 without wings.
  double hubTwist(const MotionState& s) const;
  /// Translation of the whole vehicle along the axis; empty for a held ring.
  RigidMotions rigidMotions() const override;
  double commonSpeed(const MotionState& s, const Stepper& stepper) const override;
  double relativeKinetic(const MotionState& s, const Stepper& stepper) const override;
  /// Deformed arms in the ring's frame.
  std::string vtu(const MotionState& s) const override;
  std::vector<std::string> leftOut() const override;
  int cellCount() const override { return scene_->cellCount(); }

  const scene::CompiledScene& scene() const { return *scene_; }

 private:
  int controlCount() const { return hand_ ? 2 : 1; }
  Eigen::VectorXd inRingFrame(const MotionState& s) const;
  void addWings(const vehicle::Vehicle& vehicle, const vehicle::VehicleParameters& p,
                const std::optional<vehicle::WingTable>& wing);
  void placeWings();
  std::vector<std::shared_ptr<const solver::Term>> wingForces();
  SmoothCurve staticRotation() const;
  std::vector<solver::Equation> armEquations() const;
  void join(solver::TermProblem::Parts& parts) const;
  solver::HessianLayout layout() const;
  Eigen::VectorXd armUp() const;  ///< unit displacement of the arms' nodes along the axis
  Eigen::VectorXd allUp() const;  ///< likewise of all bodies
  solver::Row travelRow() const;
  /// @param carried  mass of arms and wings, which is part of the ring's [kg]
  std::vector<std::shared_ptr<const solver::Term>> bodies(const vehicle::VehicleParameters& p, double carried) const;
  std::shared_ptr<const solver::Term> loads(const vehicle::VehicleParameters& p, double carried,
                                            const Eigen::VectorXd& moved) const;
  std::shared_ptr<const solver::Term> damping(double c);
  /// Damping c of the travel in Q that is equivalent to the relaxation [N s/m], of the vehicle.
  double lossOfMemory(const vehicle::VehicleParameters& p) const;
  double restOfDamping(const vehicle::VehicleParameters& p) const;
  std::shared_ptr<const solver::Term> memory() const;
  template <int D>
  std::shared_ptr<const solver::Term> materialDampingIn(DampingLaw law, double beta) const;
  std::shared_ptr<const solver::Term> materialDamping(DampingLaw law, double beta) const;
  double lossOf(const solver::Term& term) const;

  vehicle::Trial trial_;
  AxisSettings settings_;
  double stop_ = 0;
  elasticity::PronySeries series_;  ///< empty: no relaxation
  bool memory_known_ = false;       ///< the vehicle file states a relaxation
  std::unique_ptr<scene::CompiledScene> scene_;
  std::shared_ptr<const ArmStrain> strain_;
  std::unique_ptr<StaticCurve> curve_;
  double share_ = 1, arm_mass_ = 0, rest_of_damping_ = 0, material_time_ = 0;
  std::optional<HandMotion> hand_;
  int nodes_ = 0;  ///< number of the arms' nodal coordinates
  int ring_ = -1, centre_ = 0;
  int arms_ = 1;
  std::vector<int> groups_;  ///< number of arms that each modelled arm represents; forces refer to one of the first
  std::shared_ptr<const WingLinkage> linkage_;
  WingAssembly wings_;
  std::vector<std::shared_ptr<const Hub>> hubs_;
  std::shared_ptr<const solver::TermProblem> problem_;
};

}  // namespace snapwing::motion
