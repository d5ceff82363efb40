#include "snapwing/motion/scheme.h"

#include <cmath>

#include "snapwing/common/enum_names.h"
#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"
#include "snapwing/common/require.h"

namespace snapwing::motion {

namespace {

constexpr common::EnumNames<SchemeKind, 4> NAMES("scheme",
                                                 {"backward_euler", "midpoint", "average_force", "corrected_midpoint"});

/// Gauss points and weights on [0, 1].
std::vector<std::pair<double, double>> gauss(int points) {
  switch (points) {
    case 1:
      return {{0.5, 1.0}};
    case 2: {
      const double x = 0.5 / std::sqrt(3.0);
      return {{0.5 - x, 0.5}, {0.5 + x, 0.5}};
    }
    case 3: {
      const double x = 0.5 * std::sqrt(0.6);
      return {{0.5 - x, 5.0 / 18}, {0.5, 8.0 / 18}, {0.5 + x, 5.0 / 18}};
    }
    default: {
      const double root = std::sqrt(1.2), a = 0.5 * std::sqrt((3 - 2 * root) / 7),
                   b = 0.5 * std::sqrt((3 + 2 * root) / 7), w = std::sqrt(30.0) / 72;
      return {{0.5 - b, 0.25 - w}, {0.5 - a, 0.25 + w}, {0.5 + a, 0.25 + w}, {0.5 + b, 0.25 - w}};
    }
  }
}

}  // namespace

SchemeKind schemeFromName(const std::string& name) { return NAMES.value(name); }

std::string schemeName(SchemeKind kind) { return NAMES.name(kind); }

Scheme::Scheme(SchemeKind kind, int points, double bias) : kind_(kind), points_(points), bias_(bias) {
  common::Require("scheme").within("points", points, 1, 4);
  common::Require("scheme").within("bias", bias, 0, 0.5);
  if (bias > 0 && kind != SchemeKind::MIDPOINT) {
    throw common::Error("bias is " + common::toText(bias) + " with scheme " + schemeName(kind) +
                        "; allowed: 0, or scheme midpoint");
  }
}

solver::Step Scheme::begin(double h, const Eigen::VectorXd& y0, const Eigen::VectorXd& v0) const {
  solver::Step step;
  step.h = h;
  step.y0 = y0;
  step.v0 = v0;
  step.kappa = (kind_ == SchemeKind::BACKWARD_EULER ? 1 : 2) / (h * h);
  if (kind_ == SchemeKind::AVERAGE_FORCE) step.path = gauss(points_);
  if (kind_ == SchemeKind::MIDPOINT || kind_ == SchemeKind::CORRECTED_MIDPOINT) step.path = {{0.5 * (1 + bias_), 1.0}};
  return step;
}

Eigen::VectorXd Scheme::rates(double h, const Eigen::VectorXd& d, const Eigen::VectorXd& v0) const {
  if (kind_ == SchemeKind::BACKWARD_EULER) return d / h;
  return 2 / h * d - v0;
}

Eigen::VectorXd Scheme::localError(const Eigen::VectorXd& change, const Eigen::VectorXd& acceleration, double h,
                                   double before) const {
  if (order() == 1) return 0.5 * h * h * acceleration;
  return h * h * h / 12 / (0.5 * (h + before)) * change;
}

}  // namespace snapwing::motion
