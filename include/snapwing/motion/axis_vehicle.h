#pragma once
/// The vehicle along its thrust axis with one soft arm for all that move alike: a rigid ring and a rigid centre, joined
/// by the arm as a solid, with the arm's share of all masses and forces. Without wings that is one arm. With wings the
/// arms that carry one are another than the others, and where left and right differ there are two of them. Full
/// coordinates are the nodes' displacements in space, places and rotations of the wings' bars, then the places of ring
/// and centre [m], so that every mass is constant.
///
/// What is in: the arm's own inertia, its large rotation and every mode of it; rotor lag; gravity along the axis; drag
/// of ring and centre; on a boom its inertia, drag and friction at the tip; the upper stop with restitution; damping of
/// the travel or of the material; the wings' linkages, whose load turns and bends the arm. leftOut() says what is not.

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

/// Where the loss that the file's damping ratio states goes; all give that ratio in Q.
enum class DampingLaw {
  TRAVEL,              ///< c u' on the travel, none in the material: the lumped model's
  RAYLEIGH,            ///< the paper's: lagged, with the exact tangent; FEEDS the falling branch
  RAYLEIGH_PROJECTED,  ///< lagged, with each particle's tangent projected
  KELVIN_VOIGT,        ///< beta C : rate of Green's strain
};
/// travel, rayleigh, rayleigh_projected or kelvin_voigt. @throws common::Error
DampingLaw dampingFromName(const std::string& name);
std::string dampingName(DampingLaw law);

struct AxisSettings {
  int dimension = 2;  ///< 2: plane stress; 3: half the arm's thickness by symmetry
  scene::SceneKernel kernel = scene::SceneKernel::LINEAR;
  double cell_size = 0;                                ///< [m]; 0: that of the arm's density
  mpm::Coarsening coarsening = mpm::Coarsening::MASS;  ///< what cells that are coarser than the file's keep
  double least_density = 0.2;  ///< cells below are left out: lighter ones invert in violent trials
  mpm::MassKind mass = mpm::MassKind::CONSISTENT;
  DampingLaw damping = DampingLaw::TRAVEL;
  bool relaxation = true;         ///< with the memory of the material that the vehicle file states, if any
  double relaxation_share = 0;    ///< where its shares lie in their half widths, [-1, 1]
  double relaxation_time = 0;     ///< the same of its times
  double stop_stiffness = 5e4;    ///< [N/m] of the upper stop; assumption, as the restitution
  double stop_restitution = 0.5;  ///< [1] in (0, 1]
  /// [N m] by which a wing's crank is held in the mean rotation of its arm within 4 mm of the axle: an assumption,
  /// stiff
  double hub_stiffness = 1000;
  double hub_radius = 0.004;  ///< [m] of the arm's material about the axle in whose rotation the crank is held
  bool wings_follow_travel =
      false;                        ///< true: tied to the static path's rotation at the travel, the lumped model's rule
  std::optional<double> wing_stop;  ///< [N m] per rad in place of the vehicle's wing.stop; 0: none
  double friction_left = 1, friction_right = 1;  ///< [1] times the friction of that wing's pins
  WingForces wing_forces;                        ///< beside the stop at rest, which is `wing_stop`
  /// As motion in space needs it: axles hold their lines along themselves too, which may slide else, and light cells
  /// have no linear part (elasticity::DensityInterpolation), which would feel a rotation.
  bool in_space = false;
  bool whole_thickness = false;      ///< a solid without its plane of symmetry, which motion in space has not
  std::optional<HandSettings> hand;  ///< that holds the ring, with mount HELD; unset: the ring stands still
  int threads = 1;
  std::function<bool()> cancelled;  ///< polled while the static curve is followed; true ends it with an error
};

class AxisVehicle : public TrialVehicle {
 public:
  /// @param parameters  of this vehicle, from vehicle::realise: masses, drag, damping c, force_scale
  /// @param trial       mount, gravity, push; wings on
  /// @param wing        table of the wings, needed if they are on. @throws common::Error for wings on a boom, a ring
  /// that is lighter than its arms and wings, an arm that is not bistable
  AxisVehicle(const vehicle::Vehicle& vehicle, const vehicle::VehicleParameters& parameters,
              const vehicle::Trial& trial, const AxisSettings& settings,
              const std::optional<vehicle::WingTable>& wing = {});

  std::shared_ptr<const solver::TermProblem> problem() const override { return problem_; }
  /// Controls of the problem are the thrust of the whole vehicle [N], then with a hand its acceleration [m/s2].
  double shareOfVehicle() const override { return share_; }
  const StaticCurve& curve() const override { return *curve_; }
  double lowerBarrier() const override;
  double valleyForce() const override { return curve_->valleyForce() / share_; }
  double armMass() const override { return arm_mass_; }
  double travelDamping() const { return rest_of_damping_; }          ///< c that is left beside the memory [N s/m]
  const elasticity::PronySeries& series() const { return series_; }  ///< of the memory; empty: none
  double materialTime() const { return material_time_; }  ///< [s] of the material's damping law; 0: on the travel

  /// The static curve with the arm's inertia as a table of one arm, without provenance: what the lumped model needs to
  /// be compared with this solid and not with another.
  vehicle::ForceTable staticTable() const override;
  /// The same of the wings as they are here. @throws common::Error without wings
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
  /// Rotation of the (left) arm about its axle [rad].
  double armRotation(const MotionState& s) const;
  /// Rotation of a wing from rest [rad]; NaN without wings.
  double wingAngle(const MotionState& s, bool left) const;
  /// Largest angle between a crank and its arm [rad]; 0 without wings.
  double hubTwist(const MotionState& s) const;
  /// The motion of all along the axis.
  RigidMotions rigidMotions() const override;
  double commonSpeed(const MotionState& s, const Stepper& stepper) const override;
  double relativeKinetic(const MotionState& s, const Stepper& stepper) const override;
  /// In the ring's frame.
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
  Eigen::VectorXd armUp() const;  ///< the arm's nodes by 1 along the axis
  Eigen::VectorXd allUp() const;  ///< all that moves
  solver::Row travelRow() const;
  /// @param carried  mass of arms and wings, which is part of the ring's [kg]
  std::vector<std::shared_ptr<const solver::Term>> bodies(const vehicle::VehicleParameters& p, double carried) const;
  std::shared_ptr<const solver::Term> loads(const vehicle::VehicleParameters& p, double carried,
                                            const Eigen::VectorXd& moved) const;
  std::shared_ptr<const solver::Term> damping(double c);
  /// c of the travel in Q that the memory makes of it [N s/m] of the vehicle.
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
  elasticity::PronySeries series_;  ///< empty: no memory
  bool memory_known_ = false;       ///< the vehicle file states one
  std::unique_ptr<scene::CompiledScene> scene_;
  std::unique_ptr<StaticCurve> curve_;
  double share_ = 1, arm_mass_ = 0, rest_of_damping_ = 0, material_time_ = 0;
  std::optional<HandMotion> hand_;
  int nodes_ = 0;  ///< coordinates of the arms' nodes
  int ring_ = -1, centre_ = 0;
  int arms_ = 1;
  std::vector<int> groups_;  ///< how many arms each that is modelled stands for; forces refer to one of the first
  std::shared_ptr<const WingLinkage> linkage_;
  WingAssembly wings_;
  std::vector<std::shared_ptr<const HubTerm>> hubs_;
  std::shared_ptr<const solver::TermProblem> problem_;
};

}  // namespace snapwing::motion
