// Solid problems against smooth solutions: orders of convergence, the patch test.
//
// Manufactured solution: a displacement at finite strain is chosen, and each node is loaded by what its exact stress
// does there, l_a = int P(F(X)) . grad N_a dX. By parts that is the body force -Div P and the traction P n.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>

#include "snapwing/elasticity/neo_hookean.h"
#include "snapwing/solver/load_term.h"
#include "snapwing/solver/newton.h"
#include "snapwing/solver/term_problem.h"

namespace snapwing::solver {
namespace {

using elasticity::Part;
using mpm::Kernel;

enum class Way { LINEAR, LINEAR_REDUCED, QUADRATIC };

template <int D>
struct Block {
  mpm::Grid<D> grid;
  std::shared_ptr<mpm::Discretisation<D>> solid = std::make_shared<mpm::Discretisation<D>>();
  elasticity::NeoHookean<D> law = makeLaw(Part::ALL);

  static elasticity::NeoHookean<D> makeLaw(Part part) {
    return elasticity::NeoHookean<D>({1, 0.3, 0}, elasticity::DensityInterpolation(), elasticity::Plane::STRAIN, part);
  }
  /// A box of full cells with its corner in the origin.
  Block(Way way, double cell_size, const mpm::Index<D>& cells) {
    grid.kernel = way == Way::QUADRATIC ? Kernel::QUADRATIC : Kernel::LINEAR;
    grid.cell_size = cell_size;
    grid.cells = cells;
    const auto term = [&](int points, Part part) {
      return mpm::Term{solid->addRule(mpm::gaussRule<D>(grid, points)),
                       solid->addModel(std::make_shared<elasticity::NeoHookean<D>>(makeLaw(part)))};
    };
    std::vector<mpm::Term> terms;
    if (way == Way::LINEAR_REDUCED) {
      terms = {term(2, Part::SHEAR), term(1, Part::VOLUME)};
    } else {
      terms = {term(way == Way::QUADRATIC ? 3 : 2, Part::ALL)};
    }
    const int kind = solid->addKind(terms);
    solid->addBody(grid);
    for (int c = 0; c < grid.cellCount(); ++c) {
      solid->addCell(grid.cellIndex(c), {kind, 1, std::pow(cell_size, D)});
    }
    solid->finish();
  }

  /// For each line of nodes across a face: their sum with the kernel's weights there is `value` of the same sum of
  /// rest positions.
  template <class Value>
  void prescribe(int axis, bool high, const Value& value, std::vector<Equation>& list) const {
    std::array<double, 3> weight{}, slope{};
    mpm::axisKernel(grid.kernel, high ? 1.0 : 0.0, weight, slope);
    int stride = 1;
    for (int a = 0; a < axis; ++a) stride *= grid.nodesAlong(a);
    const int first = high ? grid.cells[axis] - 1 : 0;
    for (int number = 0; number < grid.nodeCount(); ++number) {
      if (number / stride % grid.nodesAlong(axis) != first) continue;
      mpm::Vector<D> place = mpm::Vector<D>::Zero();
      std::array<Equation, D> equations;
      for (int k = 0; k < mpm::nodesPerAxis(grid.kernel); ++k) {
        if (weight[k] == 0) continue;
        const int node = solid->findNode(0, number + k * stride);
        place += weight[k] * solid->position(node);
        for (int i = 0; i < D; ++i) equations[i].terms.emplace_back(D * node + i, weight[k]);
      }
      for (int i = 0; i < D; ++i) {
        equations[i].constant = value(place)(i);
        equations[i].name = "face";
        list.push_back(equations[i]);
      }
    }
  }

