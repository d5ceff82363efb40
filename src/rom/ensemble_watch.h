#pragma once
/// Basins under load and the energy margin in lanes: what LoadedBasins and MarginWatch do, eight vehicles at a time.
/// Private to the layer.

#include "ensemble_motion.h"

namespace snapwing::rom::SNAPWING_WIDTH {

constexpr double FAR = 1e30;  ///< in place of infinity: no margin is larger than 10

struct Branch {
  Real peak, peak_force, valley, valley_force;
};
struct Barrier {
  Real travel;
  Branch branch;
  Mask over, under;  ///< the load leaves Q, or F, alone
  Mask exists() const { return ~(over | under); }
};

template <bool ARMS, bool WINGS>
struct Basins {
  const EnsembleScene& s;
  const Vehicles& a;

  ForceSample sample(Real u, Real specific) const {
    const Place p = locate(s.curves, u);
    ForceSample f = arms(s.curves, u, p);
    f.force = f.force * a.force_scale;
    f.stiffness = f.stiffness * a.force_scale;
    if (ARMS || WINGS) {
      const Moved m = movedAt<ARMS, WINGS>(s.curves, a, u, p);
      f.force = f.force + specific * m.coupled;
      f.stiffness = f.stiffness + specific * m.coupled_slope;
    }
    return f;
  }

  __attribute__((noinline)) Real energy(Real u, const Load& load) const {
    const Place p = locate(s.curves, u);
    Real e = a.force_scale * armsEnergy(s.curves, u, p) - load.force * u;
    if (ARMS) e = e + load.specific * moment(s.curves.arms, u, p);
    if (WINGS) e = e + load.specific * a.wing_inertia * moment(s.curves.wings, u, p);
    return e;
  }

  Real kinetic(Real u, Real rate) const {
    const Moved m = movedAt<ARMS, WINGS>(s.curves, a, u, locate(s.curves, u));
    return 0.5 * inertiaOf<ARMS, WINGS>(a, m).mass * rate * rate;
  }

  __attribute__((noinline)) Branch branchAt(Real specific) const {
    const BranchView& t = s.branches;
    const Real x = clamp((specific / a.force_scale - t.low) * (1.0 / t.step), Real(0.0), Real(t.count - 1.0));
    const Index i = whole(x, t.count - 2);
    const Real r = x - real(i);
    Index row = i * BranchTable::ROW;
    Real v[4];
    if (t.wing_count > 1) {
      const Real y = clamp((a.wing_inertia - t.wing_low) * (1.0 / t.wing_step), Real(0.0), Real(t.wing_count - 1.0));
      const Index j = whole(y, t.wing_count - 2);
      const Real q = y - real(j);
      row = row + j * (t.count * BranchTable::ROW);
      for (int k = 0; k < 4; ++k)
        v[k] = (1.0 - q) * along(t, row, k, r) + q * along(t, shifted(row, t.count * BranchTable::ROW), k, r);
    } else {
      for (int k = 0; k < 4; ++k) v[k] = along(t, row, k, r);
    }
    return {v[0], v[1] * a.force_scale, v[2], v[3] * a.force_scale};
  }

  /// Zero of force - load in a bracket: Newton kept inside, to some 1e-10 m (the last move is below 1e-6 m and
  /// converges quadratically). Lanes that are not wanted keep the guess.
  __attribute__((noinline)) Real solveForce(bool rising_force, const Load& load, Real low, Real high, Real guess,
                                            Mask wanted) const {
    const Mask rising = rising_force ? ~none() : none();
    const Mask usable = (guess > low) & (guess < high);
    Real u = select(usable | ~wanted, guess, 0.5 * (low + high));
    Mask done = ~wanted;
    for (int i = 0; i < 60 && !all(done); ++i) {
      const ForceSample here = sample(u, load.specific);
      const Mask below = same(here.force < load.force, rising);
      low = select(below, u, low);
      high = select(below, high, u);
      Real next = u - (here.force - load.force) / here.stiffness;
      next = select((next > low) & (next < high), next, 0.5 * (low + high));
      const Mask close = magnitude(next - u) < 1e-6;
      u = select(done, u, next);
      done = done | close;
    }
    return u;
  }

  Barrier barrierUnder(const Load& load, Real guess, Mask wanted) const {
    Barrier b;
    b.branch = branchAt(load.specific);
    b.over = load.force >= b.branch.peak_force;
    b.under = (load.force <= b.branch.valley_force) & ~b.over;
    const Real found = solveForce(false, load, b.branch.peak, b.branch.valley, guess, wanted & b.exists());
    b.travel = select(b.over, b.branch.peak, select(b.under, b.branch.valley, found));
    return b;
  }

  /// Stable equilibrium of the side (mask: Q). @return lanes in which there is one
  Mask equilibrium(Mask side, const Load& load, const Branch& b, Mask wanted, Real* u) const {
    const Mask there = choose(side, load.force > b.valley_force, load.force < b.peak_force);
    const Equilibria& e = s.equilibria;
    const Real low = select(side, b.valley, least(Real(e.first), b.peak) - 0.03);
    const Real high = select(side, most(Real(e.second), b.valley) + 0.03, b.peak);
    *u = solveForce(true, load, low, high, select(side, Real(e.second), Real(e.first)), wanted & there);
    return there;
  }

  Real barrierOf(Mask side) const {
    return a.force_scale * select(side, Real(s.equilibria.barrier_second), Real(s.equilibria.barrier_first));
  }

  /// Energy that separates a place from the barrier.
  Real clearance(Mask side, Real u, Real kinetic_energy, const Load& load, const Barrier& b) const {
    const Real own = energy(b.travel, load) - energy(u, load) - kinetic_energy;
    const Real alone = select(choose(side, b.over, b.under), Real(FAR), Real(-FAR));
    return select(b.exists(), own, alone);
  }

 private:
  static Real along(const BranchView& t, Index row, int k, Real r) {
    const double* base = t.rows + k;
    const Real begin = pick(base, row), end = pick(base + BranchTable::ROW, row);
    return begin + r * (end - begin);
  }
};

}  // namespace snapwing::rom::SNAPWING_WIDTH
