#include "snapwing/mpm/block_matrix.h"

#include <algorithm>

namespace snapwing::mpm {

template <int D>
BlockPattern<D>::BlockPattern(int nodes, const std::vector<int>& stencils, int stencil) {
  std::vector<std::vector<int>> columns(nodes);
  const int cells = stencil > 0 ? static_cast<int>(stencils.size()) / stencil : 0;
  for (int c = 0; c < cells; ++c) {
    const int* nodes_of = stencils.data() + static_cast<std::size_t>(c) * stencil;
    for (int a = 0; a < stencil; ++a) {
      std::vector<int>& column = columns[nodes_of[a]];
      for (int b = 0; b < stencil; ++b) {
        if (nodes_of[b] >= nodes_of[a]) column.push_back(nodes_of[b]);
      }
      // Neighbouring cells repeat most nodes: sort now and then to keep the lists short.
      if (column.size() > 4096) {
        std::sort(column.begin(), column.end());
        column.erase(std::unique(column.begin(), column.end()), column.end());
      }
    }
  }
  start_.assign(1, 0);
  for (std::vector<int>& column : columns) {
    std::sort(column.begin(), column.end());
    column.erase(std::unique(column.begin(), column.end()), column.end());
    row_.insert(row_.end(), column.begin(), column.end());
    start_.push_back(static_cast<int>(row_.size()));
    std::vector<int>().swap(column);
  }
}

template <int D>
int BlockPattern<D>::find(int row, int column) const {
  const auto first = row_.begin() + start_[column], last = row_.begin() + start_[column + 1];
  return static_cast<int>(std::lower_bound(first, last, row) - row_.begin());
}

template <int D>
Eigen::VectorXd BlockPattern<D>::multiply(const std::vector<double>& values,
                                          const Eigen::Ref<const Eigen::VectorXd>& x) const {
  using Block = Eigen::Matrix<double, D, D>;
  Eigen::VectorXd y = Eigen::VectorXd::Zero(x.size());
  for (int column = 0; column < nodes(); ++column) {
    for (int k = start_[column]; k < start_[column + 1]; ++k) {
      const Eigen::Map<const Block> block(values.data() + static_cast<std::size_t>(k) * D * D);
      const int row = row_[k];
      y.template segment<D>(D * row) += block * x.template segment<D>(D * column);
      if (row != column) y.template segment<D>(D * column) += block.transpose() * x.template segment<D>(D * row);
    }
  }
  return y;
}

template class BlockPattern<2>;
template class BlockPattern<3>;

}  // namespace snapwing::mpm