  /// Each particle of the Gauss rule of `points`: its place, the cell, the rule and its number in it.
  template <class Visit>
  void eachPoint(int points, const Visit& visit) const {
    const mpm::QuadratureRule<D> rule = mpm::gaussRule<D>(grid, points);
    for (int c = 0; c < solid->cellCount(); ++c) {
      const mpm::Vector<D> corner =
          solid->grid(0).cellCentre(solid->cellAt(c)) - mpm::Vector<D>::Constant(0.5 * grid.cell_size);
      for (int q = 0; q < rule.size(); ++q) {
        visit(corner + grid.cell_size * rule.local[q], solid->cellNodes(c), rule, q,
              rule.weight[q] * std::pow(grid.cell_size, D));
      }
    }
  }
};

/// u_i = A_i sin(k X_0) cos(w_i . X + phi_i), gradients up to .5. Zero on the face X_0 = 0, in the plane on X_0 = 1
/// too: stable equilibria, or the search would end elsewhere.
template <int D>
mpm::Vector<D> exact(const mpm::Vector<D>& x, elasticity::Matrix<D>* f = nullptr) {
  const double rate = D == 2 ? M_PI : 1.3, scale = D == 2 ? 0.45 : 1;
  const double amplitude[] = {0.30 * scale, 0.35 * scale, -0.25 * scale}, phase[] = {0.2, -0.6, 0.4};
  const double wave[3][3] = {{0.5, 1.1, -0.7}, {0.9, -0.6, 0.8}, {-0.4, 1.2, 0.9}};
  mpm::Vector<D> u;
  if (f != nullptr) f->setIdentity();
  for (int i = 0; i < D; ++i) {
    double angle = phase[i];
    for (int j = 0; j < D; ++j) angle += wave[i][j] * x(j);
    u(i) = amplitude[i] * std::sin(rate * x(0)) * std::cos(angle);
    if (f == nullptr) continue;
    for (int j = 0; j < D; ++j) (*f)(i, j) -= amplitude[i] * std::sin(rate * x(0)) * wave[i][j] * std::sin(angle);
    (*f)(i, 0) += amplitude[i] * rate * std::cos(rate * x(0)) * std::cos(angle);
  }
  return u;
}

template <int D>
Eigen::VectorXd exactLoad(const Block<D>& block) {
  Eigen::VectorXd load = Eigen::VectorXd::Zero(block.solid->dofCount());
  block.eachPoint(4, [&](const mpm::Vector<D>& x, const int* nodes, const auto& rule, int q, double volume) {
    elasticity::Matrix<D> f;
    exact<D>(x, &f);
    elasticity::Response<D> r;
    EXPECT_TRUE(block.law.evaluate(f, 1, Order::STRESS, r));
    for (int a = 0; a < rule.stencil; ++a) {
      const Eigen::Map<const mpm::Vector<D>> slope(rule.slopeOf(q) + D * a);
      load.segment<D>(D * nodes[a]) += volume * r.stress * slope;
    }
  });
  return load;
}

struct Errors {
  double l2 = 0, energy_norm = 0;  ///< of u and of F, shares of the exact ones
};

template <int D>
Errors errorsOf(const Block<D>& block, const Eigen::VectorXd& u) {
  double miss = 0, size = 0, slope_miss = 0, slope_size = 0;
  block.eachPoint(4, [&](const mpm::Vector<D>& x, const int* nodes, const auto& rule, int q, double volume) {
    elasticity::Matrix<D> f, at = elasticity::Matrix<D>::Identity();
    const mpm::Vector<D> expected = exact<D>(x, &f);
    mpm::Vector<D> moved = mpm::Vector<D>::Zero();
    for (int a = 0; a < rule.stencil; ++a) {
      const mpm::Vector<D> of_node = u.segment<D>(D * nodes[a]);
      moved += rule.valueOf(q)[a] * of_node;
      at += of_node * Eigen::Map<const mpm::Vector<D>>(rule.slopeOf(q) + D * a).transpose();
    }
    miss += volume * (moved - expected).squaredNorm();
    size += volume * expected.squaredNorm();
    slope_miss += volume * (at - f).squaredNorm();
    slope_size += volume * (f - elasticity::Matrix<D>::Identity()).squaredNorm();
  });
  return {std::sqrt(miss / size), std::sqrt(slope_miss / slope_size)};
}

template <int D>
TermProblem::Parts partsOf(const std::shared_ptr<const mpm::Discretisation<D>>& solid,
                           const std::vector<Equation>& equations, const Eigen::VectorXd& load) {
  TermProblem::Parts parts =
      solidParts<D>(solid, std::make_shared<const Coordinates>(Reduction(solid->dofCount(), 1, equations)), 1, 1e-15);
  parts.terms.push_back(std::make_shared<const LoadTerm>(load, Eigen::MatrixXd()));
  return parts;
}

template <int D>
Errors solveOn(Way way, int cells) {
  mpm::Index<D> all;
  all.fill(cells);
  const Block<D> block(way, 1.0 / cells, all);
  std::vector<Equation> equations;
  const auto rest = [](const auto&) { return mpm::Vector<D>(mpm::Vector<D>::Zero()); };
  block.prescribe(0, false, rest, equations);
  if (D == 2) block.prescribe(0, true, rest, equations);
  const TermProblem problem(partsOf<D>(block.solid, equations, exactLoad(block)));
  Eigen::VectorXd start(block.solid->dofCount());
  for (int n = 0; n < block.solid->nodeCount(); ++n) {
    start.segment<D>(D * n) = exact<D>(block.solid->position(n));
  }
  NewtonSettings settings;
  settings.relative_tolerance = 1e-10;
  settings.max_iterations = 15;  // the search begins near its end
  Newton newton(problem, settings);
  Eigen::VectorXd z = problem.coordinates().linear().freePart(start);
  Evaluation at;
  const NewtonResult result = newton.solve(Eigen::VectorXd::Zero(1), z, at);
  EXPECT_TRUE(result.converged()) << result.message;
  return errorsOf(block, at.place.y);
}

/// Errors at three resolutions; the order is that between the two finest.
template <int D>
void checkOrder(Way way, double order) {
  const int coarsest = D == 2 ? 8 : 3;
  std::array<Errors, 3> errors;
  for (int k = 0; k < 3; ++k) errors[k] = solveOn<D>(way, coarsest << k);
  for (int k = 1; k < 3; ++k) {
    const double l2 = std::log2(errors[k - 1].l2 / errors[k].l2);
    const double energy = std::log2(errors[k - 1].energy_norm / errors[k].energy_norm);
    ::testing::Test::RecordProperty("l2_order_" + std::to_string(k), std::to_string(l2));
    ::testing::Test::RecordProperty("energy_order_" + std::to_string(k), std::to_string(energy));
    EXPECT_NEAR(l2, order, k == 2 ? 0.15 : 0.3) << "errors " << errors[k - 1].l2 << ", " << errors[k].l2;
    EXPECT_NEAR(energy, order - 1, k == 2 ? 0.15 : 0.3)
        << "errors " << errors[k - 1].energy_norm << ", " << errors[k].energy_norm;
  }
  EXPECT_LT(errors[2].l2, order > 2 ? 5e-5 : 5e-3);
}

TEST(ConvergenceOrder, LinearPlanar) { checkOrder<2>(Way::LINEAR, 2); }
TEST(ConvergenceOrder, LinearReducedPlanar) { checkOrder<2>(Way::LINEAR_REDUCED, 2); }
TEST(ConvergenceOrder, QuadraticPlanar) { checkOrder<2>(Way::QUADRATIC, 3); }
TEST(ConvergenceOrder, LinearVolumetric) { checkOrder<3>(Way::LINEAR, 2); }
TEST(ConvergenceOrder, LinearReducedVolumetric) { checkOrder<3>(Way::LINEAR_REDUCED, 2); }
TEST(ConvergenceOrder, QuadraticVolumetric) { checkOrder<3>(Way::QUADRATIC, 3); }

/// An affine displacement of all faces, at large strain, is met inside, wherever the search begins.
template <int D>
void checkPatch(Way way) {
  mpm::Index<D> cells;
  for (int a = 0; a < D; ++a) cells[a] = 5 - a;
  const Block<D> block(way, 0.2, cells);
  elasticity::Matrix<D> f = elasticity::Matrix<D>::Identity();
  f(0, 0) = 1.4;
  f(0, 1) = 0.5;
  f(1, 0) = -0.2;
  f(D - 1, D - 1) += -0.3;
  const auto affine = [&](const mpm::Vector<D>& x) {
    return mpm::Vector<D>((f - elasticity::Matrix<D>::Identity()) * x + mpm::Vector<D>::Constant(0.1));
  };
  std::vector<Equation> equations;
  for (int axis = 0; axis < D; ++axis) {
    for (const bool high : {false, true}) block.prescribe(axis, high, affine, equations);
  }
  const TermProblem problem(partsOf<D>(block.solid, equations, Eigen::VectorXd()));
  ASSERT_GT(problem.freeCount(), 5);
  Eigen::VectorXd expected(block.solid->dofCount());
  for (int n = 0; n < block.solid->nodeCount(); ++n) {
    expected.segment<D>(D * n) = affine(block.solid->position(n));
  }
  Eigen::VectorXd z = problem.coordinates().linear().freePart(expected);
  for (int k = 0; k < z.size(); ++k) z(k) += 0.02 * std::sin(2.3 * k + 1);
  NewtonSettings settings;
  settings.relative_tolerance = 1e-12;
  Newton newton(problem, settings);
  Evaluation at;
  const NewtonResult result = newton.solve(Eigen::VectorXd::Zero(1), z, at);
  ASSERT_TRUE(result.converged()) << result.message;
  EXPECT_GE(result.iterations, 2) << "the search began at its end: nothing was tested";
  EXPECT_LT((at.place.y - expected).cwiseAbs().maxCoeff(), 1e-9);
  elasticity::Response<D> r;
  ASSERT_TRUE(block.law.evaluate(f, 1, Order::ENERGY, r));
  EXPECT_NEAR(at.elastic_energy, r.energy * block.solid->cellCount() * std::pow(0.2, D), 1e-9 * at.elastic_energy);
}

TEST(PatchTest, LinearPlanar) { checkPatch<2>(Way::LINEAR); }
TEST(PatchTest, LinearReducedPlanar) { checkPatch<2>(Way::LINEAR_REDUCED); }
TEST(PatchTest, QuadraticPlanar) { checkPatch<2>(Way::QUADRATIC); }
TEST(PatchTest, LinearVolumetric) { checkPatch<3>(Way::LINEAR); }
TEST(PatchTest, LinearReducedVolumetric) { checkPatch<3>(Way::LINEAR_REDUCED); }
TEST(PatchTest, QuadraticVolumetric) { checkPatch<3>(Way::QUADRATIC); }

}  // namespace
}  // namespace snapwing::solver
