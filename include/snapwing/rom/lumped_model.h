#pragma once
/// Two bodies on the thrust axis, joined by the arms' potential: ring side m_r (with the boom, if mounted on one) and
/// centre m_c, u = z_ring - z_centre.
///   m_r z_r'' = T - D_r(z_r') - friction - F(u) - c u' - m_r g
///   m_c z_c'' =     - D_c(z_c')          + F(u) + c u' - m_c g
/// D = k |v| v. Thrust follows q s^2 + (1-q) s of the motor output s by a first-order lag (own constants up and down).
/// Time stepping: implicit midpoint with the discrete gradient (E(u1) - E(u0)) / (u1 - u0) for the elastic force, so
/// that without loads and losses the energy is kept to rounding [Gonzalez 1996]. Second order; steps end where the
/// command changes.

#include <functional>
#include <memory>
#include <vector>

#include "snapwing/common/pulse.h"
#include "snapwing/common/vehicle_parameters.h"
#include "snapwing/rom/potential.h"
#include "snapwing/rom/trial.h"

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
  /// @throws common::Error naming the member
  void validate() const;
};

/// Full thrust share wanted at the motors from `time` on. Rectangular pulses are three of these.
struct ThrustDemand {
  double time = 0;      ///< [s]
  double fraction = 0;  ///< [1] steady thrust / full thrust
};

/// Called after each step. @return false to stop
using LumpedObserver = std::function<bool(const LumpedState&)>;

/// Immutable after construction: predict() may be called from several threads.
class LumpedModel {
 public:
  /// @param idle_fraction  steady thrust at motor idle / full thrust [0, 1)
  /// @throws common::Error for bad parameters (masses and time constants > 0, the rest >= 0, all finite)
  LumpedModel(std::shared_ptr<const Potential> potential, const common::VehicleParameters& parameters,
              double idle_fraction, const LumpedSettings& settings = {});

  /// The usual way: spline and idle thrust from the vehicle and its table. @throws common::Error
  static LumpedModel fromVehicle(const common::Vehicle& vehicle, const common::ForceTable& table,
                                 const common::VehicleParameters& parameters, const LumpedSettings& settings = {});

  /// Steady thrust share of a stick throttle for these parameters. @param throttle [0, 1]
  double thrustFraction(const common::Radio& radio, double throttle) const;

  /// What a pulse does.
  /// @param start      F or Q; the motion starts in its equilibrium under the initial loads
  /// @param fraction   steady thrust of the pulse / full thrust [0, 1]
  /// @param duration   of the command [s], >= 0
  /// @param observer   optional, sees each step
  /// @throws common::Error for UNKNOWN start, a potential that is not bistable, bad pulse or trial
  SnapPrediction predict(common::Mode start, double fraction, double duration, const Trial& trial,
                         const LumpedObserver& observer = {}) const;
  /// The same with the stick's throttle.
  SnapPrediction predict(common::Mode start, const common::Pulse& pulse, const common::Radio& radio, const Trial& trial,
                         const LumpedObserver& observer = {}) const;

  /// One step of the integrator. @param demand steady thrust share during the step, @param dt [s]
  LumpedState step(const LumpedState& state, double demand, double dt, const Trial& trial) const;

  /// Start of a trial: equilibrium of `mode` under the initial loads. @param held false if there is none (then the
  /// unloaded equilibrium)
  LumpedState startState(common::Mode mode, const Trial& trial, bool* held = nullptr) const;

  /// Load on the relative motion, mu ((T - D_r - friction)/m_r + D_c/m_c) (free and boom), [N]: what the force of the
  /// arms must balance. HELD: m_c g + D_c.
  double relativeLoad(const LumpedState& state, const Trial& trial) const;
  /// mu = m_r m_c / (m_r + m_c), or m_c if held [kg].
  double relativeMass(Mount mount) const;
  /// Kinetic and elastic energy of the relative motion, mu u'^2/2 + E(u) [J].
  double relativeEnergy(const LumpedState& state, Mount mount) const;

  const Potential& potential() const { return *potential_; }
  const common::VehicleParameters& parameters() const { return parameters_; }
  double idleFraction() const { return idle_fraction_; }
  const LumpedSettings& settings() const { return settings_; }

 private:
  std::shared_ptr<const Potential> potential_;
  common::VehicleParameters parameters_;
  double idle_fraction_;
  LumpedSettings settings_;
};

}  // namespace snapwing::rom
