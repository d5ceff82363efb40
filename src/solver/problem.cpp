#include "snapwing/solver/problem.h"

#include <algorithm>
#include <sstream>

namespace snapwing::solver {

template <int D>
SolidProblem<D>::SolidProblem(std::shared_ptr<const mpm::Discretisation<D>> solid, Reduction reduction,
                              Eigen::MatrixXd loads, int threads, double floor)
    : solid_(std::move(solid)),
      reduction_(std::move(reduction)),
      loads_(std::move(loads)),
      threads_(threads),
      floor_(floor) {
  buildPattern();
}

/// K_red = T^T K T. Most entries of K go to one place with factor 1; the rest is listed in mixed_.
template <int D>
void SolidProblem<D>::buildPattern() {
  struct Item {
    int column, row, source;
    double factor;
  };
  std::vector<Item> items;
  const auto& blocks = solid_->pattern();
  items.reserve(static_cast<std::size_t>(blocks.blocks()) * D * D);
  for (int column = 0; column < blocks.nodes(); ++column) {
    for (int b = blocks.start()[column]; b < blocks.start()[column + 1]; ++b) {
      const int row = blocks.row()[b];
      for (int k = 0; k < D; ++k) {
        for (int i = 0; i < D; ++i) {
          const bool diagonal_block = row == column;
          if (diagonal_block && i < k) continue;
          const bool off_diagonal = !(diagonal_block && i == k);
          const int source = b * D * D + i + D * k;
          for (const auto& [zr, fr] : reduction_.terms(D * row + i)) {
            for (const auto& [zc, fc] : reduction_.terms(D * column + k)) {
              if (!off_diagonal && zr < zc) continue;
              // The mirrored entry adds the same again where both ends meet in one coordinate.
              const double factor = fr * fc * (off_diagonal && zr == zc ? 2 : 1);
              items.push_back({std::min(zr, zc), std::max(zr, zc), source, factor});
            }
          }
        }
      }
    }
  }
  std::stable_sort(items.begin(), items.end(), [](const Item& a, const Item& b) {
    return a.column != b.column ? a.column < b.column : a.row < b.row;
  });
  pattern_.size = freeCount();
  pattern_.start.assign(pattern_.size + 1, 0);
  for (std::size_t n = 0; n < items.size(); ++n) {
    const Item& item = items[n];
    const bool fresh = n == 0 || items[n - 1].column != item.column || items[n - 1].row != item.row;
    if (fresh) {
      pattern_.row.push_back(item.row);
      ++pattern_.start[item.column + 1];
      source_.push_back(item.factor == 1.0 ? item.source : -1);
      if (item.factor == 1.0) continue;
    }
    mixed_.push_back({pattern_.entries() - 1, item.source, item.factor});
  }
  for (int c = 0; c < pattern_.size; ++c) pattern_.start[c + 1] += pattern_.start[c];
}

template <int D>
void SolidProblem<D>::gatherHessian(const std::vector<double>& blocks, std::vector<double>& values) const {
  values.resize(source_.size());
  for (std::size_t k = 0; k < source_.size(); ++k) values[k] = source_[k] < 0 ? 0.0 : blocks[source_[k]];
  for (const Mixed& m : mixed_) values[m.target] += m.factor * blocks[m.source];
}

template <int D>
Eigen::VectorXd SolidProblem<D>::padded(const Eigen::VectorXd& forces) const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(reduction_.dofCount());
  result.head(forces.size()) = forces;
  return result;
}

template <int D>
Eigen::VectorXd SolidProblem<D>::loadAt(const Eigen::VectorXd& p) const {
  Eigen::VectorXd load = dead_load_.size() > 0 ? dead_load_ : Eigen::VectorXd::Zero(solid_->dofCount());
  if (loads_.size() > 0) load += loads_ * p;
  return load;
}

template <int D>
void SolidProblem<D>::evaluate(const Eigen::VectorXd& z, const Eigen::VectorXd& p, Order order, Evaluation& out) const {
  out.displacements = reduction_.expand(z, p);
  out.displacements.conservativeResize(solid_->dofCount());
  solid_->assemble(out.displacements, order, threads_, out.assembly);
  out.finite = out.assembly.finite;
  out.elastic_energy = out.energy = out.assembly.energy;
  out.force_scale = out.assembly.force_scale;
  out.min_det_f = out.assembly.min_det_f;
  out.min_det_f_cell = out.assembly.min_det_f_cell;
  const bool driven = loads_.size() > 0, loaded = driven || dead_load_.size() > 0;
  Eigen::VectorXd load;
  if (loaded) {
    load = loadAt(p);
    out.energy -= load.dot(out.displacements);
  }
  if (order == Order::ENERGY || !out.finite) return;
  Eigen::VectorXd force = out.assembly.gradient;
  if (loaded) force -= load;
  force = padded(force);
  out.residual = reduction_.restrictToFree(force);
  out.control_force = reduction_.restrictToControl(force);
  if (driven) out.control_force -= loads_.transpose() * out.displacements;
  if (loaded) {
    out.force_scale = std::max(out.force_scale, load.norm());
  }
  if (elasticity::withTangent(order)) gatherHessian(out.assembly.blocks, out.hessian);
}

template <int D>
void SolidProblem<D>::controlTangent(const Evaluation& at, const Eigen::VectorXd& dp, Eigen::VectorXd& free_part,
                                     Eigen::VectorXd& control_part) const {
  Eigen::VectorXd du = reduction_.expandDirection(Eigen::VectorXd::Zero(freeCount()), dp);
  du.conservativeResize(solid_->dofCount());
  Eigen::VectorXd df = solid_->pattern().multiply(at.assembly.blocks, du);
  if (loads_.size() > 0) df -= loads_ * dp;
  df = padded(df);
  free_part = reduction_.restrictToFree(df);
  control_part = reduction_.restrictToControl(df);
  if (loads_.size() > 0) control_part -= loads_.transpose() * du;
}

template <int D>
std::string SolidProblem<D>::describeCell(int cell) const {
  if (cell < 0) return "no cell";
  const int body = solid_->cellBody(cell);
  const auto centre = solid_->grid(body).cellCentre(solid_->cellAt(cell));
  std::ostringstream text;
  text << "cell " << cell << " of body " << body << " at (" << centre.transpose() << ") m";
  return text.str();
}

template class SolidProblem<2>;
template class SolidProblem<3>;

}  // namespace snapwing::solver
