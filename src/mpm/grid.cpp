#include "snapwing/mpm/grid.h"

#include <cmath>
#include <string>

#include "snapwing/common/error.h"

namespace snapwing::mpm {

void axisKernel(Kernel kernel, double x, std::array<double, 3>& value, std::array<double, 3>& slope) {
  if (kernel == Kernel::LINEAR) {
    value = {1 - x, x, 0};
    slope = {-1, 1, 0};
  } else {
    value = {0.5 * (1 - x) * (1 - x), 0.75 - (x - 0.5) * (x - 0.5), 0.5 * x * x};
    slope = {x - 1, 1 - 2 * x, x};
  }
}

template <int D>
int Grid<D>::cellCount() const {
  int count = 1;
  for (int a = 0; a < D; ++a) count *= cells[a];
  return count;
}

template <int D>
int Grid<D>::nodeCount() const {
  int count = 1;
  for (int a = 0; a < D; ++a) count *= nodesAlong(a);
  return count;
}

template <int D>
int Grid<D>::cellNumber(const Index<D>& cell) const {
  int number = 0;
  for (int a = D - 1; a >= 0; --a) number = number * cells[a] + cell[a];
  return number;
}

template <int D>
Index<D> Grid<D>::cellIndex(int number) const {
  Index<D> cell{};
  for (int a = 0; a < D; ++a) {
    cell[a] = number % cells[a];
    number /= cells[a];
  }
  return cell;
}

template <int D>
std::vector<int> Grid<D>::cellNodes(const Index<D>& cell) const {
  const int n = nodesPerAxis(kernel);
  std::vector<int> nodes;
  const int layers = D == 3 ? n : 1;
  for (int k = 0; k < layers; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        int number = D == 3 ? cell[D - 1] + k : 0;
        number = number * nodesAlong(1) + cell[1] + j;
        nodes.push_back(number * nodesAlong(0) + cell[0] + i);
      }
    }
  }
  return nodes;
}

template <int D>
Vector<D> Grid<D>::nodePosition(int number) const {
  const double shift = kernel == Kernel::LINEAR ? 0 : -0.5;
  Vector<D> position = origin;
  for (int a = 0; a < D; ++a) {
    position(a) += cell_size * (number % nodesAlong(a) + shift);
    number /= nodesAlong(a);
  }
  return position;
}

template <int D>
Vector<D> Grid<D>::cellCentre(const Index<D>& cell) const {
  Vector<D> centre = origin;
  for (int a = 0; a < D; ++a) centre(a) += cell_size * (cell[a] + 0.5);
  return centre;
}

template <int D>
bool Grid<D>::locate(const Vector<D>& point, Index<D>& cell, Vector<D>& local) const {
  constexpr double slack = 1e-9;  // cells; a point on a face may be rounded out of the grid
  for (int a = 0; a < D; ++a) {
    const double scaled = (point(a) - origin(a)) / cell_size;
    if (!(scaled >= -slack && scaled <= cells[a] + slack)) return false;
    cell[a] = std::min(std::max(static_cast<int>(std::floor(scaled + slack)), 0), cells[a] - 1);
    local(a) = std::min(std::max(scaled - cell[a], 0.0), 1.0);
  }
  return true;
}

template <int D>
void Grid<D>::weights(const Vector<D>& local, Eigen::VectorXd& value,
                      Eigen::Matrix<double, D, Eigen::Dynamic>& slope) const {
  const int n = nodesPerAxis(kernel);
  std::array<std::array<double, 3>, D> v, s;
  for (int a = 0; a < D; ++a) axisKernel(kernel, local(a), v[a], s[a]);
  int count = 1;
  for (int a = 0; a < D; ++a) count *= n;
  value.resize(count);
  slope.resize(D, count);
  for (int node = 0; node < count; ++node) {
    Index<D> at{};
    for (int a = 0, rest = node; a < D; ++a, rest /= n) at[a] = rest % n;
    double product = 1;
    for (int a = 0; a < D; ++a) product *= v[a][at[a]];
    value(node) = product;
    for (int d = 0; d < D; ++d) {
      double part = s[d][at[d]] / cell_size;
      for (int a = 0; a < D; ++a) part *= a == d ? 1.0 : v[a][at[a]];
      slope(d, node) = part;
    }
  }
}

template <int D>
QuadratureRule<D> makeRule(const Grid<D>& grid, const std::vector<Vector<D>>& local,
                           const std::vector<double>& weight) {
  QuadratureRule<D> rule;
  rule.local = local;
  rule.weight = weight;
  Eigen::VectorXd value;
  Eigen::Matrix<double, D, Eigen::Dynamic> slope;
  for (const Vector<D>& point : local) {
    grid.weights(point, value, slope);
    rule.value.insert(rule.value.end(), value.data(), value.data() + value.size());
    rule.slope.insert(rule.slope.end(), slope.data(), slope.data() + slope.size());
    rule.stencil = static_cast<int>(value.size());
  }
  return rule;
}

template <int D>
QuadratureRule<D> gaussRule(const Grid<D>& grid, int points) {
  std::vector<double> x, w;
  switch (points) {
    case 1:
      x = {0}, w = {2};
      break;
    case 2:
      x = {-std::sqrt(1.0 / 3), std::sqrt(1.0 / 3)}, w = {1, 1};
      break;
    case 3:
      x = {-std::sqrt(0.6), 0, std::sqrt(0.6)}, w = {5.0 / 9, 8.0 / 9, 5.0 / 9};
      break;
    case 4: {
      const double near = std::sqrt(3.0 / 7 - 2.0 / 7 * std::sqrt(1.2)),
                   far = std::sqrt(3.0 / 7 + 2.0 / 7 * std::sqrt(1.2));
      const double heavy = (18 + std::sqrt(30.0)) / 36, light = (18 - std::sqrt(30.0)) / 36;
      x = {-far, -near, near, far}, w = {light, heavy, heavy, light};
      break;
    }
    default:
      throw common::Error("particles per axis is " + std::to_string(points) + "; allowed: 1 .. 4");
  }
  int count = 1;
  for (int a = 0; a < D; ++a) count *= points;
  std::vector<Vector<D>> local(count);
  std::vector<double> weight(count, 1.0);
  for (int p = 0; p < count; ++p) {
    for (int a = 0, rest = p; a < D; ++a, rest /= points) {
      local[p](a) = 0.5 + 0.5 * x[rest % points];
      weight[p] *= 0.5 * w[rest % points];
    }
  }
  return makeRule<D>(grid, local, weight);
}

template struct Grid<2>;
template struct Grid<3>;
template QuadratureRule<2> makeRule<2>(const Grid<2>&, const std::vector<Vector<2>>&, const std::vector<double>&);
template QuadratureRule<3> makeRule<3>(const Grid<3>&, const std::vector<Vector<3>>&, const std::vector<double>&);
template QuadratureRule<2> gaussRule<2>(const Grid<2>&, int);
template QuadratureRule<3> gaussRule<3>(const Grid<3>&, int);

}  // namespace snapwing::mpm
