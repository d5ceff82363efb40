#pragma once
/// Curves, loads and equations of motion in lanes. Private to the layer; docs/reduced_model.md has the equations.

#include "lanes.h"

namespace snapwing::rom::SNAPWING_WIDTH {

/// EnsembleBlock in vectors.
struct Vehicles {
  Real ring_mass, centre_mass, all, all_inverse, force_scale, damping, max_thrust, time_up, time_down, latency;
  Real ring_drag, centre_drag, boom_friction, wing_inertia, wing_friction, before, during, hold, after, duration,
      hold_duration;
  explicit Vehicles(const EnsembleBlock& b)
      : ring_mass(b.ring_mass),
        centre_mass(b.centre_mass),
        all(b.all),
        all_inverse(b.all_inverse),
        force_scale(b.force_scale),
        damping(b.damping),
        max_thrust(b.max_thrust),
        time_up(b.time_up),
        time_down(b.time_down),
        latency(b.latency),
        ring_drag(b.ring_drag),
        centre_drag(b.centre_drag),
        boom_friction(b.boom_friction),
        wing_inertia(b.wing_inertia),
        wing_friction(b.wing_friction),
        before(b.before),
        during(b.during),
        hold(b.hold),
        after(b.after),
        duration(b.duration),
        hold_duration(b.hold_duration) {}
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
static inline ForceSample arms(const CurvesView& c, Real u, const Place& p) {
  const Index row = p.cell * UniformCurves::FORCE_ROW;
  const double* base = c.force;
  const Real d = p.distance, c1 = pick(base + 1, row), c2 = pick(base + 2, row), c3 = pick(base + 3, row);
  const Beyond b = beyond(c, u, p);
  return {pick(base, row) + d * (c1 + d * (c2 + d * c3)) + b.by * (b.stiffness + 0.5 * b.by * b.growth),
          c1 + d * (2.0 * c2 + d * (3.0 * c3)) + b.by * b.growth};
}
static inline Real armsEnergy(const CurvesView& c, Real u, const Place& p) {
  const Index row = p.cell * UniformCurves::FORCE_ROW;
  const double* base = c.force;
  const Real d = p.distance;
  const Beyond b = beyond(c, u, p);
  return pick(base + 4, row) +
         d * (pick(base, row) +
              d * (0.5 * pick(base + 1, row) + d * (pick(base + 2, row) / 3.0 + d * (0.25 * pick(base + 3, row))))) +
         b.by * (b.force + b.by * (0.5 * b.stiffness + b.by * b.growth / 6.0));
}

struct Moved {
  Real kinetic, kinetic_slope, coupled, coupled_slope, friction;
};
static inline void addMoved(const double* table, Real u, const Place& p, Real scale, Moved* sum) {
  const Index row = p.cell * UniformCurves::INERTIA_ROW;
  const double* base = table;
  const Real d = p.distance;
  const Real k1 = pick(base + 1, row), k2 = pick(base + 2, row), k3 = pick(base + 3, row);
  const Real s1 = pick(base + 5, row), s2 = pick(base + 6, row), s3 = pick(base + 7, row);
  const Mask in = u == p.inside;
  sum->kinetic = sum->kinetic + scale * (pick(base, row) + d * (k1 + d * (k2 + d * k3)));
  sum->coupled = sum->coupled + scale * (pick(base + 4, row) + d * (s1 + d * (s2 + d * s3)));
  sum->kinetic_slope = sum->kinetic_slope + select(in, scale * (k1 + d * (2.0 * k2 + d * (3.0 * k3))), Real(0.0));
  sum->coupled_slope = sum->coupled_slope + select(in, scale * (s1 + d * (2.0 * s2 + d * (3.0 * s3))), Real(0.0));
}
template <bool ARMS, bool WINGS>
static inline Moved movedAt(const CurvesView& c, const Vehicles& a, Real u, const Place& p) {
  Moved m{0.0, 0.0, 0.0, 0.0, 0.0};
  if (ARMS) addMoved(c.arms, u, p, Real(1.0), &m);
  if (WINGS) {
    addMoved(c.wings, u, p, a.wing_inertia, &m);
    const Index row = p.cell * UniformCurves::INERTIA_ROW;
    m.friction = a.wing_friction * (pick(c.wings + 9, row) + p.distance * pick(c.wings + 10, row));
  }
  return m;
}
static inline Real moment(const double* table, Real u, const Place& p) {
  const Index row = p.cell * UniformCurves::INERTIA_ROW;
  const double* base = table;
  const Real d = p.distance;
  const Real s0 = pick(base + 4, row), s1 = pick(base + 5, row), s2 = pick(base + 6, row), s3 = pick(base + 7, row);
  const Real end = s0 + d * (s1 + d * (s2 + d * s3));
  return pick(base + 8, row) + d * (s0 + d * (0.5 * s1 + d * (s2 / 3.0 + d * (0.25 * s3)))) + end * (u - p.inside);
}

/// Travel, its rate, common momentum.
struct MotionInLanes {
  Real u, w, p;
};
struct Load {
  Real force, specific;  ///< as RelativeLoad
};

/// Inertia of the relative motion at one travel.
struct Inertia {
  Real mass, slope, lag;
};
template <bool ARMS, bool WINGS>
static inline Inertia inertiaOf(const Vehicles& a, const Moved& m) {
  Inertia i;
  i.lag = a.centre_mass - m.coupled;
  const Real share = i.lag * a.all_inverse;
  i.mass = a.centre_mass + m.kinetic - share * i.lag;
  i.slope = m.kinetic_slope + 2.0 * share * m.coupled_slope;
  return i;
}

static inline Real ringResistance(const EnsembleScene& s, const Vehicles& a, Real ring) {
  Real r = a.ring_drag * magnitude(ring) * ring;
  if (s.on_boom) r = r + a.boom_friction * ring / root(ring * ring + s.friction_speed * s.friction_speed);
  return r;
}

/// @param ring  its speed [m/s]; w: rate of the travel
static inline Load loadOf(const EnsembleScene& s, const Vehicles& a, Real thrust, Real ring, Real w) {
  const Real centre = ring - w, drag = a.centre_drag * magnitude(centre) * centre;
  if (s.held) return {a.centre_mass * s.gravity + drag, Real(s.gravity)};
  const Real push = thrust + s.push - ringResistance(s, a, ring);
  return {(a.centre_mass * push + a.ring_mass * drag) * a.all_inverse, (push - drag) * a.all_inverse};
}

template <bool ARMS, bool WINGS>
static inline MotionInLanes rateOf(const EnsembleScene& s, const Vehicles& a, Real thrust, const MotionInLanes& x) {
  const Place place = locate(s.curves, x.u);
  const Real force = a.force_scale * arms(s.curves, x.u, place).force;
  const Moved m = movedAt<ARMS, WINGS>(s.curves, a, x.u, place);
  const Inertia i = inertiaOf<ARMS, WINGS>(a, m);
  const Real ring = (x.p + i.lag * x.w) * a.all_inverse, centre = ring - x.w;
  const Real drag = a.centre_drag * magnitude(centre) * centre;
  Real push = Real(0.0);
  if (!s.held) push = thrust + s.push - ringResistance(s, a, ring) - drag - a.all * s.gravity;
  Real relative = drag + i.lag * s.gravity + i.lag * a.all_inverse * push - force - a.damping * x.w;
  if (ARMS || WINGS) relative = relative - 0.5 * i.slope * x.w * x.w;
  if (WINGS) relative = relative - m.friction * x.w / root(x.w * x.w + s.friction_speed * s.friction_speed);
  return {x.w, relative / i.mass, push};
}

}  // namespace snapwing::rom::SNAPWING_WIDTH
