#include "snapwing/statics/saddle_point.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace snapwing::statics {

using Eigen::MatrixXd;

RowRank rankOf(const ConstraintRows& H, double threshold) {
  RowRank result;
  const auto rows = H.rows();
  if (rows == 0 || rows > H.cols()) return result;
  // The singular values of H are those of the small triangle of H^T = Q R.
  const Eigen::HouseholderQR<MatrixXd> qr(MatrixXd(H).transpose());
  const MatrixXd R = qr.matrixQR().topRows(rows).template triangularView<Eigen::Upper>();
  const Eigen::JacobiSVD<MatrixXd> svd(R, Eigen::ComputeFullV);
  const Eigen::VectorXd& values = svd.singularValues();
  result.smallest = values[0] > 0 ? values[rows - 1] / values[0] : 0;
  for (Eigen::Index k = 0; k < rows; ++k) result.rank += values[k] > threshold * values[0] ? 1 : 0;
  const Eigen::VectorXd last = svd.matrixV().col(rows - 1);
  for (Eigen::Index k = 0; k < rows; ++k) {
    if (std::abs(last[k]) > 0.3 * last.cwiseAbs().maxCoeff()) result.culprits.push_back(static_cast<int>(k));
  }
  return result;
}

namespace {

struct Entry {
  int column, row, source;
  double base;
};

template <int D>
std::vector<Entry> entriesOf(const mpm::BlockPattern<D>& blocks, const ConstraintRows& H, double weight) {
  std::vector<Entry> entries;
  for (int column = 0; column < blocks.nodes(); ++column) {
    for (int b = blocks.start()[column]; b < blocks.start()[column + 1]; ++b) {
      for (int k = 0; k < D; ++k) {
        for (int i = 0; i < D; ++i) {
          const int row = D * blocks.row()[b] + i, col = D * column + k;
          if (row >= col) entries.push_back({col, row, b * D * D + i + D * k, 0});
        }
      }
    }
  }
  const Eigen::SparseMatrix<double> product = weight * (H.transpose() * H);
  for (int column = 0; column < product.outerSize(); ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator at(product, column); at; ++at) {
      if (at.row() >= column) entries.push_back({column, static_cast<int>(at.row()), -1, at.value()});
    }
  }
  std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return a.column != b.column ? a.column < b.column : a.row < b.row;
  });
  return entries;
}

}  // namespace

template <int D>
SaddlePoint<D>::SaddlePoint(const mpm::BlockPattern<D>& blocks, const ConstraintRows& H, double weight)
    : H_(H), weight_(weight) {
  pattern_.size = D * blocks.nodes();
  pattern_.start.assign(pattern_.size + 1, 0);
  const Entry* last = nullptr;
  const std::vector<Entry> entries = entriesOf<D>(blocks, H, weight);
  for (const Entry& e : entries) {
    if (last == nullptr || last->column != e.column || last->row != e.row) {
      if (e.row == e.column) diagonal_.push_back(pattern_.entries());
      pattern_.row.push_back(e.row);
      ++pattern_.start[e.column + 1];
      source_.push_back(-1);
      base_.push_back(0);
    }
    if (e.source >= 0) source_.back() = e.source;
    base_.back() += e.base;
    last = &e;
  }
  for (int c = 0; c < pattern_.size; ++c) pattern_.start[c + 1] += pattern_.start[c];
  cholesky_ = std::make_unique<Cholesky>(pattern_);
}

template <int D>
bool SaddlePoint<D>::factorize(const std::vector<double>& blocks, double shift) {
  std::vector<double> values = base_;
  for (std::size_t k = 0; k < values.size(); ++k) values[k] += source_[k] >= 0 ? blocks[source_[k]] : 0;
  for (const int k : diagonal_) values[k] += shift;
  if (!cholesky_->factorize(values)) return false;
  spread_ = cholesky_->solve(MatrixXd(H_.transpose()));
  schur_.compute(H_ * spread_);
  return schur_.info() == Eigen::Success;
}

template <int D>
void SaddlePoint<D>::solve(const MatrixXd& f, const MatrixXd& g, MatrixXd* x, MatrixXd* y) const {
  const MatrixXd free = cholesky_->solve(MatrixXd(f + weight_ * (H_.transpose() * g)));
  *y = schur_.solve(H_ * free - g);
  *x = free - spread_ * *y;
}

template class SaddlePoint<2>;
template class SaddlePoint<3>;

}  // namespace snapwing::statics
