#pragma once
/// The simulated vehicle: its own true model, written independently of the reduced model that plans for it. Absolute
/// positions of ring and centre, one lag per rotor, own interpolation of the table (cubic force), mechanical stops,
/// the experimenter's hand; explicit fourth-order Runge-Kutta with a small fixed step.
///   m_r z_r'' = T - D_r - friction + H + P - F(u) - c u' - m_r g  (H: hand, only when it holds; P: push from outside)
///   m_c z_c'' =     - D_c             + F(u) + c u' - m_c g       u = z_r - z_c
/// Arms, and wings that are on (standin/plant_forces.cpp), add their inertia to both equations, wings also friction at
/// their pins.

#include <cstdint>
#include <optional>
#include <vector>

#include "snapwing/vehicle/force_table.h"
#include "snapwing/vehicle/mode.h"
#include "snapwing/vehicle/trial.h"
#include "snapwing/vehicle/vehicle.h"
#include "snapwing/vehicle/vehicle_parameters.h"
#include "snapwing/vehicle/wing_table.h"

namespace snapwing::standin {

struct PlantSettings {
  vehicle::Mount mount = vehicle::Mount::BOOM;
  /// Wings on or off; unset = on if there is a table of them, but off on a boom, where the centripetal force that turns
  /// them is not modelled.
  std::optional<bool> wings;
  double gravity = 0;             ///< [m/s2] against the thrust axis; 0 for a boom that turns level
  double step = 1e-4;             ///< [s] largest step, (0, 1e-3]
  double stop_restitution = 0.3;  ///< [1] relative speed kept when u hits a mechanical stop, [0, 1]
  /// Largest deceleration by which the hand brakes: gentle in Q, whose hold on the centre is weak.
  double hand_share_q = 0.4;          ///< [1] of the deceleration that Q holds, valley force / centre's mass, (0, 1)
  double hand_deceleration_f = 12.0;  ///< [m/s2]
  void validate() const;              ///< @throws common::Error naming the member
};

struct PlantState {
  double time = 0;                   ///< [s]
  double ring_position = 0;          ///< [m] along the thrust axis (arc length on a boom)
  double ring_speed = 0;             ///< [m/s]
  double centre_position = 0;        ///< [m]
  double centre_speed = 0;           ///< [m/s]
  std::vector<double> rotor_thrust;  ///< [N] each
  double travel() const { return ring_position - centre_position; }  ///< [m]
  double travelRate() const { return ring_speed - centre_speed; }    ///< [m/s]
  double thrust() const;                                             ///< of all rotors [N]
};

class Plant {
 public:
  /// @param table  of one arm; parameters.force_scale and arm_count are applied here
  /// @param wing  with the blade's columns; none: the vehicle has no wings
  /// @throws common::Error for bad settings, parameters or tables
  Plant(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table, const vehicle::VehicleParameters& parameters,
        const PlantSettings& settings = {}, const std::optional<vehicle::WingTable>& wing = {});

  /// Puts the vehicle at rest in an equilibrium, motors off, hand off, the clock as it is. @throws common::Error for
  /// UNKNOWN or a table that is not bistable
  void reset(vehicle::Mode mode);

  /// Motor outputs [0, 1], one per rotor, valid from the present time on. Values are clamped; NaN counts as 0.
  void setMotorOutputs(const std::vector<double>& outputs);

  /// Moves on to `time` [s]; earlier times do nothing. Motor outputs are held meanwhile.
  void advanceTo(double time);

  /// The experimenter takes the ring side: brakes it with bounded deceleration to rest and holds it there.
  void grab();
  void release();
  bool held() const { return hand_; }
  /// Somebody pushes the ring side from now on; a ring that is held firmly does not feel it. Ends with reset().
  /// @param force [N] along the thrust axis; 0: no longer. @throws common::Error if not finite
  void push(double force);
  /// Held and standing still (|u'| and ring speed small).
  bool atRest() const;

  const PlantState& state() const { return state_; }
  double ringAcceleration() const;    ///< [m/s2] at the present state
  double centreAcceleration() const;  ///< [m/s2]
  /// What an accelerometer on the centre reads along the thrust axis: z_c'' + g [m/s2]
  double centreSpecificForce() const;
  /// Which side of the barrier u is on, if the relative motion cannot leave it unloaded; else UNKNOWN.
  vehicle::Mode mode() const;
  double armRotation() const;  ///< [rad]
  const vehicle::VehicleParameters& parameters() const { return parameters_; }

 private:
  struct Rates {
    double ring = 0, centre = 0;  ///< accelerations [m/s2]
  };
  /// Inertia of arms and wings at one travel and its slopes: K, S of their tables. [kg, kg/m]
  struct Moved {
    double kinetic = 0, kinetic_slope = 0, coupled = 0, coupled_slope = 0, friction = 0;
  };
  Moved movedAt(double travel) const;
  /// Inertia against the travel with the common momentum as it is, or with the ring fixed. [kg]
  double travelMass(double travel) const;
  double armForce(double travel) const;
  double armEnergy(double travel) const;
  double handForce(double ring_speed, double travel, double thrust) const;
  Rates accelerations(double ring_position, double ring_speed, double centre_position, double centre_speed,
                      double thrust) const;
  Rates present() const;
  double thrustAfter(double dt, std::vector<double>* each) const;
  void stepOnce(double dt);
  void hitStop(double limit);
  bool ringFixed() const { return settings_.mount == vehicle::Mount::HELD || locked_; }

  vehicle::VehicleParameters parameters_;
  PlantSettings settings_;
  vehicle::ForceTable table_;
  vehicle::CurveFeatures features_;
  std::optional<vehicle::WingTable> wing_;  ///< only if on
  double travel_min_, travel_max_;
  double ring_mass_, ring_drag_, friction_;
  std::vector<double> outputs_;
  PlantState state_;
  double push_ = 0;  ///< [N]
  bool hand_ = false;
  bool locked_ = false;  ///< the hand has brought the ring to rest and holds it firmly
};

/// Parameters of one simulated vehicle, uniform in the uncertainty box of the vehicle file.
/// @param seed  equal seeds give equal vehicles on every machine
vehicle::VehicleParameters drawParameters(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table,
                                          std::uint64_t seed);

}  // namespace snapwing::standin
