#pragma once
/// Elastic energy of solids on background grids (mpm::Discretisation).

#include <memory>

#include "snapwing/solver/term.h"

namespace snapwing::solver {

template <int D>
class ElasticTerm : public Term {
 public:
  /// @param solid   finished
  /// @param region  of the layout that the solid's pattern defines
  /// @param first   full coordinate of the solid's first displacement
  explicit ElasticTerm(std::shared_ptr<const mpm::Discretisation<D>> solid, int region = 0, int first = 0)
      : solid_(std::move(solid)), region_(region), first_(first) {}

  std::string name() const override { return "elasticity"; }
  Role role() const override { return Role::STORED; }
  int region() const override { return region_; }
  void evaluate(const Point& at, Order order, Sum& sum) const override;
  std::unique_ptr<ForceSeries> series(int order) const override;
  void densityDerivative(const Point& at, const Eigen::VectorXd* v, Eigen::VectorXd& by_cell) const override;
  std::string describe(int cell) const override;

  const mpm::Discretisation<D>& solid() const { return *solid_; }
  int first() const { return first_; }  ///< full coordinate of the solid's first displacement
  std::shared_ptr<const mpm::Discretisation<D>> sharedSolid() const { return solid_; }

 private:
  std::shared_ptr<const mpm::Discretisation<D>> solid_;
  int region_, first_;
};

}  // namespace snapwing::solver
