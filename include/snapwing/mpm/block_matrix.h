#pragma once
/// Symmetric sparse matrix of D x D blocks with a fixed pattern: block columns, lower triangle, diagonal blocks full.

#include <Eigen/Core>
#include <vector>

namespace snapwing::mpm {

template <int D>
class BlockPattern {
 public:
  BlockPattern() = default;
  /// @param nodes     number of block rows
  /// @param stencils  node numbers of all cells, `stencil` per cell
  BlockPattern(int nodes, const std::vector<int>& stencils, int stencil);

  int nodes() const { return static_cast<int>(start_.size()) - 1; }
  int blocks() const { return static_cast<int>(row_.size()); }
  /// Block number of (row, column), row >= column. The block must exist.
  int find(int row, int column) const;
  const std::vector<int>& start() const { return start_; }  ///< first block of each column
  const std::vector<int>& row() const { return row_; }      ///< row of each block, ascending in a column

  /// y = A x. @param values  of the blocks, D*D each by columns; @param x  (D nodes x 1)
  Eigen::VectorXd multiply(const std::vector<double>& values, const Eigen::Ref<const Eigen::VectorXd>& x) const;

 private:
  std::vector<int> start_{0};
  std::vector<int> row_;
};

}  // namespace snapwing::mpm
