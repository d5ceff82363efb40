// A vector with which no symmetry of a body agrees (private to the layer).
#pragma once

#include <Eigen/Core>

#include "snapwing/common/elementary.h"

namespace snapwing::solver {

inline Eigen::VectorXd unsymmetricVector(Eigen::Index size) {
  Eigen::VectorXd v(size);
  for (int k = 0; k < size; ++k) v(k) = common::sin(1.7 * k + 0.3);
  return v;
}

}  // namespace snapwing::solver
