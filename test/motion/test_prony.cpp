// Memory of the material: coefficients, derivatives, closed forms of a bar, loss against frequency, energy in flight.
#include <cmath>

#include "snapwing/common/error.h"
#include "snapwing/elasticity/prony_series.h"
#include "snapwing/solver/elastic_term.h"
#include "snapwing/solver/load_term.h"
#include "snapwing/solver/prony_term.h"
#include "solid_motion.h"
#include "support/block.h"
#include "support/term_check.h"

namespace snapwing::motion {
namespace {

using elasticity::PronySeries;
using elasticity::RelaxationStep;

const PronySeries TWO{{{0.3, 0.02}, {0.2, 0.4}}};

/// Mean over s in [0, x] of f(exp(-s), (1 - exp(-s))/x), by Gauss points in many pieces.
template <class F>
double mean(double x, const F& f) {
  constexpr int PIECES = 2000;
  double sum = 0;
  for (int k = 0; k < PIECES; ++k) {
    for (const double at : {0.5 - 0.5 / std::sqrt(3.0), 0.5 + 0.5 / std::sqrt(3.0)}) {
      const double s = x * (k + at) / PIECES;
      sum += 0.5 * f(std::exp(-s), -std::expm1(-s) / x) / PIECES;
    }
  }
  return sum;
}

TEST(PronySeries, CoefficientsOfAStepAreItsIntegrals) {
  for (const double x : {1e-7, 1e-3, 0.0199, 0.0201, 0.5, 3.0, 30.0}) {
    SCOPED_TRACE(x);
    const RelaxationStep step(x);
    const auto near = [&](double value, double exact) { EXPECT_NEAR(value / exact, 1, 1e-8); };
    near(step.decay, std::exp(-x));
    near(step.mean, mean(x, [](double old, double) { return old; }));
    near(step.ramp, mean(x, [](double, double grown) { return grown; }));
    near(step.first, x * mean(x, [](double old, double) { return old * old; }));
    near(step.mixed, x * mean(x, [](double old, double grown) { return old * grown; }));
    near(step.last, x * mean(x, [](double, double grown) { return grown * grown; }));
    EXPECT_GT(step.first * step.last, step.mixed * step.mixed) << "a loss is never negative";
  }
}

TEST(PronySeries, RefusesBadBranchesByName) {
  const auto message = [](const PronySeries& series) {
    try {
      series.validate();
    } catch (const common::Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(message(TWO), "");
  EXPECT_NE(message({{{0.1, 1}, {-0.2, 1}}}).find("relaxation term 1: share is -0.2"), std::string::npos);
  EXPECT_NE(message({{{std::nan(""), 1}}}).find("share is nan"), std::string::npos);
  EXPECT_NE(message({{{0.1, 0}}}).find("time is 0"), std::string::npos);
  EXPECT_NE(message({{{0.1, std::numeric_limits<double>::infinity()}}}).find("time is inf"), std::string::npos);
  EXPECT_NE(message({{{0.6, 1}, {0.4, 2}}}).find("less than 1"), std::string::npos);
  EXPECT_THROW(solver::PronyTerm<2>(test::block<2>(), {{{-0.1, 1}}}), common::Error);
}

template <int D>
void checkDerivatives(std::vector<std::pair<double, double>> path) {
  const auto solid = test::block<D>();
  const solver::PronyTerm<D> term(solid, TWO);
  solver::Step step;
  step.h = 0.03, step.kappa = 1;
  step.y0 = test::wavy(solid->dofCount(), 6e-4, 0.3);
  step.v0 = Eigen::VectorXd::Zero(solid->dofCount());
  step.path = std::move(path);
  test::TermCase c{solver::HessianLayout(solid->dofCount()), {}};
  c.layout.addRegion(0, solid->pattern());
  c.y = {test::wavy(solid->dofCount(), 6e-4, 0.0), test::wavy(solid->dofCount(), 6e-4, 1.2)};
  c.step = &step;
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(1), strained = test::wavy(term.historyCount(), 0.05, 0.7);
  checkTerm(test::WithKept(term, term.keepWith({step.y0, none}, strained)), c);
}

TEST(PronyTerm, IsATermOnEveryPath) {
  checkDerivatives<2>({});
  checkDerivatives<2>({{0.5, 1}});
  checkDerivatives<2>({{0.6, 1}});
  checkDerivatives<2>({{0.25, 0.5}, {0.75, 0.5}});
  checkDerivatives<3>({{0.5, 1}});
}

/// One cell that is stretched along x and held across.
struct Bar {
  static constexpr double SMALL = 1e-7;  // [1] strain: Green's is the linear one within that
  Bar() {
    mpm::Grid<2> grid;
    grid.kernel = mpm::Kernel::LINEAR;
    grid.cell_size = test::BLOCK_CELL;
    grid.cells[0] = grid.cells[1] = 1;
    solid = std::make_shared<mpm::Discretisation<2>>();
    const elasticity::Material material{E, NU, test::BLOCK_DENSITY};
    const int model = solid->addModel(std::make_shared<elasticity::NeoHookean<2>>(
        material, elasticity::DensityInterpolation{}, elasticity::Plane::STRESS));
    const int kind = solid->addKind({{solid->addRule(mpm::gaussRule(grid, 2)), model}});
    solid->addBody(grid);
    solid->addCell(grid.cellIndex(0), {kind, 1.0, test::BLOCK_CELL * test::BLOCK_CELL});
    solid->finish();
    for (int n = 0; n < solid->nodeCount(); ++n) {
      if (solid->position(n)(0) > 0.5 * test::BLOCK_CELL) end.push_back(2 * n);
    }
  }
  Eigen::VectorXd stretched(double strain) const {
    Eigen::VectorXd y = Eigen::VectorXd::Zero(solid->dofCount());
    for (const int dof : end) y(dof) = strain * test::BLOCK_CELL;
    return y;
  }
  double stiffness() const { return E / (1 - NU * NU); }  ///< slow [N/m]: area over length is 1 m
  /// Force at the stretched end [N].
  double along(const Eigen::VectorXd& gradient) const {
    double sum = 0;
    for (const int dof : end) sum += gradient(dof);
    return sum;
  }
  std::shared_ptr<const solver::TermProblem> inTime(const PronySeries& series, double mass) const {
    std::vector<solver::Equation> equations;
    for (int dof = 0; dof < solid->dofCount(); ++dof) {
      if (dof == end.front()) continue;
      solver::Equation equation;
      equation.terms = {{dof, 1.0}};
      if (std::find(end.begin(), end.end(), dof) != end.end()) equation.terms.emplace_back(end.front(), -1.0);
      equations.push_back(equation);
    }
    auto coordinates = std::make_shared<const solver::Coordinates>(solver::Reduction(solid->dofCount(), 1, equations));
    auto parts = solver::solidParts<2>(solid, coordinates, 1, 1e-13);
    parts.terms.push_back(std::make_shared<const solver::PronyTerm<2>>(solid, series));
    parts.terms.push_back(std::make_shared<const solver::RowInertia>("mass", test::only(end.front()), mass));
    Eigen::MatrixXd load = Eigen::MatrixXd::Zero(solid->dofCount(), 1);
    load(end.front(), 0) = 1;
    parts.terms.push_back(
        std::make_shared<const solver::LoadTerm>(Eigen::VectorXd::Zero(solid->dofCount()), std::move(load)));
    return std::make_shared<const solver::TermProblem>(std::move(parts));
  }
  static constexpr double E = 1e6, NU = 0.3;
  std::shared_ptr<mpm::Discretisation<2>> solid;
  std::vector<int> end;
};

/// A history of strains through pass(): force of the branches at each end over the slow stiffness, and what is lost.
struct Driven {
  Driven(const Bar& b, const PronySeries& s) : bar(b), term(b.solid, s) {
    layout.addRegion(0, bar.solid->pattern());
    history = Eigen::VectorXd::Zero(term.historyCount());
  }
  void to(double strain, double h) {
    solver::Step step;
    step.h = h;
    step.y0 = bar.stretched(now);
    const auto kept = term.keepWith({step.y0, none}, history);
    const Eigen::VectorXd y = bar.stretched(strain);
    const solver::Point end{y, none, &step, 1, kept.get()};
    solver::Sum sum;
    sum.reset(layout, 1, solver::Order::STRESS);
    term.evaluate(end, solver::Order::STRESS, sum);
    force = bar.along(sum.gradient) / bar.stiffness() / test::BLOCK_CELL;
    const solver::HistoryTerm::Passed passed = term.pass(end);
    EXPECT_GE(passed.loss, 0);
    loss += passed.loss, stored = passed.stored, history = passed.history, now = strain;
  }
  const Bar& bar;
  solver::PronyTerm<2> term;
  solver::HessianLayout layout{8};
  Eigen::VectorXd history, none = Eigen::VectorXd::Zero(1);
  double now = 0, force = 0, loss = 0, stored = 0;
};

/// A strain that is held: the force falls as the series says, however long the steps are; what was put in is lost.
TEST(PronyTerm, RelaxesAsTheSeriesSays) {
  const Bar bar;
  for (const int steps : {1, 7, 50}) {
    Driven driven(bar, TWO);
    driven.to(Bar::SMALL, 1e-9);
    const double put_in = driven.stored;
    EXPECT_NEAR(put_in, 0.5 * bar.stiffness() * std::pow(Bar::SMALL * test::BLOCK_CELL, 2), 1e-6 * put_in)
        << "shares are half of the fast modulus: as much again as the slow one";
    for (int k = 0; k < steps; ++k) driven.to(Bar::SMALL, 0.3 / steps);
    EXPECT_NEAR(driven.force / Bar::SMALL, (TWO.relaxation(0.3) - TWO.slow()) / TWO.slow(), 1e-6);
    EXPECT_NEAR(driven.loss + driven.stored, put_in, 1e-6 * put_in);
  }
}

/// Loss of a cycle pi e^2 E'' within the square of the step, over three decades of frequency.
TEST(PronyTerm, LosesWhatTheLossModulusSays) {
  const Bar bar;
  for (const double omega : {0.5, 5.0, 50.0, 500.0}) {
    SCOPED_TRACE(omega);
    const double amplitude = Bar::SMALL * test::BLOCK_CELL;
    const double exact = M_PI * amplitude * amplitude * bar.stiffness() * TWO.loss(omega) / TWO.slow();
    double errors[2];
    for (const int fine : {0, 1}) {
      const int steps = fine != 0 ? 80 : 40, settled = 1 + static_cast<int>(omega * 0.4 * 3);  // periods
      Driven driven(bar, TWO);
      double before = 0;
      for (int k = 1; k <= (settled + 1) * steps; ++k) {
        if (k == settled * steps + 1) before = driven.loss;
        driven.to(Bar::SMALL * std::sin(2 * M_PI * k / steps), 2 * M_PI / omega / steps);
      }
      errors[fine] = std::abs((driven.loss - before) / exact - 1);
    }
    EXPECT_LT(errors[1], 3e-3);
    EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2, 0.3);
  }
}

/// A mass on the bar: a linear equation of third order, integrated finely by Runge and Kutta.
double exactMode(const PronySeries& series, double w2, double u, double until) {
  using State = Eigen::Vector4d;  // u, v, q of both branches
  const auto rate = [&](const State& s) {
    State d;
    d << s(1), -w2 * s(0), s(1), s(1);
    for (int k = 0; k < 2; ++k) {
      d(1) -= w2 * series.branches[k].share / series.slow() * s(2 + k);
      d(2 + k) -= s(2 + k) / series.branches[k].time;
    }
    return d;
  };
  constexpr int STEPS = 20000;
  const double h = until / STEPS;
  State s(u, 0, 0, 0);
  for (int k = 0; k < STEPS; ++k) {
    const State a = rate(s), b = rate(s + 0.5 * h * a), c = rate(s + 0.5 * h * b), d = rate(s + h * c);
    s += h / 6 * (a + 2 * b + 2 * c + d);
  }
  return s(0);
}

TEST(PronyTerm, AMassOnABarConvergesAtTheSchemesOrder) {
  const Bar bar;
  constexpr double UNTIL = 0.2, OMEGA = 40;
  const double u = Bar::SMALL * test::BLOCK_CELL, exact = exactMode(TWO, OMEGA * OMEGA, u, UNTIL);
  const auto problem = bar.inTime(TWO, bar.stiffness() / (OMEGA * OMEGA));
  const auto error = [&](const Scheme& scheme, int steps) {
    Stepper stepper(problem, scheme, test::equalSteps(UNTIL / steps, 1e-11));
    MotionState state = stepper.start(Eigen::VectorXd::Constant(1, u), Eigen::VectorXd::Zero(1));
    double loss = 0, imbalance = 0;
    for (int k = 0; k < steps; ++k) {
      const StepAccount account = stepper.step(state, (k + 1) * UNTIL / steps, test::constantControl(0));
      EXPECT_GE(account.loss, 0);
      loss += account.loss, imbalance += account.imbalance;
    }
    if (scheme.order() == 2) {
      EXPECT_LT(std::abs(imbalance), 0.01 * loss);
    }
    return std::abs(state.y(bar.end.front()) - exact) / u;
  };
  for (const Scheme& scheme :
       {Scheme(SchemeKind::BACKWARD_EULER), Scheme(SchemeKind::MIDPOINT), Scheme(SchemeKind::AVERAGE_FORCE, 2)}) {
    SCOPED_TRACE(schemeName(scheme.kind()));
    const double coarse = error(scheme, 400), fine = error(scheme, 800);
    EXPECT_NEAR(std::log2(coarse / fine), scheme.order(), 0.2) << coarse << " " << fine;
    EXPECT_LT(fine, scheme.order() == 2 ? 1e-3 : 5e-2);
  }
}

/// A light end under a load that stays: J(t) = (1 - share exp(-slow t / time)) / E_slow for one branch.
TEST(PronyTerm, CreepsAsTheClosedFormSays) {
  const Bar bar;
  const PronySeries one{{{0.4, 0.1}}};
  const double u = Bar::SMALL * test::BLOCK_CELL, load = u * bar.stiffness();
  const auto problem = bar.inTime(one, 1e-9 * bar.stiffness());
  double errors[2];
  for (const int fine : {0, 1}) {
    const int steps = fine != 0 ? 80 : 40;
    Stepper stepper(problem, Scheme(SchemeKind::BACKWARD_EULER), test::equalSteps(0.2 / steps, 1e-11));
    MotionState state = stepper.start(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Zero(1));
    for (int k = 0; k < steps; ++k) stepper.step(state, (k + 1) * 0.2 / steps, test::constantControl(load));
    errors[fine] = std::abs(state.y(bar.end.front()) / u - (1 - 0.4 * std::exp(-0.6 * 0.2 / 0.1)));
  }
  EXPECT_LT(errors[1], 5e-3);
  EXPECT_NEAR(std::log2(errors[0] / errors[1]), 1, 0.2);
}

/// A spinning L with memory in free flight at large strain: momenta kept, a loss in every step, an account that closes
/// with the step's square, and a rest without strain at last.
TEST(PronyTerm, FreeFlightKeepsMomentaAndLosesEnergy) {
  scene::Scene s = test::planarScene(
      "L", mpm::makeUnion({mpm::makeBox(test::boxOf(0, 0.08, 0, 0.02)), mpm::makeBox(test::boxOf(0, 0.02, 0, 0.06))}),
      0.01, {1e5, 0.3, 1200}, 0.01);
  const auto scene = scene::compileScene(s, 1);
  const mpm::Discretisation<2>& solid = *scene->planar();
  const auto elastic = std::dynamic_pointer_cast<const solver::ElasticTerm<2>>(scene->terms().terms().front());
  const auto problem =
      test::inTime(*scene, {std::make_shared<const solver::PronyTerm<2>>(elastic->sharedSolid(), TWO)});
  Eigen::VectorXd v(solid.dofCount());
  for (int n = 0; n < solid.nodeCount(); ++n) {
    const Eigen::Vector2d x = solid.position(n);
    v.segment<2>(2 * n) = Eigen::Vector2d(0.3 - 8 * x(1) + 6 * x(0), -0.2 + 8 * x(0));
  }
  const auto momenta = [&](const Stepper& stepper, const MotionState& state) {
    const Eigen::VectorXd p = stepper.momentum(state.v);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int n = 0; n < solid.nodeCount(); ++n) {
      const Eigen::Vector2d x = solid.position(n) + state.y.segment<2>(2 * n);
      sum += Eigen::Vector3d(p(2 * n), p(2 * n + 1), x(0) * p(2 * n + 1) - x(1) * p(2 * n));
    }
    return sum;
  };
  double imbalances[2];
  for (const int fine : {0, 1}) {
    const double h = fine != 0 ? 5e-4 : 1e-3;
    Stepper stepper(problem, Scheme(SchemeKind::MIDPOINT), test::equalSteps(h, 1e-12));
    MotionState state = stepper.start(Eigen::VectorXd::Zero(problem->freeCount()), Eigen::VectorXd::Zero(1), v);
    const Eigen::Vector3d before = momenta(stepper, state);
    double loss = 0, imbalance = 0;
    for (int k = 0; k < (fine != 0 ? 400 : 200); ++k) {
      const StepAccount account = stepper.step(state, state.time + h, test::constantControl(0));
      EXPECT_GT(account.loss, 0);
      loss += account.loss, imbalance += account.imbalance;
      const Eigen::Vector3d off = momenta(stepper, state) - before;
      EXPECT_LT(off.head<2>().norm(), 1e-10 * before.head<2>().norm());
      EXPECT_LT(std::abs(off(2)), 1e-10 * std::abs(before(2)));
    }
    EXPECT_GT(loss, 1e-4);
    imbalances[fine] = std::abs(imbalance) / loss;
  }
  EXPECT_LT(imbalances[1], 0.02);
  EXPECT_GT(imbalances[0] / imbalances[1], 3);
}

}  // namespace
}  // namespace snapwing::motion
