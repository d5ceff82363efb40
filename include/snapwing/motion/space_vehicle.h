#pragma once
/// The vehicle in space: ring and housing as rigid bodies with six degrees of freedom each, connected by all soft arms,
/// which are arranged around the axis. Propellers are follower forces. On a boom, ring and boom are one body that
/// rotates about the boom's axis, so that the centripetal load acts on centre, arms and wings. World axes: y is the
/// thrust axis at the start, x points along the first arm (and outwards along the boom), the origin lies on the thrust
/// axis at the arms' lower edge. The first arm carries the left wing and the opposite arm the right one; on a boom both
/// lie in its plane of rotation, the left one outside. In free flight their bars turn in space with the ring.
///
/// Full coordinates: nodal displacements in the axes of each arm; c of ring, housing and the wings' bars; then their E
/// (solver/rotation.h). kept() and leftOut() list what is included and what is neglected.

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "snapwing/motion/axis_vehicle.h"
#include "snapwing/solver/point_terms.h"

namespace snapwing::motion {

struct SpaceSettings {
  std::vector<double> rotor_scale;          ///< [1] 0 .. 2, factor of each rotor's thrust; empty: all 1
  double rotor_angle = 0.7853981633974483;  ///< [rad] from the first arm to the first rotor; equal spacing
  double moment_per_thrust = 0;             ///< [m] >= 0, yaw moment of a propeller / thrust; signs alternate
  double no_thrust_speed = 0;  ///< [m/s] >= 0, axial speed at which full thrust is lost (solver::Propeller); 0: none is
  double sag = 0;              ///< [1] 0 .. 0.9, thrust lost at full thrust of all rotors by the battery's voltage drop
  double gravity_across = 0;   ///< [m/s2] gravity against x, in addition to the trial's against y
  /// @throws common::Error naming the member. @param rotors  of the vehicle
  void validate(int rotors) const;
};

class SpaceVehicle : public TrialVehicle {
 public:
  /// @param settings  of the arms: dimension 3; damping TRAVEL or KELVIN_VOIGT, which do not damp rigid rotations
  /// @param wing  table of the wings, required if they are on (an even number of arms)
  /// @throws common::Error for anything else, wings that follow the travel, or a hand
  SpaceVehicle(const vehicle::Vehicle& vehicle, const vehicle::VehicleParameters& parameters,
               const vehicle::Trial& trial, const AxisSettings& settings, const SpaceSettings& space,
               const std::optional<vehicle::WingTable>& wing = {});

  std::shared_ptr<const solver::TermProblem> problem() const override { return problem_; }
  double shareOfVehicle() const override { return 1; }
  const StaticCurve& curve() const override { return axis_.curve(); }
  double lowerBarrier() const override { return axis_.lowerBarrier(); }
  double valleyForce() const override { return axis_.valleyForce(); }
  vehicle::ForceTable staticTable() const override { return axis_.staticTable(); }
  double armMass() const override { return axis_.armMass(); }
  const WingLinkage* linkage() const override { return linkage_.get(); }
  /// Equilibrium of the model along the axis: symmetric, without wing loads.
  MotionState start(vehicle::Mode mode, double thrust, bool* held = nullptr) const override;
  Eigen::VectorXd controls(double from, double h, double thrust) const override;
  AxisSample sample(const MotionState& s) const override;
  double turnLength() const override { return 2 * EIGEN_PI * boom_; }
  RigidMotions rigidMotions() const override;
  double commonSpeed(const MotionState& s, const Stepper& stepper) const override;
  std::string vtu(const MotionState& s) const override;
  std::vector<std::string> kept() const override;
  std::vector<std::string> leftOut() const override;
  int cellCount() const override { return scene_->cellCount(); }
  const AxisVehicle& axis() const { return axis_; }

  /// Rates of the full coordinates for the rigid velocity field velocity + turn x position, world axes.
  /// @param y  full coordinates [m]; @param velocity  of the origin [m/s]; @param turn  [rad/s]. @return [m/s]
  Eigen::VectorXd rigidRates(const Eigen::VectorXd& y, const Eigen::Vector3d& velocity,
                             const Eigen::Vector3d& turn) const;
  /// Linear [kg m/s] and angular momentum about the origin [kg m2/s], world axes.
  Eigen::Vector3d linearMomentum(const Stepper& stepper, const MotionState& s) const;
  Eigen::Vector3d angularMomentum(const Stepper& stepper, const MotionState& s) const;
  double mass() const { return mass_; }  ///< of all that moves [kg]
  /// Position of the ring's centre at rest [m], and angular velocity of the ring [rad/s], world axes.
  const Eigen::Vector3d& ringCentre() const { return ring_centre_; }
  Eigen::Vector3d ringTurning(const MotionState& s) const;
  /// Rotation of the ring from rest, world axes.
  Eigen::Matrix3d ringOrientation(const MotionState& s) const { return orientation(ring_, s.y); }
  Eigen::Vector3d rotorPlace(int rotor) const;  ///< position of a rotor at rest [m], world axes

