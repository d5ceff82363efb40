#pragma once
/// The energy margin in lanes: what MarginWatch does, vehicles side by side, on steps that are forty times longer.
/// What happens within a step is placed on cubics through values and rates of both ends. Private to the layer.

#include "ensemble_outlook.h"

namespace snapwing::rom::SNAPWING_WIDTH {

constexpr double LARGEST_MARGIN = 10.0;
constexpr double CLOSE = 3e-3;  // [m] from the barrier

/// Cubic through value and rate at both ends of a step; s in [0, 1].
struct StepCubic {
  Real y0, y1, m0, m1;  ///< m: rates times the step's length
  Real at(Real s) const {
    const Real r = 1.0 - s;
    return r * r * ((1.0 + 2.0 * s) * y0 + s * m0) + s * s * ((3.0 - 2.0 * s) * y1 - r * m1);
  }
  Real slope(Real s) const {
    const Real r = 1.0 - s;
    return 6.0 * s * r * (y1 - y0) + r * (1.0 - 3.0 * s) * m0 + s * (3.0 * s - 2.0) * m1;
  }
  /// Where the slope is zero, of lanes in which m0 and m1 have different signs (0 where they have not).
  Real level() const {
    const Real rise = 3.0 * (y1 - y0), a = m0 + m1 - 2.0 * (y1 - y0), half = rise - 2.0 * m0 - m1;
    // 3 a s^2 + 2 half s + m0 = 0; the root that does not lose digits, and the one inside.
    const Real square = most(half * half - 3.0 * a * m0, Real(0.0)), sign = select(half < 0.0, Real(-1.0), Real(1.0));
    const Real q = -(half + sign * root(square));
    const Real one = q / (3.0 * a), other = m0 / q;
    const Real s = select((other >= 0.0) & (other <= 1.0), other, one);
    return select((m0 < 0.0) ^ (m1 < 0.0), clamp(s, Real(0.0), Real(1.0)), Real(0.0));
  }
};

/// A step of all lanes.
struct Step {
  const Instant &from, &to;
  const Barrier &barrier_from, &barrier_to;
  const Real &length, &rate_from, &rate_to;  ///< rates of the barrier

  StepCubic travel() const { return {from.at.u, to.at.u, from.w * length, to.w * length}; }
  StepCubic speed() const { return {from.at.v, to.at.v, from.rate.v * length, to.rate.v * length}; }
  Load loadAt(Real s) const {
    const StepCubic force = {from.load.force, to.load.force, from.load_rate.force * length,
                             to.load_rate.force * length};
    const StepCubic specific = {from.load.specific, to.load.specific, from.load_rate.specific * length,
                                to.load_rate.specific * length};
    return {force.at(s), specific.at(s)};
  }
  /// Distance from the barrier. Where a cubic does not follow the barrier, because it appears, vanishes or has just
  /// done so, its mean rate counts; such steps are short.
  StepCubic distance() const {
    const Real moves = barrier_to.travel - barrier_from.travel;
    const Mask smooth = followed();
    return {from.at.u - barrier_from.travel, to.at.u - barrier_to.travel,
            from.w * length - select(smooth, rate_from * length, moves),
            to.w * length - select(smooth, rate_to * length, moves)};
  }
  Mask followed() const {
    const Real moves = barrier_to.travel - barrier_from.travel;
    const Real bends = magnitude(rate_from * length - moves) + magnitude(rate_to * length - moves);
    return barrier_from.exists() & barrier_to.exists() & (bends < 1e-3);
  }
  /// Both ends agree whether there is a barrier, and the cubic follows it if so.
  Mask even() const {
    return followed() | (barrier_from.over & barrier_to.over) | (barrier_from.under & barrier_to.under);
  }
};

/// MarginWatch in masks: what is known of every lane so far.
template <bool ARMS, bool WINGS>
struct Watch {
  const EnsembleScene& s;
  const Vehicles& a;
  const Basins<ARMS, WINGS>& basins;
  const Outlook<ARMS, WINGS> outlook;
  Mask side, done, snapped;  ///< side: Q
  Mask nearing;              ///< the barrier, at the end of the last step
  Real entry, hold, peak, margin;
  Real rest;  ///< of the side, where it was sought last

  static Mask sideOf(const Barrier& b, Real u) {
    return ~((u <= b.branch.peak) | ((u < b.branch.valley) & (u < b.travel)));
  }

