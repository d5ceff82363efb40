#pragma once
// The Hessian of a term that announces one couple.

#include <Eigen/Core>

#include "snapwing/solver/term.h"

namespace snapwing::motion {

/// Adds a symmetric matrix to the first couple of the term that is evaluated.
inline void addCouple(const Eigen::MatrixXd& block, solver::Sum& sum) {
  int place = (*sum.couples)[0];
  for (Eigen::Index column = 0; column < block.cols(); ++column) {
    for (Eigen::Index row = column; row < block.rows(); ++row) sum.hessian[place++] += block(row, column);
  }
}

}  // namespace snapwing::motion
