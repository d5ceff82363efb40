#pragma once
/// Storage of the Hessian in full coordinates: D x D node blocks of regions of cells, then one dense lower triangle for
/// each set of coordinates that a term couples. Fixed at setup; a term can write nowhere else.

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "snapwing/mpm/block_matrix.h"

namespace snapwing::solver {

class HessianLayout {
 public:
  /// @param full  number of full coordinates
  explicit HessianLayout(int full) : full_(full) {}
  /// Adds the node blocks of a discretisation whose first displacement is full coordinate `first`.
  /// @return number of the region. @throws common::Error if it does not fit, or after addCouple()
  template <int D>
  int addRegion(int first, const mpm::BlockPattern<D>& blocks);
  /// Adds the lower triangle, by columns, of these coordinates in their order. @return index of its first value
  /// @throws common::Error for a coordinate that does not exist or repeats
  int addCouple(std::vector<int> coordinates);

  int fullCount() const { return full_; }
  int entries() const { return entries_; }
  int regionCount() const { return static_cast<int>(regions_.size()); }
  int regionFirst(int region) const { return regions_[region].first; }  ///< first full coordinate
  int regionPlace(int region) const { return regions_[region].place; }  ///< index of its first value
  int regionSize(int region) const { return regions_[region].nodes * regions_[region].dimension; }
  /// Visits every stored entry once, place: its index. Of diagonal blocks only the lower triangle. A couple's row may
  /// be less than its column, where its coordinates do not ascend.
  void each(const std::function<void(int row, int column, int place)>& visit) const;
  /// H x. @param values  [N/m] in this storage; @param x  (full x 1) [m]. @return [N]
  Eigen::VectorXd multiply(const std::vector<double>& values, const Eigen::VectorXd& x) const;

 private:
  struct Region {
    int first = 0, dimension = 0, nodes = 0, place = 0;
    std::vector<int> start, row;  ///< blocks by columns of nodes
  };
  struct Couple {
    std::vector<int> coordinates;
    int place = 0;
  };
  int full_, entries_ = 0;
  std::vector<Region> regions_;
  std::vector<Couple> couples_;
};

}  // namespace snapwing::solver
