#pragma once
/// Basins under load in lanes: what LoadedBasins does, vehicles side by side. Private to the layer.

#include "ensemble_motion.h"

namespace snapwing::rom::SNAPWING_WIDTH {

constexpr double FAR = 1e30;  ///< in place of infinity: no margin is larger than 10

struct Branch {
  Real peak, peak_force, valley, valley_force;
};
struct Barrier {
  Real travel, stiffness, coupled;  ///< as Balance
  Branch branch;
  Mask over, under;  ///< the load leaves Q, or F, alone
  Mask exists() const { return ~(over | under); }
  /// [m/s] by which a changing load moves it; meaningless unless it exists
  Real rate(const Load& load_rate) const { return (load_rate.force - load_rate.specific * coupled) / stiffness; }
};

/// Where the force is the load's, with what the curves say there.
struct Balance {
  Real travel, stiffness, coupled;
};

template <bool ARMS, bool WINGS>
struct Basins {
  const EnsembleScene& s;
  const Vehicles& a;
  Index branch_row;  ///< begin of the vehicle's rows in the table of peaks and valleys, and what it takes of the next
  Real branch_share;

  Basins(const EnsembleScene& scene, const Vehicles& vehicles)
      : s(scene), a(vehicles), branch_row{}, branch_share(0.0) {
    const BranchView& t = s.branches;
    if (t.wing_count == 1) return;
    const Real y = clamp((a.wing_inertia - t.wing_low) * (1.0 / t.wing_step), Real(0.0), Real(t.wing_count - 1.0));
    const Index j = whole(y, t.wing_count - 2);
    branch_share = y - real(j);
    branch_row = j * t.count;
  }

  Real energy(Real u, const Load& load) const {
    return energyAt<ARMS, WINGS>(s.curves, a, u, load.force, load.specific);
  }

  Real rootOfMass(Real u) const {
    return root(inertiaOf(a, curvesAt < ARMS, WINGS, ARMS || WINGS > (s.curves, a, u).moved).mass);
  }

  Branch branchAt(Real specific) const {
    const BranchView& t = s.branches;
    const Real x = clamp((specific / a.force_scale - t.low) * (1.0 / t.step), Real(0.0), Real(t.count));
    const Index i = whole(x, t.count - 1);
    const Real r = x - real(i);
    Real row[8], v[4];
    columns(t.rows, t.wing_count > 1 ? branch_row + i : i, row);
    for (int k = 0; k < 4; ++k) v[k] = row[k] + r * row[4 + k];
    if (t.wing_count > 1) {
      columns(t.rows + t.count, branch_row + i, row);
      for (int k = 0; k < 4; ++k) v[k] = v[k] + branch_share * ((row[k] + r * row[4 + k]) - v[k]);
    }
    return {v[0], v[1] * a.force_scale, v[2], v[3] * a.force_scale};
  }

  /// Zero of force - load in a bracket: Newton kept inside, until a move is below `close`; it converges quadratically.
  /// Lanes that are not wanted keep the guess.
  Balance balance(bool rising_force, const Load& load, Real low, Real high, Real guess, double close,
                  Mask wanted) const {
    const Mask rising = rising_force ? ~none() : none();
    const Mask usable = (guess > low) & (guess < high);
    Balance b;
    b.travel = select(usable | ~wanted, guess, 0.5 * (low + high));
    b.stiffness = b.coupled = Real(1.0);
    Mask done = ~wanted;
    for (int i = 0; i < 60 && !all(done); ++i) {
      const Curves here = curvesAt<ARMS, WINGS, false>(s.curves, a, b.travel);
      const Real force = here.arms.force * a.force_scale + load.specific * here.moved.coupled;
      const Real stiffness = here.arms.stiffness * a.force_scale + load.specific * here.moved.coupled_slope;
      const Mask below = same(force < load.force, rising);
      low = select(below & ~done, b.travel, low);
      high = select(below | done, high, b.travel);
      Real next = b.travel - (force - load.force) / stiffness;
      next = select((next > low) & (next < high), next, 0.5 * (low + high));
      const Mask stays = magnitude(next - b.travel) < close;
      b.travel = select(done, b.travel, next);
      b.stiffness = select(done, b.stiffness, stiffness);
      b.coupled = select(done, b.coupled, here.moved.coupled);
      done = done | stays;
    }
    return b;
  }

  /// Energy does not change with the place of its maximum: 1e-5 m before the last move is 1e-13 of a margin after it.
  __attribute__((noinline)) Barrier barrierUnder(const Load& load, Real guess, Mask wanted) const {
    Barrier b;
    b.branch = branchAt(load.specific);
    b.over = load.force >= b.branch.peak_force;
    b.under = (load.force <= b.branch.valley_force) & ~b.over;
    const Balance found = balance(false, load, b.branch.peak, b.branch.valley, guess, 1e-5, wanted & b.exists());
    b.travel = select(b.over, b.branch.peak, select(b.under, b.branch.valley, found.travel));
    b.stiffness = found.stiffness;
    b.coupled = found.coupled;
    return b;
  }

  /// Stable equilibrium of the side (mask: Q). @param u  where it may be, FAR if that is not known; changed in lanes
  /// that want it. @return lanes in which there is one
  __attribute__((noinline)) Mask equilibrium(Mask side, const Load& load, const Branch& b, Mask wanted, Real* u) const {
    const Mask there = choose(side, load.force > b.valley_force, load.force < b.peak_force);
    const Equilibria& e = s.equilibria;
    const Real low = select(side, b.valley, least(Real(e.first), b.peak) - 0.03);
    const Real high = select(side, most(Real(e.second), b.valley) + 0.03, b.peak);
    const Real guess = select((*u > low) & (*u < high), *u, select(side, Real(e.second), Real(e.first)));
    *u = select(wanted & there, balance(true, load, low, high, guess, 1e-6, wanted & there).travel, *u);
    return there;
  }

  Real barrierOf(Mask side) const {
    return a.force_scale * select(side, Real(s.equilibria.barrier_second), Real(s.equilibria.barrier_first));
  }

  /// Energy that separates a place from the barrier.
  Real clearance(Mask side, Real u, const Load& load, const Barrier& b) const {
    const Real own = energy(b.travel, load) - energy(u, load);
    const Real alone = select(choose(side, b.over, b.under), Real(FAR), Real(-FAR));
    return select(b.exists(), own, alone);
  }
};

}  // namespace snapwing::rom::SNAPWING_WIDTH
