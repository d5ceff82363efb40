#pragma once
/// Particles of a solid for viscous laws that are linear in Green's strain G. C: moduli of each particle's elastic law
/// at rest, isotropic.

#include <limits>
#include <memory>
#include <vector>

#include "snapwing/elasticity/green_strain.h"
#include "snapwing/mpm/discretisation.h"
#include "snapwing/solver/term.h"

namespace snapwing::solver {

template <int D>
class GreenParticles {
 public:
  using Matrix = elasticity::Matrix<D>;
  struct Moduli {
    double lambda = 0, mu = 0;  ///< [Pa]
    Matrix stress(const Matrix& g) const { return lambda * g.trace() * Matrix::Identity() + 2 * mu * g; }
  };
  struct Particle {
    std::size_t number = 0;   ///< in the order of each()
    int cell = 0, index = 0;  ///< index: of the particle in its rule
    double measure = 0;       ///< [m3]
    const Moduli* moduli = nullptr;
    const mpm::QuadratureRule<D>* rule = nullptr;
  };
  /// Destination of one evaluation's forces and stiffness.
  struct Target {
    Sum& sum;
    Order order;
    double* values = nullptr;         ///< the region's blocks, if the order includes the Hessian
    double forces = 0, rounding = 0;  ///< sums that finish() turns into noteForce and noteRounding
    void finish() const;
  };

  /// @param solid  finished; @param first  its first coordinate
  GreenParticles(std::shared_ptr<const mpm::Discretisation<D>> solid, int region, int first);

  int region() const { return region_; }
  std::size_t count() const { return count_; }
  Target target(Order order, Sum& sum) const;
  /// Calls visit(particle) for all particles in a fixed order.
  template <class Visit>
  void each(const Visit& visit) const;
  /// Displacement gradient h [1]: F = I + h.
  Matrix gradient(const Eigen::VectorXd& y, const Particle& at) const;
  /// Green's strain G = (F^T F - I) / 2 [1].
  Matrix strain(const Eigen::VectorXd& y, const Particle& at) const {
    return elasticity::greenStrain<D>(gradient(y, at));
  }
  /// Adds force and stiffness of a second Piola-Kirchhoff stress s(G) at F = I + h.
  /// @param s        [Pa], with ds/dG = scale C
  /// @param weight, stiffness_weight  [m3], times force and stiffness
  void add(const Particle& at, const Matrix& h, const Matrix& s, double scale, double weight, double stiffness_weight,
           Target& to) const;

 private:
  void addStiffness(const Particle& at, const Matrix& f, const Matrix& s, double scale, double weight,
                    Target& to) const;

  std::shared_ptr<const mpm::Discretisation<D>> solid_;
  int region_, first_;
  std::size_t count_ = 0;
  std::vector<std::vector<Moduli>> moduli_;  ///< per cell and term of its kind
};

template <int D>
template <class Visit>
void GreenParticles<D>::each(const Visit& visit) const {
  Particle at;
  for (at.cell = 0; at.cell < solid_->cellCount(); ++at.cell) {
    const std::vector<mpm::Term>& terms = solid_->terms(solid_->cell(at.cell).kind);
    for (std::size_t t = 0; t < terms.size(); ++t) {
      at.rule = &solid_->rule(terms[t].rule);
      at.moduli = &moduli_[at.cell][t];
      for (at.index = 0; at.index < at.rule->size(); ++at.index, ++at.number) {
        at.measure = solid_->cell(at.cell).measure * at.rule->weight[at.index];
        visit(at);
      }
    }
  }
}

}  // namespace snapwing::solver