 private:
  struct RigidBody {
    int centre_at = 0;  ///< full coordinate of c
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    solver::Rotation rotation;
  };
  /// Three full coordinates that rotate with the vehicle as a vector: a node's position, a centre + c, a column of
  /// L I + E.
  struct Arrow {
    int first = 0, arm = -1;                         ///< arm: in whose axes; -1: world axes
    Eigen::Vector3d rest = Eigen::Vector3d::Zero();  ///< world axes [m]
    bool moves = true;                               ///< true: a position; false: a column of E, no translation
  };
  void placeBodies(const vehicle::Vehicle& vehicle);
  void addWings(const vehicle::Vehicle& vehicle, const vehicle::VehicleParameters& p, const AxisSettings& settings,
                const std::optional<vehicle::WingTable>& wing);
  int armOfWing(int wing) const { return wing == 0 ? 0 : arms_ / 2; }
  std::vector<std::shared_ptr<const solver::Term>> wingForces(const AxisSettings& settings);
  void findArrows();
  std::vector<solver::Equation> equations() const;
  void join(solver::TermProblem::Parts& parts) const;
  /// Displacement component of a body's point, in the axes of an arm.
  struct Followed {
    Eigen::Vector3d rest;  ///< in the world [m]
    int arm = 0, axis = 0;
  };
  void addFollowing(const Followed& at, double factor, const RigidBody& body, std::map<int, double>& terms) const;
  Turning ringTurningAbout(int arm) const;
  Directions ringDirections(int arm) const;
  double wingAngle(const MotionState& s, int wing, const Eigen::VectorXd& in_ring_frame) const;
  std::vector<std::shared_ptr<const solver::Term>> bodies(const vehicle::VehicleParameters& p) const;
  std::vector<std::shared_ptr<const solver::Term>> forces(const vehicle::VehicleParameters& p) const;
  std::vector<std::shared_ptr<const solver::Term>> propellers(const vehicle::VehicleParameters& p) const;
  std::shared_ptr<const solver::Term> weight() const;
  Eigen::VectorXd wholeArm(const Eigen::VectorXd& along) const;
  solver::SpacePoint pointOf(const RigidBody& body, const Eigen::Vector3d& at) const;
  Eigen::Vector3d inWorld(const Arrow& arrow, const Eigen::VectorXd& full) const;
  Eigen::Matrix3d orientation(const RigidBody& body, const Eigen::VectorXd& y) const;
  Eigen::VectorXd inRingFrame(const Eigen::VectorXd& y) const;
  bool onBoom() const { return trial_.mount == vehicle::Mount::BOOM; }

  vehicle::Trial trial_;
  SpaceSettings space_;
  AxisVehicle axis_;
  int rotors_ = 0, arms_ = 0, nodes_ = 0, per_arm_ = 0, full_ = 0;
  double max_thrust_ = 0, mass_ = 0, half_ = 0, boom_ = 0, rotor_radius_ = 0, housing_height_ = 0, stop_ = 0;
  double stop_stiffness_ = 0, restitution_ = 0;
  std::unique_ptr<scene::CompiledScene> scene_;
  std::shared_ptr<const ArmStrain> strain_;
  std::vector<Eigen::Matrix3d> turned_;  ///< axes of each arm, in columns, world
  std::vector<Eigen::Vector3d> origin_;
  RigidBody ring_, housing_;
  std::shared_ptr<const WingLinkage> linkage_;
  WingAssembly wings_;
  WingForces wing_forces_;
  Eigen::Vector3d axle_ = Eigen::Vector3d::Zero();  ///< of an arm, in its axes [m]
  std::vector<std::shared_ptr<const Hub>> hubs_;
  Eigen::Vector3d ring_centre_ = Eigen::Vector3d::Zero();
  std::vector<Arrow> arrows_;
  solver::SpacePoint hub_, strut_;  ///< the ring's centre; vector from a point of the housing to one of the ring
  std::shared_ptr<const solver::TermProblem> problem_;
};

}  // namespace snapwing::motion
