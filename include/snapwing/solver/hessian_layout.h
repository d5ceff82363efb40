#pragma once
/// Where second derivatives may stand in the full coordinates: D x D node blocks of regions of cells, then one dense
/// lower triangle for each set of coordinates that a term couples. Decided once; a term has slots for nothing else.

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "snapwing/mpm/block_matrix.h"

namespace snapwing::solver {

class HessianLayout {
 public:
  /// @param full  number of full coordinates
  explicit HessianLayout(int full) : full_(full) {}
  /// Node blocks of a discretisation whose first displacement is coordinate `first`. @return number of the region
  template <int D>
  int addRegion(int first, const mpm::BlockPattern<D>& blocks);
  /// @throws common::Error for a coordinate that does not exist, or twice the same
  /// @return place of the couple's first value: the lower triangle by columns, in the order of the coordinates
  int addCouple(std::vector<int> coordinates);

  int fullCount() const { return full_; }
  int entries() const { return entries_; }
  int regionCount() const { return static_cast<int>(regions_.size()); }
  int regionFirst(int region) const { return regions_[region].first; }  ///< first coordinate
  int regionPlace(int region) const { return regions_[region].place; }  ///< of its first value
  int regionSize(int region) const { return regions_[region].nodes * regions_[region].dimension; }
  /// Every entry once, (row, column, place): a block row below its column, the diagonal's lower triangle.
  void each(const std::function<void(int row, int column, int place)>& visit) const;
  /// H x for values in this order. [N] for x in m
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
