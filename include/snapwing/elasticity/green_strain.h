#pragma once
/// Green's strain G = (F^T F - I) / 2.

#include "snapwing/elasticity/constitutive_model.h"

namespace snapwing::elasticity {

/// Of F = I + h [1]; no digits cancel at small h.
template <int D>
Matrix<D> greenStrain(const Matrix<D>& h) {
  return 0.5 * (h + h.transpose() + h.transpose() * h);
}

}  // namespace snapwing::elasticity
