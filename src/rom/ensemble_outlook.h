#pragma once
/// What can still happen to the margins of vehicles that got their last demand: the clearance that they cannot lose any
/// more until they are calm. Private to the layer; docs/reduced_model.md, "Decided early".

#include "ensemble_basins.h"

namespace snapwing::rom::SNAPWING_WIDTH {

constexpr double CALM = 1e-3;  // of the full thrust, beside the last demand

/// Not below ln x where x > 1, at most 15 % above it up to 1000; 0 where x < 1.
static inline Real logarithm(const Real& x) {
  const Real fourth = root(root(most(x, Real(1.0))));
  return 4.0 * (fourth - 1.0) / root(fourth);
}

template <bool ARMS, bool WINGS>
class Outlook {
 public:
  explicit Outlook(const Basins<ARMS, WINGS>& basins) : s_(basins.s), a_(basins.a), basins_(basins) {
    first_ = bottomAt(s_.equilibria.first);
    second_ = bottomAt(s_.equilibria.second);
    const Real drag = a_.ring_drag + a_.centre_drag, push = a_.after * a_.max_thrust - a_.all * s_.gravity;
    push_ = magnitude(push);
    drag_ = drag;
    const Real terminal = root(push_ / drag);
    terminal_ = select(drag > 0.0, select(push < 0.0, -terminal, terminal), Real(0.0));
    drag_on_load_ = (a_.ring_mass * a_.centre_drag - a_.centre_mass * a_.ring_drag) * a_.all_inverse;
  }

  /// Lanes that stay on their side with more than `wanted` [J] between them and the barrier, and do not go beyond
  /// `peak`, until they are calm, which they become before the horizon. @param left  until the horizon [s]
  Mask keeps(Mask asked, const Mask& side, const Instant& n, const Barrier& b, const Real& wanted, const Real& peak,
             const Real& small, const Real& left) const {
    const Bottom bottom = {select(side, second_.travel, first_.travel), select(side, second_.mass, first_.mass),
                           select(side, second_.stiffness, first_.stiffness)};
    // Above the loaded bottom, by its distance and by the pull towards it, as if the stiffness were the same
    // everywhere.
    const Real moving = 0.5 * n.at.v * n.at.v, force = n.load.force;
    const Real off = n.at.u - bottom.travel - force / bottom.stiffness;
    const Real excess = moving + 0.5 * most(bottom.stiffness * off * off, n.pull * n.pull / bottom.stiffness);
    const Real thrust_off = a_.after * a_.max_thrust - n.thrust;
    const Real calm = most(bottom.mass / a_.damping * logarithm(excess / small),
                           a_.time_down * logarithm(magnitude(thrust_off) / (CALM * a_.max_thrust)));
    // What thrust and speed do to the load until then.
    const Real by_thrust = thrust_off * a_.centre_mass * a_.all_inverse, by_speed = bySpeed(n.ring, calm);
    const Real rise = most(by_thrust, Real(0.0)) + most(by_speed, Real(0.0));
    const Real fall = most(-by_thrust, Real(0.0)) + most(-by_speed, Real(0.0));
    // The clearance of the loaded bottom falls by what the load does on the way to the barrier. The motion keeps its
    // energy above the bottom, but for what the thrust does while it is off; and a load moves the bottom itself.
    const Real way = magnitude(b.travel - bottom.travel);
    const Real lost = select(side, fall, rise) * way;
    const Real gained = magnitude(by_thrust) * root(2.0 * excess / bottom.stiffness);
    // Who is in the only basin there is, and in which there will be none other, has no barrier.
    const Mask alone = choose(side, force - fall >= b.branch.peak_force, force + rise <= b.branch.valley_force);
    const Real roughly = basins_.barrierOf(side) + select(side, force, -force) * way - moving - gained;
    const Mask likely = (roughly - lost > wanted) & ~choose(side, b.under, b.over);
    asked = asked & (left > 3.0 * calm) & (alone | likely);
    if (!any(asked)) return none();
    const Real here = basins_.energy(n.at.u, n.load) + moving, moved = gained + force * force / bottom.stiffness;
    const Real clear = basins_.energy(b.travel, n.load) - here - moved;
    asked = asked & ((alone & (clear > 0.0)) | (likely & (clear - lost > wanted)));
    const Mask beyond = ~side & (peak > b.travel);
    if (all(beyond | ~asked)) return asked;
    return asked & (beyond | (basins_.energy(peak, n.load) - here - moved > lost));
  }

 private:
  /// An equilibrium without load.
  struct Bottom {
    Real travel, mass, stiffness;
  };
  Bottom bottomAt(double travel) const {
    const Real u = Real(travel), root_of_mass = basins_.rootOfMass(u);
    const ForceSample arms = curvesAt<ARMS, WINGS, false>(s_.curves, a_, u).arms;
    return {u, root_of_mass * root_of_mass, a_.force_scale * arms.stiffness};
  }
  /// What the load gains by the change of the whole vehicle's speed within a time.
  Real bySpeed(const Real& ring, const Real& time) const {
    if (s_.held) return Real(0.0);
    const Real share = time * a_.all_inverse, pull = drag_ * magnitude(ring);
    const Real change = share * (push_ + pull * magnitude(ring) / (1.0 + share * pull));
    const Real then = clamp(terminal_, ring - change, ring + change);
    return drag_on_load_ * (then * magnitude(then) - ring * magnitude(ring));
  }

  const EnsembleScene& s_;
  const Vehicles& a_;
  const Basins<ARMS, WINGS>& basins_;
  Bottom first_, second_;
  Real push_, drag_, terminal_, drag_on_load_;
};

}  // namespace snapwing::rom::SNAPWING_WIDTH
