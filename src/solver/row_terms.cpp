#include "snapwing/solver/row_terms.h"

#include <algorithm>
#include <cmath>

#include "snapwing/common/elementary.h"
#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"
#include "snapwing/common/require.h"

namespace snapwing::solver {

namespace {

common::Require requireOf(const std::string& term) { return common::Require("term '" + term + "'"); }

}  // namespace

Row::Row(std::vector<std::pair<int, double>> entries) {
  std::sort(entries.begin(), entries.end());
  values_.resize(static_cast<int>(entries.size()));
  for (const auto& [coordinate, value] : entries) {
    const bool twice = !coordinates_.empty() && coordinates_.back() == coordinate;
    if (coordinate < 0 || twice || !std::isfinite(value)) {
      throw common::Error("a row has coordinate " + std::to_string(coordinate) + " with coefficient " +
                          common::toText(value) + "; allowed: finite coefficients, coordinates >= 0, none twice");
    }
    values_(static_cast<int>(coordinates_.size())) = value;
    coordinates_.push_back(coordinate);
  }
  if (coordinates_.empty()) throw common::Error("a row has no coordinates; allowed: at least one");
}

void RowTerm::add(const Point& at, double energy, double slope, double curvature, Order order, Sum& sum) const {
  sum.energy += energy;
  if (role_ == Role::STORED) sum.stored += energy;
  if (order == Order::ENERGY) return;
  row_.addTo(slope, sum.gradient);
  sum.noteForce(std::abs(slope) * row_.norm());
  sum.noteRounding(std::numeric_limits<double>::epsilon() * std::abs(curvature) * row_.norm() * row_.size(at.y));
  if (elasticity::withTangent(order) && curvature != 0) sum.addRankOne(0, curvature, row_.values());
}

RowInertia::RowInertia(std::string name, Row row, double mass)
    : RowTerm(std::move(name), Role::INERTIA, std::move(row)), mass_(mass) {
  requireOf(name_).notNegative("mass", mass);
}

void RowInertia::evaluate(const Point& at, Order order, Sum& sum) const {
  if (at.step == nullptr) return;
  const Step& step = *at.step;
  const double away = row_.dot(at.y) - row_.dot(step.y0) - step.h * row_.dot(step.v0), m = step.kappa * mass_;
  add(at, 0.5 * m * away * away, m * away, m, order, sum);
}

RowSpring::RowSpring(std::string name, Row row, double stiffness)
    : RowTerm(std::move(name), Role::STORED, std::move(row)), stiffness_(stiffness) {
  requireOf(name_).notNegative("stiffness", stiffness);
}

void RowSpring::evaluate(const Point& at, Order order, Sum& sum) const {
  const double g = row_.dot(at.y);
  add(at, 0.5 * stiffness_ * g * g, stiffness_ * g, stiffness_, order, sum);
}

RowDamper::RowDamper(std::string name, Row row, double damping)
    : RowTerm(std::move(name), Role::DISSIPATION, std::move(row)), damping_(damping) {
  requireOf(name_).notNegative("damping", damping);
}

void RowDamper::evaluate(const Point& at, Order order, Sum& sum) const {
  if (at.step == nullptr) return;
  const double h = at.step->h, v = (row_.dot(at.y) - row_.dot(at.step->y0)) / h;
  add(at, 0.5 * h * damping_ * v * v, damping_ * v, damping_ / h, order, sum);
}

RowDrag::RowDrag(std::string name, Row row, double coefficient, double wind)
    : RowTerm(std::move(name), Role::DISSIPATION, std::move(row)), coefficient_(coefficient), wind_(wind) {
  requireOf(name_).notNegative("coefficient", coefficient);
  requireOf(name_)(std::isfinite(wind), "wind", wind, "finite");
}

void RowDrag::evaluate(const Point& at, Order order, Sum& sum) const {
  if (at.step == nullptr) return;
  const double h = at.step->h, w = (row_.dot(at.y) - row_.dot(at.step->y0)) / h - wind_, size = std::abs(w);
  add(at, h * coefficient_ / 3 * size * size * size, coefficient_ * size * w, 2 * coefficient_ * size / h, order, sum);
}

RowFriction::RowFriction(std::string name, Row row, double force, double speed)
    : RowTerm(std::move(name), Role::DISSIPATION, std::move(row)), force_(force), speed_(speed) {
  requireOf(name_).notNegative("force", force);
  requireOf(name_)(speed > 0 && std::isfinite(speed), "speed", speed, "> 0");
}

void RowFriction::evaluate(const Point& at, Order order, Sum& sum) const {
  if (at.step == nullptr) return;
  const double h = at.step->h, v = (row_.dot(at.y) - row_.dot(at.step->y0)) / h, r = common::hypot(v, speed_);
  add(at, h * force_ * (r - speed_), force_ * v / r, force_ * speed_ * speed_ / (r * r * r * h), order, sum);
}

RowStop::RowStop(std::string name, Row row, double gap, double stiffness)
    : RowTerm(std::move(name), Role::STORED, std::move(row)), gap_(gap), stiffness_(stiffness) {
  requireOf(name_)(std::isfinite(gap), "gap", gap, "finite");
  requireOf(name_)(stiffness > 0 && std::isfinite(stiffness), "stiffness", stiffness, "> 0");
}

void RowStop::evaluate(const Point& at, Order order, Sum& sum) const {
  const double into = gap_ - row_.dot(at.y);
  if (into <= 0) return;
  add(at, 0.5 * stiffness_ * into * into, -stiffness_ * into, stiffness_, order, sum);
}

double stopDamping(const std::string& term, double stiffness, double mass, double restitution) {
  const common::Require require = requireOf(term);
  require(restitution > 0 && restitution <= 1, "restitution", restitution, "(0, 1]");
  require(mass > 0 && std::isfinite(mass), "mass", mass, "> 0");
  require(stiffness > 0 && std::isfinite(stiffness), "stiffness", stiffness, "> 0");
  const double log = common::log(restitution), pi = std::acos(-1.0);
  return 2 * (-log / common::hypot(pi, log)) * std::sqrt(stiffness * mass);
}

RowStopLoss::RowStopLoss(std::string name, Row row, double gap, double stiffness, double mass, double restitution)
    : RowTerm(std::move(name), Role::DISSIPATION, std::move(row)),
      gap_(gap),
      damping_(stopDamping(name_, stiffness, mass, restitution)) {}

void RowStopLoss::evaluate(const Point& at, Order order, Sum& sum) const {
  if (at.step == nullptr || row_.dot(at.step->y0) >= gap_) return;
  const double h = at.step->h, v = (row_.dot(at.y) - row_.dot(at.step->y0)) / h;
  add(at, 0.5 * h * damping_ * v * v, damping_ * v, damping_ / h, order, sum);
}

}  // namespace snapwing::solver
