#include "snapwing/elasticity/constitutive_model.h"

#include <Eigen/Dense>

namespace snapwing::elasticity {

template <int D>
Matrix<D> tangentTimes(const SharedTangent& shared, const Response<D>& response, const Matrix<D>& d_f) {
  using Vector = Eigen::Matrix<double, D * D, 1>;
  if (!response.compact) {
    Matrix<D> rest;
    Eigen::Map<Vector>(rest.data()) = response.full * Eigen::Map<const Vector>(d_f.data());
    return shared.a * d_f + rest + shared.b * d_f.trace() * Matrix<D>::Identity() + shared.c * d_f.transpose();
  }
  const CompactTangent<D>& t = response.tangent;
  return shared.a * d_f + t.b * t.q.cwiseProduct(d_f).sum() * t.q + t.c * t.q * d_f.transpose() * t.q +
         shared.b * d_f.trace() * Matrix<D>::Identity() + shared.c * d_f.transpose();
}

template <int D>
FullTangent<D> fullTangent(const SharedTangent& shared, const Response<D>& response) {
  FullTangent<D> result;
  for (int l = 0; l < D; ++l) {
    for (int k = 0; k < D; ++k) {
      Matrix<D> unit = Matrix<D>::Zero();
      unit(k, l) = 1;
      const Matrix<D> column = tangentTimes<D>(shared, response, unit);
      result.col(k + D * l) = Eigen::Map<const Eigen::Matrix<double, D * D, 1>>(column.data());
    }
  }
  return result;
}

template Matrix<2> tangentTimes(const SharedTangent&, const Response<2>&, const Matrix<2>&);
template Matrix<3> tangentTimes(const SharedTangent&, const Response<3>&, const Matrix<3>&);
template FullTangent<2> fullTangent(const SharedTangent&, const Response<2>&);
template FullTangent<3> fullTangent(const SharedTangent&, const Response<3>&);

}  // namespace snapwing::elasticity
