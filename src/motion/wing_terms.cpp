#include "snapwing/motion/wing_terms.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "couple.h"
#include "snapwing/common/error.h"
#include "snapwing/common/require.h"

namespace snapwing::motion {

using solver::Order;
using solver::Sum;

namespace {

std::string asker(const std::string& term) { return "term '" + term + "'"; }

std::shared_ptr<const PinAngle> turningAngle(const std::string& term, std::vector<Turning> bodies) {
  return std::make_shared<const TurningAngle>(asker(term), std::move(bodies));
}

bool exact(Order order) { return order == Order::TANGENT; }

/// Of a body's angle by its (a, b), also where a^2 + b^2 is not L^2: in the middle of a step.
struct AngleSlope {
  Eigen::Vector2d first;
  Eigen::Matrix2d second;
};

AngleSlope slopeOf(const Turning& body, const Eigen::VectorXd& y) {
  const double a = body.length + y(body.cosine), b = y(body.sine), square = a * a + b * b;
  AngleSlope out;
  out.first = body.sign * Eigen::Vector2d(-b, a) / square;
  out.second << 2 * a * b, b * b - a * a, b * b - a * a, -2 * a * b;
  out.second *= body.sign / (square * square);
  return out;
}

/// What depends on an angle alone: its potential [J], moment [N m] and the moment's slope [N m].
struct OfAngle {
  double potential, moment, slope;
};

/// @param from  start of the step of which `of` is a function of the angle's change; null: of the angle itself
void addOfAngle(const PinAngle& angle, const Eigen::VectorXd* from, const Eigen::VectorXd& y, const OfAngle& of,
                Order order, Sum& sum) {
  sum.energy += of.potential;
  if (order == Order::ENERGY) return;
  const Eigen::VectorXd slope = from != nullptr ? angle.slopeOver(*from, y) : angle.slope(y);
  for (Eigen::Index k = 0; k < slope.size(); ++k) sum.gradient(angle.coordinates()[k]) += of.moment * slope(k);
  sum.noteForce(std::abs(of.moment) * slope.norm());
  if (!elasticity::withTangent(order)) return;
  Eigen::MatrixXd block = of.slope * slope * slope.transpose();
  if (exact(order)) block += of.moment * (from != nullptr ? angle.curvatureOver(*from, y) : angle.curvature(y));
  addCouple(block, sum);
}

}  // namespace

double Turning::angle(const Eigen::VectorXd& y) const { return sign * std::atan2(y(sine), length + y(cosine)); }

TurningAngle::TurningAngle(const std::string& asker, std::vector<Turning> bodies) : bodies_(std::move(bodies)) {
  const common::Require require(asker);
  require(bodies_.size() == 1 || bodies_.size() == 2, "number of bodies", static_cast<double>(bodies_.size()),
          "1 or 2");
  for (const Turning& body : bodies_) coordinates_.push_back(body.cosine), coordinates_.push_back(body.sine);
}

double TurningAngle::at(const Eigen::VectorXd& y) const {
  const double first = bodies_.front().angle(y);
  return bodies_.size() == 1 ? first : std::remainder(first - bodies_.back().angle(y), 2 * M_PI);
}

double TurningAngle::between(const Eigen::VectorXd& from, const Eigen::VectorXd& y) const {
  double turned = 0, sign = 1;
  for (const Turning& body : bodies_) {
    turned += sign * std::remainder(body.angle(y) - body.angle(from), 2 * M_PI);
    sign = -1;
  }
  return turned;
}

Eigen::VectorXd TurningAngle::slope(const Eigen::VectorXd& y) const {
  Eigen::VectorXd out(2 * bodies_.size());
  out.head<2>() = slopeOf(bodies_.front(), y).first;
  if (bodies_.size() == 2) out.tail<2>() = -slopeOf(bodies_.back(), y).first;
  return out;
}

Eigen::MatrixXd TurningAngle::curvature(const Eigen::VectorXd& y) const {
  const auto size = static_cast<Eigen::Index>(2 * bodies_.size());
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(size, size);
  out.topLeftCorner<2, 2>() = slopeOf(bodies_.front(), y).second;
  if (bodies_.size() == 2) out.bottomRightCorner<2, 2>() = -slopeOf(bodies_.back(), y).second;
  return out;
}

HubTerm::HubTerm(std::string name, const Eigen::VectorXd& rotation_at_rest, const std::vector<int>& nodes, int point,
                 const Turning& body, double stiffness)
    : name_(std::move(name)), body_(body), stiffness_(stiffness) {
  common::Require(asker(name_))(stiffness > 0 && std::isfinite(stiffness), "stiffness", stiffness, "> 0 N m");
  common::Require(asker(name_))(!nodes.empty(), "number of nodes", 0, "at least 1");
  const auto count = static_cast<Eigen::Index>(2 * nodes.size() + 2);
  sine_ = cosine_ = Eigen::VectorXd::Zero(count);
  Eigen::Index k = 0;
  for (const int node : nodes) {
    // Rotation by x and y of a node at (X, Y) from the point is (-Y, X) / N, stretch (X, Y) / N.
    sine_.segment<2>(k) = rotation_at_rest.segment<2>(node);
    cosine_.segment<2>(k) = Eigen::Vector2d(rotation_at_rest(node + 1), -rotation_at_rest(node));
    coordinates_.push_back(node), coordinates_.push_back(node + 1);
    k += 2;
  }
  for (Eigen::Index n = 0; n < k; n += 2) {
    sine_.tail<2>() -= sine_.segment<2>(n);
    cosine_.tail<2>() -= cosine_.segment<2>(n);
  }
  coordinates_.push_back(point), coordinates_.push_back(point + 1);
  coordinates_.push_back(body.cosine), coordinates_.push_back(body.sine);
}

Eigen::VectorXd HubTerm::pick(const Eigen::VectorXd& y) const {
  Eigen::VectorXd own(sine_.size());
  for (Eigen::Index k = 0; k < own.size(); ++k) own(k) = y(coordinates_[k]);
  return own;
}

double HubTerm::twist(const Eigen::VectorXd& y) const {
  const Eigen::VectorXd own = pick(y);
  return std::remainder(std::atan2(sine_.dot(own), 1 + cosine_.dot(own)) - body_.angle(y), 2 * M_PI);
}

void HubTerm::evaluate(const solver::Point& at, Order order, Sum& sum) const {
  const Eigen::VectorXd own = pick(at.y);
  const Eigen::Index soft = own.size();
  const double s = sine_.dot(own), c = 1 + cosine_.dot(own), length = body_.length;
  const double a = (length + at.y(body_.cosine)) / length, b = at.y(body_.sine) / length;
  const double g = s * a - c * b, energy = 0.5 * stiffness_ * g * g;
  sum.energy += energy;
  sum.stored += energy;
  if (order == Order::ENERGY) return;
  Eigen::VectorXd slope(soft + 2);
  slope.head(soft) = a * sine_ - b * cosine_;
  slope(soft) = s / length;
  slope(soft + 1) = -c / length;
  const double force = stiffness_ * g;
  for (Eigen::Index k = 0; k < slope.size(); ++k) sum.gradient(coordinates_[k]) += force * slope(k);
  sum.noteForce(std::abs(force) * slope.norm());
  sum.noteRounding(std::numeric_limits<double>::epsilon() * stiffness_ * slope.norm());
  if (!elasticity::withTangent(order)) return;
  Eigen::MatrixXd block = stiffness_ * slope * slope.transpose();
  if (exact(order)) {
    block.row(soft).head(soft) += force / length * sine_.transpose();
    block.col(soft).head(soft) += force / length * sine_;
    block.row(soft + 1).head(soft) -= force / length * cosine_.transpose();
    block.col(soft + 1).head(soft) -= force / length * cosine_;
  }
  addCouple(block, sum);
}

PinFriction::PinFriction(const std::string& name, std::vector<Turning> bodies, double moment, double rate)
    : PinFriction(name, turningAngle(name, std::move(bodies)), moment, rate) {}

PinFriction::PinFriction(std::string name, std::shared_ptr<const PinAngle> angle, double moment, double rate)
    : name_(std::move(name)), angle_(std::move(angle)), moment_(moment), rate_(rate) {
  common::Require(asker(name_))(moment >= 0 && std::isfinite(moment), "moment", moment, ">= 0 N m");
  common::Require(asker(name_))(rate > 0 && std::isfinite(rate), "rate", rate, "> 0 rad/s");
}

void PinFriction::evaluate(const solver::Point& at, Order order, Sum& sum) const {
  if (at.step == nullptr) return;
  const double h = at.step->h, w = angle_->between(at.step->y0, at.y) / h, root = std::hypot(w, rate_);
  addOfAngle(*angle_, &at.step->y0, at.y,
             {h * moment_ * (root - rate_), moment_ * w / root, moment_ * rate_ * rate_ / (root * root * root * h)},
             order, sum);
}

TurningDrag::TurningDrag(const std::string& name, std::vector<Turning> bodies, double coefficient)
    : TurningDrag(name, turningAngle(name, std::move(bodies)), coefficient) {}

TurningDrag::TurningDrag(std::string name, std::shared_ptr<const PinAngle> angle, double coefficient)
    : name_(std::move(name)), angle_(std::move(angle)), coefficient_(coefficient) {
  common::Require(asker(name_))(coefficient >= 0 && std::isfinite(coefficient), "coefficient", coefficient,
                                ">= 0 N m s2");
}

void TurningDrag::evaluate(const solver::Point& at, Order order, Sum& sum) const {
  if (at.step == nullptr) return;
  const double h = at.step->h, w = angle_->between(at.step->y0, at.y) / h, fast = std::abs(w);
  addOfAngle(*angle_, &at.step->y0, at.y,
             {h * coefficient_ / 3 * fast * fast * fast, coefficient_ * fast * w, 2 * coefficient_ * fast / h}, order,
             sum);
}

SmoothCurve::SmoothCurve(std::vector<double> x, std::vector<double> value, std::vector<double> slope)
    : x_(std::move(x)), value_(std::move(value)), slope_(std::move(slope)) {
  bool good = x_.size() >= 2 && x_.size() == value_.size() && (slope_.empty() || slope_.size() == x_.size());
  for (std::size_t k = 1; good && k < x_.size(); ++k) good = x_[k] > x_[k - 1];
  if (!good) {
    throw common::Error("curve: number of points is " + std::to_string(x_.size()) +
                        ", or x does not increase; allowed: at least 2 points with increasing x and one value each");
  }
  const std::size_t last = x_.size() - 1;
  for (std::size_t k = slope_.size(); k <= last; ++k) {
    const std::size_t a = k == 0 ? 0 : k - 1, b = std::min(k + 1, last);
    slope_.push_back((value_[b] - value_[a]) / (x_[b] - x_[a]));
  }
}

SmoothCurve::Value SmoothCurve::at(double x) const {
  const double inside = std::clamp(x, x_.front(), x_.back());
  const auto upper = std::upper_bound(x_.begin() + 1, x_.end() - 1, inside);
  const auto k = static_cast<std::size_t>(upper - x_.begin());
  const double h = x_[k] - x_[k - 1], t = (inside - x_[k - 1]) / h, r = 1 - t;
  const double e0 = value_[k - 1], e1 = value_[k], s0 = h * slope_[k - 1], s1 = h * slope_[k];
  Value out;
  out.value = r * r * (1 + 2 * t) * e0 + t * t * (3 - 2 * t) * e1 + t * r * (r * s0 - t * s1);
  out.first = (6 * t * r * (e1 - e0) + r * (1 - 3 * t) * s0 - t * (2 - 3 * t) * s1) / h;
  out.second = ((6 - 12 * t) * (e1 - e0) + (6 * t - 4) * s0 + (6 * t - 2) * s1) / (h * h);
  if (x != inside) out.value += out.first * (x - inside), out.second = 0;
  return out;
}

AngleEnergy::AngleEnergy(const std::string& name, std::vector<Turning> bodies, SmoothCurve energy)
    : AngleEnergy(name, turningAngle(name, std::move(bodies)), std::move(energy)) {}

AngleEnergy::AngleEnergy(std::string name, std::shared_ptr<const PinAngle> angle, SmoothCurve energy)
    : name_(std::move(name)), angle_(std::move(angle)), energy_(std::move(energy)) {}

void AngleEnergy::evaluate(const solver::Point& at, Order order, Sum& sum) const {
  const SmoothCurve::Value now = energy_.at(angle_->at(at.y));
  sum.stored += now.value;
  const double slope = exact(order) ? now.second : std::max(0.0, now.second);
  addOfAngle(*angle_, nullptr, at.y, {now.value, now.first, slope}, order, sum);
}

TravelHub::TravelHub(std::string name, const Turning& body, solver::Row travel, SmoothCurve curve, double stiffness)
    : name_(std::move(name)),
      body_(body),
      travel_(std::move(travel)),
      curve_(std::move(curve)),
      stiffness_(stiffness),
      coordinates_(travel_.coordinates()) {
  common::Require(asker(name_))(stiffness > 0 && std::isfinite(stiffness), "stiffness", stiffness, "> 0 N m");
  coordinates_.push_back(body.cosine), coordinates_.push_back(body.sine);
}

void TravelHub::evaluate(const solver::Point& at, Order order, Sum& sum) const {
  const SmoothCurve::Value wanted = curve_.at(travel_.dot(at.y));
  const double g = std::remainder(body_.angle(at.y) - wanted.value, 2 * M_PI);
  const double energy = 0.5 * stiffness_ * g * g, moment = stiffness_ * g;
  sum.energy += energy;
  sum.stored += energy;
  if (order == Order::ENERGY) return;
  const AngleSlope own = slopeOf(body_, at.y);
  const Eigen::Index n = travel_.values().size();
  Eigen::VectorXd slope(n + 2);
  slope << -wanted.first * travel_.values(), own.first;
  for (Eigen::Index k = 0; k < n + 2; ++k) sum.gradient(coordinates_[k]) += moment * slope(k);
  sum.noteForce(std::abs(moment) * slope.norm());
  sum.noteRounding(std::numeric_limits<double>::epsilon() * stiffness_ * slope.norm());
  if (!elasticity::withTangent(order)) return;
  Eigen::MatrixXd block = stiffness_ * slope * slope.transpose();
  if (exact(order)) {
    block.topLeftCorner(n, n) -= moment * wanted.second * travel_.values() * travel_.values().transpose();
    block.bottomRightCorner(2, 2) += moment * own.second;
  }
  addCouple(block, sum);
}

}  // namespace snapwing::motion
