#pragma once
/// The battery that every term goes through: energy, gradient and Hessian are derivatives of each other, controls
/// included; a term adds to what is there; it writes nothing but what it announced.

#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "snapwing/solver/term.h"
#include "support/derivative_check.h"

namespace snapwing::test {

struct TermCase {
  solver::HessianLayout layout;    ///< with the regions, if any
  std::vector<Eigen::VectorXd> y;  ///< full coordinates to test at [m]
  Eigen::VectorXd p = Eigen::VectorXd::Zero(1);
  const solver::Step* step = nullptr;
  double scale = 1e-3;  ///< natural size of a motion [m]
  double floor = 1e-7;  ///< relative error that differences must reach
  bool energy_depends_on_control = false;
};

/// A term with what it kept of a start, as the battery's plain term.
class WithKept : public solver::Term {
 public:
  WithKept(const solver::Term& of, std::shared_ptr<const solver::Memory> kept) : of_(of), kept_(std::move(kept)) {}
  std::string name() const override { return of_.name(); }
  Role role() const override { return of_.role(); }
  int region() const override { return of_.region(); }
  void evaluate(const solver::Point& at, solver::Order order, solver::Sum& sum) const override {
    solver::Point with = at;
    with.kept = kept_.get();
    of_.evaluate(with, order, sum);
  }

 private:
  const solver::Term& of_;
  std::shared_ptr<const solver::Memory> kept_;
};

class TermBattery {
 public:
  TermBattery(const solver::Term& term, TermCase c) : term_(term), case_(std::move(c)) {
    for (const auto& couple : term.couples()) places_.push_back(case_.layout.addCouple(couple));
  }

  void run() {
    for (std::size_t k = 0; k < case_.y.size(); ++k) {
      SCOPED_TRACE(term_.name() + ", point " + std::to_string(k));
      derivatives(case_.y[k]);
      adding(case_.y[k]);
      if (case_.step == nullptr) series(case_.y[k]);
    }
  }

 private:
  void add(const Eigen::VectorXd& y, const Eigen::VectorXd& p, solver::Order order, solver::Sum& sum) const {
    sum.couples = &places_;
    term_.evaluate({y, p, case_.step, 1}, order, sum);
  }
  solver::Sum at(const Eigen::VectorXd& y, const Eigen::VectorXd& p, solver::Order order) const {
    solver::Sum sum;
    sum.reset(case_.layout, static_cast<int>(p.size()), order);
    add(y, p, order, sum);
    return sum;
  }
  Eigen::VectorXd direction(Eigen::Index size, double length) {
    std::normal_distribution<double> normal;
    Eigen::VectorXd d = Eigen::VectorXd::NullaryExpr(size, [&] { return normal(random_); });
    return d * (length / d.norm());
  }

  void derivatives(const Eigen::VectorXd& y) {
    using solver::Order;
    const Eigen::VectorXd& p = case_.p;
    const solver::Sum here = at(y, p, Order::TANGENT);
    ASSERT_TRUE(here.finite);
    const Eigen::VectorXd d = direction(y.size(), 1);
    if (here.gradient.norm() > 0) {
      EXPECT_TRUE(derivativeMatches(
          [&](double h) { return Eigen::VectorXd::Constant(1, at(y + h * d, p, Order::ENERGY).energy); },
          Eigen::VectorXd::Constant(1, here.gradient.dot(d)), case_.scale, case_.floor));
    }
    const Eigen::VectorXd curved = case_.layout.multiply(here.hessian, d);
    const auto gradient = [&](double h) { return at(y + h * d, p, Order::STRESS).gradient; };
    if (curved.norm() > 0) {
      EXPECT_TRUE(derivativeMatches(gradient, curved, case_.scale, case_.floor));
    } else {
      EXPECT_EQ((gradient(case_.scale) - gradient(0)).norm(), 0) << "a gradient that changes has a Hessian";
    }
    if (!case_.energy_depends_on_control) return;
    const Eigen::VectorXd dp = direction(p.size(), 1);
    EXPECT_TRUE(derivativeMatches(
        [&](double h) { return Eigen::VectorXd::Constant(1, at(y, p + h * dp, Order::ENERGY).energy); },
        Eigen::VectorXd::Constant(1, here.control.dot(dp)), 1, case_.floor));
    Eigen::VectorXd by_y = Eigen::VectorXd::Zero(y.size()), by_p = Eigen::VectorXd::Zero(p.size());
    term_.controlTangent({y, p, case_.step, 1}, d, dp, by_y, by_p);
    EXPECT_TRUE(
        derivativeMatches([&](double h) { return at(y, p + h * dp, Order::STRESS).gradient; }, by_y, 1, case_.floor));
    EXPECT_TRUE(derivativeMatches([&](double h) { return at(y + h * d, p + h * dp, Order::STRESS).control; }, by_p,
                                  case_.scale, case_.floor));
  }

  /// The second coefficient of the gradient along y + t d: half the slope of the Hessian along d, times d.
  void series(const Eigen::VectorXd& y) {
    using solver::Order;
    const Eigen::VectorXd d = direction(y.size(), case_.scale);
    const auto slope = [&](double h) {
      return Eigen::VectorXd(case_.layout.multiply(at(y + h * d, case_.p, Order::TANGENT).hessian, d));
    };
    if (term_.linearInStatics()) {
      EXPECT_LE((slope(1) - slope(0)).norm(), 1e-12 * slope(0).norm());
    }
    const auto series = term_.series(3);
    if (series == nullptr) return;
    Eigen::VectorXd second = Eigen::VectorXd::Zero(y.size());
    series->start(y);
    series->advance(1, d, second);
    EXPECT_TRUE(derivativeMatches(slope, 2 * second, 1, case_.floor));
  }

  /// Twice into one sum is twice as much.
  void adding(const Eigen::VectorXd& y) {
    solver::Sum once = at(y, case_.p, solver::Order::TANGENT), twice = once;
    add(y, case_.p, solver::Order::TANGENT, twice);
    EXPECT_NEAR(twice.energy, 2 * once.energy, 1e-14 * std::abs(once.energy));
    EXPECT_LE((twice.gradient - 2 * once.gradient).norm(), 1e-14 * once.gradient.norm());
    double worst = 0, size = 0;
    for (std::size_t k = 0; k < once.hessian.size(); ++k) {
      worst = std::max(worst, std::abs(twice.hessian[k] - 2 * once.hessian[k]));
      size = std::max(size, std::abs(once.hessian[k]));
    }
    EXPECT_LE(worst, 1e-13 * size);
  }

  const solver::Term& term_;
  TermCase case_;
  std::vector<int> places_;
  std::mt19937 random_{7};
};

inline void checkTerm(const solver::Term& term, TermCase c) { TermBattery(term, std::move(c)).run(); }

}  // namespace snapwing::test
