#include <cmath>

#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"
#include "snapwing/elasticity/green_strain.h"
#include "snapwing/solver/material_damping.h"

namespace snapwing::solver {

using elasticity::Matrix;

/// Green's strain of every particle at the step's start, in the order of eachParticle().
template <int D>
struct KelvinVoigtTerm<D>::Strains : Memory {
  std::vector<Matrix<D>> green;
};

template <int D>
KelvinVoigtTerm<D>::KelvinVoigtTerm(std::shared_ptr<const mpm::Discretisation<D>> solid, double beta, int region,
                                    int first)
    : solid_(std::move(solid)), beta_(beta), region_(region), first_(first) {
  if (!std::isfinite(beta) || beta < 0) {
    throw common::Error("Kelvin-Voigt damping: beta is " + common::toText(beta) + " s; allowed: >= 0");
  }
  for (int c = 0; c < solid_->cellCount(); ++c) {
    std::vector<Moduli>& own = moduli_.emplace_back();
    for (const mpm::Term& term : solid_->terms(solid_->cell(c).kind)) {
      elasticity::Response<D> rest;
      solid_->model(term.model).evaluate(Matrix<D>::Identity(), solid_->cell(c).density, Order::TANGENT, rest);
      const elasticity::FullTangent<D> a = rest.compact ? rest.tangent.full() : rest.full;
      own.push_back({a(0, D + 1), a(1, 1)});  // dP_00/dF_11, dP_10/dF_10
    }
  }
}

/// Visits (number, cell, term, rule, particle) in a fixed order.
template <int D>
template <class Visit>
void KelvinVoigtTerm<D>::eachParticle(const Visit& visit) const {
  std::size_t number = 0;
  for (int c = 0; c < solid_->cellCount(); ++c) {
    const std::vector<mpm::Term>& terms = solid_->terms(solid_->cell(c).kind);
    for (std::size_t t = 0; t < terms.size(); ++t) {
      const mpm::QuadratureRule<D>& rule = solid_->rule(terms[t].rule);
      for (int p = 0; p < rule.size(); ++p) visit(number++, c, t, rule, p);
    }
  }
}

namespace {

/// Gradient h of the displacements: F = I + h.
template <int D>
Matrix<D> gradientAt(const mpm::Discretisation<D>& solid, const Eigen::VectorXd& y, int first, int cell,
                     const mpm::QuadratureRule<D>& rule, int particle) {
  Matrix<D> h = Matrix<D>::Zero();
  const int* nodes = solid.cellNodes(cell);
  const double* slope = rule.slopeOf(particle);
  for (int a = 0; a < rule.stencil; ++a) {
    const Eigen::Map<const Eigen::Matrix<double, D, 1>> g(slope + D * a);
    h += y.template segment<D>(first + D * nodes[a]) * g.transpose();
  }
  return h;
}

}  // namespace

template <int D>
std::shared_ptr<const Memory> KelvinVoigtTerm<D>::keep(const Point& start) const {
  auto strains = std::make_shared<Strains>();
  eachParticle([&](std::size_t, int c, std::size_t, const mpm::QuadratureRule<D>& rule, int p) {
    strains->green.push_back(elasticity::greenStrain<D>(gradientAt(*solid_, start.y, first_, c, rule, p)));
  });
  return strains;
}

template <int D>
void KelvinVoigtTerm<D>::evaluate(const Point& at, Order order, Sum& sum) const {
  if (at.step == nullptr || at.kept == nullptr) return;
  const std::vector<Matrix<D>>& before = static_cast<const Strains*>(at.kept)->green;
  const double factor = beta_ / at.step->h;
  double forces = 0, rounding = 0;
  double* values = elasticity::withTangent(order) ? sum.hessian.data() + sum.region_place[region_] : nullptr;
  eachParticle([&](std::size_t number, int c, std::size_t t, const mpm::QuadratureRule<D>& rule, int p) {
    const double weight = factor * solid_->cell(c).measure * rule.weight[p];
    const Moduli& m = moduli_[c][t];
    const Matrix<D> h = gradientAt(*solid_, at.y, first_, c, rule, p), f = Matrix<D>::Identity() + h;
    const Matrix<D> d = elasticity::greenStrain<D>(h) - before[number];
    const Matrix<D> s = m.lambda * d.trace() * Matrix<D>::Identity() + 2 * m.mu * d;
    sum.energy += 0.5 * weight * s.cwiseProduct(d).sum();
    if (order == Order::ENERGY) return;
    const int* nodes = solid_->cellNodes(c);
    const Eigen::Map<const Eigen::Matrix<double, D, Eigen::Dynamic>> g(rule.slopeOf(p), D, rule.stencil);
    const Eigen::Matrix<double, D, Eigen::Dynamic> sg = s * g, fg = f * sg;
    for (int a = 0; a < rule.stencil; ++a)
      sum.gradient.template segment<D>(first_ + D * nodes[a]) += weight * fg.col(a);
    forces += weight * weight * fg.squaredNorm();
    const double stiff = weight * (m.lambda + 2 * m.mu);
    rounding += stiff * stiff * g.squaredNorm();
    if (values == nullptr) return;
    // dS = lambda (F : dF) I + mu (F^T dF + dF^T F);  d(F S g_a) = dF S g_a + F dS g_a, dF = v g_b^T
    const Matrix<D> ff = f * f.transpose();
    const Eigen::Matrix<double, D, Eigen::Dynamic> moved = f * g;  // F g_a
    for (int b = 0; b < rule.stencil; ++b) {
      for (int a = 0; a < rule.stencil; ++a) {
        if (nodes[a] < nodes[b]) continue;
        const double gg = g.col(a).dot(g.col(b));
        Matrix<D> k = m.lambda * moved.col(a) * moved.col(b).transpose() +
                      m.mu * moved.col(b) * moved.col(a).transpose() + m.mu * gg * ff;
        // The stress's own part may be negative: left out where the Hessian must not be.
        if (order == Order::TANGENT) k += g.col(b).dot(sg.col(a)) * Matrix<D>::Identity();
        double* block = values + static_cast<std::size_t>(solid_->pattern().find(nodes[a], nodes[b])) * D * D;
        Eigen::Map<Matrix<D>>{block} += weight * k;
      }
    }
  });
  sum.noteForce(std::sqrt(forces));
  sum.noteRounding(std::numeric_limits<double>::epsilon() * std::sqrt(rounding));
}

template class KelvinVoigtTerm<2>;
template class KelvinVoigtTerm<3>;

}  // namespace snapwing::solver
