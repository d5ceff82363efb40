#pragma once
/// Traced force-displacement curve of an arm, stored with units and provenance in an HDF5 file. It is the only result
/// of the solvers that programs on the vehicle use.

#include <array>
#include <map>
#include <string>
#include <vector>

namespace snapwing::vehicle {

/// Outline of an arm as polylines, undeformed and at each travel, for pictures only. Arm coordinates (x outward, y up)
/// [m].
struct ArmShapes {
  std::vector<std::vector<std::array<double, 2>>> rest;  ///< closed loops, at u = 0
  /// moved[k][loop][point] belongs to ForceTable::travel[k]
  std::vector<std::vector<std::vector<std::array<double, 2>>>> moved;
};

/// Force and inertia of ONE arm against travel. All arrays have one entry per point; travel is strictly increasing.
/// Kinetic energy with the ring at z along the thrust axis and the arm on its static path:
///   T = m z'^2 / 2 + S z' u' + K u'^2 / 2,   K = sum m |dx/du|^2,   S = sum m dh/du
/// x(u): position of a particle in the ring's frame, h: its height. S is negative, because the arm follows the centre
/// down.
struct ForceTable {
  std::vector<double> travel;        ///< u [m]
  std::vector<double> force;         ///< R(u) = dE/du [N], force on the housing at equilibrium
  std::vector<double> stiffness;     ///< dR/du [N/m], from the tangent at the converged point
  std::vector<double> energy;        ///< elastic energy E(u) [J]
  std::vector<double> rotation;      ///< arm rotation [rad], positive as u grows
  std::vector<double> min_det_f;     ///< smallest det F over all cells [1]
  std::vector<int> stable;           ///< 1 if the constrained equilibrium is a minimum (no negative pivot)
  std::vector<int> iterations;       ///< Newton iterations spent on the point
  std::vector<double> kinetic_mass;  ///< K [kg]
  std::vector<double> coupled_mass;  ///< S [kg]
  std::vector<double> force_back;    ///< R on the way back [N], same travel; empty if not traced
  ArmShapes shapes;                  ///< may be empty
  double mass = 0;                   ///< m of one arm [kg]
  int arm_count = 1;                 ///< arms of the vehicle; its force is arm_count * force
  /// Provenance: "rung", "kernel", "cell_size_m", "inputs_sha256", "snapwing_version", "command", ...
  std::map<std::string, std::string> provenance;

  /// @throws Error naming the array and index: unequal lengths, fewer than 4 points, not increasing, not finite, or an
  /// inertia that no mass can have
  void validate() const;
};

/// Writes atomically (temporary file, then rename): a killed run leaves the previous file unchanged.
/// @throws FileError
void saveForceTable(const ForceTable& table, const std::string& path);

/// Reads a file of saveForceTable. @throws FileError if missing, no HDF5, with wrong units or inconsistent
ForceTable loadForceTable(const std::string& path);

/// Extremes and zeros of the force curve of all arms (arm_count * R), by cubic Hermite interpolation with the
/// stiffness. Travels in m, forces in N.
struct CurveFeatures {
  double peak_travel, peak_force;      ///< first maximum for u > 0
  double valley_travel, valley_force;  ///< minimum after the peak
  double barrier_travel;               ///< middle zero: unstable equilibrium; NaN if none
  double second_travel;                ///< second stable equilibrium; NaN if none
  double barrier_forward;              ///< [J] energy from u = 0 to the barrier
  double barrier_back;                 ///< [J] energy from the second equilibrium to the barrier
  double hysteresis;                   ///< max |forward - back| force [N]; NaN if not traced back
  bool bistable;
};
/// @throws common::Error for an invalid table (ForceTable::validate)
CurveFeatures curveFeatures(const ForceTable& table);

/// Force of one arm at a travel [m] by the same interpolation, continued linearly beyond the table's ends. [N]
double forceAt(const ForceTable& table, double travel);

}  // namespace snapwing::vehicle
