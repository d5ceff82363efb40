#include "snapwing/rom/wing_inertia.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "snapwing/common/error.h"

namespace snapwing::rom {

namespace {

/// Slopes of the monotone cubic interpolant: weighted harmonic means of the neighbouring secants, 0 at extrema.
std::vector<double> monotoneSlopes(const std::vector<double>& x, const std::vector<double>& y) {
  const std::size_t n = x.size();
  std::vector<double> slope(n, 0.0);
  const auto secant = [&](std::size_t i) { return (y[i + 1] - y[i]) / (x[i + 1] - x[i]); };
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double left = secant(i - 1), right = secant(i);
    if (left * right <= 0) continue;
    const double a = 2 * (x[i + 1] - x[i]) + (x[i] - x[i - 1]), b = (x[i + 1] - x[i]) + 2 * (x[i] - x[i - 1]);
    slope[i] = (a + b) / (a / left + b / right);
  }
  return slope;  // 0 at both ends, where the constant goes on
}

void requireScale(bool good, const char* name, double value, const char* allowed) {
  if (!good) throw common::Error(std::string(name) + " is " + std::to_string(value) + "; allowed: " + allowed);
}

}  // namespace

/// Cubic pieces c0 + c1 t + c2 t^2 + c3 t^3, t in [0, 1] within an interval.
struct WingInertia::Curve {
  struct Piece {
    double kinetic[4], coupled[4];
    double moment;  ///< H at the interval's begin
    double friction0, friction1;
  };
  std::vector<double> travel;
  std::vector<Piece> pieces;
  double moment_end = 0;
  double uniform_inverse = 0;  ///< 1/h if the knots are equally spaced, else 0

  explicit Curve(const common::WingTable& table);
  std::size_t intervalOf(double u) const {
    if (uniform_inverse > 0) {
      return std::min<std::size_t>(static_cast<std::size_t>((u - travel.front()) * uniform_inverse), pieces.size() - 1);
    }
    const auto above = std::upper_bound(travel.begin(), travel.end(), u);
    return std::min<std::size_t>(above - travel.begin() - 1, pieces.size() - 1);
  }
};

namespace {

void setPiece(double (&c)[4], double y0, double y1, double m0, double m1) {
  c[0] = y0;
  c[1] = m0;
  c[2] = 3 * (y1 - y0) - 2 * m0 - m1;
  c[3] = 2 * (y0 - y1) + m0 + m1;
}

double value(const double (&c)[4], double t) { return c[0] + t * (c[1] + t * (c[2] + t * c[3])); }
double slope(const double (&c)[4], double t) { return c[1] + t * (2 * c[2] + t * 3 * c[3]); }
double integral(const double (&c)[4], double t) { return t * (c[0] + t * (c[1] / 2 + t * (c[2] / 3 + t * c[3] / 4))); }

void requireColumns(const common::WingTable& t) {
  t.validate();
  if (t.kinetic_mass.empty() || t.coupled_mass.empty() || t.friction_force.empty()) {
    throw common::Error(
        "wing table: no 'kinetic_mass', 'coupled_mass' or 'friction_force'; allowed: a table made with "
        "a blade, by `snapwing design wing`");
  }
  for (std::size_t i = 0; i < t.travel.size(); ++i) {
    const double k = t.kinetic_mass[i], f = t.friction_force[i];
    if (!(k >= 0)) throw common::Error("wing table: 'kinetic_mass' is " + std::to_string(k) + "; allowed: 0 or more");
    if (!(f >= 0)) throw common::Error("wing table: 'friction_force' is " + std::to_string(f) + "; allowed: 0 or more");
  }
}

}  // namespace

WingInertia::Curve::Curve(const common::WingTable& table) : travel(table.travel) {
  requireColumns(table);
  const auto kinetic = monotoneSlopes(travel, table.kinetic_mass);
  const auto coupled = monotoneSlopes(travel, table.coupled_mass);
  double narrowest = INFINITY, widest = 0;
  for (std::size_t i = 0; i + 1 < travel.size(); ++i) {
    const double h = travel[i + 1] - travel[i];
    narrowest = std::min(narrowest, h);
    widest = std::max(widest, h);
    Piece piece;
    setPiece(piece.kinetic, table.kinetic_mass[i], table.kinetic_mass[i + 1], h * kinetic[i], h * kinetic[i + 1]);
    setPiece(piece.coupled, table.coupled_mass[i], table.coupled_mass[i + 1], h * coupled[i], h * coupled[i + 1]);
    piece.moment = moment_end;
    moment_end += h * integral(piece.coupled, 1.0);
    piece.friction0 = table.friction_force[i];
    piece.friction1 = table.friction_force[i + 1];
    pieces.push_back(piece);
  }
  if (widest - narrowest < 1e-9 * widest) uniform_inverse = pieces.size() / (travel.back() - travel.front());
}

RelativeInertia relativeInertia(const WingSample& wing, double centre, double all) {
  RelativeInertia r;
  r.lag = centre - wing.coupled_mass;
  r.share = std::isinf(all) ? 0.0 : r.lag / all;
  r.mass = centre + wing.kinetic_mass - r.share * r.lag;
  r.mass_slope = wing.kinetic_slope + 2.0 * r.share * wing.coupled_slope;
  return r;
}

WingInertia::WingInertia(const common::WingTable& table, double inertia_scale, double friction_scale)
    : curve_(std::make_shared<const Curve>(table)) {
  *this = scaled(inertia_scale, friction_scale);
}

WingInertia WingInertia::scaled(double inertia_scale, double friction_scale) const {
  requireScale(inertia_scale > 0 && std::isfinite(inertia_scale), "wing inertia scale", inertia_scale, "above 0");
  requireScale(friction_scale >= 0 && std::isfinite(friction_scale), "wing friction scale", friction_scale,
               "0 or more");
  WingInertia other = *this;
  other.inertia_scale_ = inertia_scale;
  other.friction_scale_ = friction_scale;
  return other;
}

WingSample WingInertia::at(double u) const {
  const Curve& c = *curve_;
  const double inside = std::clamp(u, c.travel.front(), c.travel.back());
  const std::size_t i = c.intervalOf(inside);
  const double h = c.travel[i + 1] - c.travel[i], t = (inside - c.travel[i]) / h;
  const Curve::Piece& piece = c.pieces[i];
  WingSample s;
  s.kinetic_mass = inertia_scale_ * value(piece.kinetic, t);
  s.coupled_mass = inertia_scale_ * value(piece.coupled, t);
  if (u == inside) {
    s.kinetic_slope = inertia_scale_ * slope(piece.kinetic, t) / h;
    s.coupled_slope = inertia_scale_ * slope(piece.coupled, t) / h;
  }
  s.mass_moment = inertia_scale_ * (piece.moment + h * integral(piece.coupled, t)) + s.coupled_mass * (u - inside);
  s.friction = friction_scale_ * (piece.friction0 + t * (piece.friction1 - piece.friction0));
  return s;
}

}  // namespace snapwing::rom
