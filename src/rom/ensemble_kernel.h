#pragma once
/// The trial of eight vehicles; compiled once for each width of vectors (ensemble_wide.cpp, ...). Private to the layer.

#include "ensemble_watch.h"

namespace snapwing::rom::SNAPWING_WIDTH {

namespace {

constexpr int LOOK_EVERY = 4;  // steps between looks whether a vehicle has settled
constexpr double LARGEST_MARGIN = 10.0;

/// A step of all lanes: states at both ends, with loads and thrust there.
struct Step {
  MotionInLanes from, to;
  Load load_from, load_to;
  Real length;
};

static inline Real travelIn(const Step& x, Real s) {
  const Real r = 1.0 - s;
  return r * r * (1.0 + 2.0 * s) * x.from.u + s * r * r * x.length * x.from.w + s * s * (3.0 - 2.0 * s) * x.to.u -
         s * s * r * x.length * x.to.w;
}
static inline Real rateIn(const Step& x, Real s) {
  const Real r = 1.0 - s;
  return 6.0 * s * r * (x.to.u - x.from.u) / x.length + r * (1.0 - 3.0 * s) * x.from.w + s * (3.0 * s - 2.0) * x.to.w;
}

/// MarginWatch in masks: what is known of every lane so far.
template <bool ARMS, bool WINGS>
struct Watch {
  const EnsembleScene& s;
  const Vehicles& a;
  Basins<ARMS, WINGS> basins;
  Mask side, done, snapped;  ///< side: Q
  Barrier barrier;
  Real entry, hold, earlier, last, peak, margin;

  static Mask sideOf(const Barrier& b, Real u) {
    return ~((u <= b.branch.peak) | ((u < b.branch.valley) & (u < b.travel)));
  }

  Watch(const EnsembleScene& scene, const Vehicles& block, Real u, const Load& load)
      : s(scene), a(block), basins{scene, block} {
    done = snapped = none();
    barrier = basins.barrierUnder(load, Real(s.equilibria.barrier), ~done);
    side = sideOf(barrier, u);
    entry = hold = Real(FAR);
    earlier = last = Real(-FAR);
    peak = u;
    margin = Real(-1.0);
  }

  void turning(const Step& x) {
    const Mask turns = (x.from.w > 0.0) & (x.to.w <= 0.0) & ~done;
    peak = select(done, peak, most(peak, x.to.u));
    if (!any(turns)) return;
    const Real share = x.from.w / (x.from.w - x.to.w);
    peak = select(turns, most(peak, travelIn(x, share)), peak);
  }

  /// Lanes that came over their barrier in this step: how much energy they had left there.
  __attribute__((noinline)) void enter(Mask changed, Mask now, const Step& x, const Barrier& next) {
    const Real before = x.from.u - barrier.travel, moves = next.travel - barrier.travel;
    Real low = Real(0.0), high = Real(1.0), share = Real(0.5);
    for (int i = 0; i < 30; ++i) {
      const Mask stays = same((travelIn(x, share) - (barrier.travel + share * moves) < 0.0), (before < 0.0));
      low = select(stays, share, low);
      high = select(stays, high, share);
      share = 0.5 * (low + high);
    }
    const Load load = {x.load_from.force + share * (x.load_to.force - x.load_from.force),
                       x.load_from.specific + share * (x.load_to.specific - x.load_from.specific)};
    const Branch b = basins.branchAt(load.specific);
    const Mask over = load.force >= b.peak_force, under = load.force <= b.valley_force;
    const Real excess =
        select(over, (load.force - b.peak_force) * (s.equilibria.barrier - b.peak),
               select(under, (b.valley_force - load.force) * (b.valley - s.equilibria.barrier), Real(0.0)));
    const Real energy = basins.kinetic(travelIn(x, share), rateIn(x, share) - moves / x.length) + excess;
    entry = select(changed, energy / basins.barrierOf(~now), entry);
    hold = select(changed, Real(FAR), hold);
    earlier = select(changed, Real(-FAR), earlier);
    last = select(changed, Real(-FAR), last);
    side = choose(changed, now, side);
  }

