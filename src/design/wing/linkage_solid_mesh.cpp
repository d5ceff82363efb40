#include "linkage_solid_mesh.h"

#include <Eigen/LU>
#include <string>

#include "snapwing/common/error.h"
#include "snapwing/elasticity/neo_hookean.h"

namespace snapwing::design {

using Eigen::Matrix;
using Eigen::Vector2d;

Complex SolidBar::piece(double share) const { return share * complexOf(b - a); }

ComplexSlopes SolidBar::pieceSlopes(double share) const {
  ComplexSlopes slopes;
  for (int k = 0; k < 4; ++k) slopes[k] = share * complexOf(db.col(k) - da.col(k));
  return slopes;
}

namespace {

std::array<SolidBar, SOLID_BARS> barsOf(const FourBar& layout, const SolidSettings& s) {
  Matrix<double, 2, 4> none = Matrix<double, 2, 4>::Zero(), on1 = none, on2 = none;
  on1.leftCols<2>().setIdentity();
  on2.rightCols<2>().setIdentity();
  const double o = s.overhang;
  std::array<SolidBar, SOLID_BARS> bars;
  bars[ARM_BAR] = {Vector2d::Zero(), layout.joint1, none, on1, s.driver + o, o};
  bars[COUPLER_BAR] = {layout.joint1, layout.joint2, on1, on2, o, o};
  bars[EDGE_BAR] = {layout.joint2, layout.tip, on2, none, o, o};
  bars[ROCKER_BAR] = {layout.auxiliary, layout.joint2, none, on2, o, o};
  return bars;
}

/// Y = dA A^-1: stretch along the bar at constant width, and rotation.
template <int D>
std::vector<elasticity::Matrix<D>> ratesOf(const SolidBar& bar) {
  const Vector2d along = bar.b - bar.a, t = along.normalized(), n(-t.y(), t.x());
  std::vector<elasticity::Matrix<D>> rates;
  for (int k = 0; k < 4; ++k) {
    const Vector2d d = (bar.db.col(k) - bar.da.col(k)) / along.norm();
    elasticity::Matrix<D> Y = elasticity::Matrix<D>::Zero();
    Y.template topLeftCorner<2, 2>() =
        t.dot(d) * t * t.transpose() + n.dot(d) * (n * t.transpose() - t * n.transpose());
    rates.push_back(Y);
  }
  return rates;
}

template <int D>
std::shared_ptr<const elasticity::ConstitutiveModel<D>> lawOf(const WingBars& b) {
  return std::make_shared<elasticity::NeoHookean<D>>(
      elasticity::Material{b.youngs_modulus, b.poisson_ratio, b.mass_density}, elasticity::DensityInterpolation{},
      elasticity::Plane::STRESS);
}

template <int D>
void fillBody(const mpm::Grid<D>& grid, const mpm::Cell& cell, mpm::Discretisation<D>* solid) {
  solid->addBody(grid);
  for (int k = 0; k < grid.cellCount(); ++k) solid->addCell(grid.cellIndex(k), cell);
}

}  // namespace

template <int D>
SolidMesh<D>::SolidMesh(const FourBar& layout, const WingBars& wing, const SolidSettings& s)
    : bars_(barsOf(layout, s)), width_(wing.width), thickness_(wing.thickness) {
  cells_[0] = s.cells_along;
  cells_[1] = s.cells_across;
  if (D == 3) cells_[D - 1] = s.cells_through;
  auto solid = std::make_shared<mpm::Discretisation<D>>();
  const int law = solid->addModel(lawOf<D>(wing));
  mpm::Grid<D> grid;
  grid.cell_size = 1;  // grid coordinates count cells; lengths come with the map
  grid.cells = cells_;
  grid.kernel = s.kernel;
  for (const SolidBar& bar : bars_) {
    const elasticity::Matrix<D> map = mapOf(bar);
    mpm::QuadratureRule<D> rule = mpm::gaussRule<D>(grid, s.kernel == mpm::Kernel::QUADRATIC ? 3 : 2);
    mpm::mapRule<D>(map, &rule);
    const int kind = solid->addKind({{solid->addRule(rule), law}});
    fillBody<D>(grid, {kind, 1, map.determinant() * (D == 2 ? thickness_ : 1)}, solid.get());
    rates_.push_back(ratesOf<D>(bar));
  }
  solid->finish();
  solid_ = solid;
}

template <int D>
elasticity::Matrix<D> SolidMesh<D>::mapOf(const SolidBar& bar) const {
  const Vector2d along = bar.b - bar.a;
  elasticity::Matrix<D> map = elasticity::Matrix<D>::Zero();
  map.template block<2, 1>(0, 0) = (1 + bar.before + bar.after) / cells_[0] * along;
  map.template block<2, 1>(0, 1) = width_ / cells_[1] * Vector2d(-along.y(), along.x()).normalized();
  if (D == 3) map(D - 1, D - 1) = thickness_ / cells_[D - 1];
  return map;
}

template <int D>
mpm::Vector<D> SolidMesh<D>::gridPoint(int name, double t, double level) const {
  mpm::Vector<D> point;
  point[0] = (t + bars_[name].before) / (1 + bars_[name].before + bars_[name].after) * cells_[0];
  point[1] = 0.5 * cells_[1];
  if (D == 3) point[D - 1] = level * cells_[D - 1];
  return point;
}

template <int D>
NodeWeights SolidMesh<D>::at(int name, double t, double level) const {
  NodeWeights weights = solid_->interpolate(name, gridPoint(name, t, level));
  if (weights.empty()) {
    throw common::Error("solid linkage: no material at " + std::to_string(t) + " of bar " + std::to_string(name));
  }
  return weights;
}

template <int D>
NodeWeights SolidMesh<D>::difference(int name, double t, double grip) const {
  NodeWeights weights = at(name, t + grip);
  for (const auto& [node, weight] : at(name, t - grip)) weights.emplace_back(node, -weight);
  return weights;
}

template <int D>
Vector2d SolidMesh<D>::rest(int node) const {
  const SolidBar& bar = bars_[solid_->nodeBody(node)];
  mpm::Vector<D> offset = solid_->position(node);
  offset[1] -= 0.5 * cells_[1];
  const mpm::Vector<D> image = mapOf(bar) * offset;
  return bar.at(-bar.before) + image.template head<2>();
}

template <int D>
double SolidMesh<D>::volume() const {
  double sum = 0;
  for (int c = 0; c < solid_->cellCount(); ++c) sum += solid_->cell(c).measure;
  return sum;
}

template class SolidMesh<2>;
template class SolidMesh<3>;

}  // namespace snapwing::design
