#include "snapwing/solver/term.h"

namespace snapwing::solver {

void Sum::reset(const HessianLayout& layout, int controls, Order order) {
  energy = stored = force = rounding = 0;
  finite = true;
  min_det_f = std::numeric_limits<double>::infinity();
  min_det_f_cell = -1;
  worst = nullptr;
  solids.resize(layout.regionCount());
  region_place.resize(layout.regionCount());
  for (int r = 0; r < layout.regionCount(); ++r) region_place[r] = layout.regionPlace(r);
  if (order == Order::ENERGY) return;
  gradient.setZero(layout.fullCount());
  control.setZero(controls);
  if (elasticity::withTangent(order)) hessian.assign(layout.entries(), 0.0);
}

void Sum::addRankOne(int couple, double value, const Eigen::VectorXd& row) {
  int place = (*couples)[couple];
  for (Eigen::Index b = 0; b < row.size(); ++b) {
    for (Eigen::Index a = b; a < row.size(); ++a) hessian[place++] += value * row(a) * row(b);
  }
}

void Term::controlTangent(const Point&, const Eigen::VectorXd&, const Eigen::VectorXd&, Eigen::VectorXd&,
                          Eigen::VectorXd&) const {}

std::unique_ptr<ForceSeries> Term::series(int) const { return nullptr; }

std::shared_ptr<const Memory> Term::keep(const Point&) const { return nullptr; }

void Term::densityDerivative(const Point&, const Eigen::VectorXd*, Eigen::VectorXd&) const {}

std::string Term::describe(int place) const { return "place " + std::to_string(place) + " of " + name(); }

}  // namespace snapwing::solver
