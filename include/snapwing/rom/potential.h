#pragma once
/// Elastic energy of the vehicle against travel. The lumped model knows nothing else about the arms, so a test can put
/// a closed form in the table's place.

#include "snapwing/common/loan.h"

namespace snapwing::rom {

/// Energy, force and stiffness at one travel; force = dE/du and stiffness = d2E/du2 exactly.
struct PotentialSample {
  double energy = 0;     ///< [J]
  double force = 0;      ///< [N], resists growing u
  double stiffness = 0;  ///< [N/m]
};

/// The two stable equilibria and the barrier between them.
struct Equilibria {
  bool bistable = false;
  double first = 0;           ///< [m] u in fixed-wing mode
  double barrier = 0;         ///< [m] unstable equilibrium; meaningless unless bistable
  double second = 0;          ///< [m] u in quadrotor mode; meaningless unless bistable
  double peak_force = 0;      ///< [N] largest force between first and barrier
  double valley_force = 0;    ///< [N] smallest force between barrier and second (negative)
  double peak_travel = 0;     ///< [m]
  double valley_travel = 0;   ///< [m]
  double barrier_first = 0;   ///< [J] E(barrier) - E(first)
  double barrier_second = 0;  ///< [J] E(barrier) - E(second)
};

/// One-dimensional potential, defined for every finite u. Immutable: may be shared between threads.
class Potential : public common::Lender {
 public:
  virtual ~Potential() = default;
  /// @param u  travel [m], finite
  virtual PotentialSample at(double u) const = 0;
  virtual double energy(double u) const { return at(u).energy; }
  /// True if u lies where the numbers were computed, not extrapolated.
  virtual bool inTable(double u) const = 0;
  virtual const Equilibria& equilibria() const = 0;
  /// Estimate of the force's error [N]; NaN if not known.
  virtual double forceError() const = 0;
};

/// Finds equilibria of any potential by scanning the force in [low, high] with `count` intervals and bisection.
/// Bistable means: zeros with rising, falling, rising force, in this order; the first rising zero is `first`.
Equilibria findEquilibria(const Potential& potential, double low, double high, int count = 2000);

}  // namespace snapwing::rom
