#pragma once
/// Curves, loads and equations of motion in lanes. Private to the layer; docs/reduced_model.md has the equations.

#include "lanes.h"

namespace snapwing::rom::SNAPWING_WIDTH {

/// EnsembleBlock in vectors.
struct Vehicles {
#define SNAPWING_NUMBER(name) Real name;
  SNAPWING_VEHICLE_NUMBERS(SNAPWING_NUMBER)
#undef SNAPWING_NUMBER

  explicit Vehicles(const EnsembleBlock& block) {
#define SNAPWING_NUMBER(name) name = Real(block.name);
    SNAPWING_VEHICLE_NUMBERS(SNAPWING_NUMBER)
#undef SNAPWING_NUMBER
  }
};

struct Place {
  Real inside, distance;  ///< travel within the grid, and from the begin of its cell [m]
  Index cell;
};

static inline Place locate(const CurvesView& c, Real u) {
  Place p;
  p.inside = clamp(u, Real(c.low), Real(c.high));
  const Real x = (p.inside - c.low) * (1.0 / c.width);
  p.cell = whole(x, c.cells - 1);
  p.distance = (x - real(p.cell)) * c.width;
  return p;
}

/// What the force adds beyond the grid.
struct Beyond {
  Real by, force, stiffness, growth;
};
static inline Beyond beyond(const CurvesView& c, Real u, const Place& p) {
  Beyond b;
  b.by = u - p.inside;
  const Mask low = b.by < 0.0;
  b.force = select(low, Real(c.at_low.force), Real(c.at_high.force));
  b.stiffness = select(low, Real(c.at_low.stiffness), Real(c.at_high.stiffness));
  b.growth = select(low, Real(c.growth_low), Real(c.growth_high));
  return b;
}

struct ForceSample {
  Real force, stiffness;
};

/// What moves with the travel, arms and wings, as InertiaSample; without the moment.
struct Moved {
  Real kinetic, kinetic_slope, coupled, coupled_slope, friction;
};
/// All that the curves say of a travel.
struct Curves {
  ForceSample arms;  ///< of force scale 1
  Moved moved;
};
/// K is left out unless it is asked for: loads on the travel do without.
template <bool ARMS, bool WINGS, bool KINETIC>
__attribute__((always_inline)) static inline Curves curvesAt(const CurvesView& c, const Vehicles& a, Real u) {
  const Place p = locate(c, u);
  const Real d = p.distance;
  Real f[8], w[8], k[8];
  columns(c.force, p.cell, f);
  if (WINGS) columns(c.wings, p.cell, w);
  if (KINETIC) columns(c.kinetic, p.cell, k);
  const Beyond b = beyond(c, u, p);
  Curves r;
  r.arms = {f[0] + d * (f[1] + d * (f[2] + d * f[3])) + b.by * (b.stiffness + 0.5 * b.by * b.growth),
            f[1] + d * (2.0 * f[2] + d * (3.0 * f[3])) + b.by * b.growth};
  Moved& m = r.moved;
  m = {Real(0.0), Real(0.0), Real(0.0), Real(0.0), Real(0.0)};
  if (ARMS) {
    m.coupled = f[4] + d * (f[5] + d * f[6]);
    m.coupled_slope = f[5] + 2.0 * d * f[6];
  }
  if (WINGS) {
    m.coupled = m.coupled + a.wing_inertia * (w[0] + d * (w[1] + d * w[2]));
    m.coupled_slope = m.coupled_slope + a.wing_inertia * (w[1] + 2.0 * d * w[2]);
    m.friction = a.wing_friction * (w[3] + d * w[4]);
  }
  if (ARMS && KINETIC) {
    m.kinetic = k[0] + d * (k[1] + d * k[2]);
    m.kinetic_slope = k[1] + 2.0 * d * k[2];
  }
  if (WINGS && KINETIC) {
    m.kinetic = m.kinetic + a.wing_inertia * (k[3] + d * (k[4] + d * k[5]));
    m.kinetic_slope = m.kinetic_slope + a.wing_inertia * (k[4] + 2.0 * d * k[5]);
  }
  return r;
}

/// Potential energy under a load.
template <bool ARMS, bool WINGS>
static inline Real energyAt(const CurvesView& c, const Vehicles& a, Real u, Real force, Real specific) {
  const Place p = locate(c, u);
  const Real d = p.distance;
  Real f[8], w[8];
  columns(c.force, p.cell, f);
  const Beyond b = beyond(c, u, p);
  const Real elastic = f[7] + d * (f[0] + d * (0.5 * f[1] + d * (f[2] * (1.0 / 3.0) + d * (0.25 * f[3])))) +
                       b.by * (b.force + b.by * (0.5 * b.stiffness + b.by * b.growth * (1.0 / 6.0)));
  Real e = a.force_scale * elastic - force * u;
  if (!ARMS && !WINGS) return e;
  columns(c.wings, p.cell, w);
  const auto moment = [&](Real begin, Real s0, Real s1, Real s2) {
    const Real end = s0 + d * (s1 + d * s2);
    return begin + d * (s0 + d * (0.5 * s1 + d * s2 * (1.0 / 3.0))) + end * b.by;
  };
  if (ARMS) e = e + specific * moment(w[5], f[4], f[5], f[6]);
  if (WINGS) e = e + specific * a.wing_inertia * moment(w[6], w[0], w[1], w[2]);
  return e;
}

/// Travel, v = sqrt(m) u', common momentum. v^2 / 2 is the kinetic energy of the relative motion and v' = (force on the
/// travel) / sqrt(m): where the inertia m(u) of the wings turns within a millimetre, steps of some millimetres see it
/// in the travel's rate alone, and no term with dm/du is left.
struct MotionInLanes {
  Real u, v, p;
};
struct Load {
  Real force, specific;  ///< as RelativeLoad
};

/// Inertia of the relative motion at one travel.
struct Inertia {
  Real mass, slope, lag;
};
static inline Inertia inertiaOf(const Vehicles& a, const Moved& m) {
  Inertia i;
  i.lag = a.centre_mass - m.coupled;
  const Real share = i.lag * a.all_inverse;
  i.mass = a.centre_mass + m.kinetic - share * i.lag;
  i.slope = m.kinetic_slope + 2.0 * share * m.coupled_slope;
  return i;
}

/// A force against a speed, and what it gains with it.
struct Against {
  Real force, slope;
};
__attribute__((always_inline)) static inline Against ringResistance(const EnsembleScene& s, const Vehicles& a,
                                                                    Real ring) {
  const Real pull = a.ring_drag * magnitude(ring);
  Against r = {pull * ring, 2.0 * pull};
  if (s.on_boom) {
    const Real square = ring * ring + s.friction_speed * s.friction_speed, rub = a.boom_friction / root(square);
    r.force = r.force + rub * ring;
    r.slope = r.slope + rub * (s.friction_speed * s.friction_speed) / square;
  }
  return r;
}

/// The motion at one instant, with what drives it.
struct Instant {
  MotionInLanes at, rate;
  Real thrust, w, ring;  ///< w: u' [m/s]; ring: its speed [m/s]
  Real pull, stiffness;  ///< force on the travel without friction and damping [N], and how it falls with the travel
  Load load, load_rate;
};

/// Equations of motion. What the caller does not use is not evaluated. @param thrust_rate  counts in load_rate only
template <bool ARMS, bool WINGS>
__attribute__((always_inline)) static inline Instant instantOf(const EnsembleScene& s, const Vehicles& a, Real thrust,
                                                               Real thrust_rate, const MotionInLanes& x) {
  const Curves c = curvesAt < ARMS, WINGS, ARMS || WINGS > (s.curves, a, x.u);
  const Inertia i = inertiaOf(a, c.moved);
  Instant n;
  n.at = x;
  n.thrust = thrust;
  Real inverse, pins = Real(0.0);  // 1 / sqrt(m); u' / sqrt(u'^2 + v_f^2) of the pins that rub
  if (WINGS) {
    const Real one = root(i.mass), other = root(x.v * x.v + i.mass * (s.friction_speed * s.friction_speed));
    const Real both = 1.0 / (one * other);
    inverse = both * other;
    pins = x.v * (both * one);
  } else {
    inverse = 1.0 / root(i.mass);
  }
  n.w = x.v * inverse;
  n.ring = s.held ? Real(0.0) : (x.p + i.lag * n.w) * a.all_inverse;
  const Real centre = n.ring - n.w, pull = a.centre_drag * magnitude(centre), drag = pull * centre;
  Against against = {Real(0.0), Real(0.0)};
  Real push = Real(0.0);
  if (!s.held) {
    against = ringResistance(s, a, n.ring);
    push = thrust + s.push - against.force - drag - a.all * s.gravity;
  }
  n.pull = drag + i.lag * s.gravity + i.lag * a.all_inverse * push - a.force_scale * c.arms.force;
  n.stiffness = a.force_scale * c.arms.stiffness;
  Real relative = n.pull - a.damping * n.w;
  if (WINGS) relative = relative - c.moved.friction * pins;
  n.rate = {n.w, relative * inverse, push};

  const Real w_rate = (relative - 0.5 * i.slope * n.w * n.w) * (inverse * inverse);
  if (s.held) {
    n.load = {a.centre_mass * s.gravity + drag, Real(s.gravity)};
    n.load_rate = {-2.0 * pull * w_rate, Real(0.0)};
    return n;
  }
  const Real ring_rate = (push + i.lag * w_rate - c.moved.coupled_slope * n.w * n.w) * a.all_inverse;
  const Real driving = thrust + s.push - against.force, driving_rate = thrust_rate - against.slope * ring_rate;
  const Real drag_rate = 2.0 * pull * (ring_rate - w_rate);
  n.load = {(a.centre_mass * driving + a.ring_mass * drag) * a.all_inverse, (driving - drag) * a.all_inverse};
  n.load_rate = {(a.centre_mass * driving_rate + a.ring_mass * drag_rate) * a.all_inverse,
                 (driving_rate - drag_rate) * a.all_inverse};
  return n;
}

/// The load at a thrust and a speed of the whole vehicle.
static inline Load loadOf(const EnsembleScene& s, const Vehicles& a, Real thrust, Real ring, Real w) {
  const Real centre = ring - w, drag = a.centre_drag * magnitude(centre) * centre;
  if (s.held) return {a.centre_mass * s.gravity + drag, Real(s.gravity)};
  const Real push = thrust + s.push - ringResistance(s, a, ring).force;
  return {(a.centre_mass * push + a.ring_mass * drag) * a.all_inverse, (push - drag) * a.all_inverse};
}

}  // namespace snapwing::rom::SNAPWING_WIDTH
