#pragma once
/// Two bodies on the thrust axis, joined by the arms' potential: ring side m_r (with the boom, if mounted on one) and
/// centre m_c, u = z_ring - z_centre.
///   m_r z_r'' = T - D_r(z_r') - friction - F(u) - c u' - m_r g + P     (P: push from outside, of the trial)
///   m_c z_c'' =     - D_c(z_c')          + F(u) + c u' - m_c g
/// With arms that have mass, and with wings (rom/travel_inertia.h), the travel has the inertia m(u) = m_c + K - (m_c -
/// S)^2 / (m_r + m_c) and
///   m(u) u'' + m'(u) u'^2 / 2 = L(u) - F(u) - c u' - friction of the pins
/// docs/reduced_model.md derives it. D = k |v| v. Thrust follows q s^2 + (1-q) s of the motor output s by a first-order
/// lag (own constants up and down). Time stepping: implicit midpoint with the discrete gradient (E(u1) - E(u0)) / (u1 -
/// u0) for the elastic force, so that without loads and losses the energy is kept to rounding [Gonzalez 1996]; m(u) is
/// treated alike. Second order; steps end where the command changes.

#include <functional>
#include <memory>
#include <vector>

#include "snapwing/rom/loaded_basins.h"
#include "snapwing/rom/potential.h"
#include "snapwing/rom/prediction.h"
#include "snapwing/rom/travel_inertia.h"
#include "snapwing/vehicle/pulse.h"
#include "snapwing/vehicle/trial.h"
#include "snapwing/vehicle/vehicle_parameters.h"

namespace snapwing::rom {

/// Motion at one instant.
struct LumpedState {
  double time = 0;                                                 ///< [s] after the command
  double position = 0;                                             ///< [m] of the ring side along the thrust axis
  double ring_speed = 0;                                           ///< [m/s]
  double centre_speed = 0;                                         ///< [m/s]
  double travel = 0;                                               ///< u [m]
  double thrust = 0;                                               ///< [N]
  double travelRate() const { return ring_speed - centre_speed; }  ///< u' [m/s]
};

struct LumpedSettings {
  double step = 5e-4;            ///< [s] largest step, (0, 0.01]
  double friction_speed = 0.02;  ///< [m/s] Coulomb friction is friction * v / sqrt(v^2 + friction_speed^2)
  /// Settled: thrust and command at rest and the energy of the relative motion above its minimum below this share of
  /// the smaller barrier, (0, 1)
  double settled_share = 0.02;
  double convergence = 1e-13;  ///< [1] relative move of the speeds at which a step's Newton iteration ends, (0, 1e-3]
  /// @throws common::Error naming the member
  void validate() const;
};

/// Wings act in this trial: where they are and not left out, but not on a boom unless the trial says so.
/// @throws common::Error if the trial asks for wings and there are none
bool wingsAct(const vehicle::Trial& trial, bool has_wings);

/// Called after each step. @return false to stop
using LumpedObserver = std::function<bool(const LumpedState&)>;

/// Immutable after construction: predict() may be called from several threads.
class LumpedModel {
 public:
  /// @param idle_fraction  steady thrust at motor idle / full thrust [0, 1)
  /// @param wing  scales applied; nullptr: none
  /// @param arms  their inertia; nullptr: weightless
  /// @throws common::Error for bad parameters (masses and time constants > 0, the rest >= 0, all finite)
  LumpedModel(std::shared_ptr<const Potential> potential, const vehicle::VehicleParameters& parameters,
              double idle_fraction, const LumpedSettings& settings = {},
              std::shared_ptr<const TravelInertia> wing = nullptr, std::shared_ptr<const TravelInertia> arms = nullptr);

  /// The usual way: spline, wings and idle thrust from the vehicle and its tables. @throws common::Error
  static LumpedModel fromVehicle(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table,
                                 const vehicle::VehicleParameters& parameters, const LumpedSettings& settings = {},
                                 const std::optional<vehicle::WingTable>& wing = {});

  /// Steady thrust share of a stick throttle for these parameters. @param throttle [0, 1]
  double thrustFraction(const vehicle::Radio& radio, double throttle) const;

