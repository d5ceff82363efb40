#pragma once
/// The closed loop of the four-bar for plain numbers and for jets; see snapwing/design/wing/linkage_four_bar.h.

#include <cmath>

#include "linkage_jet.h"
#include "snapwing/design/wing/linkage_four_bar.h"

namespace snapwing::design {

template <class S>
struct Plane {
  S x, y;
};
template <class S>
Plane<S> operator-(const Plane<S>& a, const Plane<S>& b) {
  return {a.x - b.x, a.y - b.y};
}
template <class S>
S dot(const Plane<S>& a, const Plane<S>& b) {
  return a.x * b.x + a.y * b.y;
}
template <class S>
S cross(const Plane<S>& a, const Plane<S>& b) {
  return a.x * b.y - a.y * b.x;
}
template <class S>
Plane<S> turned(const Plane<S>& a, const S& angle) {
  using std::cos;
  using std::sin;
  const S c = cos(angle), s = sin(angle);
  return {c * a.x - s * a.y, s * a.x + c * a.y};
}

/// What of a linkage does not depend on the design variables.
struct LoopFrame {
  double bx, by, tx, ty;
  int crank_sign, branch;
  static LoopFrame of(const FourBar& bar) {
    return {bar.auxiliary.x(), bar.auxiliary.y(), bar.tip.x(), bar.tip.y(), bar.crank_sign, bar.branch()};
  }
};

template <class S>
struct Loop {
  Plane<S> joint1, joint2, tip;
  S wing_rotation, rocker_rotation, transmission_sine, transmission_cosine;
  double opening = 0;  ///< h^2 before any smoothing; negative: the bars do not reach
};

/// sqrt(h^2), or for soft > 0 a smooth positive stand-in that is defined for a loop that does not close:
/// sqrt((h^2 + sqrt(h^4 + soft^2)) / 2), relative error soft^2 / (8 h^4).
template <class S>
S halfHeight(const S& h2, double soft) {
  using std::sqrt;
  if (soft <= 0) return valueOf(h2) > 0 ? S(sqrt(h2)) : S(0.0);
  return sqrt(0.5 * (h2 + sqrt(h2 * h2 + soft * soft)));
}

/// Angle at the auxiliary joint that d = B - x1 has turned since rest; continuous for any theta, because the vector
/// that is left when the larger of x1 and B is taken out never turns by more than a right angle.
template <class S>
S turnOfDiagonal(const Plane<S>& b, const Plane<S>& rest, const Plane<S>& now, const S& angle) {
  using std::atan2;
  const Plane<S> d0 = b - rest, d = b - now;
  if (valueOf(dot(rest, rest)) <= valueOf(dot(b, b))) {
    return atan2(cross(b, d), dot(b, d)) - atan2(cross(b, d0), dot(b, d0));
  }
  const Plane<S> e0 = rest - b, e = now - b;
  return angle + atan2(cross(now, e), dot(now, e)) - atan2(cross(rest, e0), dot(rest, e0));
}

/// @param soft  see halfHeight; 0: exact
template <class S>
Loop<S> closeLoop(const LoopFrame& f, const Plane<S>& X1, const Plane<S>& X2, const S& theta, double soft = 0) {
  using std::atan2;
  using std::sqrt;
  Loop<S> loop;
  const Plane<S> b{S(f.bx), S(f.by)};
  const S angle = static_cast<double>(f.crank_sign) * theta;
  loop.joint1 = turned(X1, angle);
  const Plane<S> d = b - loop.joint1, coupler = X2 - X1, rocker = X2 - b, d0 = b - X1;
  const S a2 = dot(coupler, coupler), b2 = dot(rocker, rocker), D2 = dot(d, d);
  const S p = 0.5 * (a2 - b2 + D2) / D2;
  const S h2 = a2 / D2 - p * p;
  loop.opening = valueOf(h2);
  const S h = halfHeight(h2, soft);
  const double side = f.branch;
  loop.joint2 = {loop.joint1.x + p * d.x - side * (h * d.y), loop.joint1.y + p * d.y + side * (h * d.x)};
  // Interior angles at x1 and at B, now and at rest; both lie in (0, pi), so the rotations never jump.
  const S at_joint1 = atan2(h, p) - side * atan2(cross(d0, coupler), dot(d0, coupler));
  const S rest_at_b = -side * atan2(cross(rocker, d0), -1.0 * dot(rocker, d0));
  const S turn = turnOfDiagonal(b, X1, loop.joint1, angle);
  loop.wing_rotation = turn + side * at_joint1;
  loop.rocker_rotation = turn - side * (atan2(h, 1.0 - p) - rest_at_b);
  const Plane<S> edge{f.tx - X1.x, f.ty - X1.y};
  const Plane<S> moved = turned(edge, loop.wing_rotation);
  loop.tip = {loop.joint1.x + moved.x, loop.joint1.y + moved.y};
  const S ab = sqrt(a2 * b2);
  loop.transmission_sine = side * (h * D2 / ab);
  loop.transmission_cosine = 0.5 * (a2 + b2 - D2) / ab;
  return loop;
}

}  // namespace snapwing::design