  /// Where the state before was the closest to the barrier, its clearance counts.
  __attribute__((noinline)) void approach(const Step& x, Real distance) {
    const Mask close = (last <= earlier) & (last < distance) & barrier.exists() & ~done;
    if (any(close)) {
      Real rest = Real(0.0);
      const Mask held = basins.equilibrium(side, x.load_from, barrier.branch, close, &rest);
      const Mask flank = (x.from.u - rest) * (barrier.travel - x.from.u) >= 0.0;
      const Real clear = basins.clearance(side, x.from.u, Real(0.0), x.load_from, barrier) / basins.barrierOf(side);
      hold = select(close & held & flank, least(hold, clear), hold);
    }
    earlier = last;
    last = distance;
  }

  void add(const Step& x) {
    turning(x);
    const Barrier next = basins.barrierUnder(x.load_to, barrier.travel, ~done);
    const Mask now = sideOf(next, x.to.u), changed = (now ^ side) & ~done;
    if (any(changed)) enter(changed, now, x, next);
    approach(x, magnitude(x.to.u - next.travel));
    barrier = next;
  }

  /// Lanes that are calm in a basin that holds, now and at the terminal speed, get their margin and are done.
  __attribute__((noinline)) void look(const Step& x, Real thrust, Real ring) {
    const Real end_thrust = a.after * a.max_thrust;
    const Mask calm = (magnitude(thrust - end_thrust) <= 1e-3 * a.max_thrust) & ~done;
    if (!any(calm)) return;
    const Load& load = x.load_to;
    Real rest = Real(0.0);
    const Mask held = basins.equilibrium(side, load, barrier.branch, calm, &rest);
    const Real moving = basins.kinetic(x.to.u, x.to.w);
    const Real excess = moving + basins.energy(x.to.u, load) - basins.energy(rest, load);
    const Real low = least(basins.barrierOf(none()), basins.barrierOf(~none()));
    const Real clear = basins.clearance(side, rest, Real(0.0), load, barrier);
    const Mask slow = excess <= least(s.settled_share * low, 0.25 * clear);
    const Mask found = calm & held & slow & holdsAtTheEnd(end_thrust, ring, x.to.w);
    if (!any(found)) return;
    const Real here = basins.clearance(side, x.to.u, moving, load, barrier) / basins.barrierOf(side);
    const Real distance = clamp(least(least(entry, hold), here), Real(0.0), Real(LARGEST_MARGIN));
    const Mask over = s.start == vehicle::Mode::FIXED_WING ? side : ~side;
    margin = select(found, select(over, distance, -distance), margin);
    snapped = snapped | (over & found);
    done = done | found;
  }

