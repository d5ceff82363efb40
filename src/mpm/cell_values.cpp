#include "snapwing/mpm/cell_values.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <vector>

#include "centre_gradients.h"
#include "snapwing/common/require.h"
#include "snapwing/mpm/strain.h"

namespace snapwing::mpm {

namespace {

/// A neighbour's place relative to a cell, and the share of it within the radius.
template <int D>
struct Neighbour {
  Index<D> offset{};
  double share = 0;
};

/// Share of a cell that lies within a radius of a point, by samples. All lengths in cells.
template <int D>
double shareWithin(const Vector<D>& centre, double radius) {
  constexpr int SAMPLES = D == 2 ? 32 : 16;
  const int all = D == 2 ? SAMPLES * SAMPLES : SAMPLES * SAMPLES * SAMPLES;
  int inside = 0;
  for (int k = 0; k < all; ++k) {
    Vector<D> point = centre;
    for (int a = 0, rest = k; a < D; ++a, rest /= SAMPLES) point(a) += (rest % SAMPLES + 0.5) / SAMPLES - 0.5;
    inside += point.squaredNorm() < radius * radius ? 1 : 0;
  }
  return static_cast<double>(inside) / all;
}

/// Cells that reach into the disc or ball about a cell's centre. @param radius  in cells
template <int D>
std::vector<Neighbour<D>> neighboursWithin(double radius) {
  const int reach = static_cast<int>(std::ceil(radius + 0.5)) - 1, row = 2 * reach + 1;
  const int all = D == 2 ? row * row : row * row * row;
  std::vector<Neighbour<D>> found;
  for (int k = 0; k < all; ++k) {
    Neighbour<D> one;
    Vector<D> centre;
    for (int a = 0, rest = k; a < D; ++a, rest /= row) centre(a) = one.offset[a] = rest % row - reach;
    one.share = shareWithin<D>(centre, radius);
    if (one.share > 0) found.push_back(one);
  }
  return found;
}

}  // namespace

template <int D>
Eigen::VectorXd cellVolumes(const Discretisation<D>& solid) {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(solid.cellCount());
  for (int c = 0; c < solid.cellCount(); ++c) {
    const QuadratureRule<D>& rule = solid.rule(solid.terms(solid.cell(c).kind)[0].rule);
    for (const double w : rule.weight) result(c) += w * solid.cell(c).measure;
  }
  return result;
}

template <int D>
Eigen::VectorXd cellStrains(const Discretisation<D>& solid, const Eigen::VectorXd& u) {
  Eigen::VectorXd strain(solid.cellCount());
  eachCentreGradient(solid, u, [&](int cell, const elasticity::Matrix<D>& f) {
    Eigen::SelfAdjointEigenSolver<elasticity::Matrix<D>> squares;
    squares.computeDirect(f.transpose() * f, Eigen::EigenvaluesOnly);
    strain(cell) = weightedStrain(solid.cell(cell).density, std::sqrt(squares.eigenvalues()(D - 1)));
  });
  return strain;
}

template <int D>
Eigen::SparseMatrix<double, Eigen::RowMajor> meansWithin(const Discretisation<D>& solid, double radius) {
  common::Require("mean").positive("radius", radius, " m");
  std::vector<std::vector<Neighbour<D>>> around;
  for (int body = 0; body < solid.bodyCount(); ++body) {
    around.push_back(neighboursWithin<D>(radius / solid.grid(body).cell_size));
  }
  const Eigen::VectorXd volume = cellVolumes(solid);
  std::vector<Eigen::Triplet<double>> entries;
  for (int cell = 0; cell < solid.cellCount(); ++cell) {
    const int body = solid.cellBody(cell);
    const std::size_t first = entries.size();
    double material = 0;
    for (const Neighbour<D>& neighbour : around[static_cast<std::size_t>(body)]) {
      Index<D> at = solid.cellAt(cell);
      for (int a = 0; a < D; ++a) at[a] += neighbour.offset[a];
      const int other = solid.findCell(body, at);
      if (other < 0) continue;
      const double here = neighbour.share * solid.cell(other).density * volume(other);
      entries.emplace_back(cell, other, here);
      material += here;
    }
    if (!(material > 0)) entries.resize(first);
    for (std::size_t k = first; k < entries.size(); ++k) {
      entries[k] = {entries[k].row(), entries[k].col(), entries[k].value() / material};
    }
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> means(solid.cellCount(), solid.cellCount());
  means.setFromTriplets(entries.begin(), entries.end());
  return means;
}

template Eigen::VectorXd cellVolumes(const Discretisation<2>&);
template Eigen::VectorXd cellVolumes(const Discretisation<3>&);
template Eigen::VectorXd cellStrains(const Discretisation<2>&, const Eigen::VectorXd&);
template Eigen::VectorXd cellStrains(const Discretisation<3>&, const Eigen::VectorXd&);
template Eigen::SparseMatrix<double, Eigen::RowMajor> meansWithin(const Discretisation<2>&, double);
template Eigen::SparseMatrix<double, Eigen::RowMajor> meansWithin(const Discretisation<3>&, double);

}  // namespace snapwing::mpm