  /// What a pulse does.
  /// @param start      F or Q; the motion starts in its equilibrium under the initial loads
  /// @param fraction   steady thrust of the pulse / full thrust [0, 1]
  /// @param duration   of the command [s], >= 0
  /// @param observer   optional, sees each step
  /// @throws common::Error for UNKNOWN start, a potential that is not bistable, bad pulse or trial
  SnapPrediction predict(vehicle::Mode start, double fraction, double duration, const vehicle::Trial& trial,
                         const LumpedObserver& observer = {}) const;
  /// The same with a second level right behind the pulse; after it comes the trial's final thrust.
  SnapPrediction predictLevels(vehicle::Mode start, const vehicle::ThrustLevel& pulse, const vehicle::ThrustLevel& hold,
                               const vehicle::Trial& trial, const LumpedObserver& observer = {}) const;
  /// The same with the stick's throttle.
  SnapPrediction predict(vehicle::Mode start, const vehicle::Pulse& pulse, const vehicle::Radio& radio,
                         const vehicle::Trial& trial, const LumpedObserver& observer = {}) const;

  /// One step of the integrator. @param demand steady thrust share during the step, @param dt [s]
  LumpedState step(const LumpedState& state, double demand, double dt, const vehicle::Trial& trial) const;

  /// Start of a trial: equilibrium of `mode` under the initial loads. @param held false if there is none (then the
  /// unloaded equilibrium)
  LumpedState startState(vehicle::Mode mode, const vehicle::Trial& trial, bool* held = nullptr) const;

  /// Load on the relative motion [N, m/s2]. Free and boom: mu ((T + P - D_r - friction)/m_r + D_c/m_c), and
  /// the specific force of the whole vehicle. HELD: m_c g + D_c, and g.
  RelativeLoad relativeLoad(const LumpedState& state, const vehicle::Trial& trial) const;
  /// Inertia of the relative motion at u [kg]: mu = m_r m_c / (m_r + m_c), m_c if held, and what arms and wings add.
  double relativeMass(const vehicle::Trial& trial, double travel) const;
  /// Kinetic and elastic energy of the relative motion, m(u) u'^2/2 + E(u) [J].
  double relativeEnergy(const LumpedState& state, const vehicle::Trial& trial) const;
  /// Momentum along the axis / mass of all that moves [m/s]; the ring's speed if held.
  double commonSpeed(const LumpedState& state, const vehicle::Trial& trial) const;
  /// What an accelerometer on the centre reads along the thrust axis, z_c'' + g [m/s2].
  double centreSpecificForce(const LumpedState& state, const vehicle::Trial& trial) const;

  /// Mass of the ring side, with what moves along on a boom [kg].
  double ringMass(const vehicle::Trial& trial) const {
    return parameters_.ring_mass + (trial.mount == vehicle::Mount::BOOM ? parameters_.boom_mass : 0.0);
  }
  /// What moves with the travel in this trial, arms and wings; nullptr: weightless arms without wings.
  /// @throws common::Error if the trial asks for wings and the model has none
  const TravelInertia* inertiaOf(const vehicle::Trial& trial) const;
  /// Wings act in this trial. @throws common::Error likewise
  bool wingsAct(const vehicle::Trial& trial) const;
  const Potential& potential() const { return *potential_; }
  const vehicle::VehicleParameters& parameters() const { return parameters_; }
  double idleFraction() const { return idle_fraction_; }  ///< of the full thrust [1]
  const LumpedSettings& settings() const { return settings_; }

 private:
  std::shared_ptr<const Potential> potential_;
  vehicle::VehicleParameters parameters_;
  double idle_fraction_;
  LumpedSettings settings_;
  std::shared_ptr<const TravelInertia> arms_;
  std::shared_ptr<const TravelInertia> winged_;  ///< arms and wings; nullptr: no wings

  /// Drag and friction on the ring side, and their slope in its speed.
  struct RingResistance {
    double force, slope;
  };
  RingResistance ringResistance(double ring_speed, const vehicle::Trial& trial) const;
  /// Both take what step() has begun: time and thrust at the step's end.
  void plainStep(const LumpedState& state, double mean_thrust, double dt, const vehicle::Trial& trial,
                 LumpedState* next) const;
  void coupledStep(const LumpedState& state, double mean_thrust, double dt, const vehicle::Trial& trial,
                   const TravelInertia& moved, LumpedState* next) const;
};

}  // namespace snapwing::rom
