#pragma once
/// Equilibria of the potential under a constant load L on the relative motion: minima and barrier of E(u) - L u.

#include "snapwing/common/mode.h"
#include "snapwing/rom/potential.h"

namespace snapwing::rom {

/// A bistable potential's basins under load. Keeps a reference: the potential must outlive it.
class LoadedBasins {
 public:
  /// @throws common::Error if the potential is not bistable
  explicit LoadedBasins(const Potential& potential);

  /// Stable equilibrium of `mode` under the load [N]. @return false if the load leaves none (above the peak force for
  /// F, below the valley force for Q)
  bool equilibrium(common::Mode mode, double load, double* travel) const;

  /// Barrier between the basins. @return false if the load leaves only one basin
  bool barrier(double load, double* travel) const;

  /// E(u) - L u [J]
  double loadedEnergy(double travel, double load) const { return potential_.energy(travel) - load * travel; }

  /// Energy that separates (travel, kinetic energy) from the barrier [J]: negative = above it. Infinite if the load
  /// leaves only the basin of `mode`; minus infinity if it leaves only the other.
  double clearance(common::Mode mode, double travel, double kinetic, double load) const;

 private:
  const Potential& potential_;
  const Equilibria& equilibria_;
};

}  // namespace snapwing::rom
