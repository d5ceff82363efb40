#pragma once
/// Equilibria of the potential under a load on the relative motion: minima and barrier of
///   V(u) = E(u) - L u + a H(u)
/// L is the load at constant force; a H(u), H' = S(u), is the weight that arms and wings feel. Without their mass H =
/// 0.

#include <cmath>
#include <optional>
#include <vector>

#include "snapwing/common/loan.h"
#include "snapwing/rom/potential.h"
#include "snapwing/rom/travel_inertia.h"
#include "snapwing/vehicle/mode.h"

namespace snapwing::rom {

struct RelativeLoad {
  double force = 0;  ///< L [N], pushes u up
  /// a [m/s2], along the thrust axis, that arms and wings lag behind: pushes by -a S(u)
  double specific_force = 0;
};

/// The barrier between the basins, which lies where the force that balances L falls from its peak to its valley.
struct LoadedBarrier {
  bool exists = false;  ///< false: the load leaves only one basin
  double travel = 0;    ///< [m]; where the barrier vanished if it does not exist, which is peak or valley
  double peak = 0;      ///< [m]
  double valley = 0;    ///< [m]
  double excess = 0;    ///< what the load has left over along the falling branch; 0 if the barrier exists [J]
  /// Which side u is on; left of the peak always F, right of the valley always Q.
  vehicle::Mode sideOf(double u) const;
};

/// A bistable potential's basins under load. Potential and inertia are lent.
class LoadedBasins {
 public:
  /// @param moved  arms and wings; nullptr: without mass
  /// @throws common::Error if the potential is not bistable
  explicit LoadedBasins(const Potential& potential, const TravelInertia* moved = nullptr);

  /// Stable equilibrium of `mode` under the load. @return false if the load leaves none
  bool equilibrium(vehicle::Mode mode, const RelativeLoad& load, double* travel) const;

  /// L at which the basin of `mode` vanishes, at a given a. [N]
  double limit(vehicle::Mode mode, double specific_force) const;

  /// @param guess  where the barrier may be [m]; a bad one costs time only
  LoadedBarrier barrierUnder(const RelativeLoad& load, double guess = NAN) const;

  /// V(u) [J]
  double loadedEnergy(double travel, const RelativeLoad& load) const;

  /// Energy that separates (travel, kinetic energy) from the barrier [J]: negative = above it. Infinite if the load
  /// leaves only the basin of `mode`; minus infinity if it leaves only the other.
  double clearance(vehicle::Mode mode, double travel, double kinetic, const RelativeLoad& load) const;

 private:
  struct Branch {
    double peak_travel, peak_force, valley_travel, valley_force;
  };
  struct Point {
    double travel, force, coupled_mass;
  };
  PotentialSample sample(double travel, double specific_force) const;
  double solveForce(bool rising, const RelativeLoad& load, double low, double high, double guess) const;
  Branch branch(double specific_force) const;
  double extremum(const std::vector<Point>& points, double specific_force, bool largest) const;
  /// Where the force neither rises nor falls between two travels; the guess where it rises or falls at both.
  double levelForce(double specific_force, double low, double high, double guess) const;

  common::Loan<const Potential> potential_;
  std::optional<common::Loan<const TravelInertia>> moved_;
  const Equilibria& equilibria_;
  std::vector<Point> rising_,
      falling_;  ///< between first equilibrium and barrier, barrier and second; with inertia only
};

}  // namespace snapwing::rom
