#include "snapwing/rom/travel_inertia.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "snapwing/common/error.h"
#include "snapwing/common/require.h"

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

const common::Require require;

}  // namespace

/// Cubic pieces c0 + c1 t + c2 t^2 + c3 t^3, t in [0, 1] within an interval.
struct TravelInertia::Curve {
  struct Piece {
    double kinetic[4], coupled[4];
    double moment;  ///< H at the interval's begin
    double friction0, friction1;
  };
  std::vector<double> travel;
  std::vector<Piece> pieces;
  double moment_end = 0;
  double uniform_inverse = 0;  ///< 1/h if the knots are equally spaced, else 0

  /// @param friction  empty: none
  Curve(std::vector<double> at, const std::vector<double>& kinetic_mass, const std::vector<double>& coupled_mass,
        const std::vector<double>& friction);
  /// Adds what is there at u.
  void add(double u, double inertia_scale, double friction_scale, InertiaSample* sum) const;
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

void requireColumns(const vehicle::WingTable& t) {
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

TravelInertia::Curve::Curve(std::vector<double> at, const std::vector<double>& kinetic_mass,
                            const std::vector<double>& coupled_mass, const std::vector<double>& friction)
    : travel(std::move(at)) {
  const auto kinetic = monotoneSlopes(travel, kinetic_mass);
  const auto coupled = monotoneSlopes(travel, coupled_mass);
  double narrowest = INFINITY, widest = 0;
  for (std::size_t i = 0; i + 1 < travel.size(); ++i) {
    const double h = travel[i + 1] - travel[i];
    narrowest = std::min(narrowest, h);
    widest = std::max(widest, h);
    Piece piece;
    setPiece(piece.kinetic, kinetic_mass[i], kinetic_mass[i + 1], h * kinetic[i], h * kinetic[i + 1]);
    setPiece(piece.coupled, coupled_mass[i], coupled_mass[i + 1], h * coupled[i], h * coupled[i + 1]);
    piece.moment = moment_end;
    moment_end += h * integral(piece.coupled, 1.0);
    piece.friction0 = friction.empty() ? 0.0 : friction[i];
    piece.friction1 = friction.empty() ? 0.0 : friction[i + 1];
    pieces.push_back(piece);
  }
  if (widest - narrowest < 1e-9 * widest) uniform_inverse = pieces.size() / (travel.back() - travel.front());
}

RelativeInertia relativeInertia(const InertiaSample& moved, double centre, double all) {
  RelativeInertia r;
  r.lag = centre - moved.coupled_mass;
  r.share = std::isinf(all) ? 0.0 : r.lag / all;
  r.mass = centre + moved.kinetic_mass - r.share * r.lag;
  r.mass_slope = moved.kinetic_slope + 2.0 * r.share * moved.coupled_slope;
  return r;
}

namespace {

std::vector<double> times(std::vector<double> values, double factor) {
  for (double& value : values) value *= factor;
  return values;
}

}  // namespace

TravelInertia::TravelInertia(const vehicle::ForceTable& table) {
  table.validate();
  const double arms = table.arm_count;
  parts_.push_back({std::make_shared<const Curve>(table.travel, times(table.kinetic_mass, arms),
                                                  times(table.coupled_mass, arms), std::vector<double>())});
}

TravelInertia::TravelInertia(const vehicle::WingTable& table, double inertia_scale, double friction_scale) {
  requireColumns(table);
  parts_.push_back(
      {std::make_shared<const Curve>(table.travel, table.kinetic_mass, table.coupled_mass, table.friction_force)});
  *this = scaled(inertia_scale, friction_scale);
}

TravelInertia TravelInertia::scaled(double inertia_scale, double friction_scale) const {
  require(inertia_scale > 0 && std::isfinite(inertia_scale), "wing inertia scale", inertia_scale, "above 0");
  require(friction_scale >= 0 && std::isfinite(friction_scale), "wing friction scale", friction_scale, "0 or more");
  TravelInertia other = *this;
  for (Part& part : other.parts_) {
    part.inertia_scale = inertia_scale;
    part.friction_scale = friction_scale;
  }
  return other;
}

TravelInertia TravelInertia::operator+(const TravelInertia& other) const {
  TravelInertia sum = *this;
  sum.parts_.insert(sum.parts_.end(), other.parts_.begin(), other.parts_.end());
  return sum;
}

double TravelInertia::lowest() const {
  double low = INFINITY;
  for (const Part& part : parts_) low = std::min(low, part.curve->travel.front());
  return low;
}

double TravelInertia::highest() const {
  double high = -INFINITY;
  for (const Part& part : parts_) high = std::max(high, part.curve->travel.back());
  return high;
}

InertiaSample TravelInertia::at(double u) const {
  InertiaSample sum;
  for (const Part& part : parts_) part.curve->add(u, part.inertia_scale, part.friction_scale, &sum);
  return sum;
}

void TravelInertia::Curve::add(double u, double inertia_scale, double friction_scale, InertiaSample* sum) const {
  const double inside = std::clamp(u, travel.front(), travel.back());
  const std::size_t i = intervalOf(inside);
  const double h = travel[i + 1] - travel[i], t = (inside - travel[i]) / h;
  const Piece& piece = pieces[i];
  const double coupled = value(piece.coupled, t);
  sum->kinetic_mass += inertia_scale * value(piece.kinetic, t);
  sum->coupled_mass += inertia_scale * coupled;
  if (u == inside) {
    sum->kinetic_slope += inertia_scale * slope(piece.kinetic, t) / h;
    sum->coupled_slope += inertia_scale * slope(piece.coupled, t) / h;
  }
  sum->mass_moment += inertia_scale * (piece.moment + h * integral(piece.coupled, t) + coupled * (u - inside));
  sum->friction += friction_scale * (piece.friction0 + t * (piece.friction1 - piece.friction0));
}

}  // namespace snapwing::rom
