#include <cmath>

#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"
#include "snapwing/solver/material_damping.h"

namespace snapwing::solver {

/// The damping matrix at the step's start [N s/m], in the region's blocks.
template <int D>
struct RayleighTerm<D>::Lagged : Memory {
  std::vector<double> blocks;
};

template <int D>
RayleighTerm<D>::RayleighTerm(std::shared_ptr<const mpm::Discretisation<D>> solid,
                              std::shared_ptr<const mpm::Mass<D>> mass, double a, double b, LaggedTangent tangent,
                              int region, int first)
    : solid_(std::move(solid)),
      mass_(std::move(mass)),
      a_(a),
      b_(b),
      tangent_(tangent),
      region_(region),
      first_(first) {
  for (const auto& [name, value] : {std::pair{"a [1/s]", a}, std::pair{"b [s]", b}}) {
    if (!std::isfinite(value) || value < 0) {
      throw common::Error("Rayleigh damping: " + std::string(name) + " is " + common::toText(value) +
                          "; allowed: >= 0");
    }
  }
  if (a > 0 && mass_ == nullptr) throw common::Error("Rayleigh damping: a > 0 needs the solid's mass");
}

template <int D>
std::shared_ptr<const Memory> RayleighTerm<D>::keep(const Point& start) const {
  auto lagged = std::make_shared<Lagged>();
  lagged->blocks.assign(static_cast<std::size_t>(solid_->pattern().blocks()) * D * D, 0.0);
  if (b_ > 0) {
    mpm::Assembly at;
    const Order order = tangent_ == LaggedTangent::EXACT ? Order::TANGENT : Order::PROJECTED;
    solid_->assemble(start.y.segment(first_, solid_->dofCount()), order, start.threads, at);
    for (std::size_t k = 0; k < lagged->blocks.size(); ++k) lagged->blocks[k] = b_ * at.blocks[k];
  }
  if (a_ > 0) {
    for (std::size_t k = 0; k < mass_->blocks().size(); ++k) {
      for (int i = 0; i < D; ++i) lagged->blocks[k * D * D + i + D * i] += a_ * mass_->blocks()[k];
    }
  }
  return lagged;
}

template <int D>
void RayleighTerm<D>::evaluate(const Point& at, Order order, Sum& sum) const {
  if (at.step == nullptr || at.kept == nullptr) return;
  const std::vector<double>& c = static_cast<const Lagged*>(at.kept)->blocks;
  const int dofs = solid_->dofCount();
  const Eigen::VectorXd d = at.y.segment(first_, dofs) - at.step->y0.segment(first_, dofs);
  const Eigen::VectorXd force = solid_->pattern().multiply(c, d) / at.step->h;
  sum.energy += 0.5 * force.dot(d);
  if (order == Order::ENERGY) return;
  sum.gradient.segment(first_, dofs) += force;
  sum.noteForce(force.norm());
  if (!elasticity::withTangent(order)) return;
  double* values = sum.hessian.data() + sum.region_place[region_];
  for (std::size_t k = 0; k < c.size(); ++k) values[k] += c[k] / at.step->h;
}

template class RayleighTerm<2>;
template class RayleighTerm<3>;

}  // namespace snapwing::solver