  Watch(const Basins<ARMS, WINGS>& of, const Real& u, const Barrier& barrier)
      : s(of.s), a(of.a), basins(of), outlook(of), entry(FAR), hold(FAR), peak(u), margin(-1.0), rest(FAR) {
    done = snapped = none();
    nearing = ~none();
    side = sideOf(barrier, u);
  }

  void turning(const Step& x, Mask taken) {
    const Mask turns = (x.from.w > 0.0) & (x.to.w <= 0.0) & taken;
    peak = select(taken, most(peak, x.to.at.u), peak);
    if (!any(turns)) return;
    const StepCubic travel = x.travel();
    peak = select(turns, most(peak, travel.at(travel.level())), peak);
  }

  /// Lanes that came over their barrier in this step: how much energy they had left there.
  __attribute__((noinline)) void enter(Mask changed, Mask now, const Step& x) {
    const StepCubic distance = x.distance();
    Real low = Real(0.0), high = Real(1.0), share = Real(0.5);
    for (int i = 0; i < 24; ++i) {
      const Mask stays = same(distance.at(share) < 0.0, distance.y0 < 0.0);
      low = select(stays, share, low);
      high = select(stays, high, share);
      share = 0.5 * (low + high);
    }
    const Load load = x.loadAt(share);
    const Branch b = basins.branchAt(load.specific);
    const Mask over = load.force >= b.peak_force, under = load.force <= b.valley_force;
    const Real excess =
        select(over, (load.force - b.peak_force) * (s.equilibria.barrier - b.peak),
               select(under, (b.valley_force - load.force) * (b.valley - s.equilibria.barrier), Real(0.0)));
    // Of the travel's rate, v is what is smooth within the step.
    const StepCubic travel = x.travel();
    const Real barrier_rate = (travel.slope(share) - distance.slope(share)) / x.length;
    const Real v = x.speed().at(share) - basins.rootOfMass(travel.at(share)) * barrier_rate;
    const Real energy = 0.5 * v * v + excess;
    entry = select(changed, energy / basins.barrierOf(~now), entry);
    hold = select(changed, Real(FAR), hold);
    side = choose(changed, now, side);
  }

  /// Lanes that were nearing the barrier and are no more: their clearance where they were closest counts, on the flank
  /// between the basin's bottom and its barrier.
  __attribute__((noinline)) void closest(Mask turned, const Step& x, const StepCubic& distance) {
    const Real share = distance.level();
    const Real u = x.travel().at(share), b = u - distance.at(share);
    const Load load = x.loadAt(share);
    const Real clear = (basins.energy(b, load) - basins.energy(u, load)) / basins.barrierOf(side);
    const Mask counts = turned & x.barrier_from.exists() & (clear < hold);
    if (!any(counts)) return;
    Real bottom = Real(FAR);
    const Mask held = basins.equilibrium(side, load, basins.branchAt(load.specific), counts, &bottom);
    const Mask flank = (u - bottom) * (b - u) >= 0.0;
    hold = select(counts & held & flank, clear, hold);
  }

  /// What a step brings: which side the lanes are on after it, and whether they come closer to the barrier.
  struct Seen {
    StepCubic distance;
    Mask side, near;
  };
  Seen see(const Step& x) const {
    const StepCubic d = x.distance();
    return {d, sideOf(x.barrier_to, x.to.at.u), d.y1 * d.m1 < 0.0};
  }
  /// Lanes whose step is too long to place what happens in it: the barrier appears, vanishes or runs, and it matters.
  Mask vague(const Step& x, const Seen& seen) const {
    const Mask close = (magnitude(seen.distance.y0) < CLOSE) | (magnitude(seen.distance.y1) < CLOSE);
    return ~x.even() & (close | (seen.side ^ side) | (nearing & ~seen.near));
  }

  /// @param taken  lanes that take this step
  void add(const Step& x, const Seen& seen, Mask taken) {
    turning(x, taken);
    const Mask changed = (seen.side ^ side) & taken, turned = nearing & ~seen.near & taken & ~changed;
    if (any(changed)) enter(changed, seen.side, x);
    if (any(turned)) closest(turned, x, seen.distance);
    nearing = choose(taken, seen.near, nearing);
  }

  /// Lanes whose numbers are none: their margin says so.
  void lose(Mask lost) {
    margin = select(lost, Real(__builtin_nan("")), margin);
    done = done | lost;
  }

