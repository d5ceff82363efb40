#pragma once
/// The part of the battery on power series: a law's tape of Taylor arithmetic against its own stress and tangent.

#include <algorithm>

#include "law_battery.h"

namespace snapwing::elasticity {

/// The stress along a path F(t) = F_0 + F_1 t + F_2 t^2 by the tape's coefficients, P_k = A : F_k + remainder.
template <int D>
std::vector<Matrix<D>> stressSeries(const Variant<D>& v, const std::vector<Matrix<D>>& path, int order) {
  TaylorTape tape(D * D);
  v.model->writeStress(tape);
  EXPECT_EQ(tape.results(), D * D) << v.name;
  std::vector<Lanes> state(tape.room(order)), results(tape.results()), change(tape.nodes());
  const auto matrix = [](const std::vector<Lanes>& lanes) {
    Matrix<D> m;
    for (int k = 0; k < D * D; ++k) m.data()[k] = lanes[k].at[LANES - 1];
    return m;
  };
  const auto give = [](const Matrix<D>& m, Lanes* lanes) {
    for (int k = 0; k < D * D; ++k) std::fill(lanes[k].at, lanes[k].at + LANES, m.data()[k]);
  };
  Response<D> r;
  EXPECT_TRUE(v.model->evaluate(path[0], 1, Order::TANGENT, r));
  const SharedTangent shared = v.model->shared(v.model->prepare(1), Order::TANGENT);
  give(path[0], tape.inputsOf(state.data()));
  tape.start(state.data(), results.data());
  std::vector<Matrix<D>> coefficients = {matrix(results)};
  for (int k = 1; k <= order; ++k) {
    const Matrix<D> own = k < static_cast<int>(path.size()) ? path[k] : Matrix<D>::Zero();
    tape.remainder(k, state.data(), results.data());
    coefficients.push_back(matrix(results) + tangentTimes<D>(shared, r, own));
    give(own, change.data());
    tape.complete(k, state.data(), change.data());
  }
  return coefficients;
}

/// What a series of n coefficients leaves of the stress falls with the power n of the way.
template <int D>
void checkSeries(const Laws<D>& laws) {
  std::mt19937 rng(13);
  constexpr int ORDER = 8;
  for (const auto& v : laws) {
    const std::vector<Matrix<D>> path = {randomGradient<D>(rng), randomMatrix<D>(rng, 0.5), randomMatrix<D>(rng, 0.5)};
    const std::vector<Matrix<D>> coefficients = stressSeries<D>(v, path, ORDER);
    const auto error = [&](int count, double t) {
      Response<D> r;
      EXPECT_TRUE(v.model->evaluate(path[0] + t * path[1] + t * t * path[2], 1, Order::STRESS, r));
      for (int k = 0; k < count; ++k) r.stress -= std::pow(t, k) * coefficients[k];
      return r.stress.norm();
    };
    const double size = coefficients[0].norm() + coefficients[1].norm();
    EXPECT_LT(error(1, 1e-15), 1e-13 * size) << v.name;
    for (int count = 2; count <= ORDER + 1; ++count) {
      const double t = std::pow(1e-9, 1.0 / count);  // what is left is far above rounding
      const double far = error(count, 0.5 * t), near = error(count, 0.25 * t);
      EXPECT_LT(near, std::max(std::pow(0.62, count) * far, 1e-14 * size))
          << v.name << ", " << count << " coefficients";
    }
    EXPECT_LT(error(ORDER + 1, 0.05), 1e-7 * size) << v.name;
  }
}

}  // namespace snapwing::elasticity
