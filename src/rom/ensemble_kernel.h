#pragma once
/// Trials of vehicles side by side; compiled once for each width of vectors (ensemble_wide.cpp, ...). Private to the
/// layer.

#include "ensemble_clock.h"
#include "ensemble_margin.h"

namespace snapwing::rom::SNAPWING_WIDTH {

namespace {

/// One step of the classical Runge-Kutta method, of all lanes.
template <bool ARMS, bool WINGS>
struct RungeKutta {
  Instant end;
  Real error;  ///< [m/s] of a step of third order with the same ends, ten times

  RungeKutta(const EnsembleScene& s, const Vehicles& a, const Instant& from, const Clock& clock, Real dt) {
    const MotionInLanes& x = from.at;
    const auto moved = [&](const MotionInLanes& rate, Real by) {
      return MotionInLanes{x.u + by * rate.u, x.v + by * rate.v, x.p + by * rate.p};
    };
    const Real half = decayed(0.5 * dt * clock.lag_inverse), off = (from.thrust - clock.wanted) * half;
    const Real middle = clock.wanted + off, last = clock.wanted + off * half;
    const MotionInLanes& k1 = from.rate;
    const MotionInLanes k2 = instantOf<ARMS, WINGS>(s, a, middle, Real(0.0), moved(k1, 0.5 * dt)).rate;
    const MotionInLanes k3 = instantOf<ARMS, WINGS>(s, a, middle, Real(0.0), moved(k2, 0.5 * dt)).rate;
    const MotionInLanes k4 = instantOf<ARMS, WINGS>(s, a, last, Real(0.0), moved(k3, dt)).rate;
    const Real sixth = dt * (1.0 / 6.0);
    const MotionInLanes to = {x.u + sixth * (k1.u + 2.0 * (k2.u + k3.u) + k4.u),
                              x.v + sixth * (k1.v + 2.0 * (k2.v + k3.v) + k4.v),
                              x.p + sixth * (k1.p + 2.0 * (k2.p + k3.p) + k4.p)};
    end = instantOf<ARMS, WINGS>(s, a, last, clock.thrustRate(last), to);
    error = dt * most(magnitude(k4.v - end.rate.v), magnitude(k4.u - end.rate.u) * (1.0 / SLOW));
  }
};

static inline void keep(Mask taken, const Instant& to, Instant* now) {
  const auto blend = [&](const Real& yes, Real& no) { no = select(taken, yes, no); };
  blend(to.thrust, now->thrust), blend(to.ring, now->ring), blend(to.w, now->w);
  blend(to.at.u, now->at.u), blend(to.at.v, now->at.v), blend(to.at.p, now->at.p);
  blend(to.rate.u, now->rate.u), blend(to.rate.v, now->rate.v), blend(to.rate.p, now->rate.p);
  blend(to.load.force, now->load.force), blend(to.load.specific, now->load.specific);
  blend(to.load_rate.force, now->load_rate.force), blend(to.load_rate.specific, now->load_rate.specific);
}

static inline void keep(Mask taken, const Barrier& to, Barrier* now) {
  const auto blend = [&](const Real& yes, Real& no) { no = select(taken, yes, no); };
  blend(to.travel, now->travel), blend(to.stiffness, now->stiffness), blend(to.coupled, now->coupled);
  blend(to.branch.peak, now->branch.peak), blend(to.branch.peak_force, now->branch.peak_force);
  blend(to.branch.valley, now->branch.valley), blend(to.branch.valley_force, now->branch.valley_force);
  now->over = choose(taken, to.over, now->over);
  now->under = choose(taken, to.under, now->under);
}

template <bool ARMS, bool WINGS>
Instant begin(const EnsembleScene& s, const Vehicles& a, const Basins<ARMS, WINGS>& basins) {
  const Real thrust = a.before * a.max_thrust, speed = Real(s.held ? 0.0 : s.initial_speed);
  const Load load = loadOf(s, a, thrust, speed, Real(0.0));
  const Mask start = s.start == vehicle::Mode::FIXED_WING ? none() : ~none();
  MotionInLanes x{Real(FAR), Real(0.0), s.held ? Real(0.0) : a.all * s.initial_speed};
  const Mask held = basins.equilibrium(start, load, basins.branchAt(load.specific), ~none(), &x.u);
  x.u = select(held, x.u, select(start, Real(s.equilibria.second), Real(s.equilibria.first)));
  return instantOf<ARMS, WINGS>(s, a, thrust, Real(0.0), x);
}

template <bool ARMS, bool WINGS>
__attribute__((noinline)) void runLanes(const EnsembleScene& s, const EnsembleBlock& block, EnsembleResult* results) {
  const Vehicles a(block);
  const Basins<ARMS, WINGS> basins(s, a);
  Instant now = begin<ARMS, WINGS>(s, a, basins);
  Barrier barrier = basins.barrierUnder(now.load, Real(s.equilibria.barrier), ~none());
  Watch<ARMS, WINGS> watch(basins, now.at.u, barrier);
  Clock clock(s, a, &now);
  while (!all(watch.done)) {
    const Real dt = clock.next(), rate = barrier.rate(now.load_rate);
    const RungeKutta<ARMS, WINGS> moved(s, a, now, clock, dt);
    const Real guess = select(barrier.exists(), barrier.travel + dt * rate, barrier.travel);
    const Barrier then = basins.barrierUnder(moved.end.load, guess, ~watch.done);
    const Real rate_then = then.rate(moved.end.load_rate);
    const Step step = {now, moved.end, barrier, then, dt, rate, rate_then};
    const auto seen = watch.see(step);
    const Mask taken = clock.judge(moved.error, watch.vague(step, seen)) & ~watch.done;
    watch.add(step, seen, taken);
    const Mask looks = clock.inLastPart() & taken;
    if (any(looks)) watch.look(step, looks, clock.left() - dt);
    keep(taken, moved.end, &now);
    keep(taken, then, &barrier);
    clock.advance(a, taken, &now);
    watch.done = watch.done | clock.over();
    watch.lose(~(now.at.v - now.at.v == 0.0));
  }
  for (int l = 0; l < LANES; ++l) results[l] = {watch.margin[l], watch.peak[l], watch.snapped[l]};
}

}  // namespace

/// Leaves out what the trial does not need.
static inline void run(const EnsembleScene& scene, const EnsembleBlock& block, EnsembleResult* results) {
  if (scene.arms) {
    scene.wings ? runLanes<true, true>(scene, block, results) : runLanes<true, false>(scene, block, results);
  } else {
    scene.wings ? runLanes<false, true>(scene, block, results) : runLanes<false, false>(scene, block, results);
  }
}

}  // namespace snapwing::rom::SNAPWING_WIDTH