  /// Lanes whose margin nothing can change any more, or that have become calm in a basin that holds, now and at the
  /// terminal speed, get it and are done. @param left  time until the horizon
  void look(const Step& x, Mask taken, const Real& left) {
    const Real end = a.after * a.max_thrust, moving = 0.5 * x.to.at.v * x.to.at.v;
    const Real small = s.settled_share * least(basins.barrierOf(none()), basins.barrierOf(~none()));
    const Real so_far = least(entry, hold);
    const Mask open = taken & (so_far < LARGEST_MARGIN);
    if (any(open)) {
      const Real wanted = so_far * basins.barrierOf(side);
      finish(outlook.keeps(open, side, x.to, x.barrier_to, wanted, peak, small, left), so_far);
      taken = taken & ~done;
    }
    // A spring that pulls so hard has the energy pull^2 / (2 stiffness). Who has more than twice the limit is not
    // asked.
    const Mask near = 0.25 * x.to.pull * x.to.pull <= (small - moving) * x.to.stiffness;
    const Mask calm = taken & (magnitude(x.to.thrust - end) <= CALM * a.max_thrust) & (moving <= small) & near;
    if (any(calm)) settle(calm, x, end, moving, small);
  }

 private:
  __attribute__((noinline)) void settle(Mask calm, const Step& x, Real end_thrust, Real moving, Real small) {
    const Load& load = x.to.load;
    const Barrier& barrier = x.barrier_to;
    const Mask held = basins.equilibrium(side, load, barrier.branch, calm, &rest);
    const Real excess = moving + basins.energy(x.to.at.u, load) - basins.energy(rest, load);
    const Real clear = basins.clearance(side, rest, load, barrier);
    const Real limit = least(small, 0.25 * clear);
    const Mask found = calm & held & (excess <= limit) & holdsAtTheEnd(end_thrust, x.to.ring, x.to.w);
    if (!any(found)) return;
    const Real at = least(excess + lostSinceCalm(x, end_thrust), limit);
    finish(found, least(least(entry, hold), (clear - at) / basins.barrierOf(side)));
  }

  void finish(Mask found, const Real& margin_of_side) {
    const Mask over = s.start == vehicle::Mode::FIXED_WING ? side : ~side;
    const Real distance = clamp(margin_of_side, Real(0.0), Real(LARGEST_MARGIN));
    margin = select(found, select(over, distance, -distance), margin);
    snapped = snapped | (over & found);
    done = done | found;
  }

  /// Energy of the relative motion that losses took in this step after the thrust had come to rest: what was left when
  /// the vehicle settled, somewhere in the step, and not at its end, is part of the margin.
  Real lostSinceCalm(const Step& x, Real end_thrust) const {
    const Real wanted = CALM * a.max_thrust, begin = magnitude(x.from.thrust - end_thrust),
               end = magnitude(x.to.thrust - end_thrust);
    // ln(begin / wanted) / ln(begin / end) of numbers that are close
    const Real share = (begin - wanted) * (begin + end) / ((begin + wanted) * most(begin - end, 1e-12 * wanted));
    const Real left = 1.0 - select(begin <= wanted, Real(0.0), clamp(share, Real(0.0), Real(1.0)));
    const auto power = [&](const Instant& n) {
      Real p = a.damping * n.w * n.w;
      if (WINGS) p = p + curvesAt<ARMS, WINGS, false>(s.curves, a, n.at.u).moved.friction * magnitude(n.w);
      return p;
    };
    return 0.5 * left * x.length * (power(x.from) + power(x.to));
  }

  Mask holdsAtTheEnd(Real thrust, Real ring, Real w) const {
    Real speed = Real(0.0);
    Real rate = w;
    if (!s.held) {
      const Real drag = a.ring_drag + a.centre_drag, push = thrust - a.all * s.gravity;
      const Real terminal = root(magnitude(push) / drag);
      speed = select(drag > 0.0, select(push < 0.0, -terminal, terminal), ring - w);
      rate = Real(0.0);
    }
    const Load load = loadOf(s, a, thrust, speed, rate);
    const Branch b = basins.branchAt(load.specific);
    return choose(side, load.force > b.valley_force, load.force < b.peak_force);
  }
};

}  // namespace snapwing::rom::SNAPWING_WIDTH