 private:
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

/// One step of the classical Runge-Kutta method. @param thrust  at begin, middle and end
template <bool ARMS, bool WINGS>
MotionInLanes advance(const EnsembleScene& s, const Vehicles& a, const MotionInLanes& x, Real dt,
                      const Real (&thrust)[3]) {
  const auto moved = [&](const MotionInLanes& rate, Real by) {
    return MotionInLanes{x.u + by * rate.u, x.w + by * rate.w, x.p + by * rate.p};
  };
  const MotionInLanes k1 = rateOf<ARMS, WINGS>(s, a, thrust[0], x);
  const MotionInLanes k2 = rateOf<ARMS, WINGS>(s, a, thrust[1], moved(k1, 0.5 * dt));
  const MotionInLanes k3 = rateOf<ARMS, WINGS>(s, a, thrust[1], moved(k2, 0.5 * dt));
  const MotionInLanes k4 = rateOf<ARMS, WINGS>(s, a, thrust[2], moved(k3, dt));
  const Real sixth = dt / 6.0;
  return {x.u + sixth * (k1.u + 2.0 * (k2.u + k3.u) + k4.u), x.w + sixth * (k1.w + 2.0 * (k2.w + k3.w) + k4.w),
          x.p + sixth * (k1.p + 2.0 * (k2.p + k3.p) + k4.p)};
}

static inline Real decay(Real dt, Real time) {
  Real e;
  for (int l = 0; l < LANES; ++l) {
    const int i = l / NATIVE, k = l % NATIVE;
    e.part[i][k] = std::exp(-0.5 * dt.part[i][k] / time.part[i][k]);
  }
  return e;
}

template <bool ARMS, bool WINGS>
Real ringSpeed(const EnsembleScene& s, const Vehicles& a, const MotionInLanes& x) {
  const Moved m = movedAt<ARMS, WINGS>(s.curves, a, x.u, locate(s.curves, x.u));
  return (x.p + (a.centre_mass - m.coupled) * x.w) * a.all_inverse;
}

template <bool ARMS, bool WINGS>
void runLanes(const EnsembleScene& s, const EnsembleBlock& block, EnsembleResult* result) {
  const Vehicles a(block);
  const Basins<ARMS, WINGS> basins{s, a};
  Real thrust = a.before * a.max_thrust;
  const Real speed = Real(s.held ? 0.0 : s.initial_speed);
  Load load = loadOf(s, a, thrust, speed, Real(0.0));
  const Mask start = s.start == vehicle::Mode::FIXED_WING ? none() : ~none();
  MotionInLanes x{Real(0.0), Real(0.0), s.held ? Real(0.0) : a.all * s.initial_speed};
  const Mask held = basins.equilibrium(start, load, basins.branchAt(load.specific), ~none(), &x.u);
  x.u = select(held, x.u, select(start, Real(s.equilibria.second), Real(s.equilibria.first)));
  Watch<ARMS, WINGS> watch(s, a, x.u, load);

  const Real lengths[] = {a.latency, a.duration, a.hold_duration, Real(s.horizon)};
  const Real demands[] = {a.before, a.during, a.hold, a.after};
  for (int part = 0; part < EnsembleScene::PARTS; ++part) {
    const int count = s.steps[part];
    if (count == 0) continue;
    const Real dt = most(lengths[part] / static_cast<double>(count), Real(1e-12));
    const Real wanted = demands[part] * a.max_thrust;
    const Real half = decay(dt, select(wanted > thrust, a.time_up, a.time_down));
    for (int i = 0; i < count; ++i) {
      const Real off = (thrust - wanted) * half;
      const Real stages[3] = {thrust, wanted + off, wanted + off * half};
      Step step;
      step.from = x;
      step.load_from = load;
      step.length = dt;
      x = advance<ARMS, WINGS>(s, a, x, dt, stages);
      thrust = stages[2];
      const Real ring = ringSpeed<ARMS, WINGS>(s, a, x);
      load = loadOf(s, a, thrust, ring, x.w);
      step.to = x;
      step.load_to = load;
      watch.add(step);
      if (part + 1 < EnsembleScene::PARTS || (i % LOOK_EVERY != LOOK_EVERY - 1 && i + 1 < count)) continue;
      watch.look(step, thrust, ring);
      if (all(watch.done)) break;
    }
  }
  watch.margin.store(&result->margin);
  watch.peak.store(&result->peak_travel);
  select(watch.snapped, 1.0, 0.0).store(&result->snapped);
}

}  // namespace

/// Leaves out what the trial does not need.
static inline void run(const EnsembleScene& scene, const EnsembleBlock& block, EnsembleResult* result) {
  if (scene.arms) {
    scene.wings ? runLanes<true, true>(scene, block, result) : runLanes<true, false>(scene, block, result);
  } else {
    scene.wings ? runLanes<false, true>(scene, block, result) : runLanes<false, false>(scene, block, result);
  }
}

}  // namespace snapwing::rom::SNAPWING_WIDTH
