#include "snapwing/solver/green_particles.h"

#include <cmath>

namespace snapwing::solver {

template <int D>
GreenParticles<D>::GreenParticles(std::shared_ptr<const mpm::Discretisation<D>> solid, int region, int first)
    : solid_(std::move(solid)), region_(region), first_(first) {
  for (int c = 0; c < solid_->cellCount(); ++c) {
    std::vector<Moduli>& own = moduli_.emplace_back();
    for (const mpm::Term& term : solid_->terms(solid_->cell(c).kind)) {
      const elasticity::ConstitutiveModel<D>& law = solid_->model(term.model);
      const elasticity::DensityInterpolation::Value state = law.prepare(solid_->cell(c).density);
      elasticity::Response<D> rest;
      law.evaluatePrepared(Matrix::Identity(), state, Order::TANGENT, rest);
      const elasticity::FullTangent<D> a = elasticity::fullTangent<D>(law.shared(state, Order::TANGENT), rest);
      own.push_back({a(0, D + 1), a(1, 1)});  // dP_00/dF_11, dP_10/dF_10
      count_ += static_cast<std::size_t>(solid_->rule(term.rule).size());
    }
  }
}

template <int D>
typename GreenParticles<D>::Target GreenParticles<D>::target(Order order, Sum& sum) const {
  Target to{sum, order};
  if (elasticity::withTangent(order)) to.values = sum.hessian.data() + sum.region_place[region_];
  return to;
}

template <int D>
void GreenParticles<D>::Target::finish() const {
  sum.noteForce(std::sqrt(forces));
  sum.noteRounding(std::numeric_limits<double>::epsilon() * std::sqrt(rounding));
}

template <int D>
typename GreenParticles<D>::Matrix GreenParticles<D>::gradient(const Eigen::VectorXd& y, const Particle& at) const {
  Matrix h = Matrix::Zero();
  const int* nodes = solid_->cellNodes(at.cell);
  const double* slope = at.rule->slopeOf(at.index);
  for (int a = 0; a < at.rule->stencil; ++a) {
    const Eigen::Map<const Eigen::Matrix<double, D, 1>> g(slope + D * a);
    h += y.template segment<D>(first_ + D * nodes[a]) * g.transpose();
  }
  return h;
}

template <int D>
void GreenParticles<D>::add(const Particle& at, const Matrix& h, const Matrix& s, double scale, double weight,
                            double stiffness_weight, Target& to) const {
  if (to.order == Order::ENERGY) return;
  const Matrix f = Matrix::Identity() + h;
  const int* nodes = solid_->cellNodes(at.cell);
  const Eigen::Map<const Eigen::Matrix<double, D, Eigen::Dynamic>> g(at.rule->slopeOf(at.index), D, at.rule->stencil);
  const Matrix fs = f * s;
  double squares = 0;
  for (int a = 0; a < at.rule->stencil; ++a) {
    const Eigen::Matrix<double, D, 1> force = fs * g.col(a);
    to.sum.gradient.template segment<D>(first_ + D * nodes[a]) += weight * force;
    squares += force.squaredNorm();
  }
  to.forces += weight * weight * squares;
  const double stiff = weight * scale * (at.moduli->lambda + 2 * at.moduli->mu);
  to.rounding += stiff * stiff * g.squaredNorm();
  if (to.values != nullptr) addStiffness(at, f, s, scale, stiffness_weight, to);
}

/// ds = scale (lambda (F : dF) I + mu (F^T dF + dF^T F));  d(F s g_a) = dF s g_a + F ds g_a, dF = v g_b^T
template <int D>
void GreenParticles<D>::addStiffness(const Particle& at, const Matrix& f, const Matrix& s, double scale, double weight,
                                     Target& to) const {
  const int* nodes = solid_->cellNodes(at.cell);
  const Eigen::Map<const Eigen::Matrix<double, D, Eigen::Dynamic>> g(at.rule->slopeOf(at.index), D, at.rule->stencil);
  const double lambda = scale * at.moduli->lambda, mu = scale * at.moduli->mu;
  const Matrix ff = mu * (f * f.transpose());
  for (int b = 0; b < at.rule->stencil; ++b) {
    const Eigen::Matrix<double, D, 1> moved_b = f * g.col(b), sb = s * g.col(b);
    for (int a = 0; a < at.rule->stencil; ++a) {
      if (nodes[a] < nodes[b]) continue;
      const Eigen::Matrix<double, D, 1> moved_a = f * g.col(a);
      Matrix k =
          lambda * moved_a * moved_b.transpose() + mu * moved_b * moved_a.transpose() + g.col(a).dot(g.col(b)) * ff;
      // The stress's own part may be negative: left out where the Hessian must not be.
      if (to.order == Order::TANGENT) k += g.col(a).dot(sb) * Matrix::Identity();
      double* block = to.values + static_cast<std::size_t>(solid_->pattern().find(nodes[a], nodes[b])) * D * D;
      Eigen::Map<Matrix>{block} += weight * k;
    }
  }
}

template class GreenParticles<2>;
template class GreenParticles<3>;

}  // namespace snapwing::solver
