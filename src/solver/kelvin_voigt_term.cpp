#include <cmath>

#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"
#include "snapwing/solver/material_damping.h"

namespace snapwing::solver {

using elasticity::Matrix;

/// Green's strain of every particle at the step's start.
template <int D>
struct KelvinVoigtTerm<D>::Strains : Memory {
  std::vector<Matrix<D>> green;
};

template <int D>
KelvinVoigtTerm<D>::KelvinVoigtTerm(std::shared_ptr<const mpm::Discretisation<D>> solid, double beta, int region,
                                    int first)
    : particles_(std::move(solid), region, first), beta_(beta) {
  if (!std::isfinite(beta) || beta < 0) {
    throw common::Error("Kelvin-Voigt damping: beta is " + common::toText(beta) + " s; allowed: >= 0");
  }
}

template <int D>
std::shared_ptr<const Memory> KelvinVoigtTerm<D>::keep(const Point& start) const {
  auto strains = std::make_shared<Strains>();
  strains->green.reserve(particles_.count());
  particles_.each([&](const auto& p) { strains->green.push_back(particles_.strain(start.y, p)); });
  return strains;
}

template <int D>
void KelvinVoigtTerm<D>::evaluate(const Point& at, Order order, Sum& sum) const {
  if (at.step == nullptr || at.kept == nullptr) return;
  const std::vector<Matrix<D>>& before = static_cast<const Strains*>(at.kept)->green;
  const double factor = beta_ / at.step->h;
  auto target = particles_.target(order, sum);
  particles_.each([&](const auto& p) {
    const double weight = factor * p.measure;
    const Matrix<D> h = particles_.gradient(at.y, p);
    const Matrix<D> d = elasticity::greenStrain<D>(h) - before[p.number];
    const Matrix<D> s = p.moduli->stress(d);
    sum.energy += 0.5 * weight * s.cwiseProduct(d).sum();
    particles_.add(p, h, s, 1, weight, weight, target);
  });
  if (order != Order::ENERGY) target.finish();
}

template class KelvinVoigtTerm<2>;
template class KelvinVoigtTerm<3>;

}  // namespace snapwing::solver
