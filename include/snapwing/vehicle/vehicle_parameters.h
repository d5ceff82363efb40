#pragma once
/// One realisation of a vehicle: numbers within the uncertainty of the vehicle file. All models of its motion (motion,
/// rom, standin) use the same definition of each uncertain quantity.

#include <string>
#include <vector>

#include "snapwing/vehicle/force_table.h"
#include "snapwing/vehicle/vehicle.h"

namespace snapwing::vehicle {

struct VehicleParameters {
  double ring_mass = 0;           ///< [kg] m_r, with the arms' mass, without boom
  double centre_mass = 0;         ///< [kg] m_c
  double force_scale = 1;         ///< [1] times the table's force and energy
  double damping = 0;             ///< [N s/m] c of the relative motion, 2 ratio sqrt(stiffness in Q * reduced mass)
  double max_thrust = 0;          ///< [N] all rotors
  double time_constant_up = 0;    ///< [s]
  double time_constant_down = 0;  ///< [s]
  double quadratic_share = 0;     ///< [1] q in thrust fraction = q s^2 + (1-q) s
  double latency = 0;             ///< [s] command -> motor output
  double ring_drag = 0;           ///< [N s2/m2] 1/2 rho CdA of the ring side
  double centre_drag = 0;         ///< [N s2/m2] 1/2 rho CdA of the centre
  double boom_mass = 0;           ///< [kg] boom inertia / length^2, added to the ring side on a boom
  double boom_drag = 0;           ///< [N s2/m2] 1/2 rho CdA of the boom, added to the ring side on a boom
  double boom_friction = 0;       ///< [N] Coulomb friction at the tip
  double wing_inertia = 1;        ///< [1] times the wing table's masses
  double wing_friction = 1;       ///< [1] times the wing table's friction
};

/// Names of the independent uncertain numbers, in the order of the coordinates of realise().
const std::vector<std::string>& uncertainNames();

/// Parameters at a point of the uncertainty box.
/// @param table  of one arm: its stiffness at the second equilibrium defines c for the damping ratio; the ring side
/// must
///               have more mass than the arms
/// @param xi     one coordinate in [-1, 1] for each of uncertainNames(): value + xi * plus_minus; empty = nominal
/// @throws Error if the size is wrong, a coordinate is outside [-1, 1], the ring side has less mass than the arms, or
/// the table has no second equilibrium
VehicleParameters realise(const Vehicle& vehicle, const ForceTable& table, const std::vector<double>& xi = {});

}  // namespace snapwing::vehicle
